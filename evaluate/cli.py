"""The command line `manipuzzle`: one function per command, which only declares arguments and examples.

The work is done by `evaluate.commands`, imported when a command runs, so that `--help` and bad usage answer at once.

Output: results on stdout, as a table or with `--json` as exactly one JSON document; everything else on stderr.
Exit status: 0 done, 1 a clean negative (something is not solved, not valid, not solvable), 2 bad input or usage, with
one line `error: ...` on stderr and nothing on stdout; 130 after Ctrl-C, which keeps the files written so far.
"""

import os
import sys
from io import TextIOWrapper
from pathlib import Path
from typing import Annotated, Any, NoReturn, cast

import typer
import typer.core

NEGATIVE = 1
BAD_INPUT = 2
BROKEN_PIPE = 141
"""What a shell reports of a program that a closed pipe ended: 128 + SIGPIPE."""


class _ClosedPipe(Exception):  # noqa: N818 - no error
    """Whoever reads stdout has stopped."""


class _Commands(typer.core.TyperGroup):
    """Turns every way in which a command can end into an exit status and at most one line on stderr."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        try:
            status = super().main(*args, **{**kwargs, "standalone_mode": False})
            sys.stdout.flush()
        except ValueError as error:
            from pcg.errors import InputError

            if not isinstance(error, InputError):
                raise
            _fail(str(error))
        except typer.TyperException as error:
            _fail(error.format_message())
        except (BrokenPipeError, _ClosedPipe):
            # Python flushes stdout once more at its end, which would fail again.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            sys.exit(BROKEN_PIPE)
        except OSError as error:
            _fail(f"{error.filename}: {error.strerror}" if error.filename else str(error))
        sys.exit(status or 0)

    def invoke(self, ctx: Any) -> Any:
        # Typer would end with status 1, which says something else here.
        try:
            return super().invoke(ctx)
        except BrokenPipeError:
            raise _ClosedPipe from None


def _fail(message: str) -> NoReturn:
    typer.echo(f"error: {' '.join(message.split())}", err=True)
    sys.exit(BAD_INPUT)


app = typer.Typer(
    cls=_Commands,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)

Json = Annotated[bool, typer.Option("--json", help="Print exactly one JSON document.")]
Out = Annotated[Path, typer.Option(metavar="DIR", help="Folder for the results; made if missing.")]
Seed = Annotated[int, typer.Option(metavar="N", min=0, help="Seed of all random choices.")]
Scenes = Annotated[list[Path], typer.Argument(metavar="SCENE", help="Scene files (.yaml, .g).")]
Still = Annotated[str, typer.Option("--format", metavar="NAME", help="png or svg.")]
Theme = Annotated[str, typer.Option(metavar="NAME", help="Colours: paper or colorblind.")]
Preset = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="Change the geometry to a preset first: clear or published.", show_default=False),
]
Tolerance = Annotated[
    float | None,
    typer.Option(
        metavar="METRES", min=0, help="Penetration that counts as touching, instead of the scene's.", show_default=False
    ),
]
Baseline = Annotated[
    bool, typer.Option("--baseline", help="Let the random baseline answer the agents' requests, not their policies.")
]


def _asked(metavar: str, text: str, default: str, **limits: float) -> Any:
    """An option of `generate` whose default is that of the agent."""
    return typer.Option(metavar=metavar, help=text, show_default=default, **cast("Any", limits))


Workers = Annotated[int, typer.Option(metavar="N", min=1, max=1024, help="Processes that share the work.")]

Demonstrations = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR", help="Demonstrations {scene}.yaml for method Hum+R, instead of data/human.", show_default=False
    ),
]


def main() -> None:
    """Entry point of the `manipuzzle` program."""
    for stream in (sys.stdout, sys.stderr):
        # A name that the terminal's encoding lacks must not end the program.
        cast("TextIOWrapper", stream).reconfigure(errors="replace")
    app()


@app.callback(invoke_without_command=True)
def manipuzzle(
    context: typer.Context,
    *,
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
) -> None:
    """Generate, convert, check, solve and evaluate sequential manipulation puzzles."""
    if version:
        from importlib.metadata import version as version_of

        typer.echo(version_of("manipuzzle"))
    elif context.invoked_subcommand is None:
        typer.echo(context.get_help())


@app.command(short_help="Generate solvable levels.")
def generate(
    *,
    out: Out,
    agent: Annotated[
        str, typer.Option(metavar="NAME", help="What proposes levels: random, or m0 ... m35 of data/agents.yaml.")
    ] = "random",
    count: Annotated[int, typer.Option(metavar="N", min=1, help="Number of levels.")] = 10,
    seed: Seed = 0,
    rows: Annotated[int | None, _asked("N", "Inner rows.", "10", min=1, max=100)] = None,
    columns: Annotated[int | None, _asked("N", "Inner columns.", "10", min=1, max=100)] = None,
    crates: Annotated[int | None, _asked("N", "Crates of a level.", "2", min=1)] = None,
    targets: Annotated[int | None, _asked("N", "Targets of a level.", "1", min=1)] = None,
    min_pushes: Annotated[
        int | None, _asked("N", "Pushes that the shortest solution needs at least.", "3, or the agent's", min=0)
    ] = None,
    max_pushes: Annotated[int | None, _asked("N", "Pushes at most.", "any, or the agent's", min=0)] = None,
    min_density: Annotated[
        float | None, _asked("SHARE", "Walls by inner cells at least.", "0.05, or the agent's", min=0, max=1)
    ] = None,
    max_density: Annotated[
        float | None, _asked("SHARE", "Walls by inner cells at most.", "0.3, or the agent's", min=0, max=1)
    ] = None,
    occluded: Annotated[
        bool | None,
        typer.Option(
            "--occluded/--visible", help="Whether the player sees the goal crate; by default both.", show_default=False
        ),
    ] = None,
    dependency: Annotated[
        bool | None,
        typer.Option(
            "--dependency/--no-dependency",
            help="Whether another crate has to move first; by default both.",
            show_default=False,
        ),
    ] = None,
    frozen: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Tiles to keep: a level in XSB text with ? for open cells.", show_default=False
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Generate solvable levels as a level set: levels.xsb and manifest.jsonl.

    Example:  manipuzzle generate --agent random --count 10 --seed 0 --out out/levels
    """
    from evaluate.commands.generate import request_of, run

    request = request_of(
        agent,
        frozen,
        rows=rows,
        columns=columns,
        crates=crates,
        targets=targets,
        pushes=(min_pushes, max_pushes),
        wall_density=(min_density, max_density),
        occluded=occluded,
        dependency=dependency,
    )
    _exit(run(agent, count, seed, request, out, as_json=json))


corpus_app = typer.Typer(
    cls=_Commands,
    rich_markup_mode=None,
    short_help="Build the corpus of 360 levels, check it, plot it.",
    help="""Build the corpus of all agents, check that it can be built again, plot it.

    Example:  manipuzzle corpus check data/corpus
    """,
)
app.add_typer(corpus_app, name="corpus")


@corpus_app.command("build", short_help="Generate, select, split and document the corpus.")
def corpus_build(*, out: Out, baseline: Baseline = False, json: Json = False) -> None:
    """Let every agent of data/agents.yaml make 100 levels and keep 10: levels.xsb, manifest.jsonl and a data card.

    Example:  manipuzzle corpus build --out data/corpus
    """
    from evaluate.commands.corpus import build

    _exit(build(out, baseline=baseline, as_json=json))


@corpus_app.command("check", short_help="Build the corpus anew and compare.")
def corpus_check(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of the corpus.")],
    *,
    baseline: Baseline = False,
    json: Json = False,
) -> None:
    """Build the corpus anew, in memory, and report the levels that differ. Exit status 1 if one does.

    Example:  manipuzzle corpus check data/corpus
    """
    from evaluate.commands.corpus import check

    _exit(check(folder, baseline=baseline, as_json=json))


@corpus_app.command("plot", short_help="Draw the expressive range of level sets.")
def corpus_plot(
    folders: Annotated[list[Path], typer.Argument(metavar="DIR", help="Level sets.")],
    *,
    out: Out,
    format_: Annotated[str, typer.Option("--format", metavar="NAME", help="svg, pdf or png.")] = "png",
    json: Json = False,
) -> None:
    """Draw histograms of walls and pushes, one a level set: DIR/expressive-range.{format}.

    Example:  manipuzzle corpus plot data/corpus out/levels --out out/pictures
    """
    from evaluate.commands.corpus import plot

    _exit(plot(folders, out, format_, as_json=json))


@app.command("compare-generators", short_help="Compare the random baseline with the policies.")
def compare_generators(
    *,
    out: Out,
    seeds: Annotated[int, typer.Option(metavar="N", min=1, max=1000, help="Runs of each source on each task.")] = 3,
    seconds: Annotated[float, typer.Option(metavar="SECONDS", min=0.01, max=1e6, help="CPU time of a run.")] = 10.0,
    max_levels: Annotated[
        int, typer.Option(metavar="N", min=1, max=1_000_000, help="A run ends when it has made as many levels.")
    ] = 500,
    task: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="A task; repeat for several.", show_default="all")
    ] = None,
    bands: Annotated[
        bool, typer.Option("--bands", help="The tasks are the agents' bands of walls and pushes, instead.")
    ] = False,
    json: Json = False,
) -> None:
    """Let random baseline, untrained and trained policies make levels; DIR/comparison.md compares yield and diversity.

    Example:  manipuzzle compare-generators --out out/comparison --seeds 3 --seconds 10
    """
    from evaluate.commands.compare_generators import run

    _exit(run(out, seeds, seconds, max_levels, task or [], bands=bands, as_json=json))


@app.command(short_help="Train a policy that makes levels.")
def train(
    *,
    representation: Annotated[str, typer.Option(metavar="NAME", help="How it edits levels: narrow, turtle or wide.")],
    out: Out,
    steps: Annotated[int, typer.Option(metavar="N", min=1, help="Steps in all; rounded up.")] = 5_000_000,
    seed: Seed = 0,
    rows: Annotated[int, typer.Option(metavar="N", min=2, max=50, help="Inner rows of its levels.")] = 10,
    columns: Annotated[int, typer.Option(metavar="N", min=2, max=50, help="Inner columns.")] = 10,
    json: Json = False,
) -> None:
    """Train a policy by PPO on the CPU: {representation}.onnx, curve.png, checkpoints. Needs the extra rl.

    The same command continues an interrupted run, and with more steps a finished one.

    Example:  manipuzzle train --representation narrow --steps 5000000 --seed 0 --out out/narrow
    """
    from evaluate.commands.train import run

    _exit(run(representation, steps, seed, rows, columns, out, as_json=json))


@app.command(short_help="Report on levels: solvable, statistics, duplicates.")
def levels(
    files: Annotated[list[Path], typer.Argument(metavar="FILE", help="XSB files or level sets.")],
    *,
    json: Json = False,
) -> None:
    """Report on levels: solvable, solution, statistics, duplicates. Exit status 1 if one is not solvable.

    Example:  manipuzzle levels out/levels
    """
    from evaluate.commands.levels import run

    _exit(run(files, as_json=json))


@app.command(short_help="Convert levels and scenes to scene files.")
def convert(
    inputs: Annotated[list[Path], typer.Argument(metavar="LEVEL|SCENE", help="XSB files, level sets, scene files.")],
    *,
    out: Out,
    to: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="Format of the scenes: yaml, g (rai), mjcf (MuJoCo) or mjcf-mocap, in which a program moves the objects.",
        ),
    ] = "yaml",
    preset: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Geometry: clear (default for levels) or published.", show_default=False),
    ] = None,
    tolerance: Tolerance = None,
    cell: Annotated[float, typer.Option(metavar="METRES", help="Side of a cell.")] = 0.4,
    agent_radius: Annotated[
        float | None, typer.Option(metavar="METRES", help="By default that of the preset.", show_default=False)
    ] = None,
    agent_height: Annotated[float, typer.Option(metavar="METRES", help="Height of the agent.")] = 0.2,
    object_size: Annotated[float, typer.Option(metavar="METRES", help="Side of the box that a crate becomes.")] = 0.2,
    object_height: Annotated[
        float | None, typer.Option(metavar="METRES", help="By default objects are cubes.", show_default=False)
    ] = None,
    goal_size: Annotated[float, typer.Option(metavar="METRES", help="Side of the goal.")] = 0.35,
    wall_height: Annotated[float, typer.Option(metavar="METRES", help="Height of all walls.")] = 0.4,
    merge_walls: Annotated[
        bool, typer.Option("--merge-walls", help="Make adjacent wall cells the fewest bodies that fill the same space.")
    ] = False,
    size_jitter: Annotated[
        float, typer.Option(metavar="SHARE", help="Make each side of each object up to this share longer or shorter.")
    ] = 0.0,
    yaw_jitter: Annotated[
        float, typer.Option(metavar="RADIANS", help="Turn each object by up to this angle, either way.")
    ] = 0.0,
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Seed of the jitter.")] = 0,
    goal_crate: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            help="Crate, counted from 1 in reading order, that becomes the goal-object; by default the one that the "
            "level set names or the solver brings to the goal.",
            show_default=False,
        ),
    ] = None,
    drop_targets: Annotated[
        bool, typer.Option("--drop-targets", help="Remove all targets but the first, which is the goal.")
    ] = False,
    drop_crates: Annotated[
        bool, typer.Option("--drop-crates", help="Remove all crates but the goal crate, and the surplus targets.")
    ] = False,
    workers: Workers = 1,
    json: Json = False,
) -> None:
    """Convert levels and scenes to scene files DIR/{name}.yaml, .g, or .xml for MuJoCo.

    Of the options only --to, --preset and --tolerance apply to scenes. A level's scene records all of them.

    Example:  manipuzzle convert out/levels --out out/scenes --merge-walls --yaw-jitter 0.5 --seed 1
    """
    from evaluate.commands.convert import conversion_of, run

    conversion = conversion_of(
        out,
        to,
        preset,
        tolerance,
        cell=cell,
        wall_height=wall_height,
        object_size=object_size,
        object_height=object_height,
        goal_size=goal_size,
        agent_radius=agent_radius,
        agent_height=agent_height,
        merge_walls=merge_walls,
        size_jitter=size_jitter,
        yaw_jitter=yaw_jitter,
        seed=seed,
        goal_crate=goal_crate,
        drop_targets=drop_targets,
        drop_crates=drop_crates,
    )
    _exit(run(inputs, conversion, workers=workers, as_json=json))


@app.command(short_help="Check scenes in a 2D physics preview.")
def check(
    scenes: Scenes,
    *,
    plan: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="PLAN", help="Play a plan of one of the scenes back; repeat for more.", show_default=False
        ),
    ] = None,
    push: Annotated[
        float | None,
        typer.Option(
            metavar="METRES",
            min=0,
            max=100,
            help="Also drive this far against every object, from four sides.",
            show_default=False,
        ),
    ] = None,
    static: Annotated[bool, typer.Option("--static", help="Only check the scenes at rest.")] = False,
    picture: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Draw what was found to DIR/{scene}.png.", show_default=False)
    ] = None,
    preset: Preset = None,
    tolerance: Tolerance = None,
    workers: Workers = 1,
    json: Json = False,
) -> None:
    """Check scenes in a 2D physics preview: at rest, driving to every object and into the goal, playing plans back.

    At rest nothing may overlap or move. A disc that is told how fast to go then follows the exact planner's shortest
    way to each object and into the goal; contacts and what it pushes are reported. In a plan that is played back nothing
    but the carried object may move by more than a millimetre.

    Exit status 1 if a scene is not valid, the disc does not arrive at the end of its way, or a plan does not play back.
    That no way leads to an object is reported but no flaw, for others may have to be carried away first.

    Example:  manipuzzle check out/scenes/*.yaml --picture out/checks --workers 2
    """
    from evaluate.commands.check import Request, run

    request = Request(static=static, push=push, picture=picture)
    _exit(run(scenes, plan or [], request, preset=preset, tolerance=tolerance, workers=workers, as_json=json))


@app.command(short_help="Plan, and verify the plans.")
def solve(
    scenes: Scenes,
    *,
    out: Out,
    method: Annotated[
        str,
        typer.Option(metavar="NAME", help="Rnd+FPR, Rnd+FP, Rnd+FR, Rnd+R, Btl+FPR, Hum+R, MBTS, MBTS-rrt or Push."),
    ] = "Rnd+FPR",
    seed: Seed = 0,
    time_limit: Annotated[float, typer.Option(metavar="SECONDS", max=1e9, help="For each scene.")] = 60.0,
    improve: Annotated[
        float, typer.Option(metavar="SECONDS", min=0, max=1e9, help="Time for improving each plan that is found.")
    ] = 0.0,
    settings: Annotated[str, typer.Option(metavar="NAME", help="Settings of the planner: fast or faithful.")] = "fast",
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="NAME=VALUE", help="One setting of the planner; repeat for more.", show_default=False
        ),
    ] = None,
    demonstrations: Demonstrations = None,
    preset: Preset = None,
    tolerance: Tolerance = None,
    json: Json = False,
) -> None:
    """Plan, verify the plan, and write it to DIR/{scene}-{method}-{seed}.json. Exit status 1 if one is not solved.

    Example:  manipuzzle solve data/puzzles/cube-free.yaml --out out/plans
    """
    from evaluate.commands.solve import run, settings_of

    of_planner = settings_of(
        settings, set_ or [], demonstrations, method=method, time_limit=time_limit, improve=improve
    )
    _exit(run(scenes, out, of_planner, seed, preset=preset, tolerance=tolerance, as_json=json))


@app.command(short_help="Check a plan independently of the planner.")
def verify(
    scene: Annotated[Path, typer.Argument(metavar="SCENE", help="Scene file (.yaml, .g).")],
    plan: Annotated[Path, typer.Argument(metavar="PLAN", help="Plan file (.json).")],
    *,
    preset: Preset = None,
    tolerance: Tolerance = None,
    json: Json = False,
) -> None:
    """Check a plan independently of the planner and list every violation. Exit status 1 if there is one.

    Example:  manipuzzle verify data/puzzles/cube-free.yaml out/plans/cube-free-Rnd+FPR-0.json
    """
    from evaluate.commands.verify import run

    _exit(run(scene, plan, preset=preset, tolerance=tolerance, as_json=json))


@app.command(short_help="Draw levels, scenes and plans.")
def render(
    inputs: Annotated[
        list[Path], typer.Argument(metavar="LEVEL|SCENE|PLAN", help="XSB files, level sets, scenes, plans.")
    ],
    *,
    out: Out,
    format_: Annotated[
        str, typer.Option("--format", metavar="NAME", help="png or svg; of plans also gif, mp4, or html: a player.")
    ] = "png",
    sheet: Annotated[bool, typer.Option("--sheet", help="One contact sheet with names and verdicts.")] = False,
    storyboard: Annotated[bool, typer.Option("--storyboard", help="The key frames of plans: each grasp.")] = False,
    theme: Theme = "paper",
    width: Annotated[
        int | None, typer.Option(metavar="PIXELS", min=16, help="Width of pictures and frames.", show_default=False)
    ] = None,
    speed: Annotated[
        float, typer.Option(metavar="M/S", min=0.01, max=1000, help="Speed of the agent in animations.")
    ] = 1.0,
    scene: Annotated[
        Path | None, typer.Option(metavar="SCENE", help="Scene of plans whose files hold none.", show_default=False)
    ] = None,
    json: Json = False,
) -> None:
    """Draw levels, scenes and plans to DIR/{name}.{format}, or with --sheet all of them to DIR/sheet.{format}.

    html makes a page that plays plans, those of one scene side by side, without a network.

    Example:  manipuzzle render out/plans/*.json --out out/pictures --format gif
    """
    from evaluate.commands.render import Request, run
    from evaluate.picture_files import Style

    style = Style(theme=theme, width_px=width, speed=speed)
    _exit(run(inputs, out, Request(format_, scene, style, sheet=sheet, storyboard=storyboard), as_json=json))


@app.command(short_help="Export plans as tables over time or as PDDL.")
def export(
    plans: Annotated[list[Path], typer.Argument(metavar="PLAN", help="Plan files (.json).")],
    *,
    out: Out,
    to: Annotated[str, typer.Option(metavar="NAME", help="csv, npz (NumPy) or pddl.")] = "csv",
    speed: Annotated[float, typer.Option(metavar="M/S", help="Full speed of the agent.")] = 0.5,
    acceleration: Annotated[
        float, typer.Option(metavar="M/S2", min=0, help="Between way-points; 0 for constant speed without stops.")
    ] = 1.0,
    grasp_time: Annotated[float, typer.Option(metavar="SECONDS", help="Rest at each grasp and each release.")] = 0.0,
    step: Annotated[float, typer.Option(metavar="SECONDS", help="Time between rows; way-points are rows too.")] = 0.02,
    scene: Annotated[
        Path | None, typer.Option(metavar="SCENE", help="Scene of plans whose files hold none.", show_default=False)
    ] = None,
    json: Json = False,
) -> None:
    """Export plans to DIR/{name}.csv or .npz, or as PDDL to {name}-domain.pddl, {name}-problem.pddl and {name}.plan.

    Example:  manipuzzle export out/plans/*.json --to npz --speed 0.5 --step 0.02 --out out/trajectories
    """
    from evaluate.commands.export import profile_of, run

    profile = profile_of(speed, acceleration, grasp_time)
    _exit(run(plans, out, to=to, scene_path=scene, profile=profile, step=step, as_json=json))


@app.command(short_help="Write down where a person would put the objects.")
def demonstrate(
    scene: Annotated[Path, typer.Argument(metavar="SCENE", help="Scene file (.yaml, .g).")],
    *,
    out: Annotated[Path, typer.Option(metavar="FILE", help="Demonstration file (.yaml).")],
    point: Annotated[
        list[str] | None,
        typer.Option(
            metavar="OBJECT:X,Y", help="Where an object is put next [m]; repeat in order.", show_default=False
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Write a demonstration for method Hum: positions of objects, in order, from --point or from lines on stdin.

    Method Hum+R takes those of data/human, called after their scenes.

    Example:  manipuzzle demonstrate data/puzzles/wall.yaml --point obj:-1.75,-1.0 --out out/human/wall.yaml
    """
    from evaluate.commands.demonstrate import run

    _exit(run(scene, out, point or [], as_json=json))


@app.command(short_help="Draw the subgoals that a method proposes.")
def subgoals(
    scene: Annotated[Path, typer.Argument(metavar="SCENE", help="Scene file (.yaml, .g).")],
    *,
    out: Out,
    object_: Annotated[
        str | None, typer.Option("--object", metavar="NAME", help="By default the goal-object.", show_default=False)
    ] = None,
    method: Annotated[str, typer.Option(metavar="NAME", help="A method of the forward search.")] = "Rnd+FPR",
    seed: Seed = 0,
    settings: Annotated[str, typer.Option(metavar="NAME", help="Settings of the planner: fast or faithful.")] = "fast",
    format_: Still = "png",
    theme: Theme = "paper",
    json: Json = False,
) -> None:
    """Draw the subgoals that a method proposes for an object at the start, before and after the filter.

    Example:  manipuzzle subgoals data/puzzles/wall.yaml --method Btl+FPR --out out/pictures
    """
    from evaluate.commands.subgoals import run
    from planner import settings_for

    _exit(
        run(
            scene, out, settings_for(settings, method=method), seed, object_, format_=format_, theme=theme, as_json=json
        )
    )


@app.command(short_help="Draw the search tree of a method.")
def tree(
    scene: Annotated[Path, typer.Argument(metavar="SCENE", help="Scene file (.yaml, .g).")],
    *,
    out: Out,
    method: Annotated[str, typer.Option(metavar="NAME", help="A method of the forward search.")] = "Rnd+FPR",
    seed: Seed = 0,
    time_limit: Annotated[float, typer.Option(metavar="SECONDS", max=1e9)] = 60.0,
    settings: Annotated[str, typer.Option(metavar="NAME", help="Settings of the planner: fast or faithful.")] = "fast",
    format_: Still = "png",
    theme: Theme = "paper",
    json: Json = False,
) -> None:
    """Plan as `solve` does and draw the search tree. Exit status 1 if the scene is not solved.

    Example:  manipuzzle tree data/puzzles/wall.yaml --out out/pictures
    """
    from evaluate.commands.tree import run
    from planner import settings_for

    of_planner = settings_for(settings, method=method, time_limit=time_limit)
    _exit(run(scene, out, of_planner, seed, format_=format_, theme=theme, as_json=json))


@app.command(short_help="Solve many scenes with many methods and seeds.")
def study(
    spec: Annotated[Path, typer.Argument(metavar="SPEC.yaml", help="Scenes, methods, seeds and limits.")],
    *,
    out: Out,
    workers: Annotated[int, typer.Option(metavar="N", min=1, max=1024, help="Processes that solve.")] = 1,
    cluster: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Dask scheduler whose workers solve instead, or local:N for one of its own.",
            show_default=False,
        ),
    ] = None,
    demonstrations: Demonstrations = None,
    json: Json = False,
) -> None:
    """Solve every scene with every method and seed; DIR/trials.sqlite holds the trials, DIR/table.md the table.

    Trials that DIR holds are not repeated, so an interrupted study is continued by the same command.

    Example:  manipuzzle study data/studies/smoke.yaml --out out/study --workers 2
    """
    from evaluate.commands.study import run

    _exit(run(spec, out, workers=workers, cluster=cluster, demonstrations=demonstrations, as_json=json))


@app.command(short_help="Tables, plots and a page of a study.")
def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a study.")],
    *,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder for the results.", show_default="DIR/report")
    ] = None,
    format_: Annotated[
        list[str] | None,
        typer.Option(
            "--format",
            metavar="NAME",
            help="html, md, tex, csv, svg, pdf, png or parquet; repeat for several.",
            show_default="all",
        ),
    ] = None,
    published: Annotated[
        str | None,
        typer.Option(
            metavar="FILE", help="CSV file of published times to stand beside, or `paper`.", show_default=False
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Write the tables and plots of a study, and report.html: all of them on one page, with every scene and its plan.

    Example:  manipuzzle report out/study --published paper
    """
    from evaluate.commands.report import run

    _exit(run(folder, out, format_ or [], published, as_json=json))


@app.command(short_help="List the trials of a study; write and verify their plans.")
def trials(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Results of a study.")],
    *,
    trial: Annotated[
        str | None, typer.Option(metavar="KEY", help="Beginning of a trial's key.", show_default=False)
    ] = None,
    scene: Annotated[str | None, typer.Option(metavar="NAME", help="Of this scene only.", show_default=False)] = None,
    method: Annotated[str | None, typer.Option(metavar="NAME", help="Of this method only.", show_default=False)] = None,
    seed: Annotated[
        int | None, typer.Option(metavar="N", min=0, help="With this seed only.", show_default=False)
    ] = None,
    status: Annotated[
        str | None, typer.Option(metavar="NAME", help="That ended so: solved, timeout, ...", show_default=False)
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Write the plans into this folder.", show_default=False)
    ] = None,
    verify: Annotated[bool, typer.Option("--verify", help="Verify the plans anew.")] = False,
    json: Json = False,
) -> None:
    """List the trials of a study; with --out write their plans, which verify and render read, scene included.

    Exit status 1 if --verify finds a plan that is not valid.

    Example:  manipuzzle trials out/study --scene corner --seed 0 --out out/plans
    """
    from evaluate.commands.trials import Choice, run

    choice = Choice(key=trial, scene=scene, method=method, seed=seed, status=status)
    _exit(run(folder, choice, out, verified=verify, as_json=json))


@app.command(short_help="Merge the results of several studies.")
def merge(
    folders: Annotated[list[Path], typer.Argument(metavar="DIR", help="Results of studies.")],
    *,
    out: Out,
    json: Json = False,
) -> None:
    """Merge the results of several studies, run on several machines for example, into one folder.

    Example:  manipuzzle merge out/study out/more --out out/all
    """
    from evaluate.commands.merge import run

    _exit(run(folders, out, as_json=json))


@app.command(short_help="Compare the results of two studies.")
def diff(
    first: Annotated[Path, typer.Argument(metavar="DIR", help="Results of a study.")],
    second: Annotated[Path, typer.Argument(metavar="DIR", help="Results of another one.")],
    *,
    json: Json = False,
) -> None:
    """Compare two results trial by trial: same scene, method and seed. Exit status 1 if one solves what the other not.

    Example:  manipuzzle diff out/study out/more
    """
    from evaluate.commands.diff import run

    _exit(run(first, second, as_json=json))


@app.command(short_help="Time the parts, with peers beside them.")
def bench(
    *,
    quick: Annotated[bool, typer.Option("--quick", help="A few seconds; the figures mean little.")] = False,
    study: Annotated[bool, typer.Option("--study", help="Time the running of studies instead.")] = False,
    trials: Annotated[
        int, typer.Option(metavar="N", min=10, max=10_000_000, help="With --study: trials that do nothing.")
    ] = 10_000,
    json: Json = False,
) -> None:
    """Time motions, grasps, collision tests and solving, each beside a peer timed in the same run; about a minute.

    Example:  manipuzzle bench
    """
    from evaluate.commands.bench import run, run_study_bench

    _exit(run_study_bench(trials, as_json=json) if study else run(quick=quick, as_json=json))


def _exit(all_well: bool) -> None:  # noqa: FBT001 - the one thing that it is about
    if not all_well:
        raise typer.Exit(NEGATIVE)

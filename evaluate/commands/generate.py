"""`manipuzzle generate`: solvable levels as a level set."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Annotated, Any, cast

import typer

from evaluate.commands.options import Json, Out, Seed, application
from evaluate.inputs import require_writable
from evaluate.output import print_json, print_line, print_table, progress
from pcg.agents import agent_named, policy_path
from pcg.errors import InputError
from pcg.frozen import read_frozen
from pcg.generate import RANDOM_AGENT, generated_levels
from pcg.level_set import GeneratedLevel, manifest_entry, write_level_set
from pcg.policy import load_policy
from pcg.policy_source import PolicySource, source_of
from pcg.random_source import RandomSource
from pcg.representation import REPRESENTATIONS
from pcg.request import LevelSource, Request

app = application()

Band = tuple[float | None, float | None]
"""Ends of a band; None for the default's."""


def _asked(metavar: str, text: str, default: str, **limits: float) -> Any:
    """An option of `generate` whose default is that of the agent."""
    return typer.Option(metavar=metavar, help=text, show_default=default, **cast("Any", limits))


@app.command()
def run(
    *,
    out: Out,
    agent: Annotated[
        str,
        typer.Option(
            metavar="NAME|FILE",
            help="What proposes levels: random, m0 ... m35 of data/agents.yaml, narrow, turtle, wide, flip, or your own .onnx.",
        ),
    ] = "random",
    count: Annotated[int, typer.Option(metavar="N", min=1, max=1_000_000, help="Number of levels.")] = 10,
    seed: Seed = 0,
    rows: Annotated[int | None, _asked("N", "Rows within the outer wall.", "10", min=1, max=100)] = None,
    columns: Annotated[int | None, _asked("N", "Columns within the outer wall.", "10", min=1, max=100)] = None,
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
) -> bool:
    """Generate solvable levels as a level set: levels.xsb and manifest.jsonl.

    Example:  manipuzzle generate --agent random --count 10 --seed 0 --out out/levels
    """
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
    require_writable(out)
    levels = generate(count, seed, request, out, agent)
    if json:
        print_json({"agent": agent, "levels": _rows(levels), **_effort(levels), "out": str(out)})
    else:
        _print(levels, out)
    return True


def request_of(
    agent: str,
    frozen: Path | None = None,
    pushes: Band = (None, None),
    wall_density: Band = (None, None),
    **others: Any,
) -> Request:
    """What the options ask for: the request of the agent, changed where an option is given.

    Args:
        agent: Name of the agent, `random`, the representation of a policy or its file.
        frozen: File with frozen tiles, which decide on rows and columns.
        pushes: Band of the pushes.
        wall_density: Band of the wall density.
        others: Further fields of the request; None for the agent's.

    Raises:
        InputError: there is no such agent, the options contradict each other, or the file of frozen tiles is no such.
    """
    request = _default_request(agent)
    given = {name: value for name, value in others.items() if value is not None}
    given["pushes"] = _filled(pushes, request.pushes)
    given["wall_density"] = _filled(wall_density, request.wall_density)
    if frozen is not None:
        tiles = read_frozen(frozen)
        given = {**given, "frozen": tiles, "rows": tiles.shape[0], "columns": tiles.shape[1]}
    try:
        return replace(request, **given)
    except ValueError as error:
        raise InputError("options", str(error)) from None


def _filled(band: Band, default: tuple[float, float]) -> tuple[float, ...]:
    return tuple(end if given is None else given for given, end in zip(band, default, strict=True))


def _default_request(agent: str) -> Request:
    """What is asked for without options: of a policy without bands, levels of the size that it makes."""
    if agent == RANDOM_AGENT:
        return Request()
    weights = _weights(agent)
    if weights is None:
        return agent_named(agent).request
    made = load_policy(weights).settings
    return Request(made.rows, made.columns, made.reward.crates, made.reward.targets)


def _weights(agent: str) -> Path | None:
    """The file of a policy that is named by its representation or its path; None for an agent with a band of its own."""
    if agent in REPRESENTATIONS:
        return policy_path(agent)
    return Path(agent) if agent.endswith(".onnx") else None


def source_named(agent: str) -> LevelSource:
    """The source of an agent's levels.

    Raises:
        InputError: there is no such agent, or its policy cannot be read.
    """
    if agent == RANDOM_AGENT:
        return RandomSource()
    weights = _weights(agent)
    return source_of(agent_named(agent)) if weights is None else PolicySource(load_policy(weights))


def generate(count: int, seed: int, request: Request, folder: Path, agent: str = RANDOM_AGENT) -> list[GeneratedLevel]:
    """Generates levels and writes the level set; interrupted, it writes those that it has.

    Raises:
        InputError: the generator finds no more levels, or the folder cannot be written.
    """
    levels: list[GeneratedLevel] = []
    source = source_named(agent)
    name = agent if _weights(agent) is None else source.representation or agent
    stream = islice(generated_levels(source, request, seed, name), count)
    try:
        with progress() as bar:
            # What was appended before an interrupt stays in the list.
            levels.extend(bar.track(stream, total=count, description="levels"))
    finally:
        if levels:
            write_level_set(folder, levels)
    return levels


def _rows(levels: Sequence[GeneratedLevel]) -> list[dict[str, Any]]:
    names = ("name", "solvable", "pushes", "moves", "occluded", "dependency", "goal_crate")
    return [{name: entry.model_dump()[name] for name in names} for entry in map(manifest_entry, levels)]


def _print(levels: Sequence[GeneratedLevel], out: Path) -> None:
    entries = map(manifest_entry, levels)
    rows = [(e.name, e.pushes, e.moves, e.statistics.walls, e.occluded, e.dependency) for e in entries]
    print_table(["level", "pushes", "moves", "walls", "occluded", "dependency"], rows)
    effort = _effort(levels)
    reasons = ", ".join(f"{n} {reason}" for reason, n in effort["rejected"].items()) or "none"
    print_line(f"{len(levels)} levels written to {out}; attempts: {effort['attempts']}, thrown away: {reasons}")


def _effort(levels: Sequence[GeneratedLevel]) -> dict[str, Any]:
    """What the levels cost: failures are counted, repairs too, of which there are none."""
    rejected: Counter[str] = Counter()
    for level in levels:
        rejected.update(level.rejected)
    return {
        "attempts": len(levels) + rejected.total(),
        "rejected": dict(rejected),
        "repaired": 0,
        "steps": sum(level.steps for level in levels),
    }

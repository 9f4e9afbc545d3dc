"""`manipuzzle compare-generators`: the random baseline, untrained and trained policies on the same tasks."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from evaluate.commands.options import Json, Out, application
from evaluate.comparison_table import COLUMNS, SUMMARY_COLUMNS, TABLE_FILE, rows, summary_rows, write_comparison
from evaluate.inputs import require_choice, require_writable
from evaluate.output import print_json, print_line, print_table, progress
from pcg.agents import policy_path, read_agents
from pcg.compare import Measurement, band_tasks, compare, standard_tasks
from pcg.policy import load_policy
from pcg.policy_source import PolicySource, UntrainedPolicy
from pcg.random_source import RandomSource
from pcg.representation import REPRESENTATIONS
from pcg.request import LevelSource

app = application()


@app.command()
def run(
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
    policy: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="A policy of your own (.onnx) beside the others; repeat for several."),
    ] = None,
    json: Json = False,
) -> bool:
    """Let random baseline, untrained and trained policies make levels; DIR/comparison.md compares yield and diversity.

    Example:  manipuzzle compare-generators --out out/comparison --seeds 3 --seconds 10
    """
    agents = read_agents().values()
    known = {each.name: each for each in (band_tasks(a.request for a in agents) if bands else standard_tasks())}
    for name in task or []:
        require_choice("--task", name, list(known))
    chosen = [known[name] for name in task or []] or list(known.values())
    contestants = sources(policy or [])
    require_writable(out)
    measurements: list[Measurement] = []
    runs = compare(contestants, chosen, range(seeds), cpu_limit=seconds, max_levels=max_levels)
    with progress() as bar:
        for measurement in bar.track(runs, total=len(chosen) * seeds * len(contestants), description="runs"):
            measurements.append(measurement)
            write_comparison(out, measurements)
    if json:
        print_json({"measurements": [asdict(m) for m in measurements], "out": str(out)})
    else:
        for each in chosen:
            print_table(list(COLUMNS), rows(measurements, each.name), title=each.name)
        print_table(list(SUMMARY_COLUMNS), summary_rows(measurements), title="all tasks")
        print_line(f"tables in {out / TABLE_FILE}")
    return True


def sources(files: Sequence[Path] = ()) -> dict[str, LevelSource]:
    """The contestants by name; the policies in the files by their paths.

    Raises:
        InputError: a policy is missing or cannot be read.
    """
    policies = {name: load_policy(policy_path(name)) for name in REPRESENTATIONS}
    untrained = {name: UntrainedPolicy(p.settings, p.weights_hash, p.session) for name, p in policies.items()}
    return {
        "random": RandomSource(),
        "random, any density": RandomSource(redraws_density=True),
        **{f"untrained {name}": PolicySource(policy) for name, policy in untrained.items()},
        **{name: PolicySource(policy) for name, policy in policies.items()},
        **{str(path): PolicySource(load_policy(path)) for path in files},
    }

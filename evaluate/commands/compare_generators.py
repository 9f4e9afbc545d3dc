"""`manipuzzle compare-generators`: the random baseline, untrained and trained policies on the same tasks."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from evaluate.comparison_table import COLUMNS, SUMMARY_COLUMNS, TABLE_FILE, rows, summary_rows, write_comparison
from evaluate.inputs import require_choice, require_writable
from evaluate.output import print_json, print_line, print_table, progress
from pcg.agents import read_agents
from pcg.compare import Measurement, band_tasks, compare, standard_tasks
from pcg.policy_source import PolicySource, UntrainedPolicy, policies_of
from pcg.random_source import RandomSource
from pcg.request import LevelSource


def sources() -> dict[str, LevelSource]:
    """The contestants by name.

    Raises:
        InputError: a policy is missing or cannot be read.
    """
    policies = policies_of(read_agents().values())
    untrained = {name: UntrainedPolicy(p.settings, p.weights_hash, p.session) for name, p in policies.items()}
    return {
        "random": RandomSource(),
        "random, any density": RandomSource(redraws_density=True),
        **{f"untrained {name}": PolicySource(policy) for name, policy in untrained.items()},
        **{name: PolicySource(policy) for name, policy in policies.items()},
    }


def run(
    out: Path, seeds: int, seconds: float, max_levels: int, tasks: Sequence[str], *, bands: bool, as_json: bool
) -> bool:
    """Runs the command; see `evaluate.cli.compare_generators`."""
    agents = read_agents().values()
    known = {task.name: task for task in (band_tasks(a.request for a in agents) if bands else standard_tasks())}
    for name in tasks:
        require_choice("--task", name, list(known))
    chosen = [known[name] for name in tasks] or list(known.values())
    contestants = sources()
    require_writable(out)
    measurements: list[Measurement] = []
    runs = compare(contestants, chosen, range(seeds), cpu_limit=seconds, max_levels=max_levels)
    with progress() as bar:
        for measurement in bar.track(runs, total=len(chosen) * seeds * len(contestants), description="runs"):
            measurements.append(measurement)
            write_comparison(out, measurements)
    if as_json:
        print_json({"measurements": [asdict(m) for m in measurements], "out": str(out)})
    else:
        for task in chosen:
            print_table(list(COLUMNS), rows(measurements, task.name), title=task.name)
        print_table(list(SUMMARY_COLUMNS), summary_rows(measurements), title="all tasks")
        print_line(f"tables in {out / TABLE_FILE}")
    return True

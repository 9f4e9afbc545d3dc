"""`manipuzzle bench`: the performance table."""

from dataclasses import asdict

from evaluate.bench import BenchRow, measure
from evaluate.bench_contests import QUICK, Effort, contests
from evaluate.bench_study import TRIAL_S, measure_study
from evaluate.number_text import duration
from evaluate.output import print_json, print_line, print_table, progress

RUNS, BURNING = 5, 60
"""Studies with one worker and with two, and their trials."""


def run(*, quick: bool, as_json: bool) -> bool:
    """Runs the command; see `evaluate.cli.bench`."""
    effort = QUICK if quick else Effort()
    entered = list(contests(effort))
    rows: list[BenchRow] = []
    with progress() as bar:
        task = bar.add_task("contests", total=len(entered))
        for contest in entered:
            bar.update(task, description=contest.name)
            rows.append(measure(contest))
            bar.advance(task)
    if as_json:
        print_json({"rows": [asdict(row) for row in rows]})
    else:
        columns = ["contest", "median", "95 %", "seeds", "peer", "peer's median", "times faster"]
        print_table(columns, [_cells(row) for row in rows])
        print_line(f"a puzzle that is not solved within {effort.time_limit:g} s counts with this time")
    return True


def run_study_bench(trials: int, *, as_json: bool) -> bool:
    """Runs the command with `--study`; see `evaluate.cli.bench`."""
    found = measure_study(trials, burning=BURNING, runs=RUNS)
    if as_json:
        print_json({**asdict(found), "speedup": found.speedup})
        return True
    print_line(
        f"{found.trials} trials that do nothing: {duration(found.trial_s)} each, of which the coordinator works "
        f"{duration(found.coordinator_s)}; it takes {found.memory_mb:.0f} MiB"
    )
    print_line(f"two workers: {found.speedup:.2f} times as fast as one, {RUNS} runs of {BURNING} trials of {TRIAL_S} s")
    return True


def _cells(row: BenchRow) -> tuple[object, ...]:
    peer_median = None if row.peer_median_s is None else duration(row.peer_median_s)
    return row.name, duration(row.median_s), duration(row.p95_s), row.n, row.peer, peer_median, row.ratio

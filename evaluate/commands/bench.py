"""`manipuzzle bench`: the performance table."""

from dataclasses import asdict
from typing import Annotated

import typer

from evaluate.bench import BenchRow, measure
from evaluate.bench_contests import QUICK, Effort, contests
from evaluate.bench_study import TRIAL_S, measure_study
from evaluate.commands.options import Json, application
from evaluate.number_text import duration
from evaluate.output import print_json, print_line, print_table, progress

RUNS, BURNING = 5, 60
"""Studies with one worker and with two, and their trials."""


app = application()


@app.command()
def run(
    *,
    quick: Annotated[bool, typer.Option("--quick", help="A few seconds; the figures mean little.")] = False,
    study: Annotated[bool, typer.Option("--study", help="Time the running of studies instead.")] = False,
    trials: Annotated[
        int, typer.Option(metavar="N", min=10, max=10_000_000, help="With --study: trials that do nothing.")
    ] = 10_000,
    json: Json = False,
) -> bool:
    """Time motions, grasps, collision tests and solving, each beside a peer timed in the same run; about two minutes.

    Example:  manipuzzle bench
    """
    if study:
        _time_studies(trials, as_json=json)
    else:
        _time_parts(QUICK if quick else Effort(), as_json=json)
    return True


def _time_parts(effort: Effort, *, as_json: bool) -> None:
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
        columns = ["contest", "median", "95 %", "seeds", "peer", "peer's median", "times faster", "besides"]
        print_table(columns, [_cells(row) for row in rows])
        print_line(f"a puzzle that is not solved within {effort.time_limit:g} s counts with this time")


def _time_studies(trials: int, *, as_json: bool) -> None:
    found = measure_study(trials, burning=BURNING, runs=RUNS)
    if as_json:
        print_json({**asdict(found), "speedup": found.speedup})
        return
    print_line(
        f"{found.trials} trials that do nothing: {duration(found.trial_s)} each, of which the coordinator works "
        f"{duration(found.coordinator_s)}; it takes {found.memory_mb:.0f} MiB"
    )
    print_line(f"two workers: {found.speedup:.2f} times as fast as one, {RUNS} runs of {BURNING} trials of {TRIAL_S} s")


def _cells(row: BenchRow) -> tuple[object, ...]:
    peer_median = None if row.peer_median_s is None else duration(row.peer_median_s)
    besides = ", ".join(f"{name.replace('_', ' ')} {value:.0%}" for name, value in row.figures.items()) or None
    return row.name, duration(row.median_s), duration(row.p95_s), row.n, row.peer, peer_median, row.ratio, besides

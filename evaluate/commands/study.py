"""`manipuzzle study`: every scene with every method and seed."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from evaluate.commands.options import Demonstrations, Json, Out, application
from evaluate.output import log, print_json, print_line, print_table, progress
from evaluate.specification import read_study
from evaluate.statistics import wilson_interval
from evaluate.store import TrialStore
from evaluate.study import StudySummary, run_study
from evaluate.study_progress import FIELD, StudyProgress
from evaluate.summary import NOTHING, Summary, summaries
from evaluate.tables import overview
from evaluate.trial_frame import read_trials
from evaluate.workers import Execute, WorkerStartError, run_tasks
from pcg.errors import InputError
from pcg.files import write_text

app = application()

TABLE_FILE = "table.md"


@app.command()
def run(
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
) -> bool:
    """Solve every scene with every method and seed; DIR/trials.sqlite holds the trials, DIR/table.md the table.

    Trials that DIR holds are not repeated, so an interrupted study is continued by the same command.

    Example:  manipuzzle study data/studies/smoke.yaml --out out/study --workers 2
    """
    study = read_study(spec, demonstrations)
    if not study.size:
        raise InputError(str(spec), "methods: none of them suits any of the scenes")
    execute = _execution(workers, cluster, out)
    for note in study.notes:
        log(note)
    with TrialStore(out) as store, progress(FIELD) as bar:
        display = StudyProgress(bar, study)
        try:
            summary = run_study(study, store, execute, on_trial=display.on_trial)
        except KeyboardInterrupt:
            log(f"interrupted: the finished trials are in {out}, the same command continues")
            raise
        except WorkerStartError as error:
            raise InputError(
                str(spec), f"{error}" + ("; memory_mb may be too small" if study.memory_mb else "")
            ) from None
    for line in display.errors():
        log(f"{line}; `manipuzzle trials {out} --status error` lists them")
    trials = read_trials(out)
    write_text(out / TABLE_FILE, overview(study.name, trials))
    of_methods = summaries(trials, "method")
    by_name = {method.name: of_methods.get((method.name,), NOTHING) for method in study.methods}
    if json:
        print_json(_document(summary, by_name))
    else:
        rows = [(name, s.trials, s.solved, s.mean, s.deviation) for name, s in by_name.items()]
        print_table(["method", "trials", "solved", "mean time [s]", "deviation [s]"], rows)
        print_line(
            f"{summary.trials} trials: {summary.run} run, {summary.skipped} skipped, {summary.solved} solved; "
            f"table in {out / TABLE_FILE}"
        )
    return True


def _execution(workers: int, cluster: str | None, out: Path) -> Execute:
    if cluster is None:
        return partial(run_tasks, workers=workers)
    try:
        # Dask takes a second to import, and need not be installed.
        from evaluate.cluster import run_on_cluster  # noqa: PLC0415  # see above
    except ImportError as error:
        raise InputError("--cluster", f"needs Dask: pip install 'manipuzzle[cluster]' ({error})") from None
    return partial(run_on_cluster, address=cluster, name=str(out.resolve()))


def _document(summary: StudySummary, by_name: Mapping[str, Summary]) -> dict[str, object]:
    return {
        "trials": summary.trials,
        "run": summary.run,
        "skipped": summary.skipped,
        "solved": summary.solved,
        "by_method": {name: _method_document(found) for name, found in by_name.items()},
    }


def _method_document(found: Summary) -> dict[str, object]:
    return {
        "trials": found.trials,
        "solved": found.solved,
        "rate": found.rate,
        "rate_interval_95": list(wilson_interval(found.solved, found.trials)),
        "mean_time_s": found.mean,
        "time_deviation_s": found.deviation,
    }

"""Studies on a Dask cluster: a scheduler and workers of their own, in processes, as on a real one."""

import sys
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from evaluate.compare import without_times
from evaluate.specification import read_study
from evaluate.store import TrialStore
from evaluate.study import Study, run_study
from evaluate.trial_row import TrialRow
from evaluate.workers import Execute, Job, run_tasks
from pcg.errors import InputError

distributed = pytest.importorskip("distributed", reason="the extra `cluster` is not installed")

from evaluate.cluster import run_on_cluster  # noqa: E402  # needs the library above

SMOKE = Path(__file__).parents[2] / "data" / "studies" / "smoke.yaml"


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """A scheduler with two workers that find the stand-ins for the planner."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(Path(__file__).parent)
        with distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, memory_limit=0, dashboard_address=":0", silence_logs=50
        ) as cluster:
            yield cluster.scheduler_address


def rows(study: Study, folder: Path, execute: Execute) -> list[TrialRow]:
    """The rows of a study, in the order of their keys, without what two runs may differ in."""
    with TrialStore(folder) as store:
        run_study(study, store, execute)
        return sorted((without_times(row) for row in store.rows()), key=lambda row: row.key)


@pytest.mark.slow
def test_the_rows_are_those_of_a_local_run(tmp_path: Path, address: str):
    """The smoke study: the same trials, verdicts, counters and plans on a cluster as on this machine."""
    study = read_study(SMOKE)
    local = rows(study, tmp_path / "local", partial(run_tasks, workers=1))
    cluster = rows(study, tmp_path / "cluster", partial(run_on_cluster, address=address, name="same"))
    assert len(cluster) == study.size == 18
    assert cluster == local


@pytest.mark.slow
def test_limits_hold_and_lost_workers_are_replaced(tmp_path: Path, address: str):
    """Overruns and crashes are rows; a trial whose Dask worker is killed is run again on another; none is lost."""
    import stub_planners  # noqa: PLC0415  # found only now

    study = replace(read_study(SMOKE), seeds=tuple(range(7)))
    study = replace(study, scenes=study.scenes[:1], methods=study.methods[:1])
    job = stub_planners.job(partial(stub_planners.troubled_once, str(tmp_path)), 1.5)
    with TrialStore(tmp_path / "out") as store:
        run_study(study, store, partial(run_on_cluster, address=address, name="troubled"), job=job)
        found = {row.seed: row.status for row in store.rows()}
    sys.modules.pop("stub_planners", None)
    assert found == {0: "timeout", 1: "error", 2: "error", 3: "exhausted", 4: "solved", 5: "solved", 6: "solved"}
    assert (tmp_path / "killed").exists()


def test_no_scheduler_is_one_line(monkeypatch: pytest.MonkeyPatch):
    """An address at which nothing answers, or that is none, is refused."""
    monkeypatch.setattr("evaluate.cluster.CONNECT_S", 0.5)
    for wrong in ("tcp://127.0.0.1:9", "local:0", "nowhere"):
        with pytest.raises(InputError, match="--cluster: no Dask scheduler answers at") as error:
            next(run_on_cluster(None, iter([]), wrong, "x"))
        assert "\n" not in str(error.value)


@pytest.mark.slow
def test_a_cluster_that_goes_is_one_line():
    """When scheduler and workers end within a study, what was finished has been handed on and the rest is refused."""
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, memory_limit=0, dashboard_address=":0", silence_logs=50
    ) as cluster:
        job = Job(time.sleep, lambda _, failure: failure, lambda _: 60.0)
        outcomes = run_on_cluster(job, iter([0.0, 60.0]), cluster.scheduler_address, "gone")
        assert next(outcomes) == (0.0, None)
        threading.Timer(0.5, cluster.close).start()
        with pytest.raises(InputError, match="--cluster: the cluster has gone; the finished trials are kept"):
            next(outcomes)

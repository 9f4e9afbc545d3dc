"""Studies that are killed, and studies that run out of disk: what is finished is kept, what is missing is run."""

import contextlib
import json
import os
import resource
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from converter.formats import write_scene
from converter.scene import Scene
from evaluate.compare import without_times
from evaluate.specification import read_study
from evaluate.store import FILE_NAME, StoredTrials, TrialStore
from evaluate.study import run_study
from evaluate.trial_row import TrialRow

TRIALS = 50
KILLS = 10
SPEC = f"""
name: interrupted
scenes: [room.yaml, other.yaml]
methods: [{{name: slow, planner: "slow_planner:solve"}}]
seeds: {TRIALS // 2}
"""
PLANNER = """
import os, time
from dataclasses import replace
import planner

def solve(scene, settings, rng):
    with open("begun", "a") as log:
        log.write("x")
    time.sleep(float(os.environ.get("TRIAL_SECONDS", "0")))
    return planner.solve(scene, replace(settings, method="Rnd+R"), rng)
"""


@pytest.fixture
def spec(tmp_path: Path, small_room: Scene, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A study of two scenes with a planner that takes its time, in the working folder."""
    for name in ("room", "other"):
        write_scene(tmp_path / f"{name}.yaml", replace(small_room, name=name))
    (tmp_path / "slow_planner.py").write_text(PLANNER)
    (tmp_path / "spec.yaml").write_text(SPEC)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path, str(tmp_path)])
    yield tmp_path / "spec.yaml"
    sys.modules.pop("slow_planner", None)


@pytest.fixture
def undisturbed(spec: Path, tmp_path: Path) -> list[TrialRow]:
    """The rows of a run in this process that nothing interrupts."""
    with TrialStore(tmp_path / "undisturbed") as store:
        run_study(read_study(spec), store, lambda job, tasks: ((task, job.function(task)) for task in tasks))
    (tmp_path / "begun").unlink()
    return finished(tmp_path / "undisturbed")


def finished(folder: Path) -> list[TrialRow]:
    """The rows of a folder in the order of their keys, without what two runs may differ in."""
    with StoredTrials(folder) as store:
        return sorted((without_times(row) for row in store.rows()), key=lambda row: row.key)


def number(folder: Path) -> int:
    """How many rows there are by now."""
    with contextlib.suppress(sqlite3.Error):
        connection = sqlite3.connect(f"file:{folder / FILE_NAME}?mode=ro", uri=True)
        try:
            return int(connection.execute("SELECT count(*) FROM trial").fetchone()[0])
        finally:
            connection.close()
    return 0


@contextlib.contextmanager
def study(seconds: float) -> Iterator["subprocess.Popen[str]"]:
    """The program, running the study with trials of so many seconds in a group of its own."""
    command = [sys.executable, "-c", "from evaluate.cli import main; main()"]
    with subprocess.Popen(  # noqa: S603  # our own program
        [*command, "study", "spec.yaml", "--out", "out", "--workers", "2", "--json"],
        env={**os.environ, "TRIAL_SECONDS": str(seconds)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        yield process


def workers_of(coordinator: int) -> list[int]:
    """The processes that a process has started."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(FileNotFoundError, ProcessLookupError):
            if int(path.read_text().rpartition(")")[2].split()[1]) == coordinator:
                found.append(int(path.parent.name))
    return found


@pytest.mark.slow
def test_a_study_survives_ten_kills(undisturbed: list[TrialRow], tmp_path: Path):
    """Coordinator and workers are killed at random moments; the rows are at last those of an undisturbed run.

    What was finished before a kill stays as it was, and no more trials are begun twice than were under way.
    """
    rng = np.random.default_rng(7)
    kills = 0
    before: list[TrialRow] = []
    while kills < KILLS:
        with study(seconds=0.1) as process:
            while kills < KILLS and process.poll() is None:
                known = number(tmp_path / "out")
                while number(tmp_path / "out") == known and process.poll() is None:
                    time.sleep(0.01)
                time.sleep(rng.uniform(0, 0.15))
                workers = workers_of(process.pid)
                victim = process.pid if not workers or rng.random() < 0.3 else int(rng.choice(workers))
                with contextlib.suppress(ProcessLookupError):
                    os.kill(victim, signal.SIGKILL)
                    kills += 1
            process.kill()
        with StoredTrials(tmp_path / "out") as store:
            rows = list(store.rows())
        assert rows[: len(before)] == before
        before = rows
    assert len(before) < TRIALS, "all was over before the last kill: the trials are too short"
    with study(seconds=0) as process:
        document = json.loads(process.communicate()[0])
    assert (document["trials"], document["run"] + document["skipped"]) == (TRIALS, TRIALS)
    assert finished(tmp_path / "out") == undisturbed
    assert (tmp_path / "begun").stat().st_size <= TRIALS + 2 * KILLS


@pytest.mark.slow
def test_a_full_disk_loses_nothing_that_is_finished(undisturbed: list[TrialRow], tmp_path: Path):
    """When the database cannot grow the study ends with one line; with room again it goes on where it stopped."""
    if not hasattr(resource, "prlimit"):
        pytest.skip("the size of another process's files can be limited on Linux only")
    with study(seconds=0.02) as process:
        while number(tmp_path / "out") < 3 and process.poll() is None:
            time.sleep(0.01)
        # Workers have limits of their own, so they are not touched.
        limit = (tmp_path / "out" / f"{FILE_NAME}-wal").stat().st_size + 20_000
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (limit, limit))
        stdout, stderr = process.communicate()
    assert (process.returncode, stdout) == (2, "")
    assert "cannot be written, the finished trials in it are kept: " in stderr
    assert stderr.count("\n") == 1
    kept = finished(tmp_path / "out")
    assert 3 <= len(kept) < TRIALS
    assert all(row in undisturbed for row in kept)
    with study(seconds=0) as process:
        document = json.loads(process.communicate()[0])
    assert (document["run"], document["skipped"]) == (TRIALS - len(kept), len(kept))
    assert finished(tmp_path / "out") == undisturbed

"""The worker pool. Its tasks are functions of the standard library or of this module, which workers import."""

import contextlib
import itertools
import math
import operator
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from evaluate.workers import Failure, Job, WorkerStartError, run_tasks
from pcg.printable import MAX_LENGTH


def as_it_is(_task: Any, failure: Failure) -> Failure:
    """The failure is the result."""
    return failure


def job(function: Callable[[Any], Any], seconds: float = 600.0, **options: Any) -> Job[Any, Any]:
    """What workers do, without much of a limit."""
    return Job(function, as_it_is, lambda _: seconds, **options)


@pytest.fixture(autouse=True)
def _importable(monkeypatch: pytest.MonkeyPatch) -> None:
    """Workers find this module where this process finds it now."""
    monkeypatch.syspath_prepend(Path(__file__).parent)
    monkeypatch.setitem(sys.modules, "test_workers", sys.modules[__name__])
    for function in (killed_once, raise_error, start_and_wait, wait_after_saying_pid):
        monkeypatch.setattr(function, "__module__", "test_workers")


def test_every_task_comes_back_with_its_result():
    """Tasks and results belong together, whatever the order."""
    outcomes = dict(run_tasks(job(math.factorial), iter(range(20)), 2))
    assert outcomes == {n: math.factorial(n) for n in range(20)}


def test_no_tasks_need_no_workers():
    """Nothing to do ends at once, without starting a process."""
    assert list(run_tasks(job(math.factorial), iter([]), 2)) == []


def test_an_exception_is_an_outcome():
    """A task that raises becomes one line with the exception's type; the worker goes on."""
    outcomes = dict(run_tasks(job(math.sqrt), iter([-1.0, 4.0]), 1))
    failure = outcomes[-1.0]
    assert isinstance(failure, Failure)
    assert failure.kind == "error"
    assert failure.message.startswith("ValueError: ")
    assert outcomes[4.0] == 2.0


def test_what_an_exception_says_can_be_written_down():
    """Halves of characters and control characters become escape sequences, and what is endless is shortened."""
    said = ["half \udc80, zero \0", "x" * 1_000_000]
    half, endless = (failure.message for _, failure in sorted(run_tasks(job(raise_error), iter(said), 1)))
    assert half == "RuntimeError: half \\udc80, zero \\x00"
    assert len(endless) <= MAX_LENGTH


def raise_error(text: str) -> None:
    """Raises an error that says `text`."""
    raise RuntimeError(text)


def test_an_overrunning_task_is_stopped():
    """The hard limit ends a task that does not end by itself, and the next task gets a new worker."""
    outcomes = dict(run_tasks(job(time.sleep, 0.3), iter([600.0, 0.0]), 1))
    failure = outcomes[600.0]
    assert isinstance(failure, Failure)
    assert (failure.kind, failure.message) == ("timeout", "stopped at the hard limit of 0.3 s")
    assert 0.3 <= failure.time_s < 60
    assert outcomes[0.0] is None


def test_a_crash_costs_one_task():
    """A worker that exits is replaced; its task says how it ended, and is not begun again."""
    outcomes = dict(run_tasks(job(os._exit), iter([7]), 2))
    failure = outcomes[7]
    assert isinstance(failure, Failure)
    assert (failure.kind, failure.message) == ("error", "the worker process ended with exit status 7")


def test_a_killed_worker_is_replaced(tmp_path: Path):
    """A task whose worker is killed from outside is begun again, and done by the next worker."""
    path = tmp_path / "begun"
    outcomes = dict(run_tasks(job(killed_once), iter([str(path), "other"]), 1))
    assert outcomes == {str(path): "done", "other": "done"}
    assert path.exists()


def killed_once(path: str) -> str:
    """Kills its process if `path` is new."""
    if path != "other" and not Path(path).exists():
        Path(path).touch()
        signal.raise_signal(signal.SIGKILL)
    return "done"


def test_a_task_that_has_its_worker_killed_is_given_up():
    """Three killed workers are enough: the task says which signal it was, and the others are done."""
    outcomes = dict(run_tasks(job(signal.raise_signal), iter([signal.SIGKILL, 0]), 1))
    failure = outcomes[signal.SIGKILL]
    assert isinstance(failure, Failure)
    assert failure.message == "the worker process ended with signal 9, 3 times in a row"
    assert len(outcomes) == 2


def test_what_a_task_has_started_ends_with_its_worker(tmp_path: Path):
    """A program that a task waits for is killed with the worker at the limit, though it has a process group."""
    path = tmp_path / "pid"
    outcomes = dict(run_tasks(job(start_and_wait, 1.0), iter([str(path)]), 1))
    assert outcomes[str(path)].kind == "timeout"
    assert ends(int(path.read_text()))


def start_and_wait(path: str) -> None:
    """Waits for a process of another group."""
    with subprocess.Popen(["/bin/sleep", "600"], process_group=0) as process:
        Path(path).write_text(str(process.pid))


def test_memory_is_limited():
    """A task that wants more memory than allowed fails alone."""
    outcomes = dict(run_tasks(job(bytes, memory_mb=512), iter([1 << 31, 3]), 1))
    failure = outcomes[1 << 31]
    assert isinstance(failure, Failure)
    assert failure.message.startswith("MemoryError")
    assert outcomes[3] == bytes(3)


def test_tasks_are_drawn_lazily():
    """An endless stream of tasks is read only as far as workers are free, and closing ends the workers."""
    drawn = []

    def endless() -> Iterator[int]:
        for n in itertools.count():
            drawn.append(n)
            yield n

    before = children()
    outcomes = run_tasks(job(math.factorial), endless(), 2)
    for _ in range(5):
        next(outcomes)
    outcomes.close()
    assert len(drawn) <= 5 + 2
    assert children() <= before


def test_workers_that_cannot_start_end_the_run():
    """An error before the first task is no task's fault; one of the preparation is quoted, others are tried again."""
    with pytest.raises(WorkerStartError, match="at their start with exit status 3"):
        list(run_tasks(job(math.factorial, prepare=partial(os._exit, 3)), iter([1]), 1))
    with pytest.raises(WorkerStartError, match="cannot be prepared: ZeroDivisionError: division by zero"):
        list(run_tasks(job(math.factorial, prepare=partial(operator.truediv, 1, 0)), iter([1]), 1))


COORDINATOR = """
import itertools
from pathlib import Path
from test_workers import job, wait_after_saying_pid
from evaluate.workers import run_tasks

list(run_tasks(job(wait_after_saying_pid), itertools.repeat({folder!r}), 2))
"""


def wait_after_saying_pid(folder: str) -> None:
    """Leaves the number of its process in a file's name."""
    Path(folder, str(os.getpid())).touch()
    time.sleep(600)


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_workers_end_with_their_coordinator(tmp_path: Path, how: signal.Signals):
    """However the coordinator ends, no process stays behind, even in the middle of a task."""
    with subprocess.Popen(  # noqa: S603  # our own interpreter with our own script
        [sys.executable, "-c", COORDINATOR.format(folder=str(tmp_path))],
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parent)},
        stderr=subprocess.DEVNULL,
    ) as coordinator:
        deadline = time.monotonic() + 60
        while len(list(tmp_path.iterdir())) < 2 and time.monotonic() < deadline:
            time.sleep(0.05)
        workers = [int(path.name) for path in tmp_path.iterdir()]
        coordinator.send_signal(how)
        coordinator.wait()
    assert len(workers) == 2
    assert all(ends(pid) for pid in workers)


def ends(pid: int, seconds: float = 20.0) -> bool:
    """Whether a process ends before long."""
    deadline = time.monotonic() + seconds
    while _is_running(pid) and time.monotonic() < deadline:
        time.sleep(0.05)
    return not _is_running(pid)


def children() -> set[int]:
    """The running processes that this one has started."""
    found = set()
    for path in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(FileNotFoundError, ProcessLookupError):
            state, parent = path.read_text().rpartition(")")[2].split()[:2]
            if int(parent) == os.getpid() and state != "Z":
                found.add(int(path.parent.name))
    return found


def _is_running(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"

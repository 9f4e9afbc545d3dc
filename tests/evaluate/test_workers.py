"""The worker pool, with functions of the standard library as tasks: they can be imported by any process."""

import itertools
import math
import multiprocessing
import operator
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from evaluate.workers import Failure, Limits, WorkerStartError, run_tasks

NO_LIMITS = Limits()


def test_every_task_comes_back_with_its_result():
    """Tasks and results belong together, whatever the order."""
    outcomes = dict(run_tasks(math.factorial, iter(range(20)), 2, NO_LIMITS))
    assert outcomes == {n: math.factorial(n) for n in range(20)}


def test_no_tasks_need_no_workers():
    """Nothing to do ends at once, without starting a process."""
    assert list(run_tasks(math.factorial, iter([]), 2, NO_LIMITS)) == []


def test_an_exception_is_an_outcome():
    """A task that raises becomes one line with the exception's type; the worker goes on."""
    outcomes = dict(run_tasks(math.sqrt, iter([-1.0, 4.0]), 1, NO_LIMITS))
    failure = outcomes[-1.0]
    assert isinstance(failure, Failure)
    assert failure.kind == "error"
    assert failure.message.startswith("ValueError: ")
    assert outcomes[4.0] == 2.0


def test_an_overrunning_task_is_stopped():
    """The hard limit ends a task that does not end by itself, and the next task gets a new worker."""
    outcomes = dict(run_tasks(time.sleep, iter([600.0, 0.0]), 1, Limits(seconds=0.3)))
    failure = outcomes[600.0]
    assert isinstance(failure, Failure)
    assert (failure.kind, failure.message) == ("timeout", "stopped at the hard limit of 0.3 s")
    assert 0.3 <= failure.time_s < 60
    assert outcomes[0.0] is None


def test_a_crash_costs_one_task():
    """A worker that exits is replaced; its task says how it ended."""
    outcomes = dict(run_tasks(os._exit, iter([7]), 2, NO_LIMITS))
    failure = outcomes[7]
    assert isinstance(failure, Failure)
    assert (failure.kind, failure.message) == ("error", "the worker process ended with exit status 7")


def test_a_killed_worker_is_replaced():
    """Tasks after a kill from outside are done; the killed one names the signal."""
    outcomes = dict(run_tasks(signal.raise_signal, iter([signal.SIGKILL, 0]), 1, NO_LIMITS))
    failure = outcomes[signal.SIGKILL]
    assert isinstance(failure, Failure)
    assert failure.message == "the worker process ended with signal 9"
    assert len(outcomes) == 2


def test_memory_is_limited():
    """A task that wants more memory than allowed fails alone."""
    outcomes = dict(run_tasks(bytes, iter([1 << 31, 3]), 1, Limits(memory_mb=512)))
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

    outcomes = run_tasks(math.factorial, endless(), 2, NO_LIMITS)
    for _ in range(5):
        next(outcomes)
    outcomes.close()
    assert len(drawn) <= 5 + 2
    assert multiprocessing.active_children() == []


def test_workers_that_cannot_start_end_the_run():
    """An error before the first task, here in the preparation, is no task's fault and is not repeated for ever."""
    with pytest.raises(WorkerStartError, match="exit status 1"):
        list(run_tasks(math.factorial, iter([1]), 1, NO_LIMITS, prepare=partial(operator.truediv, 1, 0)))


COORDINATOR = """
import itertools, os, time
from evaluate.workers import Limits, run_tasks

def pids():
    print(os.getpid(), flush=True)

if __name__ == "__main__":
    list(run_tasks(time.sleep, itertools.repeat(600.0), 2, Limits(), pids))
"""


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_workers_end_with_their_coordinator(tmp_path: Path, how: signal.Signals):
    """However the coordinator ends, no process stays behind, even in the middle of a task."""
    script = tmp_path / "coordinator.py"
    script.write_text(COORDINATOR)
    with subprocess.Popen(  # noqa: S603 - our own interpreter with our own script
        [sys.executable, str(script)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as coordinator:
        assert coordinator.stdout is not None
        workers = [int(coordinator.stdout.readline()) for _ in range(2)]
        coordinator.send_signal(how)
        coordinator.wait()
    deadline = time.monotonic() + 20
    while any(_is_running(pid) for pid in workers) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not any(_is_running(pid) for pid in workers)


def _is_running(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"

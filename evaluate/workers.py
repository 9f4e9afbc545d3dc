"""A pool of worker processes that survives whatever a task does to its worker.

Each worker is a fresh interpreter (`evaluate.worker_process`) with one connection to its coordinator. A task that
overruns its limit, exhausts its memory or crashes costs its worker, which is replaced, and ends as a `Failure`; the
other tasks are not touched. A worker that somebody else killed is replaced too, and its task begins anew: that was not
the task's fault, unless it happens `ATTEMPTS` times. Tasks are drawn from their iterator only when a worker is free, so
any number of them needs bounded memory. Workers end with their coordinator, however it ends, and with them whatever
they have started.

The executors of the standard library do not fit: a killed worker breaks the whole executor, a running task cannot be
stopped, all tasks are queued at once, and workers of a Dask worker (`evaluate.cluster`) may start no processes.
"""

import contextlib
import signal
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum, auto
from multiprocessing.connection import wait
from typing import Any, Generic, Literal, Protocol, TypeVar

from evaluate.worker_process import READY, Duty, Unprepared, WorkerProcess

Task = TypeVar("Task")
Result = TypeVar("Result")

START_ATTEMPTS = 3
"""How often in a row a worker may end before it is ready."""

ATTEMPTS = 3
"""How often a task is begun whose worker is killed from outside."""

KILLED = (-signal.SIGKILL, -signal.SIGTERM)
"""Exit codes of workers that somebody killed: an administrator, a batch system, or the kernel for lack of memory."""


class _State(Enum):
    """Of a worker, where a result is not there yet."""

    UNDER_WAY = auto()


class WorkerStartError(RuntimeError):
    """Worker processes end before they can take a task."""


@dataclass(frozen=True)
class Failure:
    """A task that returned nothing.

    Attributes:
        kind: `timeout` (the worker was killed at the limit) or `error` (the task raised, or its worker ended).
        message: What happened, one line.
        time_s: Wall time from handing the task out to its end [s].
    """

    kind: Literal["timeout", "error"]
    message: str
    time_s: float


@dataclass(frozen=True)
class Job(Generic[Task, Result]):
    """What workers do with tasks. All but `seconds` is sent to them: functions of modules, or partial ones.

    Attributes:
        function: Does a task.
        failed: The result of a task that failed.
        seconds: Wall time that a task may take [s].
        memory_mb: Memory for the data of a worker, and of each program that it starts [MiB]; None for no limit.
        prepare: Called once in each new worker, outside the time limit: imports and compilation.
    """

    function: Callable[[Task], Result]
    failed: Callable[[Task, Failure], Result]
    seconds: Callable[[Task], float]
    memory_mb: int | None = None
    prepare: Callable[[], object] | None = None

    @property
    def duty(self) -> Duty:
        """What a worker process has to know."""
        return Duty(self.function, self.prepare, self.memory_mb)


class Execute(Protocol):
    """A way to do tasks: on this machine, or on a cluster."""

    def __call__(self, job: Job[Task, Result], tasks: Iterator[Task]) -> Generator[tuple[Task, Result]]:
        """Yields each task with its result, in the order of completion; closing it stops the workers."""


def run_tasks(job: Job[Task, Result], tasks: Iterator[Task], workers: int) -> Generator[tuple[Task, Result]]:
    """Yields each task with its result, in the order of completion.

    Closing the generator, or an exception inside it such as KeyboardInterrupt, kills the workers and drops the
    unfinished tasks.

    Args:
        job: What to do.
        tasks: Drawn from lazily: at most `workers` of them are under way.
        workers: Number of processes, >= 1.

    Raises:
        WorkerStartError: a worker ended `START_ATTEMPTS` times before it was ready.
    """
    idle = [Worker[Task, Result](job.duty) for _ in range(workers)]
    busy: list[Worker[Task, Result]] = []
    try:
        while True:
            while idle and (task := next(tasks, None)) is not None:
                worker = idle.pop()
                busy.append(worker)
                worker.assign(task, job.seconds(task))
            if not busy:
                return
            for worker in _with_news(busy):
                outcome = worker.news()
                if isinstance(outcome, _State):
                    continue
                busy.remove(worker)
                idle.append(worker)
                yield worker.task, job.failed(worker.task, outcome) if isinstance(outcome, Failure) else outcome
    finally:
        for worker in (*idle, *busy):
            worker.kill()


def _with_news(busy: Sequence["Worker[Any, Any]"]) -> list["Worker[Any, Any]"]:
    """Waits until a worker sent something, ended or reached its limit, and returns those workers."""
    deadline = min((worker.deadline for worker in busy if worker.deadline is not None), default=None)
    timeout = None if deadline is None else max(0.0, deadline - time.monotonic())
    ready = wait([worker.process.connection for worker in busy if worker.process is not None], timeout)
    now = time.monotonic()
    return [
        worker
        for worker in busy
        if worker.process is not None
        and (worker.process.connection in ready or (worker.deadline is not None and worker.deadline <= now))
    ]


class Worker(Generic[Task, Result]):
    """One place in the pool: a process that is started when needed and again after it was lost.

    Attributes:
        task: The task that was assigned last.
        process: The process; None before it is needed and after it was lost.
        deadline: When the present task reaches its limit (monotonic clock) [s]; None before it began.
    """

    task: Task

    def __init__(self, duty: Duty) -> None:
        self.process: WorkerProcess | None = None
        self.deadline: float | None = None
        self._duty = duty
        self._ready = False
        self._failed_starts = 0
        self._attempts = 0
        self._seconds = 0.0
        self._began = 0.0

    def assign(self, task: Task, seconds: float) -> None:
        """Hands out a task with its time limit [s], as soon as the process is ready for it."""
        self.task, self._seconds, self._attempts = task, seconds, 0
        self._began = time.monotonic()
        if self.process is None:
            self.process = WorkerProcess(self._duty)
        elif self._ready:
            self._send(self.process)

    def do(self, task: Task, seconds: float) -> Result | Failure:
        """Does one task and waits for its result."""
        self.assign(task, seconds)
        while True:
            for worker in _with_news([self]):
                outcome = worker.news()
                if not isinstance(outcome, _State):
                    return outcome

    def news(self) -> Result | Failure | Literal[_State.UNDER_WAY]:
        """What became of the task; to be called when there is something to hear."""
        process = self.process
        assert process is not None  # noqa: S101  # a task is under way
        if not process.connection.poll():
            self.kill()
            return Failure("timeout", f"stopped at the hard limit of {self._seconds:g} s", self._elapsed())
        try:
            message = process.connection.recv()
        except (EOFError, OSError):
            return self._lost(process)
        if isinstance(message, Unprepared):
            raise WorkerStartError(f"worker processes cannot be prepared: {message.reason}")
        if message is READY:
            self._ready, self._failed_starts = True, 0
            self._send(process)
            return _State.UNDER_WAY
        self.deadline = None
        succeeded, value = message
        return value if succeeded else Failure("error", value, self._elapsed())

    def kill(self) -> None:
        """Ends the process, whatever it is doing."""
        if self.process is not None:
            self.process.kill()
        self.process, self._ready, self.deadline = None, False, None

    def _send(self, process: WorkerProcess) -> None:
        self._began = time.monotonic()
        self.deadline = self._began + self._seconds
        self._attempts += 1
        # A process that has just ended is noticed by the next `news`.
        with contextlib.suppress(OSError):
            process.connection.send(self.task)

    def _lost(self, process: WorkerProcess) -> Failure | Literal[_State.UNDER_WAY]:
        was_ready, code = self._ready, process.ended()
        self.process, self._ready, self.deadline = None, False, None
        reason = f"signal {-code}" if code < 0 else f"exit status {code}"
        if was_ready and (code not in KILLED or self._attempts == ATTEMPTS):
            times = "" if self._attempts == 1 else f", {self._attempts} times in a row"
            return Failure("error", f"the worker process ended with {reason}{times}", self._elapsed())
        self._failed_starts += not was_ready
        if self._failed_starts == START_ATTEMPTS:
            raise WorkerStartError(f"worker processes end at their start with {reason}")
        self.process = WorkerProcess(self._duty)
        return _State.UNDER_WAY

    def _elapsed(self) -> float:
        return time.monotonic() - self._began

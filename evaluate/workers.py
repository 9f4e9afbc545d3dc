"""A pool of worker processes that survives whatever a task does to its worker.

Each worker is a fresh interpreter with one pipe to the coordinator. A task that overruns its limit, exhausts its
memory or crashes costs its worker, which is replaced, and ends as a `Failure`; the other tasks are not touched. Tasks
are drawn from their iterator only when a worker is free, so any number of them needs bounded memory. Workers end with
their coordinator, however it ends.

The executors of the standard library do not fit: a killed worker breaks the whole executor, a running task cannot be
stopped, and all tasks are queued at once.
"""

import contextlib
import multiprocessing
import multiprocessing.connection
import multiprocessing.resource_tracker
import os
import resource
import signal
import threading
import time
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass
from enum import Enum, auto
from multiprocessing.connection import Connection
from typing import Any, Generic, Literal, TypeVar

Task = TypeVar("Task")
Result = TypeVar("Result")

START_ATTEMPTS = 3
"""How often in a row a worker may end before it is ready."""

_SPAWN = multiprocessing.get_context("spawn")


class _State(Enum):
    """Of a worker, where a result is not there yet."""

    READY = auto()
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
class Limits:
    """What a task may use.

    Attributes:
        seconds: Wall time of one task [s]; None for no limit.
        memory_mb: Memory for the data of a worker [MiB]; None for no limit.
    """

    seconds: float | None = None
    memory_mb: int | None = None


def run_tasks(
    function: Callable[[Task], Result],
    tasks: Iterator[Task],
    workers: int,
    limits: Limits,
    prepare: Callable[[], object] | None = None,
) -> Generator[tuple[Task, Result | Failure]]:
    """Yields each task with its result, in the order of completion.

    Closing the generator, or an exception inside it such as KeyboardInterrupt, kills the workers and drops the
    unfinished tasks.

    Args:
        function: Called with one task; has to be importable (defined in a module) like tasks and results.
        tasks: Drawn from lazily: at most `workers` of them are under way.
        workers: Number of processes, >= 1.
        limits: What a task may use.
        prepare: Called once in each new worker, outside the time limit: imports and compilation.

    Raises:
        WorkerStartError: a worker ended `START_ATTEMPTS` times before it was ready.
    """
    idle = [_Worker(function, prepare, limits) for _ in range(workers)]
    busy: list[_Worker[Task, Result]] = []
    try:
        while True:
            while idle and (task := next(tasks, None)) is not None:
                worker = idle.pop()
                busy.append(worker)
                worker.assign(task)
            if not busy:
                return
            for worker in _with_news(busy):
                outcome = worker.news()
                if outcome is not _State.UNDER_WAY:
                    busy.remove(worker)
                    idle.append(worker)
                    yield worker.task, outcome
    finally:
        for worker in (*idle, *busy):
            worker.kill()


def _with_news(busy: list["_Worker[Task, Result]"]) -> list["_Worker[Task, Result]"]:
    """Waits until a worker sent something, ended or reached its limit, and returns those workers."""
    deadline = min((worker.deadline for worker in busy if worker.deadline is not None), default=None)
    timeout = None if deadline is None else max(0.0, deadline - time.monotonic())
    ready = multiprocessing.connection.wait([worker.connection for worker in busy], timeout)
    now = time.monotonic()
    return [
        worker
        for worker in busy
        if worker.connection in ready or (worker.deadline is not None and worker.deadline <= now)
    ]


class _Worker(Generic[Task, Result]):
    """One place in the pool: a process that is started when needed and again after it was lost."""

    task: Task
    connection: Connection
    deadline: float | None
    """When the present task reaches its limit (monotonic clock) [s]; None without limit or before it began."""

    def __init__(
        self, function: Callable[[Task], Result], prepare: Callable[[], object] | None, limits: Limits
    ) -> None:
        self._function, self._prepare, self._limits = function, prepare, limits
        self._process: multiprocessing.context.SpawnProcess | None = None
        self._ready = False
        self._failed_starts = 0
        self._began = 0.0
        self.deadline = None

    def assign(self, task: Task) -> None:
        """Hands out a task, as soon as the process is ready for it."""
        self.task = task
        if self._process is None:
            self._start()
        elif self._ready:
            self._send()

    def news(self) -> Result | Failure | Literal[_State.UNDER_WAY]:
        """What became of the task; to be called when there is something to hear."""
        if not self.connection.poll():
            self.kill()
            return Failure("timeout", f"stopped at the hard limit of {self._limits.seconds:g} s", self._elapsed())
        try:
            message = self.connection.recv()
        except (EOFError, OSError):
            return self._lost()
        if message is _State.READY:
            self._ready, self._failed_starts = True, 0
            self._send()
            return _State.UNDER_WAY
        self.deadline = None
        return message  # type: ignore[no-any-return]  # what the function returned, or a Failure

    def kill(self) -> None:
        """Ends the process, whatever it is doing."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self.connection.close()
        self._process, self._ready, self.deadline = None, False, None

    def _start(self) -> None:
        self.connection, theirs = _SPAWN.Pipe()
        arguments = (theirs, self._function, self._prepare, self._limits.memory_mb)
        self._process = _SPAWN.Process(target=_serve, args=arguments, daemon=True)
        with _interrupts_blocked():
            self._process.start()
        # The pipe reports the end of the process only when no other process holds its far end.
        theirs.close()

    def _send(self) -> None:
        self._began = time.monotonic()
        self.deadline = None if self._limits.seconds is None else self._began + self._limits.seconds
        # A process that has just ended is noticed by the next `news`.
        with contextlib.suppress(OSError):
            self.connection.send(self.task)

    def _lost(self) -> Failure | Literal[_State.UNDER_WAY]:
        assert self._process is not None  # noqa: S101  # a connection implies a process
        was_ready = self._ready
        self._process.join()
        code = self._process.exitcode or 0
        reason = f"signal {-code}" if code < 0 else f"exit status {code}"
        self.kill()
        if was_ready:
            return Failure("error", f"the worker process ended with {reason}", self._elapsed())
        self._failed_starts += 1
        if self._failed_starts == START_ATTEMPTS:
            raise WorkerStartError(f"worker processes end at their start with {reason}")
        self._start()
        return _State.UNDER_WAY

    def _elapsed(self) -> float:
        return time.monotonic() - self._began


@contextlib.contextmanager
def _interrupts_blocked() -> Iterator[None]:
    """Processes started inside never see Ctrl-C, which a terminal sends to all; the coordinator ends them."""
    # The first process starts this helper too, and that would unblock the signal again.
    multiprocessing.resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _serve(
    connection: Connection,
    function: Callable[[Any], Any],
    prepare: Callable[[], object] | None,
    memory_mb: int | None,
) -> None:
    """The worker process: calls `function` with each task that arrives, until the pipe closes."""
    threading.Thread(target=_exit_with_parent, daemon=True).start()
    if memory_mb is not None:
        resource.setrlimit(resource.RLIMIT_DATA, (memory_mb << 20, memory_mb << 20))
    if prepare is not None:
        prepare()
    with contextlib.suppress(EOFError, BrokenPipeError, ConnectionResetError):
        connection.send(_State.READY)
        while True:
            connection.send(_outcome(function, connection.recv()))


def _outcome(function: Callable[[Any], Any], task: Any) -> Any:
    began = time.monotonic()
    try:
        return function(task)
    except Exception as error:  # noqa: BLE001  # whatever a task raises is its outcome
        message = " ".join(f"{type(error).__name__}: {error}".split())
        return Failure("error", message, time.monotonic() - began)


def _exit_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)

"""The tasks of a study on a cluster, through Dask.

A Dask worker is only a way to another machine: each of its threads has a worker process of ours (`evaluate.workers`)
that does the tasks, so limits of time and memory and crashes mean there what they mean here. Tasks are handed to the
scheduler a few at a time, so any number of them needs bounded memory. A task whose Dask worker is lost begins anew on
another one; Dask gives up after the fourth.

`docs/cluster.md` is the recipe for SLURM.
"""

import contextlib
import logging
import re
import threading
import time
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import CancelledError
from typing import Any

from distributed import (
    Client,
    Future,
    KilledWorker,
    LocalCluster,
    Reschedule,
    WorkerPlugin,
    as_completed,
    get_worker,
)

from evaluate.worker_process import Duty
from evaluate.workers import Failure, Job, Result, Task, Worker
from pcg.errors import InputError

CONNECT_S = 10.0
"""How long the scheduler may take to answer [s]."""

SURVEY_S = 2.0
"""How often the threads of a cluster are counted, which may grow and shrink [s]."""

SPARE_TASKS = 4
"""Tasks handed out beyond two a thread, so that a cluster that grows on demand sees that there is demand."""

_LOCAL = re.compile(r"local:([1-9][0-9]{0,3})")


def run_on_cluster(
    job: Job[Task, Result], tasks: Iterator[Task], address: str, name: str
) -> Generator[tuple[Task, Result]]:
    """Yields each task with its result, in the order of completion; closing the generator stops what is under way.

    Args:
        job: What to do; its functions have to be importable on the cluster.
        tasks: Drawn from lazily.
        address: Of the scheduler, such as `tcp://host:8786`; or `local:N` for a scheduler and N workers of its own.
        name: Of the run; a second run of this name takes the place of the first on the cluster.

    Raises:
        InputError: the scheduler does not answer.
        WorkerStartError: the worker processes do not start.
    """
    with _client(address) as client:
        plugin = f"manipuzzle {name}"
        client.register_plugin(_Places(job.duty, job.failed), plugin)
        try:
            yield from _results(client, job, tasks, plugin)
        finally:
            # Whatever ended the run, possibly the loss of the cluster itself, counts more.
            with contextlib.suppress(Exception):
                client.unregister_worker_plugin(plugin)  # type: ignore[no-untyped-call]  # typed in parts


def _results(
    client: Client, job: Job[Task, Result], tasks: Iterator[Task], plugin: str
) -> Generator[tuple[Task, Result]]:
    window = _Window(client)
    completed = as_completed()  # type: ignore[no-untyped-call]  # typed in parts
    under_way: dict[Any, tuple[Task, float]] = {}
    while True:
        while len(under_way) < window.size() and (task := next(tasks, None)) is not None:
            future = client.submit(_do, plugin, task, job.seconds(task), pure=False)
            under_way[future.key] = task, time.monotonic()
            completed.add(future)  # type: ignore[no-untyped-call]  # typed in parts
        if not under_way:
            return
        future = next(completed)
        task, began = under_way.pop(future.key)
        yield task, _result(future, job, task, time.monotonic() - began)


def _result(future: "Future[Result]", job: Job[Task, Result], task: Task, elapsed: float) -> Result:
    """The result of a finished future.

    Raises:
        InputError: the cluster was shut down.
        WorkerStartError: the worker processes do not start.
    """
    try:
        # Where the Dask worker was lost together with the result, this waits until another has done the task anew.
        return future.result()
    except CancelledError:
        raise InputError("--cluster", "the cluster has gone; the finished trials are kept") from None
    except KilledWorker as error:
        return job.failed(task, Failure("error", f"its Dask worker was lost again and again: {error}", elapsed))


class _Window:
    """How many tasks may be under way: two for each thread of the cluster, and some to spare."""

    def __init__(self, client: Client) -> None:
        self._client = client
        self._threads = 0
        self._surveyed = -SURVEY_S

    def size(self) -> int:
        now = time.monotonic()
        if now - self._surveyed >= SURVEY_S:
            threads: dict[str, int] = self._client.nthreads()  # type: ignore[no-untyped-call]  # typed in parts
            self._threads, self._surveyed = sum(threads.values()), now
        return 2 * self._threads + SPARE_TASKS


class _Places(WorkerPlugin):
    """On a Dask worker: the worker processes of its threads, begun as they are needed."""

    def __init__(self, duty: Duty, failed: Callable[[Any, Failure], Any]) -> None:
        self._duty, self._failed = duty, failed

    def setup(self, worker: Any) -> None:
        """Called by Dask on each of its workers."""
        del worker
        self._lock = threading.Lock()
        self._closed = False
        self._idle: list[Worker[Any, Any]] = []
        self._all: list[Worker[Any, Any]] = []

    def teardown(self, worker: Any) -> None:
        """Called by Dask when the run or the Dask worker ends."""
        del worker
        self._closed = True
        with self._lock:
            for place in self._all:
                place.kill()

    def do(self, task: Any, seconds: float) -> Any:
        """Does a task in the calling thread's stead."""
        with self._lock:
            if not self._idle:
                self._idle.append(Worker(self._duty))
                self._all.append(self._idle[0])
            place = self._idle.pop()
        try:
            outcome = place.do(task, seconds)
        except Exception:
            if self._closed:
                # The Dask worker was told to end, and the process taken away: the task begins anew elsewhere.
                raise Reschedule from None
            raise
        with self._lock:
            self._idle.append(place)
        return self._failed(task, outcome) if isinstance(outcome, Failure) else outcome


def _do(plugin: str, task: Any, seconds: float) -> Any:
    """What runs on a Dask worker."""
    places: Any = get_worker().plugins[plugin]
    return places.do(task, seconds)


@contextlib.contextmanager
def _client(address: str) -> Iterator[Client]:
    local = _LOCAL.fullmatch(address)
    if local is not None:
        with _local_cluster(int(local[1])) as cluster, Client(cluster) as client:  # type: ignore[no-untyped-call]  # typed in parts
            yield client
        return
    try:
        client = Client(address, timeout=CONNECT_S)  # type: ignore[no-untyped-call]  # typed in parts
    except (OSError, ValueError) as error:
        raise InputError("--cluster", f"no Dask scheduler answers at {address!r}: {error}") from None
    with client:
        yield client


def _local_cluster(workers: int) -> LocalCluster:
    # Memory is limited in our own worker processes; Dask's hold nothing.
    return LocalCluster(  # type: ignore[no-untyped-call]  # typed in parts
        n_workers=workers,
        threads_per_worker=1,
        memory_limit=0,
        dashboard_address=":0",
        silence_logs=logging.CRITICAL,
    )

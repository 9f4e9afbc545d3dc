"""The same work on many inputs, in this process or in several, with results in the order of the inputs."""

import contextlib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any, Generic, TypeVar

from evaluate.workers import Failure, Job, run_tasks
from pcg.errors import InputError

Task = TypeVar("Task")
Result = TypeVar("Result")

HARD_LIMIT = 3600.0
"""Wall time of one task [s]; whatever takes longer hangs."""


@dataclass(frozen=True)
class _Attempt(Generic[Result]):
    """What became of a task: one of these. An `InputError` itself does not survive the way between processes."""

    result: Result | None = None
    refused: str | None = None
    crashed: str | None = None


def in_order(
    function: Callable[[Task], Result],
    tasks: Iterable[Task],
    workers: int,
    prepare: Callable[[], object] | None = None,
) -> Iterator[Result]:
    """`function` of each task, in the order of the tasks, which are drawn one by one as they are needed.

    Args:
        function: Called with one task; with several workers it, the tasks and the results have to be picklable.
        tasks: Any number of them.
        workers: Processes, >= 1; with one the work is done in this process.
        prepare: Called once in each new worker: imports and compilation.

    Raises:
        InputError: `function` raised it for a task; the results of all tasks before have been returned.
        RuntimeError: a worker failed for any other reason.
    """
    if workers == 1:
        yield from map(function, tasks)
        return
    job: Job[tuple[int, Task], _Attempt[Result]] = Job(partial(_attempt, function), _failed, _limit, prepare=prepare)
    finished: dict[int, _Attempt[Result]] = {}
    following = 0
    with contextlib.closing(run_tasks(job, enumerate(tasks), workers)) as outcomes:
        for (number, _), attempt in outcomes:
            finished[number] = attempt
            while following in finished:
                yield _result(finished.pop(following))
                following += 1


def _attempt(function: Callable[[Task], Result], task: tuple[int, Task]) -> _Attempt[Result]:
    try:
        return _Attempt(function(task[1]))
    except InputError as error:
        return _Attempt(refused=str(error))


def _failed(_: object, failure: Failure) -> _Attempt[Any]:
    return _Attempt(crashed=failure.message)


def _limit(_: object) -> float:
    return HARD_LIMIT


def _result(attempt: _Attempt[Result]) -> Result:
    if attempt.refused is not None:
        raise InputError("", attempt.refused)
    if attempt.crashed is not None:
        raise RuntimeError(attempt.crashed)
    return attempt.result  # type: ignore[return-value]  # of a task that neither was refused nor crashed

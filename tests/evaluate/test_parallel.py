"""Work in several processes: the results and refusals of one process, in the same order."""

import operator
import time
from collections.abc import Iterator

import pytest

from evaluate.parallel import in_order
from pcg.errors import InputError


def slow_first(number: int) -> int:
    """The square of a number; that of 0 takes longest."""
    time.sleep(0.2 if number == 0 else 0.0)
    return number**2


def refuse_two(number: int) -> int:
    """Every number but 2."""
    if number == 2:
        raise InputError("two.yaml", "found 2, allowed are others")
    return number


@pytest.mark.parametrize("workers", [1, 2])
def test_results_come_in_the_order_of_the_tasks(workers: int):
    """Even if the first one is finished last."""
    assert list(in_order(slow_first, range(6), workers)) == [0, 1, 4, 9, 16, 25]
    assert list(in_order(slow_first, [], workers)) == []


@pytest.mark.parametrize("workers", [1, 2])
def test_bad_input_is_refused_in_its_place(workers: int):
    """What came before is returned; then the message is that of the task."""
    results = in_order(refuse_two, range(4), workers)
    assert [next(results), next(results)] == [0, 1]
    with pytest.raises(InputError, match=r"^two.yaml: found 2, allowed are others$"):
        next(results)


def test_tasks_are_drawn_when_they_are_needed():
    """So any number of them takes little memory."""
    drawn = []

    def tasks() -> Iterator[int]:
        for number in range(1000):
            drawn.append(number)
            yield number

    one = in_order(slow_first, tasks(), 1)
    next(one)
    assert drawn == [0]


def test_a_failing_worker_is_a_program_error():
    """Not the user's: it names what happened."""
    with pytest.raises(RuntimeError, match="TypeError"):
        list(in_order(operator.neg, ["text"], 2))  # type: ignore[arg-type]  # wrong on purpose

"""Restarts: budgets grow, work is added up, and only what gave up starts anew."""

from collections.abc import Callable

import pytest

from converter.plan import Status
from planner.restarts import luby, with_restarts
from planner.result import PlanResult
from planner.settings import Settings


def searches(*statuses: Status) -> tuple[Callable[[Settings], PlanResult], list[int]]:
    """A search that ends each time as told, having used all its expansions, and a list of what it was allowed."""
    allowed: list[int] = []

    def search(settings: Settings) -> PlanResult:
        allowed.append(settings.max_expansions)
        return PlanResult(statuses[len(allowed) - 1], 0.0, counters={"expansions": settings.max_expansions})

    return search, allowed


def test_the_sequence_of_luby():
    """Each power of two comes after two sequences of the smaller ones."""
    assert [luby(i) for i in range(1, 16)] == [1, 1, 2, 1, 1, 2, 4, 1, 1, 2, 1, 1, 2, 4, 8]


def test_budgets_follow_the_sequence():
    """A search without a plan is started anew; time and counters are those of all."""
    search, allowed = searches(*3 * [Status.TIMEOUT], Status.SOLVED)
    result = with_restarts(search, Settings(restart_after=10))
    assert allowed == [10, 10, 20, 10]
    assert result.status is Status.SOLVED
    assert result.counters == {"expansions": 50, "restarts": 3}


@pytest.mark.parametrize("status", [Status.SOLVED, Status.EXHAUSTED])
def test_what_has_not_given_up_is_not_repeated(status: Status):
    """A plan ends it, and so does a search with nothing left to expand."""
    search, allowed = searches(status)
    assert with_restarts(search, Settings(restart_after=10)).status is status
    assert allowed == [10]


def test_expansions_are_limited_in_all():
    """The last search gets what is left."""
    search, allowed = searches(*3 * [Status.TIMEOUT])
    result = with_restarts(search, Settings(restart_after=10, max_expansions=25))
    assert allowed == [10, 10, 5]
    assert (result.status, result.counters["expansions"]) == (Status.TIMEOUT, 25)


def test_a_search_that_was_stopped_is_not_repeated():
    """With expansions left it ran out of time or was stopped from outside."""

    def stopped(settings: Settings) -> PlanResult:
        return PlanResult(Status.TIMEOUT, 0.0, counters={"expansions": settings.max_expansions - 1})

    assert with_restarts(stopped, Settings(restart_after=10)).counters == {"expansions": 9}


def test_restarts_end_with_the_time():
    """Counted budgets bound the work, the time limit is the guard."""
    search, allowed = searches(*2 * [Status.TIMEOUT])
    with_restarts(search, Settings(restart_after=10, time_limit=1e-9))
    assert allowed == [10]

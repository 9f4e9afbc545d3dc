"""Restarts: budgets grow, work is added up, and only what gave up starts anew."""

from collections.abc import Callable

import pytest

from converter.plan import Status
from planner.restarts import with_restarts
from planner.result import PlanResult
from planner.settings import Settings


def searches(*statuses: Status) -> tuple[Callable[[Settings], PlanResult], list[int]]:
    """A search that ends each time as told, having used all its expansions, and a list of what it was allowed."""
    allowed: list[int] = []

    def search(settings: Settings) -> PlanResult:
        allowed.append(settings.max_expansions)
        return PlanResult(statuses[len(allowed) - 1], 0.0, counters={"expansions": settings.max_expansions})

    return search, allowed


def test_each_search_may_expand_twice_as_many():
    """What a search spent without a plan is doubled for the next; time and counters are those of all."""
    search, allowed = searches(Status.TIMEOUT, Status.TIMEOUT, Status.SOLVED)
    result = with_restarts(search, Settings(restart_after=10))
    assert allowed == [10, 20, 40]
    assert result.status is Status.SOLVED
    assert result.counters == {"expansions": 70, "restarts": 2}


@pytest.mark.parametrize("status", [Status.SOLVED, Status.EXHAUSTED])
def test_what_has_not_given_up_is_not_repeated(status: Status):
    """A plan ends it, and so does a search with nothing left to expand."""
    search, allowed = searches(status)
    assert with_restarts(search, Settings(restart_after=10)).status is status
    assert allowed == [10]


def test_expansions_are_limited_in_all():
    """The last search gets what is left."""
    search, allowed = searches(*3 * [Status.TIMEOUT])
    result = with_restarts(search, Settings(restart_after=10, max_expansions=35))
    assert allowed == [10, 20, 5]
    assert (result.status, result.counters["expansions"]) == (Status.TIMEOUT, 35)


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

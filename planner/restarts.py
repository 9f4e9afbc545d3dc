"""Restarts: a search that has drawn badly is given up for a new one.

How many expansions a search takes has a heavy tail: one Maze in fifteen is still unsolved after ten times the median.
Without knowing the distribution, budgets in the proportions 1, 1, 2, 1, 1, 2, 4, ... are the best to within a factor of
the logarithm (Luby, Sinclair and Zuckerman 1993), and what takes long is found as well.
"""

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from itertools import count

from converter.plan import Status
from planner.result import PlanResult
from planner.settings import Settings

_NO_TIME = 1e-9
"""A time limit [s] that is over at once."""


def with_restarts(search: Callable[[Settings], PlanResult], settings: Settings) -> PlanResult:
    """The result of `search`, started anew as often as it gives up for want of expansions.

    Args:
        search: Searches from the start with the budgets of the settings that it is given.
        settings: Budgets of all searches together, and `restart_after`, the smallest of a single one.

    Returns:
        The result of the last search; time and counters are those of all, `restarts` among them.
    """
    started, counters = time.perf_counter(), Counter[str]()
    for budget in map(luby, count(1)):
        time_left = max(settings.time_limit - (time.perf_counter() - started), _NO_TIME)
        expansions_left = settings.max_expansions - int(counters["expansions"])
        allowed = min(settings.restart_after * budget, expansions_left)
        result = search(replace(settings, max_expansions=allowed, time_limit=time_left))
        counters.update(result.counters)
        has_given_up = result.status is Status.TIMEOUT and result.counters.get("expansions", 0) >= allowed
        if not has_given_up or allowed == expansions_left or time.perf_counter() - started >= settings.time_limit:
            break
        counters["restarts"] += 1
    return replace(result, time_s=time.perf_counter() - started, counters=dict(counters))


def luby(i: int) -> int:
    """The term `i` >= 1 of the sequence 1, 1, 2, 1, 1, 2, 4, ..."""
    power = 1 << (i.bit_length() - 1)
    return power if i == 2 * power - 1 else luby(i - power + 1)

"""Restarts: a search that has drawn badly is given up for a new one (Gomes, Selman and Kautz 1998).

How many expansions a search takes has a heavy tail: one Maze in twenty is still unsolved after ten times the median.
Each search may expand twice as many configurations as the one before, so what takes long is found as well.
"""

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import replace

from converter.plan import Status
from planner.result import PlanResult
from planner.settings import Settings

_NO_TIME = 1e-9
"""A time limit [s] that is over at once."""


def with_restarts(search: Callable[[Settings], PlanResult], settings: Settings) -> PlanResult:
    """The result of `search`, started anew after `restart_after` expansions, then after twice as many, and so on.

    Args:
        search: Searches from the start with the budgets of the settings that it is given.
        settings: Budgets of all searches together.

    Returns:
        The result of the last search; time and counters are those of all, `restarts` among them.
    """
    started, counters, patience = time.perf_counter(), Counter[str](), settings.restart_after
    while True:
        time_left = max(settings.time_limit - (time.perf_counter() - started), _NO_TIME)
        patience = min(patience, settings.max_expansions - int(counters["expansions"]))
        result = search(replace(settings, max_expansions=patience, time_limit=time_left))
        counters.update(result.counters)
        has_given_up = result.status is Status.TIMEOUT and result.counters.get("expansions", 0) >= patience
        out_of_time = time.perf_counter() - started >= settings.time_limit
        if not has_given_up or out_of_time or counters["expansions"] >= settings.max_expansions:
            return replace(result, time_s=time.perf_counter() - started, counters=dict(counters))
        counters["restarts"] += 1
        patience *= 2

"""One entry point for every method."""

from typing import Any

import numpy as np
import pytest

import planner
from converter.plan import Status
from planner import METHODS, Settings, methods
from planner.result import PlanResult, Progress
from tests.planner.scenes import body, room

OPEN = room(objects=(body("obj", 0.6, 0.0),), goal=(1.5, 0.0))


def test_every_method_has_a_solver():
    """No name is missing and none is unknown to the settings."""
    assert set(methods.SOLVERS) == set(METHODS)
    assert planner.solve is methods.solve


@pytest.mark.parametrize("method", METHODS)
def test_the_method_of_the_settings_is_called_with_everything(method: str, monkeypatch: pytest.MonkeyPatch):
    """Scene, settings, generator and callbacks arrive as they are, at the solver of that name only."""
    calls: list[tuple[Any, ...]] = []
    answer = PlanResult(Status.EXHAUSTED, 0.0)

    def solver(*arguments: Any, **callbacks: Any) -> PlanResult:
        calls.append((*arguments, *callbacks.values()))
        return answer

    monkeypatch.setattr(methods, "SOLVERS", {method: solver})
    settings, rng, reports = Settings(method=method), np.random.default_rng(0), list[Progress]()
    assert methods.solve(OPEN, settings, rng, should_stop=lambda: True, on_progress=reports.append) is answer
    ((*arguments, on_progress, should_stop),) = calls
    assert arguments == [OPEN, settings, rng]
    assert on_progress == reports.append
    assert should_stop()


@pytest.mark.parametrize("method", ["Rnd+FPR", "MBTS", "MBTS-rrt"])
def test_methods_solve_an_open_room(method: str):
    """The searches behind the names work and can be stopped."""
    settings = Settings(method=method)
    assert methods.solve(OPEN, settings, np.random.default_rng(0)).status is Status.SOLVED
    stopped = methods.solve(OPEN, settings, np.random.default_rng(0), should_stop=lambda: True)
    assert stopped.status is Status.TIMEOUT

"""Proofs that there is no plan: given where walls forbid it, and never where there is one."""

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from converter.convert import convert_level
from converter.formats import read_scene
from converter.plan import Status
from converter.scene import Scene
from converter.shape import Part
from pcg.level_set import read_level_set
from planner.infeasible import proof_of_infeasibility, with_proof
from planner.methods import solve
from planner.problem import Problem
from planner.result import PlanResult
from planner.settings import METHODS, Settings
from tests.planner.scenes import body, room, wall

DATA = Path(__file__).parents[2] / "data"
GAP = 0.4
"""As wide as the agent."""


def divided(width: float, *, goal: tuple[float, float] = (1, 0), obj: tuple[float, float] = (1, 1)) -> Scene:
    """A room with a wall across, in which there is a door of this width."""
    door = (wall(0, -1 - width / 2, 0.2, 2), wall(0, 1 + width / 2, 0.2, 2))
    return room(*door, objects=(body("obj", *obj),), agent=(-1, 0), goal=goal)


def test_a_door_as_wide_as_the_agent_is_open():
    """With tolerance 0 a door of exactly the agent's width proves nothing, one half a per cent narrower and more does."""
    assert proof_of_infeasibility(Problem(replace(divided(GAP), tolerance=0.0))) is None
    proof = proof_of_infeasibility(Problem(replace(divided(0.97 * GAP), tolerance=0.0)))
    assert proof == "the agent can touch no object"


def test_objects_can_be_moved_but_walls_cannot():
    """An object in the door is no proof, if it can be touched; a goal-object behind walls is one, a helper or not."""
    blocked = divided(GAP + 0.2)
    blocked = replace(blocked, objects=(*blocked.objects, body("door", 0, 0, Part.box((0.5, 0.5)))))
    assert proof_of_infeasibility(Problem(blocked)) is None
    closed = divided(0.3)
    closed = replace(closed, objects=(*closed.objects, body("helper", -1.5, 1)))
    assert proof_of_infeasibility(Problem(closed)) == "walls keep the agent from touching 'obj'"


def test_the_goal_has_to_be_touched_from_outside():
    """A goal behind a door too narrow is proof, unless the object reaches through it, or the agent is there already."""
    proof = "walls keep the agent from touching 'obj' anywhere in the goal"
    assert proof_of_infeasibility(Problem(divided(0.3, obj=(-1, 1)))) == proof
    assert proof_of_infeasibility(Problem(divided(0.3, obj=(-1, 1), goal=(0.05, 0)))) is None
    assert proof_of_infeasibility(Problem(divided(0.3, obj=(-1.5, 1), goal=(-1, 0)))) is None


@pytest.mark.parametrize(("x", "proof"), [(2.1, None), (2.2, "the goal is out of bounds")])
def test_the_goal_has_to_be_in_bounds(x: float, proof: str | None):
    """A goal of side 0.35 whose centre is 0.1 m outside can still be met, one 0.2 m outside cannot."""
    assert proof_of_infeasibility(Problem(room(goal=(x, 0)))) == proof


@pytest.mark.parametrize("tolerance", [0.0, 1e-3])
def test_no_published_puzzle_is_infeasible(tolerance: float):
    """All of them have plans, with and without tolerance."""
    for path in sorted((DATA / "puzzles").glob("*.yaml")):
        assert proof_of_infeasibility(Problem(replace(read_scene(path), tolerance=tolerance))) is None


def test_no_solvable_level_is_infeasible():
    """Levels that pushes solve have plans in the geometry `clear`."""
    for level in read_level_set(DATA / "corpus")[::9]:
        assert proof_of_infeasibility(Problem(convert_level(level))) is None


@pytest.mark.parametrize("method", [method for method in METHODS if method not in {"Push", "Hum+R", "MBTS"}])
def test_every_exact_method_says_infeasible(method: str):
    """A proof ends the search of any method whose plans are exact, and is its certificate."""
    result = solve(divided(0.3), Settings(method=method, time_limit=30), np.random.default_rng(0))
    assert (result.status, result.certificate) == (Status.INFEASIBLE, "the agent can touch no object")
    assert result.time_s < 30


def test_a_seed_fixes_how_far_a_search_gets_before_the_proof(monkeypatch: pytest.MonkeyPatch):
    """The counters of an infeasible scene are the same on a machine that is a hundred times slower."""
    scene, settings = divided(0.3, obj=(-1, 1)), Settings(time_limit=1e6)
    now = time.perf_counter
    quick = solve(scene, settings, np.random.default_rng(0))
    monkeypatch.setattr(time, "perf_counter", lambda: 100 * now())
    slow = solve(scene, settings, np.random.default_rng(0))
    assert quick.status is slow.status is Status.INFEASIBLE
    assert quick.counters["expansions"] > 0
    counted, counted_slowly = ({k: v for k, v in r.counters.items() if not k.endswith("_s")} for r in (quick, slow))
    assert counted == counted_slowly


def test_a_proof_ends_a_search(monkeypatch: pytest.MonkeyPatch):
    """A search without end stops once there is a proof; one that finds a plan keeps it, and no proof changes nothing."""
    monkeypatch.setattr("planner.infeasible.PATIENCE", 0)

    def endless(should_stop: Callable[[], bool]) -> PlanResult:
        while not should_stop():
            pass
        return PlanResult(Status.TIMEOUT, 1.0)

    assert with_proof(endless, divided(0.3), lambda: False).status is Status.INFEASIBLE
    asked = iter([False, False, True])
    assert with_proof(endless, divided(0.5), lambda: next(asked)).status is Status.TIMEOUT
    assert with_proof(lambda _: PlanResult(Status.SOLVED, 1.0), divided(0.3), lambda: False).status is Status.SOLVED


def test_a_search_that_is_not_ended_is_judged_afterwards(monkeypatch: pytest.MonkeyPatch):
    """Without `ends_search` a proof does not stop the search, and counts once that has failed by itself."""
    monkeypatch.setattr("planner.infeasible.PATIENCE", 0)

    def stubborn(should_stop: Callable[[], bool]) -> PlanResult:
        assert not should_stop()
        return PlanResult(Status.EXHAUSTED, 1.0)

    result = with_proof(stubborn, divided(0.3), lambda: False, ends_search=False)
    assert (result.status, result.certificate) == (Status.INFEASIBLE, "the agent can touch no object")

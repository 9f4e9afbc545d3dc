"""The original problem from one configuration: three ways to attempt it."""

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from converter.formats import read_scene
from converter.scene import Scene
from planner.methods import solve
from planner.original_problem import original_solver
from planner.problem import Problem
from planner.settings import SOLVE_BY, settings_for
from planner.subproblems import subproblem_solvers
from planner.verify import verify

PUZZLES = Path(__file__).resolve().parents[2] / "data" / "puzzles"
FAITHFUL = settings_for("faithful", time_limit=30.0)


def attempt(scene: Scene, way: str):
    """The steps found from the start of `scene`, and the problem."""
    problem, counters = Problem(scene), Counter[str]()
    settings = replace(FAITHFUL, solve_by=way, mbts_max_depth=2)
    rng = np.random.default_rng(0)
    subproblems = subproblem_solvers(problem, settings, rng, counters, lambda: False)(problem.initial)
    solver = original_solver(problem, settings, rng, counters, lambda: False)
    return problem, solver(problem.initial, subproblems), counters


@pytest.mark.parametrize("way", ["pick-place", "MBTS-rrt"])
def test_the_steps_bring_the_object_to_the_goal(way: str):
    """One pick-place solves Cube-Free, and it ends in the goal."""
    problem, steps, _ = attempt(read_scene(PUZZLES / "cube-free.yaml"), way)
    assert len(steps) == 1
    assert problem.at_goal(steps[-1].applied_to(problem.initial))


@pytest.mark.parametrize("way", SOLVE_BY)
def test_nothing_is_found_where_nothing_can_be(way: str):
    """O-Room needs several pick-places: one alone finds no way."""
    _, steps, counters = attempt(read_scene(PUZZLES / "o-room.yaml"), way)
    assert steps == []
    assert counters["mbts_calls"] == (way != "pick-place")


@pytest.mark.parametrize("way", SOLVE_BY)
def test_plans_of_the_search_verify_whichever_way_it_takes(way: str):
    """Trajectories that the optimiser accepts and that cut corners do not get into a plan."""
    scene = read_scene(PUZZLES / "corner.yaml")
    settings = replace(FAITHFUL, solve_by=way, mbts_max_depth=2)
    result = solve(scene, settings, np.random.default_rng(1))
    plan = result.to_plan(scene, settings, seed=1)
    assert plan.solved
    assert not verify(scene, plan)

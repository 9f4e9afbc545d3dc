"""Multi-bound tree search: its steps, pruning, limits, and what its plans are worth."""

from dataclasses import replace
from itertools import count
from pathlib import Path

import numpy as np
import pytest

from converter.formats import read_scene
from converter.plan import Plan, Status
from converter.scene import Scene
from pcg.errors import InputError
from planner.lgp import Bound
from planner.mbts import MultiBoundTreeSearch, solve
from planner.problem import Problem
from planner.result import Progress
from planner.settings import Settings
from planner.verify import ViolationKind, verify
from tests.planner.scenes import body, room, wall

PUZZLES = Path(__file__).parents[2] / "data" / "puzzles"
MBTS, MBTS_RRT = Settings(method="MBTS"), Settings(method="MBTS-rrt")
OPEN = room(objects=(body("obj", 0.6, 0.0),), goal=(1.5, 0.0))
TWO = room(objects=(body("obj", 0.6, 0.0), body("other", 0.0, 1.0)), goal=(1.5, 0.0))
ACROSS = room(wall(0.0, 0.0, 0.1, 4.0), objects=(body("obj", 1.5, 0.0),), agent=(-1.5, 0.0), goal=(1.5, 1.0))
"""A wall across the whole room between agent and object."""


def planned(scene: Scene, settings: Settings, seed: int = 0) -> Plan:
    """The plan file's content."""
    return solve(scene, settings, np.random.default_rng(seed)).to_plan(scene, settings, seed)


@pytest.mark.parametrize("settings", [MBTS, MBTS_RRT], ids=["MBTS", "MBTS-rrt"])
@pytest.mark.parametrize("scene", [OPEN, TWO], ids=["one object", "two objects"])
def test_open_rooms_are_solved_and_verified(scene: Scene, settings: Settings):
    """With nothing in the way both path bounds give valid plans of one move and one carry."""
    plan = planned(scene, settings)
    assert plan.status is Status.SOLVED
    assert plan.counters["accepted"] == 1
    assert [segment.mode for segment in plan.segments] == ["move", "carry"]
    assert verify(scene, plan) == []


def test_an_obstacle_is_put_away_first():
    """Only with the obstacle-object gone, which fills the goal, can the goal-object be placed."""
    scene = room(objects=(body("obj", 0.8, 0.0), body("other", 0.0, 1.2)), goal=(0.0, 1.2), goal_size=(0.1, 0.1))
    plan = planned(scene, MBTS_RRT)
    assert [subgoal.object for subgoal in plan.subgoals] == ["other", "obj"]
    assert verify(scene, plan) == []


def test_paths_have_the_configured_number_of_steps():
    """Ten configurations a phase besides the one it starts from."""
    assert [len(segment.path) for segment in planned(OPEN, MBTS).segments] == [11, 11]
    assert [len(s.path) for s in planned(OPEN, replace(MBTS, mbts_phase_steps=4)).segments] == [5, 5]


def test_a_seed_fixes_the_plan():
    """The same seed gives the same plan bit by bit, another one another plan."""
    one, again, other = (planned(TWO, MBTS, seed) for seed in (1, 1, 2))
    paths = [np.concatenate([segment.path for segment in plan.segments]) for plan in (one, again, other)]
    assert one.counters == again.counters
    np.testing.assert_array_equal(paths[0], paths[1])
    assert not np.array_equal(paths[0], paths[2])


def test_each_step_expands_one_node_and_solves_each_bound_once_at_most():
    """With two objects the first solution of the symbolic search comes with the third expansion, in breadth-first order.

    Root, pick 0, pick 1: the second step queues the poses of `pick 0` and of `place 0 goal`.
    """
    search = MultiBoundTreeSearch(Problem(TWO), MBTS, np.random.default_rng(0))
    assert search.step() is None
    assert search.counters["nlp_calls"] == 0
    assert len(search.fringe) == 2
    assert search.step() is None
    assert search.counters["pose_feasible"] == 1
    assert len(search.queues[Bound.POSE]) == 1
    solution = search.step()
    assert solution is not None
    assert [str(action) for action in solution[0].skeleton] == ["pick 0", "place 0 goal"]
    assert search.counters["expansions"] == search.counters["steps"] == 3
    assert [search.counters[f"{bound}_feasible"] for bound in Bound] == [2, 1, 1]


def test_an_infeasible_node_prunes_its_subtree():
    """If no bound can be feasible, the first pose, that of the only pick, ends the search."""
    result = solve(OPEN, replace(MBTS, mbts_max_violation=0.0), np.random.default_rng(0))
    assert result.status is Status.EXHAUSTED
    assert result.counters["pose_infeasible"] == result.counters["nlp_calls"] == 1
    assert result.counters["nodes"] == 3


def test_a_wall_defeats_exact_motions():
    """Sequences have switches on both sides of it, but no motion leads there, so all skeletons are tried."""
    result = solve(ACROSS, replace(MBTS_RRT, mbts_max_depth=4, motion_iterations=200), np.random.default_rng(0))
    assert result.status is Status.EXHAUSTED
    assert result.certificate == "all skeletons of up to 4 actions were tried"
    assert result.counters["path_infeasible"] == result.counters["sequence_feasible"] > 0
    assert not result.segments


def test_a_wall_is_jumped_over_between_two_steps():
    """Collisions are looked at in single configurations, so the optimiser accepts a path that verification does not."""
    plan = planned(ACROSS, MBTS)
    assert plan.status is Status.SOLVED
    assert ViolationKind.COLLISION in [violation.kind for violation in verify(ACROSS, plan)]


def test_no_skeleton_is_longer_than_the_limit():
    """One action is too few for any solution."""
    result = solve(OPEN, replace(MBTS, mbts_max_depth=1), np.random.default_rng(0))
    assert result.status is Status.EXHAUSTED
    assert "nlp_calls" not in result.counters


def test_the_search_can_be_stopped():
    """Asked before any work, and by counted expansions."""
    assert solve(OPEN, MBTS, np.random.default_rng(0), should_stop=lambda: True).status is Status.TIMEOUT
    result = solve(TWO, replace(MBTS, max_expansions=2), np.random.default_rng(0))
    assert result.status is Status.TIMEOUT
    assert result.counters["expansions"] == 2


def test_a_motion_cut_short_does_not_exhaust_the_search():
    """Stopped in the middle of the last path bound, the search ran out of time, not out of skeletons."""
    asked = count()
    settings = replace(MBTS_RRT, mbts_max_depth=2, motion="ompl")
    result = solve(ACROSS, settings, np.random.default_rng(0), should_stop=lambda: next(asked) > 200)
    assert result.counters["path_infeasible"] == 1
    assert result.status is Status.TIMEOUT
    assert result.certificate is None


def test_progress_is_reported_after_each_step_without_a_solution():
    """Two steps before the one that solves; expansions rise by one."""
    reports: list[Progress] = []
    solve(TWO, MBTS, np.random.default_rng(0), on_progress=reports.append)
    assert [(report.expansions, report.nodes, report.best_score) for report in reports] == [(1, 2, 0.0), (2, 4, 1.0)]


def test_a_solved_scene_needs_no_motion():
    """With the object in the goal from the start the plan is empty."""
    scene = room(objects=(body("obj", 1.5, 0.0),), goal=(1.5, 0.0))
    plan = planned(scene, MBTS)
    assert plan.status is Status.SOLVED
    assert plan.segments == ()
    assert verify(scene, plan) == []


def test_overlapping_bodies_are_refused():
    """A scene with an invalid start is bad input."""
    with pytest.raises(InputError, match="overlaps"):
        solve(room(objects=(body("obj", 0.1, 0.0),)), MBTS, np.random.default_rng(0))


def test_accepted_is_not_verified():
    """In Corner no grasp allows a single carry; the loose threshold accepts one that misses the goal by centimetres."""
    scene = read_scene(PUZZLES / "corner.yaml")
    plan = planned(scene, MBTS)
    assert plan.status is Status.SOLVED
    assert [violation.kind for violation in verify(scene, plan)] == [ViolationKind.GOAL_MISSED]
    strict = planned(scene, replace(MBTS, mbts_max_violation=1e-3, mbts_max_depth=2))
    assert strict.status is Status.EXHAUSTED


@pytest.mark.parametrize("name", ["cube-free", "two-blocks"])
def test_exact_motions_make_verified_plans_of_puzzles(name: str):
    """What passes RRT-Connect between the switches has no violation."""
    scene = read_scene(PUZZLES / f"{name}.yaml")
    plan = planned(scene, MBTS_RRT)
    assert plan.status is Status.SOLVED
    assert verify(scene, plan) == []

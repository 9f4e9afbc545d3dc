"""Plan improvement: never worse, always valid, and good."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import planner
from converter.formats import read_scene
from converter.plan import Segment, Status, Subgoal, plan_document
from converter.scene import Scene
from planner import improve as improve_module
from planner.assemble import segments_of
from planner.carries import Route, RoutePlanner, route_of
from planner.improve import improve
from planner.improve_draws import Draws
from planner.improve_moves import Moves
from planner.problem import Problem
from planner.result import PlanResult
from planner.settings import Settings
from planner.verify import verify
from tests.planner.scenes import RADIUS, body, room, wall

PUZZLES = Path(__file__).parents[2] / "data" / "puzzles"
OPEN = room(objects=(body("obj", 0.6, 0.0), body("other", -1.0, 1.0)), goal=(1.5, 0.0), agent=(-1.0, 0.0))
BEHIND = 0.1 + RADIUS


def rounds(n: int) -> Settings:
    """Improvement that ends after `n` rounds, whatever the time."""
    return Settings(improve=1e6, improve_rounds=n)


def cost(result: PlanResult) -> tuple[int, float]:
    """Pick-places and length."""
    return len(result.subgoals), sum(segment.length for segment in result.segments)


def first_plan(scene: Scene, seed: int) -> PlanResult:
    """A plan that the search finds."""
    result = planner.solve(scene, Settings(), np.random.default_rng(seed))
    assert result.status is Status.SOLVED
    return result


def detour() -> PlanResult:
    """In the open room: the other object is moved for nothing, the goal-object by way of a needless placement."""
    carries = [
        ("other", [(-1.0, 1.0 - BEHIND), (-1.0, 1.3 - BEHIND)]),
        ("obj", [(0.6 - BEHIND, 0.0), (0.8 - BEHIND, -1.0)]),
        ("obj", [(0.8 - BEHIND, -1.0), (1.5 - BEHIND, 0.0)]),
    ]
    segments, place = [], (-1.0, 0.0)
    for name, path in carries:
        segments += [Segment("move", None, np.array([place, path[0]])), Segment("carry", name, np.array(path))]
        place = path[-1]
    ends = [("other", (-1.0, 1.3)), ("obj", (0.8, -1.0)), ("obj", (1.5, 0.0))]
    subgoals = tuple(Subgoal(name, np.array(position)) for name, position in ends)
    return PlanResult(Status.SOLVED, 0.5, tuple(segments), subgoals, counters={"nodes": 4})


def test_needless_pick_places_go():
    """One carry is enough here, and the way is then as good as straight; what is known of the first plan stays."""
    first = detour()
    assert verify(OPEN, first.to_plan(OPEN, Settings(), 0)) == []
    best = improve(OPEN, first, rounds(5), np.random.default_rng(0))
    assert len(best.subgoals) == 1
    # From (-1, 0) to the grasp, and into the near side of the goal.
    assert cost(best)[1] == pytest.approx(2.5 - BEHIND - 0.175, abs=0.03)
    assert verify(OPEN, best.to_plan(OPEN, Settings(), 0)) == []
    assert (best.status, best.time_s, best.counters["nodes"]) == (Status.SOLVED, 0.5, 4)
    assert best.counters["improve_rounds"] == 5
    assert best.counters["improve_time_s"] > 0


@pytest.mark.parametrize("name", ["corner", "wall", "two-blocks"])
def test_plans_of_puzzles_get_better_and_stay_valid(name: str):
    """Fewer pick-places or a shorter way, in two rounds already; the verification finds nothing."""
    scene = read_scene(PUZZLES / f"{name}.yaml")
    first = first_plan(scene, 1)
    best = improve(scene, first, rounds(2), np.random.default_rng(1))
    assert cost(best) < cost(first)
    assert verify(scene, best.to_plan(scene, Settings(), 1)) == []


def test_a_corridor_without_clearance_needs_contact():
    """Puzzle Wall: where the object touches the wall the agent can pass it, which halves the way."""
    scene = read_scene(PUZZLES / "wall.yaml")
    best = improve(scene, first_plan(scene, 0), rounds(40), np.random.default_rng(0))
    assert len(best.subgoals) == 2
    assert cost(best)[1] < 11.0
    assert verify(scene, best.to_plan(scene, Settings(), 0)) == []


def test_a_seed_fixes_the_improvement():
    """The same rounds give the same bytes."""
    scene = read_scene(PUZZLES / "corner.yaml")
    first = first_plan(scene, 0)

    def text() -> str:
        result = improve(scene, first, rounds(3), np.random.default_rng(7))
        counters = {key: value for key, value in result.counters.items() if not key.endswith("_s")}
        return json.dumps(plan_document(replace(result, counters=counters).to_plan(scene, Settings(), 0)))

    assert text() == text()


def test_what_verification_refuses_does_not_count(monkeypatch: pytest.MonkeyPatch):
    """Then the first plan stays, to the last way-point."""
    first = detour()
    monkeypatch.setattr(improve_module, "verify", lambda _, plan: plan.segments != first.segments)
    best = improve(OPEN, first, rounds(2), np.random.default_rng(0))
    assert (best.segments, best.subgoals) == (first.segments, first.subgoals)


@pytest.mark.parametrize("name", ["maze", "o-room"])
def test_a_plan_is_a_route_with_its_own_motions(name: str):
    """From its segments and back nothing is lost."""
    scene = read_scene(PUZZLES / f"{name}.yaml")
    first = first_plan(scene, 1)
    steps = route_of(Problem(scene), first.segments).steps
    assert plan_document(replace(first, segments=segments_of(scene, steps)).to_plan(scene, Settings(), 0)) == (
        plan_document(first.to_plan(scene, Settings(), 0))
    )


def test_a_plan_that_shortest_paths_cannot_retrace_gets_better():
    """This one of Maze goes by way of a grasp in a sliver of free space that shortest paths miss."""
    scene = read_scene(PUZZLES / "maze.yaml")
    first = first_plan(scene, 101)
    problem = Problem(scene)
    assert RoutePlanner(problem).route(route_of(problem, first.segments).carries) is None
    assert cost(improve(scene, first, rounds(8), np.random.default_rng(1))) < cost(first)


def test_what_is_no_valid_plan_stays():
    """Neither a plan through a wall nor a failure becomes a success."""
    blocked = replace(OPEN, walls=(wall(0.1, 0.0, 0.1, 1.0),))
    for first in (detour(), PlanResult(Status.EXHAUSTED, 0.1)):
        assert improve(blocked, first, rounds(2), np.random.default_rng(0)) is first


def test_improvement_stops_when_told():
    """By its time, or by the caller."""
    first = detour()
    for settings, stop in ((Settings(improve=1e-9), False), (rounds(10), True)):
        best = improve(OPEN, first, settings, np.random.default_rng(0), should_stop=lambda stop=stop: stop)
        assert (best.segments, best.counters["improve_moves"]) == (first.segments, 0)


def test_solve_improves_if_settings_say_so():
    """The time to the first plan stays apart; without the setting nothing is counted."""
    plain = planner.solve(OPEN, Settings(), np.random.default_rng(0))
    better = planner.solve(OPEN, rounds(1), np.random.default_rng(0))
    assert "improve_time_s" not in plain.counters
    assert better.counters["improve_rounds"] == 1
    assert cost(better) < cost(plain)


def detour_route() -> tuple[Route, Moves]:
    """The detour with its motions, and moves for it."""
    problem = Problem(OPEN)
    motions = RoutePlanner(problem)
    route = motions.route(route_of(problem, detour().segments).carries)
    assert route is not None
    return route, Moves(problem, motions, np.random.default_rng(3))


@pytest.mark.parametrize(
    ("move", "changes"),
    [("other_grasp", (1, 0)), ("other_placement", (0, 1)), ("placement_on_the_way", (0, 1))],
)
def test_moves_change_one_decision(move: str, changes: tuple[int, int]):
    """One grasp or one placement, everything else stays."""
    route, moves = detour_route()
    for _ in range(30):
        carries = getattr(moves, move)(route)
        pairs = list(zip(carries, route.carries, strict=True))
        assert sum((a.grasp != b.grasp).any() for a, b in pairs) == changes[0]
        assert sum((a.placement != b.placement).any() for a, b in pairs) == changes[1]
        assert [a.index for a, _ in pairs] == [b.index for _, b in pairs]


def test_moves_that_drop_swap_and_shake():
    """One or two carries fewer; the same objects in another order; the same objects anew."""
    route, moves = detour_route()
    assert {len(moves.fewer(route)) for _ in range(30)} <= {0, 1, 2}
    assert {tuple(c.index for c in moves.other_order(route)) for _ in range(30)} >= {(0, 1, 0), (1, 0, 0)}
    shaken = [carries for carries in (moves.shaken(route) for _ in range(30)) if len(carries) == 3]
    assert shaken
    assert {tuple(c.index for c in carries) for carries in shaken} == {(1, 0, 0)}


def test_grasps_touch_and_contacts_hold():
    """Every drawn grasp touches; some placements touch a wall or the bounds from the free side."""
    problem = Problem(room(wall(0.0, 1.0, 3.0, 0.2), objects=(body("obj", 0.0, 0.0),), agent=(-1.0, 0.0)))
    draws, space = Draws(problem, np.random.default_rng(0)), problem.object_space(problem.initial, 0)
    carry = route_of(Problem(OPEN), detour().segments).carries[1]
    in_contact = 0
    for _ in range(200):
        grasp = draws.grasp(problem.initial, carry).grasp
        outside = np.maximum(np.abs(grasp) - 0.1, 0.0)
        assert np.hypot(*outside) == pytest.approx(RADIUS, abs=1e-9)
        placement = draws.near_placement(problem.initial, carry, is_final=False).placement
        if space.point_free(placement):
            steps = 2e-9 * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
            in_contact += not space.points_free(placement + steps).all()
    assert 50 < in_contact < 150


def test_the_goal_object_ends_in_the_goal():
    """Its last placement never leaves the goal, however far it is moved."""
    problem = Problem(OPEN)
    draws, carry = Draws(problem, np.random.default_rng(0)), route_of(problem, detour().segments).carries[2]
    for draw in (draws.near_placement, draws.new_placement):
        for _ in range(50):
            assert OPEN.goal.contains(draw(problem.initial, carry, is_final=True).placement)

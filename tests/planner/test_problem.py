"""Problems: valid starts, configurations, and the spaces that belong to them."""

from dataclasses import replace

import numpy as np
import pytest

from converter.scene import Body
from converter.shape import Part
from pcg.errors import InputError
from planner.configuration_space import ConfigurationSpace
from planner.problem import Configuration, Problem
from tests.planner.scenes import body, room, vectors, wall

OBJ, OTHER = body("obj", 1.0, 0.0), body("other", -1.0, 0.0)


def test_too_many_pairs_of_bodies_are_refused(monkeypatch: pytest.MonkeyPatch):
    """Nobody would wait for what grows with the square of the objects."""
    scene = room(wall(0, 1, 0.1, 0.1), objects=(body("obj", -1, 1), body("other", 1, -1)), agent=(0, -1))
    pairs = 2 * (2 + len(scene.walls))
    monkeypatch.setattr("planner.problem.MAX_PAIRS", pairs)
    Problem(scene)
    monkeypatch.setattr("planner.problem.MAX_PAIRS", pairs - 1)
    with pytest.raises(InputError, match=rf"{pairs} pairs .* too many .*; at most {pairs - 1}"):
        Problem(scene)


def test_initial_configuration_is_the_scene():
    """Positions come from the scene, objects in its order; the goal-object is found by name."""
    scene = room(objects=(OTHER, OBJ), agent=(0.5, 1.0))
    problem = Problem(scene)
    np.testing.assert_array_equal(problem.initial.agent, [0.5, 1.0])
    np.testing.assert_array_equal(problem.initial.objects, [[-1, 0], [1, 0]])
    assert problem.n_objects == 2
    assert problem.goal_index == 0
    assert Problem(replace(scene, goal=replace(scene.goal, object="obj"))).goal_index == 1


def test_configurations_are_values():
    """A changed configuration is a new one, and its arrays cannot be written to."""
    before = Configuration(np.zeros(2), vectors([1, 0], [2, 0]))
    after = before.with_object(1, np.array([3.0, 3.0]))
    np.testing.assert_array_equal(before.objects, [[1, 0], [2, 0]])
    np.testing.assert_array_equal(after.objects, [[1, 0], [3, 3]])
    with pytest.raises(ValueError, match="read-only"):
        after.objects[0, 0] = 1.0


@pytest.mark.parametrize(("x", "inside"), [(1.675, True), (1.675 + 1e-10, True), (1.675 + 1e-8, False)])
def test_at_goal_counts_the_border(x: float, *, inside: bool):
    """The goal rectangle is closed, with the numeric slack."""
    problem = Problem(room(goal=(1.5, 1.5), goal_size=(0.35, 0.35)))
    assert problem.at_goal(problem.initial.with_object(0, np.array([x, 1.325]))) == inside


@pytest.mark.parametrize(
    ("gap", "near"), [(-0.1, True), (0.0, True), (1e-3 + 0.9e-6, True), (1e-3 + 1.1e-6, False), (0.1, False)]
)
def test_touching_is_a_matter_of_the_gap(gap: float, *, near: bool):
    """Up to the tolerance, and the slack that a plan may have beside it, the agent can grasp; of each object by itself."""
    problem = Problem(room(objects=(OBJ, OTHER), tolerance=1e-3))
    beside = Configuration(np.array([1.0 - 0.1 - problem.scene.agent.radius - gap, 0.0]), problem.initial.objects)
    assert problem.touches(beside, 0) == near
    assert not problem.touches(beside, 1)


def test_agent_space_follows_the_objects():
    """Objects are obstacles where the configuration has them; a held one is none."""
    problem = Problem(room(objects=(OBJ, OTHER)))
    moved = problem.initial.with_object(0, np.array([0.0, 1.5]))
    places = vectors([1, 0], [0, 1.5], [-1, 0])
    assert problem.agent_space(problem.initial).points_free(places).tolist() == [False, True, False]
    assert problem.agent_space(moved).points_free(places).tolist() == [True, False, False]
    assert problem.agent_space(moved, held=0).points_free(places).tolist() == [True, True, False]


def test_object_space_ignores_the_agent_and_the_object_itself():
    """An object may be where it is and where the agent is, not where walls and other objects are."""
    problem = Problem(room(wall(0, 1.5, 0.4, 0.4), objects=(OBJ, OTHER), agent=(0.0, -1.0)))
    places = vectors([1, 0], [0, -1], [-1, 0.1], [0, 1.3], [-1, 0.2], [0, 1.2])
    free = [True, True, False, False, True, True]
    assert problem.object_space(problem.initial, 0).points_free(places).tolist() == free
    alone = [True, True, True, False, True, True]
    assert problem.wall_space(0).points_free(places).tolist() == alone


def test_carry_space_is_where_both_fit():
    """With an object held on its right the agent keeps clear by its radius, the object by half its side."""
    problem = Problem(room(wall(-1, 0, 0.2, 4), objects=(OBJ,)))
    grasp = np.array([0.3, 0.0])
    space = problem.carry_space(problem.initial, 0, grasp)
    # The object's left side meets the wall's right side at -0.9 when its centre is at -0.8.
    limit = -0.8 + 0.3
    places = vectors([limit, 0], [limit - 1e-6, 0], [2, 0], [2.1, 0])
    assert space.points_free(places).tolist() == [True, False, True, False]
    # Held above, both centres stay in the bounds.
    space = problem.carry_space(problem.initial, 0, np.array([0.0, 0.3]))
    np.testing.assert_allclose(space.bounds, [[-2, -1.7], [2, 2]])


def test_an_object_on_the_bounds_can_be_carried_along_them():
    """Rounding of position + grasp does not put an object out of bounds that stands exactly on them."""
    rng = np.random.default_rng(0)
    for grasp in rng.uniform(-0.3, 0.3, (100, 2)):
        for corner in vectors([-2, -2], [2, -2], [2, 2]):
            problem = Problem(room(objects=(body("obj", *corner),)))
            space = problem.carry_space(problem.initial, 0, grasp)
            at = np.clip(corner + grasp, -2, 2)
            inside = (at == corner + grasp).all()
            assert space.point_free(corner + grasp) == inside


def test_sight_blockers_leave_out_the_ignored():
    """All walls and all objects but the ignored ones, at their places in the configuration."""
    problem = Problem(room(wall(0, 1.5, 0.4, 0.4), objects=(OBJ, OTHER)))
    assert len(problem.sight_blockers(problem.initial)) == 3
    assert len(problem.sight_blockers(problem.initial, 0)) == 2
    assert len(problem.sight_blockers(problem.initial, 0, 1)) == 1


def test_rooms_without_walls_are_problems():
    """Only the bounds confine an empty room."""
    problem = Problem(room())
    assert problem.agent_space(problem.initial).segment_free(*vectors([-2, -2], [-2, 2]))
    assert problem.object_space(problem.initial, 0).point_free(np.array([2.0, 2.0]))


@pytest.mark.parametrize("tolerance", [0.0, 1e-3])
@pytest.mark.parametrize(
    ("bodies", "message"),
    [
        ((body("obj", 0.3, 0),), "agent overlaps 'obj'"),
        ((body("obj", 1, 0), body("other", 1.2, 0)), "object 'other' overlaps 'obj'"),
        ((body("obj", -0.8, 1.5),), "object 'obj' overlaps 'wall at -1, 1.5'"),
        ((body("obj", 1, 0, Part(np.array([[0.0, 0.0]]), 0.8)),), "agent overlaps 'obj'"),
    ],
)
def test_starts_may_touch_but_not_overlap(bodies: tuple[Body, ...], message: str, tolerance: float):
    """Bodies may touch and overlap by the tolerance at the start; a micrometre more is refused, naming both."""
    *others, last = bodies

    def start_with_last_pushed_left(by: float) -> Problem:
        pushed = replace(last, position=last.position - [by, 0, 0])
        return Problem(room(wall(-1, 1.5, 0.2, 0.2), objects=(*others, pushed), tolerance=tolerance))

    start_with_last_pushed_left(tolerance)
    with pytest.raises(InputError, match=message):
        start_with_last_pushed_left(tolerance + 1e-6)


@pytest.mark.parametrize(
    ("agent", "obj", "message"),
    [((2.01, 0), (1, 0), "agent is out of bounds"), ((0, 0), (1, -2.01), "object 'obj' is out of bounds")],
)
def test_starts_have_to_be_in_bounds(agent: tuple[float, float], obj: tuple[float, float], message: str):
    """Each centre starts within the bounds; the message names the one that does not and where it is."""
    with pytest.raises(InputError, match=message):
        Problem(room(objects=(body("obj", *obj),), agent=agent))


def test_grasp_obstacles_are_those_of_the_agent_about_the_object():
    """An offset from the object is free exactly where the agent, holding it, is free in the world."""
    problem = Problem(room(wall(0.5, 0, 0.4, 2), objects=(body("obj", 0, 0.1), body("other", -1, 1)), agent=(-1, -1)))
    configuration = problem.initial
    offsets = np.random.default_rng(0).uniform(-1.2, 1.2, (200, 2))
    relative = ConfigurationSpace(problem.grasp_obstacles(configuration, 0), np.array([[-9.0, -9.0], [9.0, 9.0]]))
    held = problem.agent_space(configuration, held=0).points_free(offsets + configuration.objects[0])
    assert 0 < held.sum() < 200
    np.testing.assert_array_equal(relative.points_free(offsets), held)


@pytest.mark.parametrize(
    ("position", "distance"), [((1.0, 1.0), 0.0), ((1.1, 0.9), 0.0), ((0.0, 1.0), 0.9), ((0.6, 0.5), 0.5)]
)
def test_distance_to_the_goal_is_that_to_its_rectangle(position: tuple[float, float], distance: float):
    """Zero inside and on the border, straight or diagonal outside."""
    problem = Problem(room(goal=(1.0, 1.0), goal_size=(0.2, 0.2)))
    configuration = problem.initial.with_object(problem.goal_index, np.array(position))
    assert problem.distance_to_goal(configuration) == pytest.approx(distance)

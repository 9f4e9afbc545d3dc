"""Lines of sight: blocked by walls and other objects, not by touching nor by the ends' own bodies."""

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from converter.shape import FloatArray, Part
from planner.line_of_sight import goal_object_sees, goal_object_sees_if
from planner.problem import Configuration, Problem
from tests.planner.plain_geometry import hull, points, polygons
from tests.planner.scenes import body, room, vectors, wall

OBJ = body("obj", -1.0, 0.0)
L_SHAPE = (Part.box((0.5, 0.1)), Part(Part.box((0.1, 0.4)).core + np.array([0.2, 0.15]), 0.02))
TARGET = np.array([1.0, 0.0])


def sees(problem: Problem, target: FloatArray = TARGET) -> bool:
    """Whether the goal-object sees `target` at the start."""
    return goal_object_sees(problem, problem.initial, target)


def test_open_room():
    """Nothing is in the way; the goal-object's own body, in which the line begins, does not count."""
    assert sees(Problem(room(objects=(OBJ,), agent=(0, -1))))


@pytest.mark.parametrize(
    ("y", "visible"),
    [(0.0, False), (0.5 - 1e-6, False), (0.5, True), (-0.5, True), (0.6, True)],
)
def test_walls_block_unless_they_only_touch(y: float, *, visible: bool):
    """A wall with its edge on the line does not block, one a micrometre over it does."""
    assert sees(Problem(room(wall(0, y, 0.4, 1.0), objects=(OBJ,), agent=(0, -1.5)))) == visible


def test_other_objects_block_and_the_agent_does_not():
    """An obstacle-object on the line blocks where the configuration has it; the agent on the line is no obstacle."""
    problem = Problem(room(objects=(OBJ, body("other", 0, 0)), agent=(0.5, 0)))
    assert not sees(problem)
    aside = problem.initial.with_object(1, np.array([0.0, 1.0]))
    assert goal_object_sees(problem, aside, TARGET)


def test_the_line_leaves_from_where_the_goal_object_is():
    """The configuration counts, not the scene."""
    problem = Problem(room(wall(0, 0, 0.4, 1.0), objects=(OBJ,), agent=(0, -1.5)))
    assert goal_object_sees(problem, problem.initial.with_object(0, np.array([0.5, 0.0])), TARGET)


def test_the_tolerance_makes_blockers_thinner():
    """What overlaps the line by the tolerance counts as touching it."""
    blocker = wall(0, 0.499, 0.4, 1.0)
    assert sees(Problem(room(blocker, objects=(OBJ,), agent=(0, -1.5), tolerance=1e-3)))
    assert not sees(Problem(room(blocker, objects=(OBJ,), agent=(0, -1.5), tolerance=0.9e-3)))


@settings(deadline=None, max_examples=60)
@given(st.lists(polygons(3), min_size=1, max_size=4), points, points)
def test_agrees_with_shapely(cores: list[FloatArray], source: FloatArray, target: FloatArray):
    """The open segment meets the interior of a blocker exactly if it is not visible."""
    far = vectors([50, 50])[0]
    walls = [body(f"wall {i}", *far, Part(core)) for i, core in enumerate(cores)]
    problem = Problem(room(*walls, objects=(OBJ,), half=100))
    configuration = problem.initial.with_object(0, source + far)
    overlaps = [shapely.intersection(shapely.LineString([source, target]), hull(core)).length for core in cores]
    assume(all(overlap == 0 or overlap > 1e-4 for overlap in overlaps) and (source != target).any())
    distances = [shapely.distance(shapely.LineString([source, target]), hull(core)) for core in cores]
    assume(all(overlap > 0 or distance > 1e-8 for overlap, distance in zip(overlaps, distances, strict=True)))
    assert goal_object_sees(problem, configuration, target + far) == (max(overlaps) == 0)


@pytest.mark.parametrize("index", [0, 1, 2])
@settings(deadline=None, max_examples=40)
@given(data=st.data())
def test_hypothetical_sight_is_sight_in_the_hypothetical_configuration(index: int, data: st.DataObject):
    """Moving the object in thought and moving it give the same answer, for the goal-object and for the others."""
    objects = (
        body("obj", -1.8, 1.8, Part.box((0.3, 0.2), 0.03), yaw=0.4),
        body("a", 1.8, 1.8),
        body("b", 1.8, -1.8, *L_SHAPE),
    )
    walls = wall(0.2, 0.1, 0.6, 0.2), wall(-0.5, -0.7, 0.3, 0.9)
    problem = Problem(room(*walls, objects=objects, agent=(-1.5, -1.5)))
    configuration = Configuration(data.draw(points), np.array([data.draw(points) for _ in range(3)]))
    candidates = np.array([data.draw(points) for _ in range(5)])
    target = data.draw(points)
    found = goal_object_sees_if(problem, configuration, index, candidates, target)
    expected = [goal_object_sees(problem, configuration.with_object(index, one), target) for one in candidates]
    assert found.tolist() == expected

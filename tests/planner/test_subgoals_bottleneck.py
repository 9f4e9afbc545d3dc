"""Bottleneck subgoals: roadmaps against a plain twin, densities of known rooms."""

from collections import deque

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from converter.scene import Body
from converter.shape import FloatArray
from planner.configuration_space import ConfigurationSpace, ObstacleSet
from planner.problem import Problem
from planner.settings import Settings
from planner.subgoals_bottleneck import KEPT_ROADMAPS, MAX_VERTICES, BottleneckSubgoals, Roadmap
from tests.planner.scenes import body, room, wall

BTL = Settings(method="Btl+FPR")
DOOR = 0.4
"""Two rooms with a door of this width, through which an object of 0.2 m passes."""


def two_rooms() -> Problem:
    """A wall across the room at x = 0 with a door at y = 0; the object stands on the left."""
    half = (2 - DOOR / 2) / 2
    walls = [wall(0, sign * (2 - half), 0.1, 2 * half) for sign in (-1, 1)]
    return Problem(room(*walls, objects=(body("obj", -1, 0), body("other", -1, 1.5)), agent=(-1.5, -1.5)))


def roadmap_of(problem: Problem, cell: float = 0.1) -> Roadmap:
    """The roadmap of the goal-object at the start."""
    return Roadmap(problem.object_space(problem.initial, 0), cell)


def reachable_by_steps(space: ConfigurationSpace, start: FloatArray, cell: float) -> set[tuple[float, float]]:
    """Plain twin of the roadmap's connectivity: breadth-first search over free steps to the 8 neighbours."""
    found, queue = {tuple(start.round(6))}, deque([start])
    while queue:
        here = queue.popleft()
        for dx in (-cell, 0.0, cell):
            for dy in (-cell, 0.0, cell):
                there = here + np.array([dx, dy])
                key = tuple(there.round(6))
                inside = (np.abs(there) <= 2 + 1e-9).all()
                if key not in found and inside and space.point_free(there) and space.segment_free(here, there):
                    found.add(key)
                    queue.append(there)
    return {(float(x), float(y)) for x, y in found}


@settings(max_examples=15, deadline=None)
@given(st.lists(st.tuples(st.floats(-1.8, 1.8), st.floats(-1.8, 1.8), st.floats(0.1, 1.5)), max_size=5))
def test_density_is_positive_exactly_where_steps_lead(blocks: list[tuple[float, float, float]]):
    """Whatever the obstacles, the vertices with paths are those that single free steps reach."""
    polygons = [np.array([[x, y], [x + s, y], [x + s, y + 0.3], [x, y + 0.3]]) for x, y, s in blocks]
    space = ConfigurationSpace(ObstacleSet.of(polygons, [0.0] * len(polygons)), np.array([[-2.0, -2.0], [2.0, 2.0]]))
    start = np.array([-2.0, -2.0])
    if not space.point_free(start):
        return
    cell = 0.25
    roadmap = Roadmap(space, cell)
    reached = roadmap.vertices[roadmap.path_density(start) > 0]
    assert {tuple(vertex) for vertex in reached.round(6).tolist()} == reachable_by_steps(space, start, cell)


def test_vertices_are_free_and_on_a_raster():
    """Multiples of the pitch from the lower corner on, none of them in a wall or an object."""
    problem = two_rooms()
    roadmap = roadmap_of(problem)
    assert problem.object_space(problem.initial, 0).points_free(roadmap.vertices).all()
    steps = (roadmap.vertices - problem.scene.bounds[0]) / 0.1
    np.testing.assert_allclose(steps, steps.round(), atol=1e-9)


def test_density_in_a_corridor():
    """Along a line of five vertices with two of them around the object, paths are counted by hand."""
    corridor = ConfigurationSpace(ObstacleSet.of([], []), np.array([[0.0, 0.0], [4.0, 0.5]]))
    roadmap = Roadmap(corridor, cell=1.0)
    assert roadmap.vertices.tolist() == [[x, 0] for x in range(5)]
    from_first, from_second = np.array([5, 4, 3, 2, 1]), np.array([1, 5, 3, 2, 1])
    np.testing.assert_allclose(roadmap.path_density(np.array([0.0, 0.0])), (from_first + from_second) / 5)


def test_the_door_is_the_bottleneck():
    """All paths to the other room go through the door, which is denser than any place of that room."""
    problem = two_rooms()
    roadmap = roadmap_of(problem)
    density = roadmap.path_density(problem.initial.objects[0])
    x, y = roadmap.vertices.T
    in_door = np.abs(x) < 0.05
    assert np.abs(y[in_door]).max() <= (DOOR - 0.2) / 2 + 1e-9
    beyond = x > 0.05
    n_sources = 9
    assert density[in_door].sum() >= n_sources * beyond.mean()
    assert density[in_door].max() > density[x > 0.3].max()


def test_no_paths_through_a_door_that_is_too_narrow():
    """Where the object does not fit through, the other room gets no candidates."""
    half = 0.96
    walls = [wall(0, sign * (2 - half), 0.1, 2 * half) for sign in (-1, 1)]
    problem = Problem(room(*walls, objects=(body("obj", -1, 0),), agent=(-1.5, -1.5)))
    found = BottleneckSubgoals(problem, BTL).candidates(problem.initial, 0, 500, np.random.default_rng(0))
    assert len(found) == 500
    assert (found[:, 0] < 0).all()


def test_candidates_are_different_and_follow_the_density():
    """No vertex is drawn twice, the same seed draws the same, and over many draws dense vertices come more often."""
    problem = two_rooms()
    generator = BottleneckSubgoals(problem, BTL)
    roadmap = Roadmap(problem.object_space(problem.initial, 0))
    density = roadmap.path_density(problem.initial.objects[0])
    dense = {tuple(vertex) for vertex in roadmap.vertices[density > np.quantile(density, 0.9)].tolist()}
    rng, hits = np.random.default_rng(0), []
    for _ in range(20):
        found = generator.candidates(problem.initial, 0, 50, rng)
        assert len(np.unique(found, axis=0)) == 50
        hits += [tuple(vertex) in dense for vertex in found.tolist()]
    assert np.mean(hits) > 0.3
    draws = [generator.candidates(problem.initial, 0, 50, np.random.default_rng(5)) for _ in range(2)]
    np.testing.assert_array_equal(*draws)


def test_an_object_between_vertices_that_cannot_move_has_no_candidates():
    """Walls on all sides leave no vertex to which it could go."""
    cage: list[Body] = [wall(0.025, y, 0.4, 0.1) for y in (-0.155, 0.155)] + [
        wall(x, 0, 0.1, 0.4) for x in (-0.13, 0.18)
    ]
    problem = Problem(room(*cage, objects=(body("obj", 0.025, 0),), agent=(-1.5, -1.5)))
    found = BottleneckSubgoals(problem, BTL).candidates(problem.initial, 0, 10, np.random.default_rng(0))
    assert found.shape == (0, 2)


def test_roadmaps_are_shared_by_configurations_with_equal_other_objects(monkeypatch: pytest.MonkeyPatch):
    """Moving the object itself needs no new roadmap; moving another one does; the number kept is bounded."""
    built = []
    monkeypatch.setattr(
        "planner.subgoals_bottleneck.Roadmap", lambda space: built.append(space) or Roadmap(space, cell=0.5)
    )
    problem = two_rooms()
    generator, rng = BottleneckSubgoals(problem, BTL), np.random.default_rng(0)
    start = problem.initial
    for configuration in (start, start.with_object(0, np.array([-1.0, -1.0]))):
        generator.candidates(configuration, 0, 5, rng)
    assert len(built) == 1
    for i in range(KEPT_ROADMAPS):
        generator.candidates(start.with_object(1, np.array([1.5, 1.5 - 0.01 * i])), 0, 5, rng)
    assert len(built) == 1 + KEPT_ROADMAPS
    generator.candidates(start, 0, 5, rng)
    assert len(built) == 2 + KEPT_ROADMAPS
    assert generator.time_s > 0


def test_large_rooms_get_a_coarser_raster():
    """The number of vertices is bounded, however large the room."""
    problem = Problem(room(objects=(body("obj", 0, 1),), half=500))
    roadmap = Roadmap(problem.object_space(problem.initial, 0))
    assert 0.9 * MAX_VERTICES < len(roadmap.vertices) < 1.05 * MAX_VERTICES

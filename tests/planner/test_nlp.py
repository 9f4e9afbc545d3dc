"""The switch-configuration program: distances, derivatives, solutions, and building once per structure."""

import casadi as ca
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from converter.scene import Body, Scene
from converter.shape import FloatArray, Part
from planner.configuration_space import ObstacleSet
from planner.lgp_constraints import MARGIN, TOUCH_GAP, PolygonBlock, signed_distance
from planner.nlp import SwitchQuery, SwitchStructure, build, solver
from planner.pick_place import Region
from planner.problem import Problem
from tests.planner.plain_geometry import clearance, points, polygons
from tests.planner.scenes import RADIUS, body, room, vectors, wall


def distance(point: FloatArray, polygon: FloatArray, vertices: int) -> float:
    """The symbolic distance, the polygon padded to so many vertices."""
    padded = polygon[np.minimum(np.arange(vertices), len(polygon) - 1)]
    return float(signed_distance(vertices)(point, padded.T))


@settings(deadline=None)
@given(points, polygons(), st.integers(0, 3))
def test_signed_distance_agrees_with_shapely(point: FloatArray, polygon: FloatArray, padding: int):
    """Outside it is the distance, inside the depth, with and without repeated vertices."""
    found = distance(point, polygon, len(polygon) + padding)
    assert found == pytest.approx(clearance(point, point, polygon), abs=2e-10)


@settings(deadline=None)
@given(polygons(2, 2), st.floats(-3, 4))
def test_beyond_the_ends_of_a_segment_nothing_is_inside(segment: FloatArray, t: float):
    """On the line of a segment rounding may put a point on either side; it is still as far as its end."""
    point = segment[0] + t * (segment[1] - segment[0])
    beyond = max(0.0, -t, t - 1) * float(np.hypot(*(segment[1] - segment[0])))
    for vertices in (2, 4):
        assert distance(point, segment, vertices) == pytest.approx(beyond, abs=1e-9)


def derivative(function: ca.Function, x: FloatArray, *others: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """Jacobian of the first output, central differences, and the largest change of slope (kinks)."""
    symbols = [ca.MX.sym(f"s{i}", *function.size_in(i)) for i in range(function.n_in())]
    jacobian = ca.Function("j", symbols, [ca.jacobian(function(*symbols), symbols[0])])
    step = 1e-6

    def at(y: FloatArray) -> FloatArray:
        return np.array(function(y, *others)).ravel()

    ahead = np.array([(at(x + step * e) - at(x)) / step for e in np.eye(len(x))])
    behind = np.array([(at(x) - at(x - step * e)) / step for e in np.eye(len(x))])
    return np.array(jacobian(x, *others)), ((ahead + behind) / 2).T, float(np.abs(ahead - behind).max())


@settings(deadline=None, max_examples=50)
@given(points, polygons())
def test_gradient_of_the_distance(point: FloatArray, polygon: FloatArray):
    """Away from kinks the gradient is a unit vector that agrees with finite differences."""
    assume(abs(clearance(point, point, polygon)) > 1e-3)
    gradient, differences, kink = derivative(signed_distance(len(polygon)), point, polygon.T)
    assume(kink < 1e-2)
    np.testing.assert_allclose(gradient, differences, atol=1e-4)
    assert np.linalg.norm(gradient) == pytest.approx(1, abs=1e-6)


L_SHAPE = (Part.box((0.6, 0.2), 0.02), Part(Part.box((0.2, 0.6), 0.02).core + np.array([0.2, 0.2]), 0.02))
WALLS = (
    wall(0.5, -1.0, 0.2, 1.0),
    wall(-1.0, 0.8, 0.8, 0.2, 0.02),
    body("post", 1.2, 1.2, Part(np.zeros((1, 2)), 0.1)),
)


def query_of(scene: Scene, index: int = 0, region: Region | None = None) -> SwitchQuery:
    """The program of one object at the start, by default into the goal."""
    problem = Problem(scene)
    region = Region.of_goal(scene.goal) if region is None else region
    obj = scene.objects[index]
    return SwitchQuery(
        position=problem.initial.objects[index],
        parts=ObstacleSet.of(obj.cores, [RADIUS + part.edge_radius for part in obj.parts]),
        agent_obstacles=problem.agent_space(problem.initial, held=index).obstacles,
        object_obstacles=problem.object_space(problem.initial, index).obstacles,
        lower=region.lower,
        upper=region.upper,
    )


def structure_and_parameters(query: SwitchQuery, start: FloatArray) -> tuple[SwitchStructure, FloatArray]:
    """What a query is built from and what it is given."""
    sets = (query.parts, query.agent_obstacles, query.object_obstacles)
    blocks = [PolygonBlock.of(one) for one in sets]
    packed = [block.pack(one) for block, one in zip(blocks, sets, strict=True)]
    return SwitchStructure(*blocks), np.concatenate([start, query.position, *packed])


def cluttered(*parts: Part) -> Scene:
    """A room with walls and two objects, the goal-object of these parts."""
    return room(*WALLS, objects=(body("obj", -0.5, -0.5, *parts, yaw=0.3), body("other", 0.8, 0.2)), agent=(-1.7, -1.7))


@pytest.mark.parametrize("parts", [(), L_SHAPE])
def test_constraints_are_what_they_say(parts: tuple[Part, ...]):
    """Touch first, then each obstacle of the agent at the pick and at the placement, then those of the object."""
    scene = cluttered(*parts)
    query, start = query_of(scene), np.zeros(4)
    structure, parameters = structure_and_parameters(query, start)
    program = build(structure)
    evaluate = ca.Function("g", [program.x, program.p], [program.constraints, program.cost])
    rng = np.random.default_rng(0)
    for _ in range(20):
        a, z = rng.uniform(-1.8, 1.8, (2, 2))
        constraints, cost = (np.array(value).ravel() for value in evaluate(np.concatenate([a, z]), parameters))

        def clear(obstacles: ObstacleSet, x: FloatArray) -> list[float]:
            rows = [obstacles.vertices[i:j] for i, j in zip(obstacles.first[:-1], obstacles.first[1:], strict=True)]
            return [clearance(x, x, core) - rho for core, rho in zip(rows, obstacles.rho, strict=True)]

        touch = min(clear(query.parts, a - query.position)) - TOUCH_GAP
        places = [a, a + z - query.position]
        others = [c for x in places for c in clear(query.agent_obstacles, x)] + clear(query.object_obstacles, z)
        np.testing.assert_allclose(constraints, [touch, *(np.array(others) - MARGIN)], atol=1e-9)
        assert cost == pytest.approx(float(a @ a + z @ z))


def test_jacobian_of_the_constraints():
    """Away from kinks the derivatives of all constraints agree with finite differences."""
    structure, parameters = structure_and_parameters(query_of(cluttered(*L_SHAPE)), np.zeros(4))
    program = build(structure)
    function = ca.Function("g", [program.x, program.p], [program.constraints])
    compared = 0
    for x in np.random.default_rng(0).uniform(-1.8, 1.8, (20, 4)):
        jacobian, differences, kink = derivative(function, x, parameters)
        if kink < 1e-2:
            np.testing.assert_allclose(jacobian, differences, atol=1e-4)
            compared += 1
    assert compared > 10


def starts_around(query: SwitchQuery, rng: np.random.Generator, n: int = 12) -> list[FloatArray]:
    """Grasps around the object, placements in the region."""
    angles = np.arange(n) * 2 * np.pi / n
    around = query.position + 0.35 * np.column_stack([np.cos(angles), np.sin(angles)])
    return [np.concatenate([grasp, rng.uniform(query.lower, query.upper)]) for grasp in around]


@pytest.mark.parametrize("obj", [body("obj", -0.5, -0.5), body("obj", -0.5, -0.5, *L_SHAPE, yaw=0.3)])
def test_solutions_satisfy_the_constraints(obj: Body):
    """Each solution touches within the gap that plans may have, penetrates nothing and lies in the region."""
    scene = room(*WALLS, objects=(obj, body("other", 0.8, 0.2)), agent=(-1.7, -1.7), goal=(1.0, 0.5))
    problem, query = Problem(scene), query_of(scene)
    solutions = query.solve(starts_around(query, np.random.default_rng(0)))
    assert len(solutions) >= 6
    for grasp, placement in solutions:
        offset = grasp - problem.initial.objects[0]
        gap = min(
            clearance(offset, offset, core) - part.edge_radius - RADIUS
            for core, part in zip(obj.cores, obj.parts, strict=True)
        )
        assert 0 <= gap <= 1e-6
        space = problem.agent_space(problem.initial, held=0)
        assert space.points_free(np.array([grasp, placement + offset])).all()
        assert problem.object_space(problem.initial, 0).point_free(placement)
        assert scene.goal.contains(placement)


def test_solutions_at_the_border_of_the_region_lie_in_it():
    """A slanted wall pushes placements against the border; none ends outside, not even by the optimiser's tolerance."""
    slanted = body("wall", 1.25, 1.25, Part.box((3, 0.2)), yaw=0.75 * np.pi)
    scene = room(slanted, objects=(body("obj", -1, 0),), agent=(-1, -1), goal=(1.0, 1.0), goal_size=(0.3, 0.3), half=4)
    query, rng = query_of(scene), np.random.default_rng(0)
    solutions = [one for _ in range(5) for one in query.solve(starts_around(query, rng, 6))]
    placements = np.array([placement for _, placement in solutions])
    assert ((placements >= query.lower) & (placements <= query.upper)).all()
    assert (placements == query.lower).any()


def test_a_region_of_one_point_is_met_exactly():
    """The placement is that point."""
    position = np.array([1.0, -0.3])
    query = query_of(cluttered(), region=Region(position, position))
    solutions = query.solve(starts_around(query, np.random.default_rng(0)))
    assert solutions
    assert all((placement == position).all() for _, placement in solutions)


def test_a_region_inside_a_wall_has_no_solution():
    """The optimiser does not claim what cannot be."""
    position = np.array([0.5, -1.0])
    query = query_of(cluttered(), region=Region(position, position))
    assert query.solve(starts_around(query, np.random.default_rng(0), 4)) == []


def test_an_empty_room_has_no_obstacles():
    """Sets without polygons are allowed."""
    query = query_of(room())
    assert (len(query.agent_obstacles), len(query.object_obstacles)) == (0, 0)
    assert query.solve([np.array([1.2, -1.5, 1.5, 1.5])])


def test_a_program_is_built_once_per_structure():
    """Other positions, shapes and regions use the compiled program; another number of walls makes a new one."""
    solver.cache_clear()
    start = [np.array([-0.5, -0.8, 1.5, 1.5])]
    query_of(cluttered()).solve(start)
    query_of(cluttered(), region=Region(np.array([-1.5, 1.2]), np.array([-1.0, 1.5]))).solve(start)
    moved = room(*WALLS, objects=(body("obj", 1.6, -0.5, yaw=0.3), body("other", -0.8, 0.2)), agent=(-1.7, -1.7))
    query_of(moved).solve(start)
    assert (solver.cache_info().misses, solver.cache_info().hits) == (1, 2)
    query_of(room(*WALLS[:1], objects=moved.objects, agent=(-1.7, -1.7))).solve(start)
    assert solver.cache_info().misses == 2


def test_polygons_are_padded_with_their_last_vertex():
    """Vertices of all polygons row by row, then the radii."""
    block = PolygonBlock.of(ObstacleSet.of([vectors([1, 2]), vectors([0, 0], [1, 0], [0, 1])], [0.5, 0.1]))
    assert (block.polygons, block.vertices) == (2, 3)
    packed = block.pack(ObstacleSet.of([vectors([1, 2]), vectors([0, 0], [1, 0], [0, 1])], [0.5, 0.1]))
    assert packed.tolist() == [1, 2, 1, 2, 1, 2, 0, 0, 1, 0, 0, 1, 0.5, 0.1]
    assert block.size == len(packed)


def test_nothing_is_printed(capfd: pytest.CaptureFixture[str]):
    """The optimiser's banner and reports stay off both streams, also when it fails."""
    solver.cache_clear()
    query_of(cluttered()).solve([np.array([-0.5, -0.8, 1.5, 1.5])])
    query_of(cluttered(), region=Region(np.zeros(2) + 0.5, np.zeros(2) + 0.5)).solve([np.zeros(4)])
    assert capfd.readouterr() == ("", "")


def test_the_cost_is_the_distance_from_the_start():
    """Of two feasible starts each is its own solution."""
    query = query_of(room())
    for angle in (0.3, 2.0):
        grasp = query.position + (RADIUS + 0.1 + TOUCH_GAP) * np.array([np.sign(np.cos(angle)), 0.0])
        start = np.concatenate([grasp, [1.45, 1.55]])
        ((found, placement),) = query.solve([start])
        np.testing.assert_allclose([*found, *placement], start, atol=1e-6)

"""Shortest paths: known answers, passages without clearance, agreement with OMPL, and free of collision by shapely."""

from collections.abc import Sequence

import numpy as np
import pytest

from converter.scene import Agent, Body
from converter.shape import FloatArray, Part, rotation
from planner.configuration_space import ConfigurationSpace, ObstacleSet, agent_obstacles, body_obstacles
from planner.motion_ompl import rrt_connect
from planner.shortcut import shortcut
from planner.visibility import ShortestPathTree
from tests.planner.plain_geometry import disc_penetration, length
from tests.planner.scenes import RADIUS, body, turned, vectors, wall

WIDTH = 2 * RADIUS
BOUNDS = vectors([-3, -3], [3, 3])
TIGHTNESS = 0.02
"""By this share of their lengths paths around arcs may exceed the taut string."""

YAWS = [float(yaw) for yaw in np.deg2rad([0, 90, 180, 30, -17, 45])]


def disc_space(walls: Sequence[Body], tolerance: float = 0.0) -> ConfigurationSpace:
    """Where a disc of the agent's radius may be among `walls`."""
    agent = Agent(np.zeros(2), RADIUS)
    sets = [agent_obstacles(agent, one, tolerance).moved(one.position[:2]) for one in walls]
    return ConfigurationSpace(ObstacleSet.union(sets), BOUNDS)


def path_between(start: FloatArray, goal: FloatArray, walls: Sequence[Body], tolerance: float = 0.0) -> FloatArray:
    """The disc's shortest path, confirmed by the exact test and by shapely's distances."""
    space = disc_space(walls, tolerance)
    tree = ShortestPathTree(space, start)
    path = tree.path_to(goal)
    assert path is not None
    assert tree.reaches(goal[np.newaxis])[0]
    np.testing.assert_array_equal(path[[0, -1]], [start, goal])
    assert space.path_free(path)
    assert disc_penetration(path, RADIUS, walls) <= tolerance + 1e-9
    return path


def is_connected(start: FloatArray, goal: FloatArray, walls: Sequence[Body], tolerance: float = 0.0) -> bool:
    """Whether the disc can get from one place to the other."""
    tree = ShortestPathTree(disc_space(walls, tolerance), start)
    reached = bool(tree.reaches(goal[np.newaxis])[0])
    assert reached == (tree.path_to(goal) is not None)
    return reached


def test_straight_line_where_nothing_is_in_the_way():
    """In the open the path is its two ends, and at rest it is the place twice."""
    start, goal = vectors([-1, -1], [1, 0.5])
    np.testing.assert_array_equal(path_between(start, goal, []), [start, goal])
    np.testing.assert_array_equal(path_between(start, start, [wall(0, 1.2, 0.4, 0.4)]), [start, start])


@pytest.mark.parametrize("yaw", YAWS)
def test_box_around_a_box(yaw: float):
    """A sharp box turns at the corners of the Minkowski sum; its path is the taut string."""
    obstacle, moving = turned(wall(0, 0, 0.8, 1.8), yaw), turned(body("obj", 0, 0), yaw)
    space = ConfigurationSpace(body_obstacles(moving, obstacle, 0.0), BOUNDS)
    ends = vectors([-1.5, 0.25], [1.5, 0.25]) @ rotation(yaw)
    path = ShortestPathTree(space, ends[0]).path_to(ends[1])
    assert path is not None
    expected = vectors([-1.5, 0.25], [-0.5, 1], [0.5, 1], [1.5, 0.25])
    np.testing.assert_allclose(path @ rotation(-yaw), expected, atol=1e-8)
    assert length(path) == pytest.approx(1 + 2 * 1.25, abs=1e-8)


@pytest.mark.parametrize("yaw", YAWS)
def test_disc_around_a_box(yaw: float):
    """Around rounded corners the path is hardly longer than the taut string, and never shorter."""
    ends = vectors([-1, 0.1], [1, 0.1]) @ rotation(yaw)
    path = path_between(*ends, [turned(wall(0, 0, 0.6, 2.0), yaw)])
    # The string leaves the start at a tangent to the disc about the corner (-0.3, 1) and goes over the top and down.
    to_corner = np.hypot(0.7, 0.9)
    tangent = np.sqrt(to_corner**2 - RADIUS**2)
    direction = np.arctan2(0.9, 0.7) + np.arcsin(RADIUS / to_corner)
    arc = RADIUS * direction
    taut = 2 * tangent + 0.6 + 2 * arc
    assert taut - 1e-8 <= length(path) <= taut + 2 * TIGHTNESS * arc


def corridor(gap: float, yaw: float) -> list[Body]:
    """Two blocks that cut the room in two, with a passage of `gap` and length 2 m between them along x."""
    return [turned(wall(0, sign * (gap / 2 + 5), 2.0, 10.0), yaw) for sign in (1, -1)]


CORRIDOR_ENDS = vectors([-1.5, 0.0], [1.5, 0.0])


@pytest.mark.parametrize("yaw", YAWS)
@pytest.mark.parametrize("tolerance", [0.0, 1e-4, 1e-3])
def test_passage_as_wide_as_the_disc(yaw: float, tolerance: float):
    """Through a passage of exactly twice the radius leads a straight path, at any angle and with tolerance 0."""
    walls, ends = corridor(WIDTH, yaw), CORRIDOR_ENDS @ rotation(yaw)
    assert length(path_between(*ends, walls, tolerance)) == pytest.approx(3.0, abs=1e-8)
    aside = vectors([-1.5, 1.0], [1.5, -1.0]) @ rotation(yaw)
    assert length(path_between(*aside, walls, tolerance)) < 2 + 2 * 1.2


@pytest.mark.parametrize("yaw", YAWS)
@pytest.mark.parametrize("tolerance", [0.0, 1e-4, 1e-3])
def test_passage_a_micrometre_too_narrow(yaw: float, tolerance: float):
    """The tolerance on both sides is the limit: a passage narrower than that by a micrometre is closed."""
    ends = CORRIDOR_ENDS @ rotation(yaw)
    limit = WIDTH - 2 * tolerance
    assert is_connected(*ends, corridor(limit, yaw), tolerance)
    assert not is_connected(*ends, corridor(limit - 1e-6, yaw), tolerance)


def test_passage_between_sharp_boxes():
    """An object carried through a gap of its own width passes with tolerance 0, and a micrometre more stops it."""
    moving = body("obj", 0, 0, Part.box((0.3, 0.2)))
    for gap, expected in [(0.2, True), (0.2 - 1e-6, False)]:
        for yaw in YAWS:
            sets = [body_obstacles(turned(moving, yaw), one, 0.0).moved(one.position[:2]) for one in corridor(gap, yaw)]
            tree = ShortestPathTree(
                ConfigurationSpace(ObstacleSet.union(sets), BOUNDS), CORRIDOR_ENDS[0] @ rotation(yaw)
            )
            assert tree.reaches(CORRIDOR_ENDS[1:] @ rotation(yaw))[0] == expected


@pytest.mark.parametrize("yaw", np.linspace(0, 0.5, 12))
def test_gap_between_two_posts(yaw: float):
    """Between two arcs, where tangents replace both, 2 % of the radius of clearance suffice; -1 micrometre does not."""

    def posts(gap: float) -> list[Body]:
        disc = Part(np.zeros((1, 2)), 0.3)
        centre = 0.3 + gap / 2
        blocks = [wall(sign * (centre + 5), 0, 10, 0.1) for sign in (1, -1)]
        return [turned(one, yaw) for one in (body("left", -centre, 0, disc), body("right", centre, 0, disc), *blocks)]

    ends = vectors([0.0, -1.5], [0.0, 1.5]) @ rotation(yaw)
    assert is_connected(*ends, posts(WIDTH + 2 * TIGHTNESS * (RADIUS + 0.3)))
    assert not is_connected(*ends, posts(WIDTH - 2e-6))


def bend(width: float, yaw: float) -> list[Body]:
    """A corridor of `width` along x that turns downwards; the inner corner of the bend is the origin."""
    inner, above = wall(-5, -5, 10, 10), wall(0, width + 5, 20, 10)
    right = wall(width + 5, 0, 10, 20)
    return [turned(one, yaw) for one in (inner, above, right)]


@pytest.mark.parametrize("yaw", YAWS)
def test_bend_of_a_corridor_as_wide_as_the_disc(yaw: float):
    """The disc gets around the bend of a one-cell corridor with tolerance 0, on an arc about the inner corner."""
    ends = vectors([-1.0, RADIUS], [RADIUS, -1.0]) @ rotation(yaw)
    path = path_between(*ends, bend(WIDTH, yaw))
    taut = 2.0 + RADIUS * np.pi / 2
    assert taut - 1e-8 <= length(path) <= taut + TIGHTNESS * RADIUS * np.pi / 2


@pytest.mark.parametrize("yaw", YAWS)
def test_corridor_of_bends_as_wide_as_the_disc(yaw: float):
    """A one-cell corridor with three bends between 0.4 m blocks is passable with tolerance 0."""
    plan = ["##########", "#    #####", "#### #####", "#### #####", "####     #", "######## #", "##########"]
    blocks = [
        turned(wall(round(WIDTH * (c - 4.5), 12), round(WIDTH * (3 - r), 12), WIDTH, WIDTH), yaw)
        for r, row in enumerate(plan)
        for c, cell in enumerate(row)
        if cell == "#"
    ]
    ends = WIDTH * vectors([-3.5, 2], [3.5, -2]) @ rotation(yaw)
    path = path_between(*ends, blocks)
    # Eleven cells, less what an arc saves in each bend.
    taut = 11 * WIDTH - 3 * (2 * RADIUS - RADIUS * np.pi / 2)
    assert taut - 1e-8 <= length(path) <= taut + TIGHTNESS * 3 * RADIUS * np.pi / 2


def test_goals_that_are_not_free_are_not_reached():
    """A place inside a wall or out of bounds is no goal, nor is any from a start inside a wall."""
    tree = ShortestPathTree(disc_space([wall(0, 0, 1, 1)]), np.array([-1.0, 0.0]))
    goals = vectors([0, 0], [0.6, 0], [3.1, 0], [1, 0])
    assert tree.reaches(goals).tolist() == [False, False, False, True]
    assert [tree.path_to(goal) is not None for goal in goals] == [False, False, False, True]
    from_inside = ShortestPathTree(disc_space([wall(0, 0, 1, 1)]), np.array([0.1, 0.0]))
    assert not from_inside.reaches(goals).any()
    assert tree.reaches(np.empty((0, 2))).shape == (0,)


def test_turns_are_the_corners_within_reach():
    """Inside a pen the corners of the two blocks in it that the other does not cover; outside none of these."""
    square = vectors([-1, -1], [1, -1], [1, 1], [-1, 1])
    sides = [square * [0.1, 1.2] + [x, 0] for x in (-1.1, 1.1)] + [square * [1.2, 0.1] + [0, y] for y in (-1.1, 1.1)]
    cores = [*sides, 0.3 * square, 0.1 * square + [0.3, 0.3]]
    space = ConfigurationSpace(ObstacleSet.of(cores, [0.0] * 6), BOUNDS)
    inside = ShortestPathTree(space, np.array([-0.7, 0.0])).turns
    of_blocks = vectors([-0.3, -0.3], [-0.3, 0.3], [0.2, 0.4], [0.3, -0.3], [0.4, 0.2], [0.4, 0.4])
    np.testing.assert_allclose(inside[np.lexsort(inside.round(6).T[::-1])], of_blocks, atol=1e-8)
    outside = ShortestPathTree(space, np.array([-2.0, 0.0])).turns
    assert len(outside) > 0
    assert (np.abs(outside).max(axis=1) > 1.1).all()


def test_closed_room_is_left_by_no_path():
    """Four walls that overlap at their corners let nothing out."""
    pen = [wall(0, 1, 2.2, 0.2), wall(0, -1, 2.2, 0.2), wall(1, 0, 0.2, 2.2), wall(-1, 0, 0.2, 2.2)]
    assert not is_connected(np.zeros(2), np.array([2.0, 0.0]), pen)
    assert is_connected(np.zeros(2), np.array([2.0, 0.0]), pen[:-1])


def random_walls(rng: np.random.Generator) -> list[Body]:
    """Boxes, discs and capsules, sharp and rounded, turned and compound."""
    kinds = [
        lambda: (Part.box(rng.uniform(0.2, 1.2, 2)),),
        lambda: (Part.box(rng.uniform(0.2, 0.8, 2), 0.05),),
        lambda: (Part(np.zeros((1, 2)), rng.uniform(0.1, 0.4)),),
        lambda: (Part(rng.uniform(-0.5, 0.5, (2, 2)), 0.1),),
        lambda: (Part.box((0.9, 0.2)), Part(Part.box((0.2, 0.6)).core + np.array([0.35, 0.3]))),
    ]
    return [
        body(f"wall {i}", *rng.uniform(-2, 2, 2), *kinds[rng.integers(len(kinds))](), yaw=float(rng.uniform(0, 6)))
        for i in range(7)
    ]


def free_pair(space: ConfigurationSpace, rng: np.random.Generator) -> FloatArray:
    """Two free places (2, 2)."""
    draws = rng.uniform(*BOUNDS, (200, 2))
    return draws[space.points_free(draws)][:2]


def plain_distance(space: ConfigurationSpace, start: FloatArray, goal: FloatArray) -> float:
    """Length of the shortest path over all free edges between corners, none of them left out beforehand."""
    corners = space.obstacles.corners
    points = np.vstack([start, goal, corners[space.points_free(corners)]])
    n = len(points)
    free = space.segments_free(np.repeat(points, n, axis=0), np.tile(points, (n, 1))).reshape(n, n)
    lengths = np.where(free, np.hypot(*(points[:, None] - points).T), np.inf)
    distance, left = np.where(np.arange(n) == 0, 0.0, np.inf), np.ones(n, dtype=bool)
    while left.any():
        nearest = np.flatnonzero(left)[distance[left].argmin()]
        left[nearest] = False
        distance = np.minimum(distance, distance[nearest] + lengths[nearest])
    return float(distance[1])


@pytest.mark.parametrize("seed", range(25))
def test_no_edge_that_matters_is_left_out(seed: int):
    """Distances are those of the complete graph, among turned boxes, aligned ones, and gaps without clearance."""
    rng = np.random.default_rng(seed)
    cells = np.argwhere(rng.random((7, 7)) < 0.35)
    aligned = [wall(*(0.8 * cell - 2.4), 0.4, 0.4, 0.1) for cell in cells]
    walls = [random_walls(rng), aligned, [*aligned, *random_walls(rng)[:3]]][seed % 3]
    space = disc_space(walls, 1e-3 * (seed % 2))
    found = 0
    for _ in range(10):
        start, goal = free_pair(space, rng)
        path = ShortestPathTree(space, start).path_to(goal)
        expected = plain_distance(space, start, goal)
        assert (np.inf if path is None else length(path)) == pytest.approx(expected, abs=1e-8)
        found += path is not None
    assert found > 0


@pytest.mark.parametrize("seed", range(30))
def test_agrees_with_rrt_connect(seed: int):
    """Where RRT-Connect finds a way for a disc 5 mm larger, the tree reaches the goal on no longer a path.

    The tangents that replace arcs lengthen a path by 2 % of its arcs at most.
    """
    rng = np.random.default_rng(seed)
    walls = random_walls(rng)
    roomy = disc_space(walls, -5e-3)
    start, goal = free_pair(roomy, rng)
    found = rrt_connect(roomy, start, goal[np.newaxis], 2000, rng).path
    if found is None:
        pytest.skip("RRT-Connect found no way to compare with")
    path = path_between(start, goal, walls)
    rival = shortcut(found, roomy, 50, rng)
    assert length(path) <= length(rival) + TIGHTNESS * (length(rival) - np.hypot(*(goal - start))) + 1e-9


@pytest.mark.parametrize("seed", range(15))
def test_sharp_obstacles_give_the_shortest_path(seed: int):
    """Among polygons no path of RRT-Connect is shorter, however much it is shortened."""
    rng = np.random.default_rng(seed)
    moving = body("obj", 0, 0, Part.box((0.3, 0.2)), yaw=0.4)
    sharp = [body(f"{i}", *rng.uniform(-2, 2, 2), Part.box(rng.uniform(0.2, 1.0, 2)), yaw=i) for i in range(7)]
    sets = [body_obstacles(moving, one, 1e-3).moved(one.position[:2]) for one in sharp]
    space = ConfigurationSpace(ObstacleSet.union(sets), BOUNDS)
    start, goal = free_pair(space, rng)
    found = rrt_connect(space, start, goal[np.newaxis], 2000, rng).path
    path = ShortestPathTree(space, start).path_to(goal)
    if found is not None:
        assert path is not None
        # Corners stand off by half a slack.
        assert length(path) <= length(shortcut(found, space, 200, rng)) + 1e-8
    if path is not None:
        assert space.path_free(path)


@pytest.mark.parametrize("seed", range(10))
def test_paths_are_the_same_both_ways(seed: int):
    """Start and goal may be swapped; either path is free by shapely's distances too."""
    rng = np.random.default_rng(seed)
    walls = random_walls(rng)
    start, goal = free_pair(disc_space(walls), rng)
    connected = is_connected(start, goal, walls)
    assert connected == is_connected(goal, start, walls)
    if connected:
        there, back = path_between(start, goal, walls), path_between(goal, start, walls)
        assert length(there) == pytest.approx(length(back), abs=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_nearest_points_are_reached(seed: int):
    """A point of the tree near a place is free and reached, and no corner that is reached is nearer."""
    rng = np.random.default_rng(seed)
    space = disc_space(random_walls(rng))
    start, _ = free_pair(space, rng)
    tree = ShortestPathTree(space, start)
    places = rng.uniform(*BOUNDS, (50, 2))
    nearest = tree.nearest_points(places)
    assert tree.reaches(nearest).all()
    corners = np.vstack([start, space.obstacles.corners])
    reached = corners[tree.reaches(corners)]
    to_corners = np.hypot(*(places[:, np.newaxis] - reached).T).T.min(axis=1)
    assert (np.hypot(*(nearest - places).T) <= to_corners + 1e-12).all()


def test_nearest_points_run_along_a_passage_without_clearance():
    """Near any place in a passage as wide as the disc there is a point of its middle."""
    tree = ShortestPathTree(disc_space(corridor(WIDTH, 0.0)), CORRIDOR_ENDS[0])
    nearest = tree.nearest_points(vectors([0.3, 0.05], [-0.7, -0.01]))
    np.testing.assert_allclose(nearest, vectors([0.3, 0], [-0.7, 0]), atol=1e-8)


def test_nearest_point_of_a_start_that_leads_nowhere():
    """In an empty space the tree is its start."""
    tree = ShortestPathTree(disc_space([]), np.array([1.0, 1.0]))
    np.testing.assert_array_equal(tree.nearest_points(vectors([0, 0], [2, 2])), vectors([1, 1], [1, 1]))


@pytest.mark.parametrize("angle", np.linspace(0.0, 2 * np.pi, 48, endpoint=False))
def test_places_that_touch_an_arc_are_reached(angle: float):
    """Also between arc and tangents, from where only the corner of these tangents is seen, as start and as end."""
    space = ConfigurationSpace(ObstacleSet.of([np.zeros((1, 2))], [0.3]), BOUNDS)
    touching = 0.3 * (1 + 1e-9) * np.array([np.cos(angle), np.sin(angle)])
    for far in vectors([1.5, 0.1], [-1.5, -0.2]):
        path = ShortestPathTree(space, far).path_to(touching)
        assert path is not None
        assert space.path_free(path)
        assert length(ShortestPathTree(space, touching).path_to(far)) == pytest.approx(length(path))

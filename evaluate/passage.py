"""The narrowest passage of a scene: how wide the gaps between walls are that the agent cannot avoid.

The free space of a disc among convex walls changes its connections only where the disc's diameter passes the gap
between two walls. So the widest disc that gets from one place to another is as wide as one of these gaps, and to try
them by bisection finds it exactly. Being close to a single wall is no passage: a wider disc may begin a little away
from the agent's own place, where it can get without coming closer to any wall.
"""

import numpy as np

from converter.scene import Body, Scene
from converter.shape import FloatArray
from planner.configuration_space import ConfigurationSpace, ObstacleSet
from planner.contact_curve import ContactCurve
from planner.problem import Problem
from planner.visibility import ShortestPathTree

SLACK = 1e-6
"""Gaps are compared with this slack [m]."""

DIRECTIONS, RINGS = 16, 4
"""Where a wider disc may begin: in so many directions, and at so many distances in each."""

GOAL_GRID = 3
"""Placements a side that stand for the goal rectangle."""


def narrowest_passage(scene: Scene) -> float:
    """The width [m] of the narrowest passage on the agent's widest way to the goal-object and to the goal.

    Objects other than walls are left out, for they can be moved. Where no two walls limit the way, it is the shorter
    side of the room; 0 if no way leads there.

    Raises:
        InputError: bodies overlap at the start.
    """
    return _widest(scene, _Places(scene))


class _Places:
    """Where the agent is at the start, and where it touches the goal-object, before and in the goal."""

    def __init__(self, scene: Scene) -> None:
        problem = Problem(scene)
        index = problem.goal_index
        body = scene.goal_object
        curve = ContactCurve(body, scene.agent.radius)
        placements = goal_grid(scene)
        placements = placements[problem.wall_space(index).points_free(placements)]
        self.start = scene.agent.position[np.newaxis]
        self.at_object = touching(curve, problem.agent_walls, body.position[np.newaxis, :2])
        self.at_goal = touching(curve, problem.agent_walls, placements)


def goal_grid(scene: Scene) -> FloatArray:
    """(n, 2) [m], world: points on a grid that fills the goal rectangle, its centre first."""
    steps = np.linspace(-0.5, 0.5, GOAL_GRID)
    offsets = np.array([(x, y) for x in steps for y in steps])
    nearest_first = np.argsort(np.hypot(*offsets.T), kind="stable")
    return np.asarray(scene.goal.position + offsets[nearest_first] * scene.goal.size)


def touching(curve: ContactCurve, obstacles: ObstacleSet, placements: FloatArray) -> FloatArray:
    """Places (n, 2) [m], world, at which the agent touches an object: ends and middle of every free stretch.

    Args:
        curve: Contact curve of the object.
        obstacles: Of the agent, world, without the object.
        placements: (m, 2) [m], world: where the object may be.
    """
    found = [np.empty((0, 2))]
    for placement in placements:
        stretches = curve.free_stretches(obstacles.moved(-placement))
        lengths = np.concatenate([stretches.ravel(), stretches.mean(axis=1)])
        found.append(placement + curve.at(lengths))
    return np.vstack(found)


def _widest(scene: Scene, places: _Places) -> float:
    room = float(np.ptp(scene.bounds, axis=0).min())
    widths = np.unique(np.round(wall_gaps(scene.walls), 6))
    widths = widths[(widths > 0) & (widths < room)]
    if len(widths) == 0:
        return room
    passes, fails = -1, len(widths)
    while fails - passes > 1:
        middle = (passes + fails) // 2
        if _fits(scene, places, widths[middle] / 2):
            passes = middle
        else:
            fails = middle
    if passes >= 0:
        return float(widths[passes])
    # A disc may fit through every gap and yet be too wide for the room.
    agent_fits = widths[0] > 2 * scene.agent.radius and _fits(scene, places, scene.agent.radius)
    return float(widths[0]) if agent_fits else 0.0


def wall_gaps(walls: tuple[Body, ...]) -> FloatArray:
    """(n,) [m]: the distances between all pairs of walls' parts; a pair that overlaps may give any value."""
    cores = [core + wall.position[:2] for wall in walls for core in wall.cores]
    radii = np.array([part.edge_radius for wall in walls for part in wall.parts])
    if len(cores) < 2:
        return np.empty(0)
    owner = np.repeat(np.arange(len(cores)), [len(core) for core in cores])
    points = np.vstack(cores)
    ends = np.vstack([np.roll(core, -1, axis=0) for core in cores])
    distances = _point_segment_distances(points, points, ends)
    first = np.flatnonzero(np.diff(owner, prepend=-1))
    between = np.minimum.reduceat(np.minimum.reduceat(distances, first, axis=0), first, axis=1)
    between = np.minimum(between, between.T) - radii[:, None] - radii
    return np.asarray(between[np.triu_indices(len(cores), 1)])


def _point_segment_distances(points: FloatArray, starts: FloatArray, ends: FloatArray) -> FloatArray:
    """(n, m) [m]: the distance of each of n points to each of m segments."""
    along = ends - starts
    squares = np.maximum((along**2).sum(axis=1), np.finfo(np.float64).tiny)
    offsets = points[:, None] - starts
    t = np.clip((offsets * along).sum(axis=2) / squares, 0.0, 1.0)
    return np.asarray(np.linalg.norm(offsets - t[..., None] * along, axis=2))


def _fits(scene: Scene, places: _Places, radius: float) -> bool:
    """Whether a disc of `radius` gets from the start to the goal-object and to the goal."""
    space = _disc_space(scene, radius)
    starts = _widened(scene, places.start, radius, space)
    ends = [_widened(scene, place, radius, space) for place in (places.at_object, places.at_goal)]
    if not all(map(len, ends)):
        return False
    while len(starts):
        tree = ShortestPathTree(space, starts[0])
        if all(bool(tree.reaches(end).any()) for end in ends):
            return True
        starts = starts[1:][~tree.reaches(starts[1:])]
    return False


def _disc_space(scene: Scene, radius: float) -> ConfigurationSpace:
    """Where the centre of a disc may be among the walls."""
    # Walls of one shape, such as the blocks of a level, become one set that is moved to their places.
    shapes: dict[tuple[object, ...], ObstacleSet] = {}
    moved = []
    for wall in scene.walls:
        shape = tuple((core.tobytes(), part.edge_radius) for core, part in zip(wall.cores, wall.parts, strict=True))
        if shape not in shapes:
            shapes[shape] = ObstacleSet.of(wall.cores, [radius + part.edge_radius - SLACK for part in wall.parts])
        moved.append(shapes[shape].moved(wall.position[:2]))
    return ConfigurationSpace(ObstacleSet.union(moved).with_free_corners(), scene.bounds)


def _widened(scene: Scene, places: FloatArray, radius: float, space: ConfigurationSpace) -> FloatArray:
    """Free places (k, 2) [m] of a disc of `radius` [m] that stand for `places` (n, 2) of the agent.

    From a place with clearance c a disc gets out of the corner between two walls, which may be at right angles, by
    sqrt(2) (radius - c) while its distance to both grows.
    """
    found = [places[space.points_free(places)]]
    for place in places[~space.points_free(places)]:
        clearance = _clearance(scene, place)
        reach = np.sqrt(2) * (radius - clearance) + 2 * SLACK
        ring = reach * np.repeat(np.arange(1, RINGS + 1) / RINGS, DIRECTIONS)
        angles = np.tile(2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS, RINGS)
        around = place + ring[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
        around = around[space.points_free(around)]
        if len(around):
            starts = np.tile(place, (len(around), 1))
            leave = _disc_space(scene, clearance).segments_free(starts, around)
            found.append(around[leave])
    return np.vstack(found)


def _clearance(scene: Scene, place: FloatArray) -> float:
    """The distance [m] of a place outside of all walls to the nearest one."""
    return min(
        float(_point_segment_distances((place - wall.position[:2])[None], core, np.roll(core, -1, 0)).min())
        - part.edge_radius
        for wall in scene.walls
        for core, part in zip(wall.cores, wall.parts, strict=True)
    )

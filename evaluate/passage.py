"""The narrowest passage of a scene: how wide the gaps between walls are that the agent cannot avoid.

The free space of a disc among convex walls changes its connections only where the disc's diameter passes the gap
between two walls. So the widest disc that gets from one place to another is as wide as one of these gaps, and to try
them by bisection finds it exactly. Being close to a single wall is no passage: a wider disc may begin a little away
from the agent's own place, where it can get without coming closer to any wall.
"""

import numpy as np

from converter.polyline import point_segment_distances
from converter.scene import Scene
from converter.shape import FloatArray
from planner.configuration_space import ConfigurationSpace, ObstacleSet
from planner.contact_curve import ContactCurve
from planner.kernel import BoolArray, segments_free
from planner.problem import Problem
from planner.visibility import ShortestPathTree

SLACK = 1e-6
"""Gaps are compared with this slack [m]."""

DIRECTIONS, RINGS = 16, 4
"""Where a wider disc may begin: in so many directions, and at so many distances in each."""

_ANGLES = np.tile(2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS, RINGS)
_RING = np.repeat(np.arange(1, RINGS + 1) / RINGS, DIRECTIONS)[:, None] * np.column_stack(
    [np.cos(_ANGLES), np.sin(_ANGLES)]
)
"""Points of the rings in the unit disc."""

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


def goal_grid(scene: Scene, side: int = GOAL_GRID) -> FloatArray:
    """(n, 2) [m], world: `side` by `side` points on a grid that fills the goal rectangle, its centre first."""
    steps = np.linspace(-0.5, 0.5, side)
    offsets = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    nearest_first = np.argsort(np.hypot(*(offsets * scene.goal.size).T), kind="stable")
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


class _Walls:
    """The walls of a scene among which discs of all sizes move.

    Attributes:
        cores: (n, 2) [m], world, of all parts of all walls.
        radii: Edge radius [m] of each part.
    """

    def __init__(self, scene: Scene) -> None:
        self._walls = scene.walls
        self._bounds = scene.bounds
        self.cores = [core + wall.position[:2] for wall in scene.walls for core in wall.cores]
        self.radii = np.array([part.edge_radius for wall in scene.walls for part in wall.parts])
        self._starts = np.vstack([np.empty((0, 2)), *self.cores])
        self._ends = np.vstack([np.empty((0, 2)), *(np.roll(core, -1, axis=0) for core in self.cores)])
        self._lengths = np.array([len(core) for core in self.cores], dtype=np.int64)
        self._first = np.concatenate([[0], np.cumsum(self._lengths)]).astype(np.int64)
        self._boxes = np.array([[*core.min(axis=0), *core.max(axis=0)] for core in self.cores]).reshape(-1, 4)

    def gaps(self) -> FloatArray:
        """(n,) [m]: the distances between all pairs of parts; a pair that overlaps may give any value."""
        if len(self.cores) < 2:
            return np.empty(0)
        distances = point_segment_distances(self._starts, self._starts, self._ends)
        first = self._first[:-1]
        between = np.minimum.reduceat(np.minimum.reduceat(distances, first, axis=0), first, axis=1)
        between = np.minimum(between, between.T) - self.radii[:, None] - self.radii
        return np.asarray(between[np.triu_indices(len(self.cores), 1)])

    def clearances(self, places: FloatArray) -> FloatArray:
        """(n,) [m]: the distance of each of `places` (n, 2), all outside of walls, to the nearest wall."""
        distances = point_segment_distances(places, self._starts, self._ends) - np.repeat(self.radii, self._lengths)
        return np.asarray(distances.min(axis=1, initial=np.inf))

    def space(self, radius: float) -> ConfigurationSpace:
        """Where the centre of a disc may be."""
        # Walls of one shape, such as the blocks of a level, become one set that is moved to their places.
        shapes: dict[tuple[object, ...], ObstacleSet] = {}
        moved = []
        for wall in self._walls:
            shape = tuple((core.tobytes(), part.edge_radius) for core, part in zip(wall.cores, wall.parts, strict=True))
            if shape not in shapes:
                shapes[shape] = ObstacleSet.of(wall.cores, [radius + part.edge_radius - SLACK for part in wall.parts])
            moved.append(shapes[shape].moved(wall.position[:2]))
        return ConfigurationSpace(ObstacleSet.union(moved).with_free_corners(), self._bounds)

    def segments_free(self, radius: float, start: FloatArray, ends: FloatArray) -> BoolArray:
        """For each of `ends` (n, 2) whether a disc gets there from `start` (2,) on a straight line."""
        rho = radius + self.radii - SLACK
        boxes = self._boxes + rho[:, None] * np.array([-1.0, -1.0, 1.0, 1.0])
        starts = np.tile(start, (len(ends), 1))
        return np.asarray(segments_free(starts, ends, self._starts, self._first, rho, boxes))


def _widest(scene: Scene, places: _Places) -> float:
    walls = _Walls(scene)
    room = float(np.ptp(scene.bounds, axis=0).min())
    widths = np.unique(np.round(walls.gaps(), 6))
    widths = widths[(widths > 0) & (widths < room)]
    if len(widths) == 0:
        return room
    passes, fails = -1, len(widths)
    while fails - passes > 1:
        middle = (passes + fails) // 2
        if _fits(walls, places, widths[middle] / 2):
            passes = middle
        else:
            fails = middle
    if passes >= 0:
        return float(widths[passes])
    # A disc may fit through every gap and yet be too wide for the room.
    radius = scene.agent.radius
    return float(widths[0]) if widths[0] > 2 * radius and _fits(walls, places, radius) else 0.0


def _fits(walls: _Walls, places: _Places, radius: float) -> bool:
    """Whether a disc of `radius` gets from the start to the goal-object and to the goal."""
    space = walls.space(radius)
    starts = _widened(walls, places.start, radius, space)
    ends = [_widened(walls, place, radius, space) for place in (places.at_object, places.at_goal)]
    if not all(map(len, ends)):
        return False
    while len(starts):
        tree = ShortestPathTree(space, starts[0])
        if all(bool(tree.reaches(end).any()) for end in ends):
            return True
        starts = starts[1:][~tree.reaches(starts[1:])]
    return False


def _widened(walls: _Walls, places: FloatArray, radius: float, space: ConfigurationSpace) -> FloatArray:
    """Free places (k, 2) [m] of a disc of `radius` [m] that stand for `places` (n, 2) of the agent.

    From a place with clearance c a disc gets out of the corner between two walls, which may be at right angles, by
    sqrt(2) (radius - c) while its distance to both grows.
    """
    is_free = space.points_free(places)
    narrow = places[~is_free]
    found = [places[is_free]]
    for place, clearance in zip(narrow, walls.clearances(narrow), strict=True):
        around = place + (np.sqrt(2) * (radius - clearance) + 2 * SLACK) * _RING
        around = around[space.points_free(around)]
        found.append(around[walls.segments_free(clearance, place, around)])
    return np.vstack(found)

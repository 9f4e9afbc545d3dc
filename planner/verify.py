"""Independent verification of plans.

This module shares no geometry with the planner: it reads cores and radii from the scene and measures distances with
shapely (GEOS). Nothing is sampled along the motion, and no circle is replaced by a polygon.

*Swept bodies.* Nothing rotates, so a convex core A that translates by d along a straight piece of path sweeps exactly
the convex hull of A and A + d. With D the distance of that hull to an obstacle's core B, the deepest penetration of
the two rounded shapes along the piece is r_A + r_B - D while D > 0.

*Intersecting cores.* If D = 0 the cores' own depth is added. The depth of A + t d in B is the least overlap over the
separating axes, the edge normals of both polygons (the distance from the origin to the border of B + (-A)). Each
overlap is linear in t, so the depth is concave and piecewise linear, and its maximum over t in [0, 1] is found
exactly. Touching polygons have depth 0; so sharp bodies may touch.

*Releases.* By the format a carry segment grasps at its first way-point and releases at its last, so a plan cannot
state that it forgets to release. It shows in what follows: the object stays where the carry ended, and then a later
carry does not touch it (`no_touch`), `subgoals` names another placement than the carries make (`subgoal_mismatch`),
or the goal-object is not in the goal (`goal_missed`).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from itertools import product
from typing import Any, Self

import numpy as np
import shapely

from converter.plan import Plan, Segment, Subgoal
from converter.scene import NUMERIC_SLACK, Agent, Body, Scene
from converter.shape import FloatArray
from pcg.errors import InputError

AGENT = "agent"
TOUCH_SLACK = 1e-6
"""A grasp may leave a gap of the scene's tolerance plus this [m]; placements may differ from `subgoals` by this."""


class ViolationKind(StrEnum):
    """What a plan does wrong."""

    NOT_SOLVED = "not_solved"
    """The plan does not claim to solve the scene."""
    UNKNOWN_OBJECT = "unknown_object"
    """A carry names an object that the scene does not have."""
    DISCONTINUITY = "discontinuity"
    """A segment does not start where the agent is; amount: length of the jump [m]."""
    COLLISION = "collision"
    """Two bodies penetrate deeper than the tolerance; amount: the penetration [m]."""
    NO_TOUCH = "no_touch"
    """A carry starts without touching its object; amount: the gap [m]."""
    OUT_OF_BOUNDS = "out_of_bounds"
    """A centre leaves the bounds of the scene; amount: by how much [m]."""
    SUBGOAL_MISMATCH = "subgoal_mismatch"
    """Carries and `subgoals` disagree; amount: distance of the placements [m], None if the objects or counts differ."""
    GOAL_MISSED = "goal_missed"
    """The goal-object does not end in the goal; amount: distance from the goal [m], 0 if it is above the floor."""


@dataclass(frozen=True)
class Violation:
    """One reason why a plan is invalid.

    Attributes:
        kind: What is wrong.
        segment: Index of the segment; None for the start configuration and for the plan as a whole.
        where: Place (x, y) [m], world: for a collision a point where the two bodies meet.
        amount: By how much [m]; see `ViolationKind`.
        message: One line for people.
    """

    kind: ViolationKind
    segment: int | None
    where: tuple[float, float] | None
    amount: float | None
    message: str


def verify(scene: Scene, plan: Plan) -> list[Violation]:
    """Every violation of `plan` in `scene`, in the order of the motion; an empty list means that it is valid.

    Of two bodies that collide in a segment the deepest place is reported. Only `scene.tolerance` counts, not the
    plan's; `require_same_scene` compares the two. A plan that is not solved or that names unknown objects is not
    followed further.
    """
    if not plan.solved:
        return [_violation(ViolationKind.NOT_SOLVED, None, None, None, f"status is {plan.status}, not solved")]
    unknown = [
        _violation(ViolationKind.UNKNOWN_OBJECT, i, segment.path[0], None, f"carries unknown object {segment.object!r}")
        for i, segment in enumerate(plan.segments)
        if segment.object is not None and segment.object not in scene.object_names
    ]
    return unknown or list(_Replay(scene).run(plan))


def require_same_scene(scene: Scene, plan: Plan, where: str = "plan") -> None:
    """Refuses a plan that was made for another scene.

    Args:
        scene: The scene to verify in.
        plan: The plan to verify.
        where: What the plan was read from; it begins the message.

    Raises:
        InputError: `plan.scene_hash` is not the hash of `scene`.
    """
    if plan.scene_hash == scene.geometry_hash:
        return
    loose = plan.tolerance >= 0 and replace(scene, tolerance=plan.tolerance).geometry_hash == plan.scene_hash
    if loose:
        raise InputError(
            where,
            f"made with tolerance {plan.tolerance:g} m, but the scene has {scene.tolerance:g} m; "
            f"pass --tolerance {plan.tolerance:g} to verify it with that",
        )
    raise InputError(
        where,
        f"plan of another scene: it was made for {plan.scene!r} ({plan.scene_hash}), "
        f"this is {scene.name!r} ({scene.geometry_hash})",
    )


@dataclass(frozen=True, eq=False)
class _Prism:
    """A rigid body at one place: convex cores with radii, over a height interval.

    Attributes:
        name: For messages.
        position: (2,) [m], world.
        cores: (n, 2) each [m], relative to `position`.
        radii: One for each core [m].
        bottom_top: Height interval [m].
    """

    name: str
    position: FloatArray
    cores: tuple[FloatArray, ...]
    radii: tuple[float, ...]
    bottom_top: tuple[float, float]

    @classmethod
    def of_body(cls, body: Body) -> Self:
        radii = tuple(part.edge_radius for part in body.parts)
        return cls(body.name, body.position[:2], body.cores, radii, body.bottom_top)

    @classmethod
    def of_agent(cls, agent: Agent) -> Self:
        return cls(AGENT, agent.position, (np.zeros((1, 2)),), (agent.radius,), (0.0, agent.height))

    def at(self, position: FloatArray) -> Self:
        return replace(self, position=position)

    @cached_property
    def placed(self) -> list[tuple[FloatArray, shapely.Geometry]]:
        """World vertices and shapely geometry of each core."""
        vertices = [core + self.position for core in self.cores]
        return [(core, shapely.multipoints(core).convex_hull) for core in vertices]

    def meets_in_height(self, other: "_Prism") -> bool:
        (bottom, top), (other_bottom, other_top) = self.bottom_top, other.bottom_top
        return min(top, other_top) - max(bottom, other_bottom) > NUMERIC_SLACK

    def gap(self, other: "_Prism") -> float:
        """Distance of the two [m]; negative or 0 if they overlap, infinite if their heights do not meet."""
        if not self.meets_in_height(other):
            return np.inf
        pairs = product(zip(self.placed, self.radii, strict=True), zip(other.placed, other.radii, strict=True))
        return min(float(shapely.distance(a, b)) - r_a - r_b for ((_, a), r_a), ((_, b), r_b) in pairs)


class _Replay:
    """Follows a plan through its scene. State: where the objects are, and where carries released them."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.agent = _Prism.of_agent(scene.agent)
        self.walls = [_Prism.of_body(wall) for wall in scene.walls]
        self.objects = {body.name: _Prism.of_body(body) for body in scene.objects}
        self.placements: list[tuple[int, _Prism]] = []

    def run(self, plan: Plan) -> Iterator[Violation]:
        yield from self._start()
        place = self.scene.agent.position
        for i, segment in enumerate(plan.segments):
            yield from _jump(place, segment.path[0], i)
            yield from self._drive(segment, i)
            if segment.object is not None:
                yield from self._carry(self.objects[segment.object], segment, i)
            place = segment.path[-1]
        yield from self._subgoals(plan.subgoals)
        yield from self._goal()

    def _start(self) -> Iterator[Violation]:
        still = list(self.objects.values())
        for i, body in enumerate([*still, self.agent]):
            yield from self._collisions(body, body.position[np.newaxis], [*self.walls, *still[:i]], None)

    def _drive(self, segment: Segment, i: int) -> Iterator[Violation]:
        yield from self._collisions(self.agent, segment.path, self._obstacles(segment.object), i)
        yield from self._outside(AGENT, segment.path, i)

    def _carry(self, held: _Prism, segment: Segment, i: int) -> Iterator[Violation]:
        # Agent and object keep their offset while they move as one, so the grasp at the start decides about both.
        gap = self.agent.at(segment.path[0]).gap(held)
        if gap > self.scene.tolerance + TOUCH_SLACK:
            reason = f"is {gap:.6g} m away" if np.isfinite(gap) else "is at another height"
            message = f"the agent grasps {held.name}, which {reason}"
            yield _violation(ViolationKind.NO_TOUCH, i, segment.path[0], gap if np.isfinite(gap) else None, message)
        yield from self._collisions(self.agent, segment.path[:1], [held], i)
        centres = held.position + (segment.path - segment.path[0])
        yield from self._collisions(held, centres, self._obstacles(held.name), i)
        yield from self._outside(held.name, centres, i)
        self.objects[held.name] = held.at(centres[-1])
        self.placements.append((i, self.objects[held.name]))

    def _obstacles(self, held: str | None) -> list[_Prism]:
        return [*self.walls, *(body for name, body in self.objects.items() if name != held)]

    def _collisions(
        self, mover: _Prism, path: FloatArray, obstacles: Sequence[_Prism], segment: int | None
    ) -> Iterator[Violation]:
        for body, (depth, where) in _deepest(mover, path, obstacles, self.scene.tolerance + NUMERIC_SLACK).items():
            message = f"{mover.name} penetrates {body} by {depth:.6g} m"
            yield _violation(ViolationKind.COLLISION, segment, where, depth, message)

    def _outside(self, name: str, centres: FloatArray, i: int) -> Iterator[Violation]:
        distances = _distance_outside(centres, *self.scene.bounds)
        k = int(distances.argmax())
        if distances[k] > NUMERIC_SLACK:
            message = f"the centre of {name} leaves the bounds by {distances[k]:.6g} m"
            yield _violation(ViolationKind.OUT_OF_BOUNDS, i, centres[k], distances[k], message)

    def _subgoals(self, subgoals: Sequence[Subgoal]) -> Iterator[Violation]:
        kind = ViolationKind.SUBGOAL_MISMATCH
        if subgoals and len(subgoals) != len(self.placements):
            message = f"{len(subgoals)} subgoals, but the carries make {len(self.placements)} placements"
            yield _violation(kind, None, None, None, message)
            return
        for k, (subgoal, (i, body)) in enumerate(zip(subgoals, self.placements, strict=False)):
            distance = float(np.hypot(*(body.position - subgoal.position)))
            if subgoal.object != body.name:
                message = f"subgoals[{k}] places {subgoal.object}, the carry places {body.name}"
                yield _violation(kind, i, body.position, None, message)
            elif distance > TOUCH_SLACK:
                message = f"the carry leaves {body.name} {distance:.6g} m away from subgoals[{k}]"
                yield _violation(kind, i, body.position, distance, message)

    def _goal(self) -> Iterator[Violation]:
        goal, body = self.scene.goal, self.objects[self.scene.goal.object]
        corners = goal.position - goal.size / 2, goal.position + goal.size / 2
        distance = float(_distance_outside(body.position[np.newaxis], *corners)[0])
        if distance > NUMERIC_SLACK:
            message = f"{goal.object} ends {distance:.6g} m outside the goal"
            yield _violation(ViolationKind.GOAL_MISSED, None, body.position, distance, message)
        elif abs(bottom := body.bottom_top[0]) > TOUCH_SLACK:
            message = f"{goal.object} does not rest on the floor: its bottom is at z = {bottom:.6g} m"
            yield _violation(ViolationKind.GOAL_MISSED, None, body.position, abs(bottom), message)


def _violation(
    kind: ViolationKind, segment: int | None, where: FloatArray | None, amount: float | None, message: str
) -> Violation:
    place = None if where is None else (float(where[0]), float(where[1]))
    prefix = "" if segment is None else f"segment {segment}: "
    return Violation(kind, segment, place, None if amount is None else float(amount), prefix + message)


def _jump(place: FloatArray, start: FloatArray, i: int) -> Iterator[Violation]:
    distance = float(np.hypot(*(start - place)))
    if distance > NUMERIC_SLACK:
        message = f"starts {distance:.6g} m away from the agent"
        yield _violation(ViolationKind.DISCONTINUITY, i, start, distance, message)


def _distance_outside(points: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """Distances (n,) [m] of points (n, 2) to a rectangle; 0 inside."""
    return np.hypot(*np.maximum(np.maximum(lower - points, points - upper), 0.0).T)


def _deepest(
    mover: _Prism, path: FloatArray, obstacles: Sequence[_Prism], allowed: float
) -> dict[str, tuple[float, FloatArray]]:
    """Obstacles that `mover` penetrates by more than `allowed` [m] along `path` (n, 2): deepest penetration, place."""
    bodies = [body for body in obstacles if body.meets_in_height(mover)]
    if not bodies:
        return {}
    names = [body.name for body in bodies for _ in body.cores]
    placed = [core for body in bodies for core in body.placed]
    radii = np.array([radius for body in bodies for radius in body.radii])
    tree = shapely.STRtree([geometry for _, geometry in placed])
    found: dict[str, tuple[float, FloatArray]] = {}
    for core, radius in zip(mover.cores, mover.radii, strict=True):
        starts, steps, swept = _sweep(core, path)
        pieces, hits = tree.query(swept, predicate="dwithin", distance=radius + radii.max())
        distances = shapely.distance(swept[pieces], tree.geometries[hits])
        reach = radius + radii[hits]
        for k in np.flatnonzero((reach - distances > allowed) | (distances == 0)):
            vertices, obstacle = placed[hits[k]]
            moving, depth = swept[pieces[k]], reach[k] - distances[k]
            if distances[k] == 0:
                overlap, t = _core_depth(starts[pieces[k]], steps[pieces[k]], vertices)
                moving, depth = _hull(starts[pieces[k]] + t * steps[pieces[k]]), depth + overlap
            name = names[hits[k]]
            if depth > max(allowed, found[name][0] if name in found else 0.0):
                found[name] = depth, shapely.get_coordinates(shapely.shortest_line(moving, obstacle))[-1]
    return found


def _hull(points: FloatArray) -> Any:
    """Convex hull of the points (..., n, 2), a shapely geometry for each."""
    return shapely.convex_hull(shapely.multipoints(points))


def _sweep(core: FloatArray, path: FloatArray) -> tuple[FloatArray, FloatArray, Any]:
    """Core (m, 2) at the start of each piece of `path` (n, 2), steps (n - 1, 2), and the hulls that it sweeps.

    A path of one point counts as one piece of length 0.
    """
    path = path if len(path) > 1 else np.repeat(path, 2, axis=0)
    starts = path[:-1, np.newaxis] + core
    steps = np.diff(path, axis=0)
    return starts, steps, _hull(np.concatenate([starts, path[1:, np.newaxis] + core], axis=1))


def _core_depth(core: FloatArray, step: FloatArray, obstacle: FloatArray) -> tuple[float, float]:
    """Deepest penetration [m] of polygon `core` + t `step`, t in [0, 1], in `obstacle`, and the t of it.

    Both polygons (n, 2) are counter-clockwise. Where the two only touch, the depth is 0.
    """
    normals = np.concatenate([_outward_normals(obstacle), -_outward_normals(core)])
    if len(normals) == 0:
        return 0.0, 0.0
    overlaps = (obstacle @ normals.T).max(axis=0) - (core @ normals.T).min(axis=0)
    t = _argmax_of_minimum(overlaps, -normals @ step)
    return max(0.0, float((overlaps - t * (normals @ step)).min())), t


def _outward_normals(polygon: FloatArray) -> FloatArray:
    """Unit normals of the edges; both normals of a segment, none of a point."""
    edges = np.roll(polygon, -1, axis=0) - polygon
    lengths = np.hypot(*edges.T)
    edges, lengths = edges[lengths > 0], lengths[lengths > 0]
    return np.stack([edges[:, 1], -edges[:, 0]], axis=1) / lengths[:, np.newaxis]


def _argmax_of_minimum(values: FloatArray, slopes: FloatArray) -> float:
    """The t in [0, 1] that maximises the least of the lines `values` + t `slopes`.

    Cutting planes (Kelley 1960), exact for lines: a rising and a falling line bound the maximum by their crossing;
    the line that is least there replaces one of them, until it is one of the two. Each line is used once at most.
    """
    rising = int(values.argmin())
    falling = int((values + slopes).argmin())
    if slopes[rising] <= 0:
        return 0.0
    if slopes[falling] >= 0:
        return 1.0
    t = 0.0
    for _ in values:
        t = (values[falling] - values[rising]) / (slopes[rising] - slopes[falling])
        least = int((values + t * slopes).argmin())
        if least in (rising, falling) or slopes[least] == 0:
            break
        rising, falling = (least, falling) if slopes[least] > 0 else (rising, least)
    return float(np.clip(t, 0.0, 1.0))

"""Independent verification of plans.

The plan is replayed segment by segment; `planner.penetration` measures how deep the moving bodies penetrate others.
Neither shares geometry with the planner: they read cores and radii from the scene and measure with shapely.

Releases: by the format a carry segment grasps at its first way-point and releases at its last, so a plan cannot
state that it forgets to release. It shows in what follows: the object stays where the carry ended, and then a later
carry does not touch it (`no_touch`), `subgoals` names another placement than the carries make (`subgoal_mismatch`),
or the goal-object is not in the goal (`goal_missed`).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from converter.plan import TOUCH_SLACK, Plan, Segment, Subgoal
from converter.scene import AGENT, NUMERIC_SLACK, Scene
from converter.shape import FloatArray
from pcg.errors import InputError
from planner.penetration import Prism, deepest_contacts


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
    """The goal-object does not end in the goal, on the floor; amount: distance from the one or the other [m]."""


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
    plan's; `require_same_scene` compares the two. Placements may differ from `subgoals` by `TOUCH_SLACK`. A plan that is not solved or that names unknown objects is not
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
    usable = 0 <= plan.tolerance < np.inf
    if usable and replace(scene, tolerance=plan.tolerance).geometry_hash == plan.scene_hash:
        raise InputError(
            where,
            f"made with tolerance {plan.tolerance} m, but the scene has {scene.tolerance} m; "
            f"pass --tolerance {plan.tolerance} to verify it with that",
        )
    raise InputError(
        where,
        f"plan of another scene: it was made for {plan.scene!r} ({plan.scene_hash}), "
        f"this is {scene.name!r} ({scene.geometry_hash})",
    )


class _Replay:
    """Follows a plan through its scene. State: where the objects are, and where carries released them."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.agent = Prism.of_agent(scene.agent)
        self.walls = [Prism.of_body(wall) for wall in scene.walls]
        self.objects = {body.name: Prism.of_body(body) for body in scene.objects}
        self.placements: list[tuple[int, Prism]] = []

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

    def _carry(self, held: Prism, segment: Segment, i: int) -> Iterator[Violation]:
        # Agent and object keep their offset while they move as one, so the grasp at the start decides about both.
        gap = self.agent.at(segment.path[0]).gap(held)
        if gap > self.scene.tolerance + TOUCH_SLACK:
            same_height = np.isfinite(gap)
            reason = f"is {gap:.6g} m away" if same_height else "is at another height"
            message = f"the agent grasps {held.name}, which {reason}"
            yield _violation(ViolationKind.NO_TOUCH, i, segment.path[0], gap if same_height else None, message)
        yield from self._collisions(self.agent, segment.path[:1], [held], i)
        centres = held.position + (segment.path - segment.path[0])
        yield from self._collisions(held, centres, self._obstacles(held.name), i)
        yield from self._outside(held.name, centres, i)
        self.objects[held.name] = held.at(centres[-1])
        self.placements.append((i, self.objects[held.name]))

    def _obstacles(self, held: str | None) -> list[Prism]:
        return [*self.walls, *(body for name, body in self.objects.items() if name != held)]

    def _collisions(
        self, mover: Prism, path: FloatArray, obstacles: Sequence[Prism], segment: int | None
    ) -> Iterator[Violation]:
        contacts = deepest_contacts(mover, path, obstacles, self.scene.tolerance + NUMERIC_SLACK)
        for name, contact in contacts.items():
            message = f"{mover.name} penetrates {name} by {contact.depth:.6g} m"
            yield _violation(ViolationKind.COLLISION, segment, contact.where, contact.depth, message)

    def _outside(self, name: str, centres: FloatArray, i: int) -> Iterator[Violation]:
        distances = _distance_outside(centres, *self.scene.bounds)
        k = int(distances.argmax())
        if distances[k] > NUMERIC_SLACK:
            message = f"the centre of {name} leaves the bounds by {distances[k]:.6g} m"
            yield _violation(ViolationKind.OUT_OF_BOUNDS, i, centres[k], distances[k], message)

    def _subgoals(self, subgoals: Sequence[Subgoal]) -> Iterator[Violation]:
        kind = ViolationKind.SUBGOAL_MISMATCH
        if not subgoals:
            return
        if len(subgoals) != len(self.placements):
            message = f"{len(subgoals)} subgoals, but the carries make {len(self.placements)} placements"
            yield _violation(kind, None, None, None, message)
            return
        for k, (subgoal, (i, body)) in enumerate(zip(subgoals, self.placements, strict=True)):
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
    distances: FloatArray = np.hypot(*np.maximum(np.maximum(lower - points, points - upper), 0.0).T)
    return distances

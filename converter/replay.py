"""Replaying a plan: where every object is when each segment begins and ends.

A replay believes the plan. Whether the motion is possible, and whether segments join, is for a verifier to say.
"""

from dataclasses import dataclass

import numpy as np

from converter.plan import Plan, Segment
from converter.scene import Scene
from converter.shape import FloatArray, frozen_array
from pcg.errors import InputError


@dataclass(frozen=True, eq=False)
class Step:
    """A segment and the objects around it.

    Attributes:
        segment: The motion.
        positions: (n_objects, 2) [m], world: centres when the segment begins, in the order of the scene's objects.
        carried: Index of the carried object; None in a `move`.
        offset: (2,) [m]: centre of the carried object less that of the agent, constant while it is held; zero in a
            `move`.
    """

    segment: Segment
    positions: FloatArray
    carried: int | None
    offset: FloatArray

    def positions_with(self, agent: FloatArray) -> FloatArray:
        """(n_objects, 2) [m], world: centres of the objects when the agent is at `agent` (2,) [m] in this segment."""
        positions = self.positions.copy()
        if self.carried is not None:
            positions[self.carried] = agent + self.offset
        return positions

    @property
    def end_positions(self) -> FloatArray:
        """(n_objects, 2) [m], world: centres of the objects when the segment ends."""
        return self.positions_with(self.segment.path[-1])


def replay(scene: Scene, plan: Plan) -> list[Step]:
    """The segments of `plan` in order, each with the objects as they are when it begins.

    Raises:
        InputError: a segment carries an object that the scene does not have.
    """
    names = scene.object_names
    positions = start_positions(scene)
    steps = []
    for i, segment in enumerate(plan.segments):
        if segment.object is not None and segment.object not in names:
            raise InputError(
                f"plan for {plan.scene!r}", f"segments[{i}].object: no object {segment.object!r}; there are {names}"
            )
        carried = None if segment.object is None else names.index(segment.object)
        offset = np.zeros(2) if carried is None else positions[carried] - segment.path[0]
        steps.append(Step(segment, positions, carried, frozen_array(offset, (2,))))
        if carried is not None:
            positions = frozen_array(steps[-1].end_positions, (None, 2))
    return steps


def start_positions(scene: Scene) -> FloatArray:
    """(n_objects, 2) [m], world: centres of the scene's objects, read-only."""
    return frozen_array([body.position[:2] for body in scene.objects], (None, 2))


def points_along(path: FloatArray, distances: FloatArray) -> FloatArray:
    """(m, 2) [m]: the points of the polyline `path` (n, 2) [m] at `distances` (m,) [m] from its start."""
    travelled = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    return np.stack([np.interp(distances, travelled, path[:, axis]) for axis in (0, 1)], axis=-1)

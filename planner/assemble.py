"""From solved subproblems to the segments and subgoals of a plan."""

from collections.abc import Sequence

import numpy as np

from converter.plan import Segment, Subgoal
from converter.scene import Scene
from converter.shape import FloatArray
from planner.pick_place import PickPlace


def segments_of(scene: Scene, steps: Sequence[PickPlace]) -> tuple[Segment, ...]:
    """Moves and carries in turn; a regrasp is a move only, and consecutive moves become one."""
    segments: list[Segment] = []
    approach = np.empty((0, 2))
    for step in steps:
        approach = _joined(approach, step.approach)
        if step.is_regrasp:
            continue
        if len(approach) > 1:
            segments.append(Segment("move", None, approach))
        segments.append(Segment("carry", scene.objects[step.index].name, step.carry))
        approach = step.carry[-1:]
    return tuple(segments)


def subgoals_of(scene: Scene, steps: Sequence[PickPlace]) -> tuple[Subgoal, ...]:
    """Where each carry ends, in order."""
    return tuple(Subgoal(scene.objects[s.index].name, s.placement) for s in steps if not s.is_regrasp)


def _joined(path: FloatArray, following: FloatArray) -> FloatArray:
    """The polyline through both, without repeated points."""
    points = np.vstack([path, following])
    distinct = np.ones(len(points), dtype=bool)
    distinct[1:] = (np.diff(points, axis=0) != 0).any(axis=1)
    return points[distinct]

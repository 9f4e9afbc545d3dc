"""From the agent positions of a skeleton to the segments and subgoals of a plan."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from converter.plan import Segment, Subgoal
from converter.shape import FloatArray
from planner.logic import Skeleton
from planner.problem import Configuration, Problem


def waypoints(start: FloatArray, switches: FloatArray, phase_steps: int) -> FloatArray:
    """Straight lines through `switches` (K, 2) from `start` (2,): (K * phase_steps, 2), every last of a phase exact."""
    ends = np.vstack([start, switches])
    steps = np.arange(1, phase_steps + 1)[:, None] / phase_steps
    return np.vstack([a + steps * (b - a) for a, b in pairwise(ends)])


def phases(start: FloatArray, path: FloatArray, n_phases: int) -> list[FloatArray]:
    """The polylines of the phases of `path` (K * n, 2); each begins where the one before ends."""
    points = np.vstack([start, path])
    n = len(path) // n_phases
    return [points[k * n : (k + 1) * n + 1] for k in range(n_phases)]


def segments_of(problem: Problem, skeleton: Skeleton, motions: Sequence[FloatArray]) -> tuple[Segment, ...]:
    """The segment of each phase: before a pick the agent moves alone, before a placement it carries."""
    names = problem.scene.object_names
    return tuple(
        Segment("move", None, motion) if action.is_pick else Segment("carry", names[action.index], motion)
        for action, motion in zip(skeleton, motions, strict=True)
    )


def subgoals_of(problem: Problem, skeleton: Skeleton, switches: FloatArray) -> tuple[Subgoal, ...]:
    """Where each placement leaves its object; `switches` (K, 2) [m] are the agent positions."""
    names, configuration, found = problem.scene.object_names, problem.initial, []
    for k, action in enumerate(skeleton):
        configuration = after(configuration, skeleton, switches, k)
        if not action.is_pick:
            found.append(Subgoal(names[action.index], configuration.objects[action.index]))
    return tuple(found)


def after(configuration: Configuration, skeleton: Skeleton, switches: FloatArray, k: int) -> Configuration:
    """The configuration after action `k`: a placement moves its object as the agent moved since the pick."""
    action = skeleton[k]
    objects = configuration.objects
    if not action.is_pick:
        placement = objects[action.index] + switches[k] - switches[k - 1]
        objects = configuration.with_object(action.index, placement).objects
    return Configuration(switches[k], objects)

"""The path bound by sampling: RRT-Connect between the switches of a sequence, with exact collision tests.

A deviation from MBTS as published, whose trajectories come from an optimiser. What passes this bound is a plan without
violations: grasps must touch, and every motion is free up to the scene's tolerance. The setting `motion` puts another
motion planner in the place of RRT-Connect.
"""

from collections import Counter
from collections.abc import Callable

import numpy as np

from converter.shape import FloatArray
from planner.lgp_motion import after
from planner.logic import Skeleton, Surface
from planner.motion import motion_planner
from planner.problem import Problem
from planner.settings import Settings
from planner.shortcut import shortcut


def motions_between(
    problem: Problem,
    skeleton: Skeleton,
    switches: FloatArray,
    settings: Settings,
    rng: np.random.Generator,
    counters: Counter[str],
    should_stop: Callable[[], bool],
) -> list[FloatArray] | None:
    """A free motion (n, 2) for each phase, or None if a switch is invalid or a motion is not found.

    Args:
        problem: The scene.
        skeleton: The actions.
        switches: (K, 2) [m] agent centres at the end of each phase.
        settings: Budgets.
        rng: Source of all randomness.
        counters: Work is added to `rrt_calls` and `rrt_iterations`.
        should_stop: Asked in every iteration of RRT-Connect.
    """
    configuration, motions = problem.initial, []
    plan_motion = motion_planner(settings.motion)
    for k, action in enumerate(skeleton):
        arrived = after(configuration, skeleton, switches, k)
        if action.is_pick:
            valid = problem.touches(arrived, action.index)
            space = problem.agent_space(configuration)
        else:
            valid = action.surface is not Surface.GOAL or problem.scene.goal.contains(arrived.objects[action.index])
            grasp = configuration.agent - configuration.objects[action.index]
            space = problem.carry_space(configuration, action.index, grasp)
        if not valid:
            return None
        counters["rrt_calls"] += 1
        goal = switches[k][None]
        found = plan_motion(space, configuration.agent, goal, settings.motion_iterations, rng, should_stop)
        counters["rrt_iterations"] += found.iterations
        if found.path is None:
            return None
        motions.append(shortcut(found.path, space, settings.shortcut_rounds, rng))
        configuration = arrived
    return motions

"""Motion planning by sampling: OMPL's RRT-Connect (Kuffner and LaValle 2000) on the exact collision tests.

Both the state and the motion validity are decided by `planner.kernel`, so no motion is checked by points along it. The
number of iterations bounds the work and the seed comes from the caller, so a query's answer does not depend on what
the process did before.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from converter.shape import FloatArray
from planner import kernel
from planner.configuration_space import ConfigurationSpace

# Seeding the generator again before each query is what makes queries repeatable; OMPL logs an error each time.
ou.setLogLevel(ou.LogLevel.LOG_NONE)

_LARGEST_SEED = 2**31 - 1


@dataclass(frozen=True, eq=False)
class MotionResult:
    """Outcome of a query.

    Attributes:
        path: (n, 2) [m] from the start to one of the goals, or None.
        iterations: Iterations spent.
    """

    path: FloatArray | None
    iterations: int


class _StateValidity(ob.StateValidityChecker):  # type: ignore[misc]  # compiled base class without type information
    def __init__(self, si: ob.SpaceInformation, space: ConfigurationSpace) -> None:
        super().__init__(si)
        self._obstacles = space.obstacles.arrays

    def isValid(self, state: ob.State) -> bool:  # noqa: N802  # name given by OMPL
        # A state has no bounds check: unpacking or listing it would crash.
        x, y = state[0], state[1]
        return bool(kernel.segment_free(x, y, x, y, *self._obstacles))


class _MotionValidity(ob.MotionValidator):  # type: ignore[misc]  # compiled base class without type information
    def __init__(self, si: ob.SpaceInformation, space: ConfigurationSpace) -> None:
        super().__init__(si)
        self._obstacles = space.obstacles.arrays

    def checkMotion(self, a: ob.State, b: ob.State) -> bool:  # noqa: N802  # name given by OMPL
        return bool(kernel.segment_free(a[0], a[1], b[0], b[1], *self._obstacles))


def rrt_connect(
    space: ConfigurationSpace,
    start: FloatArray,
    goals: FloatArray,
    max_iterations: int,
    rng: np.random.Generator,
    should_stop: Callable[[], bool] = lambda: False,
) -> MotionResult:
    """A free path from `start` (2,) to the first of `goals` (k, 2) [m] that the trees meet.

    Args:
        space: Where the point may be.
        start: (2,) [m].
        goals: (k, 2) [m]; those that are not free are left out.
        max_iterations: Iterations after which the query fails.
        rng: Gives the seed of OMPL's generator.
        should_stop: Asked in every iteration.
    """
    goals = goals[space.points_free(goals)]
    if len(goals) == 0 or not space.point_free(start):
        return MotionResult(None, 0)
    ou.RNG.setSeed(int(rng.integers(1, _LARGEST_SEED)))
    si = _space_information(space)
    problem = ob.ProblemDefinition(si)
    problem.addStartState(_state(si, start))
    targets = ob.GoalStates(si)
    for goal in goals:
        targets.addState(_state(si, goal))
    problem.setGoal(targets)
    planner = og.RRTConnect(si)
    planner.setProblemDefinition(problem)
    planner.setup()
    iterations = 0

    def spent() -> bool:
        nonlocal iterations
        if iterations == max_iterations or should_stop():
            return True
        iterations += 1
        return False

    planner.solve(ob.PlannerTerminationCondition(spent))
    if not problem.hasExactSolution():
        return MotionResult(None, iterations)
    states = problem.getSolutionPath().getStates()
    return MotionResult(np.array([[state[0], state[1]] for state in states]), iterations)


def _space_information(space: ConfigurationSpace) -> ob.SpaceInformation:
    plane = ob.RealVectorStateSpace(2)
    bounds = ob.RealVectorBounds(2)
    for axis in range(2):
        bounds.setLow(axis, float(space.bounds[0, axis]))
        bounds.setHigh(axis, float(space.bounds[1, axis]))
    plane.setBounds(bounds)
    si = ob.SpaceInformation(plane)
    si.setStateValidityChecker(_StateValidity(si, space))
    si.setMotionValidator(_MotionValidity(si, space))
    si.setup()
    return si


def _state(si: ob.SpaceInformation, point: FloatArray) -> ob.State:
    state = si.allocState()
    state[0], state[1] = float(point[0]), float(point[1])
    return state

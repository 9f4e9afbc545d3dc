"""Motion planning by the planners of OMPL, above all RRT-Connect (Kuffner and LaValle 2000), on the exact tests.

Both the state and the motion validity are decided by `planner.kernel`, so no motion is checked by points along it. The
number of iterations bounds the work and the seed comes from the caller, so a query's answer does not depend on what
the process did before.
"""

from collections.abc import Callable

import numpy as np
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from converter.shape import FloatArray
from planner import kernel
from planner.configuration_space import ConfigurationSpace
from planner.motion import OMPL_PLANNERS, MotionResult

# Seeding the generator again before each query is what makes queries repeatable; OMPL logs an error each time.
ou.setLogLevel(ou.LogLevel.LOG_NONE)

_LARGEST_SEED = 2**31 - 1


class StateValidity(ob.StateValidityChecker):  # type: ignore[misc]  # compiled base class without type information
    """Whether a state is in no obstacle."""

    def __init__(self, si: ob.SpaceInformation, space: ConfigurationSpace) -> None:
        super().__init__(si)
        self._obstacles = space.obstacles.arrays

    def isValid(self, state: ob.State) -> bool:  # noqa: N802  # name given by OMPL
        """See OMPL."""
        # A state has no bounds check: unpacking or listing it would crash.
        x, y = state[0], state[1]
        return bool(kernel.segment_free(x, y, x, y, *self._obstacles))


class _MotionValidity(ob.MotionValidator):  # type: ignore[misc]  # compiled base class without type information
    def __init__(self, si: ob.SpaceInformation, space: ConfigurationSpace) -> None:
        super().__init__(si)
        self._obstacles = space.obstacles.arrays

    def checkMotion(self, a: ob.State, b: ob.State) -> bool:  # noqa: N802  # name given by OMPL
        return bool(kernel.segment_free(a[0], a[1], b[0], b[1], *self._obstacles))


def exact_space_information(space: ConfigurationSpace) -> ob.SpaceInformation:
    """States and motions checked by the exact tests."""
    si = ob.SpaceInformation(plane(space))
    si.setStateValidityChecker(StateValidity(si, space))
    si.setMotionValidator(_MotionValidity(si, space))
    si.setup()
    return si


def plane(space: ConfigurationSpace) -> ob.RealVectorStateSpace:
    """The bounds of a space as OMPL's state space."""
    states = ob.RealVectorStateSpace(2)
    bounds = ob.RealVectorBounds(2)
    for axis in range(2):
        bounds.setLow(axis, float(space.bounds[0, axis]))
        bounds.setHigh(axis, float(space.bounds[1, axis]))
    states.setBounds(bounds)
    return states


class OmplPlanner:
    """A planner of OMPL as a back end; see `planner.motion.MotionPlanner`.

    Planners that look for the shortest path spend all their iterations.

    Args:
        name: One of `planner.motion.OMPL_PLANNERS`.
        space_information: How states and motions are checked: by default exactly.
    """

    def __init__(
        self,
        name: str,
        space_information: Callable[[ConfigurationSpace], ob.SpaceInformation] = exact_space_information,
    ) -> None:
        if name not in OMPL_PLANNERS:
            raise ValueError(f"no planner {name!r}; there are {', '.join(OMPL_PLANNERS)}")
        self._planner = getattr(og, name)
        self._space_information = space_information

    def __call__(
        self,
        space: ConfigurationSpace,
        start: FloatArray,
        goals: FloatArray,
        max_iterations: int,
        rng: np.random.Generator,
        should_stop: Callable[[], bool] = lambda: False,
    ) -> MotionResult:
        """A free path to one of `goals`; `rng` gives the seed of OMPL's generator, every iteration asks to stop."""
        goals = goals[space.points_free(goals)]
        if len(goals) == 0 or not space.point_free(start):
            return MotionResult(None, 0)
        ou.RNG.setSeed(int(rng.integers(1, _LARGEST_SEED)))
        si = self._space_information(space)
        problem = ob.ProblemDefinition(si)
        problem.addStartState(_state(si, start))
        targets = ob.GoalStates(si)
        for goal in goals:
            targets.addState(_state(si, goal))
        problem.setGoal(targets)
        planner = self._planner(si)
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


rrt_connect = OmplPlanner("RRTConnect")
"""The planner that [L] uses."""


def _state(si: ob.SpaceInformation, point: FloatArray) -> ob.State:
    state = si.allocState()
    state[0], state[1] = float(point[0]), float(point[1])
    return state

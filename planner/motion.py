"""Motion queries: a free path of a point from a start to one of several goals.

Three back ends answer them by the same exact collision test, so none checks a motion by points along it:

- `ompl`: RRT-Connect of OMPL, and `ompl:NAME` its other planners (`planner.motion_ompl`);
- `rrt`: RRT-Connect, compiled (`planner.rrt_connect`);
- `visibility`: shortest paths, which exist wherever there is a path (`planner.visibility`).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from converter.shape import FloatArray
from planner.configuration_space import ConfigurationSpace

OMPL_PLANNERS = (
    "RRTConnect",
    "RRT",
    "RRTstar",
    "InformedRRTstar",
    "SORRTstar",
    "BITstar",
    "FMT",
    "BFMT",
    "KPIECE1",
    "BKPIECE1",
    "LBKPIECE1",
    "AORRTC",
)
"""Planners of OMPL, the default first. PRM and PRMstar are left out: their second thread would wait for ever for the
Python interpreter, and an answer that depends on threads is not repeatable."""

MOTION_PLANNERS = ("ompl", "rrt", "visibility", *(f"ompl:{name}" for name in OMPL_PLANNERS))
"""Names of all back ends."""


@dataclass(frozen=True, eq=False)
class MotionResult:
    """Outcome of a query.

    Attributes:
        path: (n, 2) [m] from the start to one of the goals, or None.
        iterations: Iterations spent; 0 where nothing is sampled.
    """

    path: FloatArray | None
    iterations: int


class MotionPlanner(Protocol):
    """A back end."""

    def __call__(
        self,
        space: ConfigurationSpace,
        start: FloatArray,
        goals: FloatArray,
        max_iterations: int,
        rng: np.random.Generator,
        should_stop: Callable[[], bool] = lambda: False,
    ) -> MotionResult:
        """A free path from `start` (2,) to one of `goals` (k, 2) [m].

        Args:
            space: Where the point may be.
            start: (2,) [m]; if it is not free, there is no path.
            goals: (k, 2) [m]; those that are not free are left out.
            max_iterations: Iterations after which a sampling planner ends.
            rng: Source of all randomness.
            should_stop: Asked from time to time; True ends the query.
        """


def motion_planner(name: str) -> MotionPlanner:
    """The back end called `name`.

    Raises:
        KeyError: there is no such back end.
    """
    if name not in MOTION_PLANNERS:
        raise KeyError(f"no motion planner {name!r}; there are {', '.join(MOTION_PLANNERS)}")
    back_end, _, planner = name.partition(":")
    return _BACK_ENDS[back_end](planner or OMPL_PLANNERS[0])


# Each back end is imported when it is used: OMPL takes a third of a second.


def _ompl(planner: str) -> MotionPlanner:
    from planner.motion_ompl import OmplPlanner  # noqa: PLC0415  # see above

    return OmplPlanner(planner)


def _rrt(_: str) -> MotionPlanner:
    from planner.rrt_connect import rrt_connect  # noqa: PLC0415  # see above

    return rrt_connect


def _visibility(_: str) -> MotionPlanner:
    from planner.visibility import shortest_path  # noqa: PLC0415  # see above

    return shortest_path


_BACK_ENDS: dict[str, Callable[[str], MotionPlanner]] = {"ompl": _ompl, "rrt": _rrt, "visibility": _visibility}

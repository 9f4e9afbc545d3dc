"""Peers of the performance table: the same questions, answered by the usual means.

- Motions: OMPL with a state checker in Python that is asked every 5 mm along a motion, as its users write it.
- Segments: shapely on the obstacles as polygons, prepared and asked all at once, which is its fastest way.
"""

import numpy as np
import shapely  # type: ignore[import-untyped]  # shapely ships no types
from ompl import base as ob

from converter.shape import FloatArray
from planner.configuration_space import ConfigurationSpace, ObstacleSet
from planner.motion_ompl import OmplPlanner, StateValidity, plane

STEP = 5e-3
"""Distance between the points at which a motion is checked [m]."""

QUARTER_SEGMENTS = 16
"""Edges by which shapely replaces a quarter of a circle; its default."""


def ompl_with_sampled_checks() -> OmplPlanner:
    """OMPL's RRT-Connect with a checker in Python that sees points only."""
    return OmplPlanner("RRTConnect", _sampled_space_information)


def _sampled_space_information(space: ConfigurationSpace) -> ob.SpaceInformation:
    si = ob.SpaceInformation(plane(space))
    si.setStateValidityChecker(StateValidity(si, space))
    si.setStateValidityCheckingResolution(STEP / si.getMaximumExtent())
    si.setup()
    return si


class ShapelyObstacles:
    """Obstacles as one prepared shapely geometry."""

    def __init__(self, obstacles: ObstacleSet) -> None:
        cores = [
            shapely.convex_hull(shapely.multipoints(obstacles.vertices[begin:end]))
            for begin, end in zip(obstacles.first[:-1], obstacles.first[1:], strict=True)
        ]
        self._union = shapely.union_all(shapely.buffer(cores, obstacles.rho, quad_segs=QUARTER_SEGMENTS))
        shapely.prepare(self._union)

    def segments_free(self, starts: FloatArray, ends: FloatArray) -> int:
        """How many of the segments between rows of (n, 2) arrays [m] do not meet the obstacles' interior."""
        lines = shapely.linestrings(np.stack([starts, ends], axis=1))
        return int((~shapely.intersects(self._union, lines)).sum())

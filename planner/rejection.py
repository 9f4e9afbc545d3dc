"""`rej` of [L], section IV: which configurations are like enough others to be left out of the search tree.

[L] calls configurations equal if their discretised object positions agree, and keeps two of each kind. That loses some
puzzles: those where configurations differ in where the agent is shut in, on which side of an object in a corridor, say,
and those where objects can be moved by centimetres only. So by access (`rejection_by_access`)

- equal are only configurations between which the agent can drive;
- as many are kept as [L] keeps, divided by the share of grasps that the agent can drive to. In the open that is all and
  two configurations are enough; in a narrow place small differences of position decide which grasps there are, and these
  what can be done next (an idea of Regrasp Maps, arXiv 2507.12407).

In Maze a fifth of the expansions remain, with which the open part of the room is done before the narrow one.
"""

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from converter.shape import FloatArray
from planner.contact_curve import ContactCurve
from planner.frontier import cells_of
from planner.problem import Configuration, Problem
from planner.settings import Settings
from planner.visibility import ShortestPathTree

GRASPS = 16
"""Grasps of each object, evenly spread over its contact curve, of which the share that can be reached is taken."""

_Place = tuple[int, FloatArray]
"""An object that the agent touches, and the agent's centre (2,) [m] relative to it."""


class Rejection:
    """Remembers the configurations that have been accepted."""

    def __init__(self, problem: Problem, settings: Settings) -> None:
        self._problem = problem
        self._active = "R" in settings.letters
        self._by_access = settings.rejection_by_access
        self._cell = settings.rejection_cell
        self._limit = settings.equal_configurations
        curves = [ContactCurve(body, problem.scene.agent.radius) for body in problem.scene.objects]
        self._grasps = [curve.at(np.linspace(0.0, curve.length, GRASPS, endpoint=False)) for curve in curves]
        self._accepted: defaultdict[bytes, list[_Place]] = defaultdict(list)

    def accepts(self, configuration: Configuration, index: int) -> bool:
        """Whether fewer than the allowed number of equal configurations have been accepted; counts this one.

        Args:
            configuration: Where everything is.
            index: The object that the agent touches there.
        """
        known = self._accepted[cells_of(configuration.objects, self._cell)]
        if self._active and len(known) >= self._limit and (not self._by_access or self._enough(configuration, known)):
            return False
        known.append((index, configuration.agent - configuration.objects[index]))
        return True

    def _enough(self, configuration: Configuration, known: Sequence[_Place]) -> bool:
        tree = ShortestPathTree(self._problem.agent_space(configuration), configuration.agent)
        # An agent that touched its object does so here: what counts is how it stood to it, not the centimetres.
        equals = tree.reaches(np.array([configuration.objects[index] + offset for index, offset in known])).sum()
        grasps = [at + offsets for at, offsets in zip(configuration.objects, self._grasps, strict=True)]
        share = max(tree.reaches(np.vstack(grasps)).mean(), 1 / GRASPS)
        return bool(equals >= self._limit / share)

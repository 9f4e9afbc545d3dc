"""The switch-configuration problem as a nonlinear program in CasADi.

A pick-and-place of one object switches modes twice, at the grasp and at the release. Between them the offset of agent
and object is constant, so two points describe both switches: the agent's centre a at the pick and the object's centre
z at the placement. With p the object's position before, s_B the signed distance to the core polygon of B and rho the
radii as in `planner.configuration_space`:

    minimise    |a - a_0|^2 + |z - z_0|^2
    subject to  min over parts B of the object of s_B(a - p) = rho_B          touch
                s_k(a) >= rho_k            for all obstacles k of the agent   no penetration at the pick
                s_k(a + z - p) >= rho_k    for all obstacles k of the agent   no penetration at the placement
                s_j(z) >= rho_j            for all obstacles j of the object
                lower <= z <= upper                                           placement in the region

(a_0, z_0) is a randomised start. Polygons are parameters: a program is built once per structure, which is the number
of polygons and of vertices, and solved for any positions. Polygons with fewer vertices repeat their last one.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from converter.shape import FloatArray
from planner.configuration_space import ObstacleSet
from planner.lgp_constraints import MARGIN, TOUCH_GAP, PolygonBlock, clearances, touch_gap

_SQP_OPTIONS: dict[str, Any] = {
    "expand": True,
    "error_on_fail": False,
    "print_time": False,
    "print_header": False,
    "print_iteration": False,
    "print_status": False,
    "max_iter": 15,
    "qpsol": "qrqp",
    "qpsol_options": {
        "max_iter": 50,
        "error_on_fail": False,
        "print_iter": False,
        "print_header": False,
        "print_info": False,
    },
}
"""Sequential quadratic programming from a start on the contact curve: of 600 subproblems it solves 370 in 0.22 ms
(median), IPOPT 350 in 4.2 ms. More iterations solve no more."""


@dataclass(frozen=True)
class SwitchStructure:
    """What a program is built for; positions and shapes are parameters."""

    parts: PolygonBlock
    agent_obstacles: PolygonBlock
    object_obstacles: PolygonBlock


@dataclass(frozen=True, eq=False)
class SwitchProgram:
    """The program of a structure, symbolically.

    Attributes:
        x: (4,) variables a and z.
        p: Parameters: start (4,), object position (2,), then the three packed polygon sets.
        cost: Scalar.
        constraints: (m,); the first is the touch equality, the others are inequalities >= 0.
    """

    x: ca.MX
    p: ca.MX
    cost: ca.MX
    constraints: ca.MX


def build(structure: SwitchStructure) -> SwitchProgram:
    """The program of a structure, for inspection or for `solver`."""
    x = ca.MX.sym("x", 4)
    blocks = (structure.parts, structure.agent_obstacles, structure.object_obstacles)
    start, position = ca.MX.sym("start", 4), ca.MX.sym("position", 2)
    packed = [ca.MX.sym(name, block.size) for name, block in zip(("parts", "agent", "object"), blocks, strict=True)]
    a, z = x[:2], x[2:]
    touch = touch_gap(a - position, structure.parts, packed[0])
    at_pick = clearances(a, structure.agent_obstacles, packed[1])
    at_place = clearances(a + z - position, structure.agent_obstacles, packed[1])
    placed = clearances(z, structure.object_obstacles, packed[2])
    constraints = ca.vertcat(touch - TOUCH_GAP, ca.vertcat(at_pick, at_place, placed) - MARGIN)
    return SwitchProgram(x, ca.vertcat(start, position, *packed), ca.sumsqr(x - start), constraints)


@lru_cache(maxsize=64)
def solver(structure: SwitchStructure) -> ca.Function:
    """The compiled program of a structure."""
    program = build(structure)
    nlp = {"x": program.x, "p": program.p, "f": program.cost, "g": program.constraints}
    return ca.nlpsol("switch", "sqpmethod", nlp, _SQP_OPTIONS)


@dataclass(frozen=True, eq=False)
class SwitchQuery:
    """The numbers of one switch-configuration problem.

    Attributes:
        position: (2,) [m] object centre before the pick.
        parts: The object's cores, relative to its position, with the radii at which the agent touches them.
        agent_obstacles: Obstacles of the agent, without the object itself.
        object_obstacles: Obstacles of the object.
        lower: (2,) [m] lower corner of the placement region.
        upper: (2,) [m] upper corner.
    """

    position: FloatArray
    parts: ObstacleSet
    agent_obstacles: ObstacleSet
    object_obstacles: ObstacleSet
    lower: FloatArray
    upper: FloatArray

    def solve(self, starts: Sequence[FloatArray]) -> list[tuple[FloatArray, FloatArray]]:
        """The solutions (a, z), each (2,) [m], that the optimiser claims from `starts` [(4,), ...]; check them."""
        sets = (self.parts, self.agent_obstacles, self.object_obstacles)
        blocks = [PolygonBlock.of(obstacles) for obstacles in sets]
        program = solver(SwitchStructure(*blocks))
        packed = [block.pack(obstacles) for block, obstacles in zip(blocks, sets, strict=True)]
        upper = np.full(1 + 2 * len(self.agent_obstacles) + len(self.object_obstacles), np.inf)
        upper[0] = 0.0
        solutions = []
        for start in starts:
            found = program(
                x0=start,
                p=np.concatenate([start, self.position, *packed]),
                lbx=np.array([-np.inf, -np.inf, *self.lower]),
                ubx=np.array([np.inf, np.inf, *self.upper]),
                lbg=0.0,
                ubg=upper,
            )
            if program.stats()["success"]:
                x = np.array(found["x"]).ravel()
                # Optimisers relax bounds by their tolerance, which is more than the numeric slack of a goal.
                solutions.append((x[:2], np.clip(x[2:], self.lower, self.upper)))
        return solutions

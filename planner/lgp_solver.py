"""Solving the bounds of a logic-geometric program: an elastic program in Ipopt.

MBTS asks of each bound a cost and how much its constraints are violated at the least, also where they cannot all be
satisfied. So each constraint gets a slack, and the sum of the slacks, which is the violation in scaled units that the
bound is judged by, joins the cost (an exact L1 penalty; Nocedal and Wright, Numerical Optimization, section 17.2):

    minimise    |r(x)|^2 + penalty * (sum s+ + sum s- + sum t)
    subject to  h(x) = s+ - s-,  g(x) + t >= 0,  s+, s-, t >= 0

The programs with slacks are always feasible, and where the penalty exceeds the multipliers their solutions satisfy the
constraints exactly, if that is possible nearby. Without slacks Ipopt leaves an infeasible program in its restoration
phase, which ignores the cost: paths that are accepted with a small violation are then erratic.

The Hessian leaves out the curvature of the inequalities, which is zero except around corners. Measured on one core, path
programs of two actions in Cube-Free and a19-20, and of four actions in a19-20: 0.04, 0.17 and 0.5 s in 16, 23 and 44
iterations; with the exact Hessian 0.07, 0.5 and 1.5 s in 16, 27 and 28; with a limited-memory one none converges in 100.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from converter.shape import FloatArray
from planner.lgp import Program, path_program, pose_program, sequence_program
from planner.lgp_scene import LgpStructure
from planner.lgp_weights import Weights
from planner.logic import Action, Skeleton

PENALTY = 10.0
"""Cost of one scaled unit of violation, a hundred times that of a whole path without any."""

_IPOPT_OPTIONS: dict[str, Any] = {
    "error_on_fail": False,
    "print_time": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.tol": 1e-7,
}


@dataclass(frozen=True, eq=False)
class BoundSolution:
    """What came of one optimisation.

    Attributes:
        x: Values of the program's variables [m].
        cost: Sum of squared residuals.
        violation: Sum of the scaled violations of all constraints.
        iterations: Of Ipopt.
    """

    x: FloatArray
    cost: float
    violation: float
    iterations: int


class BoundSolver:
    """A program ready to be solved for any positions and shapes.

    Args:
        program: One of the bounds.
        max_iterations: Of Ipopt.
    """

    def __init__(self, program: Program, max_iterations: int) -> None:
        self.n = program.x.numel()
        self._n_equalities, self._n_inequalities = program.equalities.numel(), program.inequalities.numel()
        parts = [ca.sumsqr(program.residuals), program.equalities, program.inequalities]
        self._evaluate = ca.Function("evaluate", [program.x, program.p], parts)
        self._minimise = self._elastic(program, max_iterations)

    def evaluate(self, x: FloatArray, p: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        """Cost, equalities and inequalities of the program at `x`."""
        cost, equalities, inequalities = self._evaluate(x, p)
        return float(cost), np.array(equalities).ravel(), np.array(inequalities).ravel()

    def solve(self, start: FloatArray, p: FloatArray) -> BoundSolution:
        """A local optimum.

        Args:
            start: (n,) where the optimisation starts.
            p: Parameters of the scene.
        """
        _, equalities, inequalities = self.evaluate(start, p)
        slacks = [np.maximum(equalities, 0), np.maximum(-equalities, 0), np.maximum(-inequalities, 0)]
        found = self._minimise(
            x0=np.concatenate([start, *slacks]),
            p=p,
            lbx=np.concatenate([np.full(self.n, -np.inf), *(np.zeros(len(slack)) for slack in slacks)]),
            lbg=0.0,
            ubg=np.concatenate([np.zeros(self._n_equalities), np.full(self._n_inequalities, np.inf)]),
        )
        x = np.array(found["x"]).ravel()[: self.n]
        cost, equalities, inequalities = self.evaluate(x, p)
        violation = float(np.abs(equalities).sum() + np.maximum(-inequalities, 0).sum())
        return BoundSolution(x, cost, violation, int(self._minimise.stats()["iter_count"]))

    def _elastic(self, program: Program, max_iterations: int) -> ca.Function:
        n_h, n_g = self._n_equalities, self._n_inequalities
        above, below, short = ca.MX.sym("above", n_h), ca.MX.sym("below", n_h), ca.MX.sym("short", n_g)
        x = ca.vertcat(program.x, above, below, short)
        cost = ca.sumsqr(program.residuals) + PENALTY * ca.sum1(ca.vertcat(above, below, short))
        constraints = ca.vertcat(program.equalities - above + below, program.inequalities + short)
        weight, multipliers = ca.MX.sym("weight"), ca.MX.sym("multipliers", n_h + n_g)
        curved = weight * ca.sumsqr(program.residuals) + ca.dot(multipliers[:n_h], program.equalities)
        hessian = ca.Function(
            "hessian",
            [x, program.p, weight, multipliers],
            [ca.triu(ca.hessian(curved, x)[0])],
            ["x", "p", "lam_f", "lam_g"],
            ["triu_hess_gamma_x_x"],
        )
        options = {**_IPOPT_OPTIONS, "hess_lag": hessian, "ipopt.max_iter": max_iterations}
        return ca.nlpsol("bound", "ipopt", {"x": x, "p": program.p, "f": cost, "g": constraints}, options)


@lru_cache(maxsize=256)
def pose_solver(
    structure: LgpStructure, moved: tuple[int, ...], action: Action, weights: Weights, max_iterations: int
) -> BoundSolver:
    """The solver of `pose_program`, built once for each structure."""
    return BoundSolver(pose_program(structure, moved, action, weights), max_iterations)


@lru_cache(maxsize=128)
def sequence_solver(structure: LgpStructure, skeleton: Skeleton, weights: Weights, max_iterations: int) -> BoundSolver:
    """The solver of `sequence_program`, built once for each structure."""
    return BoundSolver(sequence_program(structure, skeleton, weights), max_iterations)


@lru_cache(maxsize=32)
def path_solver(
    structure: LgpStructure, skeleton: Skeleton, weights: Weights, phase_steps: int, max_iterations: int
) -> BoundSolver:
    """The solver of `path_program`, built once for each structure."""
    return BoundSolver(path_program(structure, skeleton, weights, phase_steps), max_iterations)

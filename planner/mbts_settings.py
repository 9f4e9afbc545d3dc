"""Parameters of multi-bound tree search that [L] leaves open; the others are those of the authors' code."""

from dataclasses import dataclass


@dataclass(frozen=True)
class MbtsSettings:
    """Parameters of MBTS.

    Attributes:
        mbts_max_depth: Actions of the longest skeleton. Eight are four placements, one more than any scene needs that
            MBTS solves; with three objects there are 625 skeletons of that length.
        mbts_phase_steps: Configurations a phase of the path bound.
        mbts_max_violation: A bound is feasible below this sum of scaled violations.
        mbts_noise: Standard deviation [m] of what is added to the start of an optimisation.
        mbts_action_cost: Symbolic cost of an action, added to the cost of every bound: shorter skeletons go first.
        mbts_max_iterations: Iterations of one optimisation; 20 to 50 are usual.
    """

    mbts_max_depth: int = 8
    mbts_phase_steps: int = 10
    mbts_max_violation: float = 2.0
    mbts_noise: float = 0.01
    mbts_action_cost: float = 0.1
    mbts_max_iterations: int = 100

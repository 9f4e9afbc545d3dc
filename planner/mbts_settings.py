"""Parameters of multi-bound tree search (`planner.mbts`) in one place, with the value chosen and why."""

from dataclasses import dataclass

from planner.lgp_weights import Weights


@dataclass(frozen=True)
class MbtsSettings:
    """Parameters of MBTS.

    The threshold, the configurations a phase, the collision scale, the noise and the weights of acceleration, homing
    and switches are those of the authors' code; [L] names none of them. The others are ours.

    Attributes:
        mbts_max_depth: Actions of the longest skeleton. Eight are four placements, one more than any scene needs that
            MBTS solves. Up to that length there are 40 skeletons with two objects and 820 with five.
        mbts_phase_steps: Configurations a phase of the path bound.
        mbts_max_violation: A bound is feasible below this sum of scaled violations.
        mbts_noise: Standard deviation [m] of what is added to the start of an optimisation.
        mbts_action_cost: Symbolic cost of an action, added to the cost of every bound. Costs of sequences are below
            0.01, so shorter skeletons go first.
        mbts_max_iterations: Iterations of one optimisation; 15 to 50 are usual.
        mbts_acceleration_weight: Factor of second differences along a path.
        mbts_velocity_weight: Factor of first differences along a path, small against that of accelerations.
        mbts_homing_weight: Factor of distances from the start.
        mbts_switch_weight: Factor of distances between consecutive switches.
        mbts_touch_scale: Scale of the gap at a pick [1/m].
        mbts_placement_scale: Scale of the distance from goal, floor and limits [1/m].
        mbts_collision_scale: Scale of penetrations [1/m].
    """

    mbts_max_depth: int = 8
    mbts_phase_steps: int = 10
    mbts_max_violation: float = 2.0
    mbts_noise: float = 0.01
    mbts_action_cost: float = 0.1
    mbts_max_iterations: int = 100
    mbts_acceleration_weight: float = Weights.acceleration
    mbts_velocity_weight: float = Weights.velocity
    mbts_homing_weight: float = Weights.homing
    mbts_switch_weight: float = Weights.switch
    mbts_touch_scale: float = Weights.touch
    mbts_placement_scale: float = Weights.placement
    mbts_collision_scale: float = Weights.collision

    @property
    def mbts_weights(self) -> Weights:
        """Factors and scales as the programs take them."""
        return Weights(
            acceleration=self.mbts_acceleration_weight,
            velocity=self.mbts_velocity_weight,
            homing=self.mbts_homing_weight,
            switch=self.mbts_switch_weight,
            touch=self.mbts_touch_scale,
            placement=self.mbts_placement_scale,
            collision=self.mbts_collision_scale,
        )

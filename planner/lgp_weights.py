"""Factors of the costs and scales of the constraints of logic-geometric programs."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Weights:
    """Costs are sums of squared residuals, each times its factor; violations are counted in scaled units.

    Attributes:
        acceleration: Factor of second differences along a path.
        velocity: Factor of first differences along a path.
        homing: Factor of distances from the start, in every bound.
        switch: Factor of distances between consecutive switches, in pose and sequence.
        touch: Scale of the gap between agent and object at a pick [1/m].
        placement: Scale of the distance from goal, floor and limits [1/m].
        collision: Scale of penetrations, as constraints and as costs [1/m].
    """

    acceleration: float = 1.0
    velocity: float = 0.1
    homing: float = 0.01
    switch: float = 0.01
    touch: float = 100.0
    placement: float = 10.0
    collision: float = 10.0

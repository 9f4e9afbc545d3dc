"""The reward: by how much an edit brings a map nearer to what is wanted.

A term is a distance to a target, 0 where it is met. The *distance* of a map is the weighted sum of its terms, the
reward of an edit the decrease of that distance plus a bonus when every term is 0 (Khalifa et al., PCGRL, AIIDE 2020).
Solution lengths are always optimal ones, so there is no detour to be rewarded for. What is wanted of walls, pushes,
occlusion and dependency may differ from episode to episode: these *controls* are inputs of the policy too (Earle et
al., Learning Controllable Content Generators, CoG 2021).
"""

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from enum import IntEnum

import numpy as np
import numpy.typing as npt

from pcg.solver_kernel import Int32Array
from pcg.statistics_kernel import Column

FloatArray = npt.NDArray[np.float64]


class Control(IntEnum):
    """The columns of an array of controls."""

    WALLS_LOW = 0
    """Least number of walls."""
    WALLS_HIGH = 1
    PUSHES_LOW = 2
    PUSHES_HIGH = 3
    OCCLUDED = 4
    """1: the player must not see the goal crate, -1: has to see it, 0: either."""
    DEPENDENCY = 5
    """1: another crate has to move first, -1: none, 0: either."""


@dataclass(frozen=True)
class Weights:
    """The weight of each term; 0 leaves it out, also of success."""

    player: float = 3.0
    crates: float = 2.0
    targets: float = 2.0
    regions: float = 2.0
    walls: float = 0.5
    solvable: float = 3.0
    pushes: float = 1.0
    occlusion: float = 2.0
    dependency: float = 2.0
    clearance: float = 0.0
    novelty: float = 0.0


@dataclass(frozen=True)
class RewardSettings:
    """What is wanted of every map, and what it is worth.

    Attributes:
        crates: Crates.
        targets: Targets, at least one and at most as many as crates.
        clearance: Free cells wanted among the eight around each crate, room for a robot's grasps.
        novelty: Cells in which a map has to differ from each in the archive.
        weights: Of the terms.
        bonus: Reward for a map with every term at 0.
        scale: Factor of the whole reward.
    """

    crates: int = 2
    targets: int = 1
    clearance: int = 0
    novelty: int = 0
    weights: Weights = field(default_factory=Weights)
    bonus: float = 5.0
    scale: float = 0.2

    def __post_init__(self) -> None:
        if not 1 <= self.targets <= self.crates:
            raise ValueError(f"{self.targets} targets need as many crates, and at least one; there are {self.crates}")


def below_and_above(values: npt.ArrayLike, low: npt.ArrayLike, high: npt.ArrayLike) -> FloatArray:
    """(n,) distance of each value to its range, 0 inside."""
    values = np.asarray(values, dtype=np.float64)
    outside: FloatArray = np.maximum(np.maximum(np.subtract(low, values), np.subtract(values, high)), 0.0)
    return outside


def player(statistics: Int32Array, controls: FloatArray, settings: RewardSettings) -> FloatArray:
    """Players too many or missing; one is wanted."""
    del controls, settings
    return below_and_above(statistics[:, Column.PLAYERS], 1, 1)


def crates(statistics: Int32Array, controls: FloatArray, settings: RewardSettings) -> FloatArray:
    """Crates too many or missing."""
    del controls
    return below_and_above(statistics[:, Column.CRATES], settings.crates, settings.crates)


def targets(statistics: Int32Array, controls: FloatArray, settings: RewardSettings) -> FloatArray:
    """Targets too many or missing."""
    del controls
    return below_and_above(statistics[:, Column.TARGETS], settings.targets, settings.targets)


def regions(statistics: Int32Array, controls: FloatArray, settings: RewardSettings) -> FloatArray:
    """Regions of free cells beyond the first."""
    del controls, settings
    return below_and_above(statistics[:, Column.REGIONS], 1, 1)


def walls(statistics: Int32Array, controls: FloatArray, settings: RewardSettings) -> FloatArray:
    """Walls outside of the band."""
    del settings
    return below_and_above(statistics[:, Column.WALLS], controls[:, Control.WALLS_LOW], controls[:, Control.WALLS_HIGH])


def solvable(statistics: Int32Array, controls: FloatArray, settings: RewardSettings) -> FloatArray:
    """1 unless the goal crate can be pushed to the first target and the other targets can be covered."""
    del controls, settings
    return 1.0 - statistics[:, Column.SOLVABLE].astype(np.float64)


def pushes(statistics: Int32Array, controls: FloatArray, settings: RewardSettings) -> FloatArray:
    """Optimal pushes outside of the band; an unsolvable map has none."""
    del settings
    return below_and_above(
        statistics[:, Column.PUSHES], controls[:, Control.PUSHES_LOW], controls[:, Control.PUSHES_HIGH]
    )


def _unlike(wanted: FloatArray, found: npt.NDArray[np.int32], known: npt.NDArray[np.int32]) -> FloatArray:
    """1 where a sign is wanted and the known flag has the other one, or where it is not known."""
    fits = (known == 1) & ((wanted > 0) == (found == 1))
    return np.where((wanted == 0) | fits, 0.0, 1.0)


def occlusion(statistics: Int32Array, controls: FloatArray, settings: RewardSettings) -> FloatArray:
    """1 if the player sees the goal crate and must not, or the other way round."""
    del settings
    return _unlike(controls[:, Control.OCCLUDED], statistics[:, Column.OCCLUDED], statistics[:, Column.SOLVABLE])


def dependency(statistics: Int32Array, controls: FloatArray, settings: RewardSettings) -> FloatArray:
    """1 if no other crate has to move first but one should, or the other way round."""
    del settings
    return _unlike(controls[:, Control.DEPENDENCY], statistics[:, Column.DEPENDENCY], statistics[:, Column.SOLVABLE])


def clearance(statistics: Int32Array, controls: FloatArray, settings: RewardSettings) -> FloatArray:
    """Free cells missing around the most enclosed crate."""
    del controls
    return below_and_above(statistics[:, Column.CLEARANCE], settings.clearance, np.inf)


def novelty(statistics: Int32Array, controls: FloatArray, settings: RewardSettings) -> FloatArray:
    """Cells that have still to differ from the most similar map of the archive."""
    del controls
    return below_and_above(statistics[:, Column.NOVELTY], settings.novelty, np.inf)


Term = Callable[[Int32Array, FloatArray, RewardSettings], FloatArray]

TERMS: dict[str, Term] = {
    "player": player,
    "crates": crates,
    "targets": targets,
    "regions": regions,
    "walls": walls,
    "solvable": solvable,
    "pushes": pushes,
    "occlusion": occlusion,
    "dependency": dependency,
    "clearance": clearance,
    "novelty": novelty,
}
"""By the name of its weight."""


def distance(statistics: Int32Array, controls: FloatArray, settings: RewardSettings) -> FloatArray:
    """(n,) weighted sum of all terms; 0 means that everything is met.

    Args:
        statistics: (n, len(Column)).
        controls: (n, len(Control)).
        settings: Targets and weights.
    """
    total = np.zeros(len(statistics))
    for term in fields(Weights):
        weight = getattr(settings.weights, term.name)
        if weight:
            total += weight * TERMS[term.name](statistics, controls, settings)
    return total


def reward(before: FloatArray, after: FloatArray, settings: RewardSettings) -> FloatArray:
    """(n,) reward of edits that changed the distance from `before` to `after`."""
    gained: FloatArray = settings.scale * (before - after + settings.bonus * (after == 0))
    return gained

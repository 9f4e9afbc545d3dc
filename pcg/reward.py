"""The reward: by how much an edit brings a map nearer to what is wanted.

A term is a distance to a target, 0 where it is met. The *distance* of a map is the weighted sum of its terms, the
reward of an edit the decrease of that distance plus a bonus when every term is 0 (Khalifa et al., PCGRL, AIIDE 2020).
Solution lengths are always optimal ones, so there is no detour to be rewarded for. What is wanted of walls, pushes,
occlusion and dependency may differ from episode to episode: these *controls* are inputs of the policy too (Earle et
al., Learning Controllable Content Generators, CoG 2021).
"""

from dataclasses import astuple, dataclass, field
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numba import njit

from pcg.arrays import FloatArray, Int32Array, IntArray
from pcg.statistics_kernel import Column


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
    """The weight of each term, in the order of `distances`; 0 leaves it out, also of success."""

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

    def wanted(self) -> "Wanted":
        """The settings as the compiled functions take them."""
        return Wanted(self.crates, self.targets, self.clearance, self.novelty, np.array(astuple(self.weights)))


class Wanted(NamedTuple):
    """`RewardSettings` for compiled functions; `weights` in the order of `Weights`."""

    crates: int
    targets: int
    clearance: int
    novelty: int
    weights: FloatArray


_PLAYERS, _CRATES, _TARGETS, _WALLS, _REGIONS, _SOLVABLE, _PUSHES = (int(column) for column in list(Column)[:7])
_OCCLUDED, _DEPENDENCY, _CLEARANCE, _NOVELTY = (int(column) for column in list(Column)[8:])
_WALLS_LOW, _WALLS_HIGH, _PUSHES_LOW, _PUSHES_HIGH, _WANT_OCCLUDED, _WANT_DEPENDENCY = (int(c) for c in Control)


@njit(cache=True)
def outside(value: float, low: float, high: float) -> float:
    """The distance of a value to its range, 0 inside."""
    return max(low - value, value - high, 0.0)


@njit(cache=True)
def player(row: Int32Array) -> float:
    """Players too many or missing; one is wanted."""
    return outside(row[_PLAYERS], 1, 1)


@njit(cache=True)
def crates(row: Int32Array, wanted: Wanted) -> float:
    """Crates too many or missing."""
    return outside(row[_CRATES], wanted.crates, wanted.crates)


@njit(cache=True)
def targets(row: Int32Array, wanted: Wanted) -> float:
    """Targets too many or missing."""
    return outside(row[_TARGETS], wanted.targets, wanted.targets)


@njit(cache=True)
def regions(row: Int32Array) -> float:
    """Regions of free cells beyond the first."""
    return outside(row[_REGIONS], 1, 1)


@njit(cache=True)
def walls(row: Int32Array, control: FloatArray) -> float:
    """Walls outside of the band."""
    return outside(row[_WALLS], control[_WALLS_LOW], control[_WALLS_HIGH])


@njit(cache=True)
def solvable(row: Int32Array) -> float:
    """1 unless the goal crate can be pushed to the first target and the other targets can be covered."""
    return float(1 - row[_SOLVABLE])


@njit(cache=True)
def pushes(row: Int32Array, control: FloatArray) -> float:
    """Optimal pushes outside of the band; an unsolvable map has none."""
    return outside(row[_PUSHES], control[_PUSHES_LOW], control[_PUSHES_HIGH])


@njit(cache=True)
def _unlike(wanted: float, found: int, known: int) -> float:
    """0 if nothing is wanted, or the flag is known and has the wanted sign; else 1."""
    return 0.0 if wanted == 0 or (known and (wanted > 0) == (found == 1)) else 1.0


@njit(cache=True)
def occlusion(row: Int32Array, control: FloatArray) -> float:
    """1 if the player sees the goal crate and must not, or the other way round."""
    return _unlike(control[_WANT_OCCLUDED], row[_OCCLUDED], row[_SOLVABLE])


@njit(cache=True)
def dependency(row: Int32Array, control: FloatArray) -> float:
    """1 if no other crate has to move first but one should, or the other way round."""
    return _unlike(control[_WANT_DEPENDENCY], row[_DEPENDENCY], row[_SOLVABLE])


@njit(cache=True)
def clearance(row: Int32Array, wanted: Wanted) -> float:
    """Free cells missing around the most enclosed crate."""
    return outside(row[_CLEARANCE], wanted.clearance, np.inf)


@njit(cache=True)
def novelty(row: Int32Array, wanted: Wanted) -> float:
    """Cells that have still to differ from the most similar map of the archive."""
    return outside(row[_NOVELTY], wanted.novelty, np.inf)


@njit(cache=True)
def distances(statistics: Int32Array, controls: FloatArray, chosen: IntArray, wanted: Wanted, out: FloatArray) -> None:
    """Writes the weighted sum of all terms; 0 means that everything is met.

    Args:
        statistics: (n, len(Column)).
        controls: (n, len(Control)).
        chosen: Numbers of the maps.
        wanted: Targets and weights.
        out: (n,), written to.
    """
    for index in chosen:
        row, control, weights = statistics[index], controls[index], wanted.weights
        out[index] = (
            weights[0] * player(row)
            + weights[1] * crates(row, wanted)
            + weights[2] * targets(row, wanted)
            + weights[3] * regions(row)
            + weights[4] * walls(row, control)
            + weights[5] * solvable(row)
            + weights[6] * pushes(row, control)
            + weights[7] * occlusion(row, control)
            + weights[8] * dependency(row, control)
            + weights[9] * clearance(row, wanted)
            + weights[10] * novelty(row, wanted)
        )


def reward(before: FloatArray, after: FloatArray, settings: RewardSettings) -> FloatArray:
    """(n,) reward of edits that changed the distance from `before` to `after`."""
    gained: FloatArray = settings.scale * (before - after + settings.bonus * (after == 0))
    return gained

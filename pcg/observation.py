"""What a policy sees of an episode, as one flat vector.

The parts, in order: the map one-hot by tile; the frozen cells; the goal crate one-hot (all zero while there is none);
in flip the cells where the optimal solution moves crates, then those from which the player pushes them; with a position
also the position one-hot and the window around it, one-hot by tile with a sixth value for what is outside of the map, then
the window's frozen cells; last the scalars of `scalars`.
"""

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from pcg.arrays import BoolArray, Float32Array, IntArray
from pcg.episodes import Episodes, EpisodeSettings
from pcg.level import TileArray
from pcg.representation import N_TILES
from pcg.scalar_kernel import SCALARS, write_scalars
from pcg.statistics_kernel import CRATE_PASSES, PUSHED_FROM, Column

WINDOW = 5
"""Side of the window around the position."""


def observation_size(settings: EpisodeSettings) -> int:
    """Numbers in an observation."""
    size = settings.cells * (N_TILES + 2) + SCALARS
    if settings.has_position:
        size += settings.cells + WINDOW * WINDOW * (N_TILES + 2)
    elif settings.sees_solution:
        size += 2 * settings.cells
    return size


EVERY: Final = slice(None)
"""All episodes."""


def scalars(episodes: Episodes, chosen: IntArray | slice = EVERY) -> Float32Array:
    """(n, SCALARS) counts, distances, flags, controls and what is left of the budgets of the chosen episodes."""
    settings = episodes.settings
    distance = episodes.distance[chosen]
    numbers = np.empty((len(distance), SCALARS), dtype=np.float32)
    write_scalars(
        episodes.statistics[chosen],
        episodes.controls[chosen],
        distance,
        (episodes.changes[chosen], episodes.steps[chosen]),
        episodes.budgets,
        (settings.reward.crates, settings.reward.targets),
        settings.cells,
        numbers,
    )
    return numbers


def observation_parts(episodes: Episodes, chosen: IntArray | slice = EVERY) -> dict[str, npt.NDArray[Any]]:
    """The observations of `pcg.environment` of the chosen episodes, these as first axis: copies, not views."""
    settings = episodes.settings
    maps = episodes.maps[chosen].copy()
    goal = np.zeros((len(maps), settings.cells), dtype=np.uint8)
    crates = episodes.statistics[chosen, Column.GOAL]
    known = np.flatnonzero(crates >= 0)
    goal[known, crates[known]] = 1
    parts: dict[str, npt.NDArray[Any]] = {
        "map": maps,
        "frozen": episodes.frozen[chosen].copy(),
        "goal": goal.reshape(maps.shape),
        "scalars": scalars(episodes, chosen),
    }
    if settings.sees_solution:
        parts["solution"] = episodes.statistics[chosen, len(Column) :].astype(np.uint8).reshape(maps.shape)
    if episodes.representation.has_position:
        parts["position"] = episodes.coordinates[episodes.representation.positions()[chosen]]
    return parts


def flat_observations(parts: Mapping[str, npt.NDArray[Any]], settings: EpisodeSettings) -> Float32Array:
    """(n, observation_size) vectors of what `observation_parts` returned."""
    n = len(parts["map"])
    pieces = [
        (parts["map"].reshape(n, -1, 1) == np.arange(N_TILES)).reshape(n, -1),
        parts["frozen"].reshape(n, -1),
        parts["goal"].reshape(n, -1),
    ]
    if "solution" in parts:
        marks = parts["solution"].reshape(n, -1)
        pieces += [(marks & CRATE_PASSES) > 0, (marks & PUSHED_FROM) > 0]
    if "position" in parts:
        row, column = parts["position"].T
        pieces.append((row * settings.columns + column)[:, None] == np.arange(settings.cells))
        pieces.append(_windows(parts["map"], parts["frozen"], row, column))
    return np.concatenate([*(piece.astype(np.float32) for piece in pieces), parts["scalars"]], axis=1)


def observations(episodes: Episodes) -> Float32Array:
    """(n, observation_size) what a policy sees."""
    return flat_observations(observation_parts(episodes), episodes.settings)


def _windows(maps: TileArray, frozen: TileArray, rows: IntArray, columns: IntArray) -> BoolArray:
    """(n, WINDOW * WINDOW * 7) tiles and frozen cells around the positions."""
    n, margin = len(maps), WINDOW // 2
    border = ((0, 0), (margin, margin), (margin, margin))
    around = np.arange(WINDOW)
    cells = np.arange(n)[:, None, None], rows[:, None, None] + around[:, None], columns[:, None, None] + around
    tiles = np.pad(maps, border, constant_values=N_TILES)[cells].reshape(n, -1, 1)
    fixed = np.pad(frozen, border, constant_values=1)[cells].reshape(n, -1)
    return np.concatenate([(tiles == np.arange(N_TILES + 1)).reshape(n, -1), fixed == 1], axis=1)

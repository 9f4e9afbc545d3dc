"""What a policy sees of an episode, as one flat vector.

The parts, in order: the map one-hot by tile; the frozen cells; the goal crate one-hot (all zero while there is none);
with a position also the position one-hot and the window around it, one-hot by tile with a sixth value for what is outside
of the map, then the window's frozen cells; last the scalars of `scalars`.
"""

import numpy as np
import numpy.typing as npt

from pcg.episodes import Episodes, EpisodeSettings
from pcg.representation import N_TILES
from pcg.reward import Control
from pcg.statistics_kernel import Column

Float32Array = npt.NDArray[np.float32]

WINDOW = 5
"""Side of the window around the position."""

SCALARS = 24


def observation_size(settings: EpisodeSettings) -> int:
    """Numbers in an observation."""
    size = settings.cells * (N_TILES + 2) + SCALARS
    if settings.representation != "wide":
        size += settings.cells + WINDOW * WINDOW * (N_TILES + 2)
    return size


def scalars(episodes: Episodes) -> Float32Array:
    """(n, SCALARS) counts, distances, flags, budgets and controls, scaled to about -2 to 2."""
    s, c, settings = episodes.statistics, episodes.controls, episodes.settings
    wanted = settings.reward
    walls, pushes = s[:, Column.WALLS], s[:, Column.PUSHES]
    tenth = settings.cells / 10
    # An open band would be far outside of the range that a network knows.
    pushes_high = np.minimum(c[:, Control.PUSHES_HIGH], 40)
    parts = (
        np.clip(s[:, Column.PLAYERS] - 1, -1, 4) / 2,
        np.clip(s[:, Column.CRATES] - wanted.crates, -4, 4) / 2,
        np.clip(s[:, Column.TARGETS] - wanted.targets, -4, 4) / 2,
        np.clip(s[:, Column.REGIONS] - 1, -1, 4) / 2,
        walls / tenth / 2,
        np.clip(c[:, Control.WALLS_LOW] - walls, 0, 2 * tenth) / tenth,
        np.clip(walls - c[:, Control.WALLS_HIGH], 0, 2 * tenth) / tenth,
        s[:, Column.SOLVABLE],
        pushes / 10,
        np.clip(c[:, Control.PUSHES_LOW] - pushes, 0, 40) / 10,
        np.clip(pushes - c[:, Control.PUSHES_HIGH], 0, 40) / 10,
        s[:, Column.OCCLUDED],
        s[:, Column.DEPENDENCY],
        c[:, Control.WALLS_LOW] / tenth / 2,
        c[:, Control.WALLS_HIGH] / tenth / 2,
        c[:, Control.PUSHES_LOW] / 10,
        pushes_high / 10,
        c[:, Control.OCCLUDED],
        c[:, Control.DEPENDENCY],
        c[:, Control.OCCLUDED] * (2 * s[:, Column.OCCLUDED] - 1) * s[:, Column.SOLVABLE],
        c[:, Control.DEPENDENCY] * (2 * s[:, Column.DEPENDENCY] - 1) * s[:, Column.SOLVABLE],
        np.clip(episodes.distance / 10, 0, 2),
        1 - episodes.changes / settings.max_changes,
        1 - episodes.steps / settings.max_steps,
    )
    return np.stack(parts, axis=1).astype(np.float32)


def observations(episodes: Episodes) -> Float32Array:
    """(n, observation_size) observations."""
    n, settings = episodes.n, episodes.settings
    maps = episodes.maps.reshape(n, -1)
    parts = [
        (maps[:, :, None] == np.arange(N_TILES)).reshape(n, -1),
        episodes.frozen.reshape(n, -1),
        episodes.statistics[:, Column.GOAL, None] == np.arange(settings.cells),
    ]
    if episodes.representation.has_position:
        positions = episodes.representation.positions()
        parts += [positions[:, None] == np.arange(settings.cells), _window(episodes, positions)]
    return np.concatenate([*(part.astype(np.float32) for part in parts), scalars(episodes)], axis=1)


def _window(episodes: Episodes, positions: npt.NDArray[np.int64]) -> npt.NDArray[np.bool_]:
    """(n, WINDOW * WINDOW * 7) tiles and frozen cells around the positions."""
    n, columns, margin = episodes.n, episodes.settings.columns, WINDOW // 2
    border = ((0, 0), (margin, margin), (margin, margin))
    around = np.arange(WINDOW)
    rows = (positions // columns)[:, None, None] + around[:, None]
    cols = (positions % columns)[:, None, None] + around
    numbers = np.arange(n)[:, None, None]
    tiles = np.pad(episodes.maps, border, constant_values=N_TILES)[numbers, rows, cols].reshape(n, -1)
    frozen = np.pad(episodes.frozen, border, constant_values=1)[numbers, rows, cols].reshape(n, -1)
    one_hot = (tiles[:, :, None] == np.arange(N_TILES + 1)).reshape(n, -1)
    return np.concatenate([one_hot, frozen == 1], axis=1)

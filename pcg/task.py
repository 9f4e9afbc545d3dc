"""From a request to the beginning of editing episodes."""

import numpy as np

from pcg.arrays import FloatArray
from pcg.episodes import Beginning, EpisodeSettings
from pcg.errors import InputError
from pcg.frozen import FrozenTiles
from pcg.representation import N_TILES
from pcg.request import Request
from pcg.reward import Control
from pcg.start_maps import start_maps

_SIGN = {None: 0, False: -1, True: 1}


def request_controls(request: Request) -> FloatArray:
    """(len(Control),) controls of a request."""
    controls = np.zeros(len(Control))
    low, high = request.wall_density
    controls[Control.WALLS_LOW] = np.ceil(low * request.cells - 1e-9)
    controls[Control.WALLS_HIGH] = np.floor(high * request.cells + 1e-9)
    controls[Control.PUSHES_LOW], controls[Control.PUSHES_HIGH] = request.pushes
    controls[Control.OCCLUDED] = _SIGN[request.occluded]
    controls[Control.DEPENDENCY] = _SIGN[request.dependency]
    return controls


def require_fitting(request: Request, settings: EpisodeSettings, where: str) -> None:
    """Refuses a request that episodes with these settings cannot meet.

    Args:
        request: What is asked for.
        settings: Of the episodes.
        where: Who is asked; it begins the message.

    Raises:
        InputError: the size or the numbers of crates or targets differ, or a frozen tile is a player or a crate on a
            target.
    """
    able = settings.rows, settings.columns, settings.reward.crates, settings.reward.targets
    if able != (request.rows, request.columns, request.crates, request.targets):
        raise InputError(
            where,
            f"asked for {request.rows} x {request.columns} cells, {request.crates} crates and {request.targets} targets; "
            f"it makes {able[0]} x {able[1]} cells, {able[2]} crates and {able[3]} targets",
        )
    frozen = request.frozen
    if frozen is not None and (frozen.tiles[~frozen.is_open] > N_TILES - 1).any():
        raise InputError("frozen", "a player or a crate that stands on a target cannot be kept")


def request_beginning(rng: np.random.Generator, n: int, request: Request, settings: EpisodeSettings) -> Beginning:
    """Random start maps for n episodes with the same request."""
    controls = np.tile(request_controls(request), (n, 1))
    fixed = request.frozen or FrozenTiles.none(request.rows, request.columns)
    maps = start_maps(rng, controls, settings, fixed)
    return Beginning(maps, np.broadcast_to(~fixed.is_open, maps.shape).astype(np.uint8), controls)

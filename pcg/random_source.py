"""The random baseline: walls, player, crates and targets at random, kept if the exact solver accepts the level.

Every learned generator has to beat this one. For each level a wall density is drawn once, and kept over all attempts, so
that rejection does not prefer open levels. An attempt adds walls in random order, leaving out each that would divide
the free cells, until their number is reached; then it places everything else on distinct free cells. It is thrown away
if the level does not meet the request.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count

import numpy as np

from pcg.errors import InputError
from pcg.examine import examined
from pcg.frozen import FrozenTiles
from pcg.grid import count_regions
from pcg.level import Level, Tile, TileArray
from pcg.request import Proposal, Rejection, Request
from pcg.solver import default_max_states

CHUNK = 100
"""Attempts after which a source without success says so."""

_REASONS = (
    Rejection.WALLS,
    Rejection.UNSOLVABLE,
    Rejection.UNDECIDED,
    Rejection.EASY,
    Rejection.HARD,
    Rejection.DEPENDENCY,
)
"""In the order of the kernel's counts."""


@dataclass(frozen=True)
class RandomSource:
    """Draws levels at random.

    Attributes:
        max_states: Limit of the solver, None for its default.
        redraws_density: Draws the density anew after each chunk of attempts. That is faster where few densities can meet
            the request, and prefers those.
    """

    max_states: int | None = None
    redraws_density: bool = False
    representation: None = None
    weights_hash: None = None

    def proposals(self, request: Request, seed: int) -> Iterator[Proposal]:
        """Levels without end, each with a random generator of its own; see `LevelSource`.

        Raises:
            InputError: the frozen tiles contradict the request.
        """
        frozen, things = _start(request)
        for index in count():
            rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(index,)))
            yield from self._until_level(rng, request, frozen, things)

    def _until_level(
        self, rng: np.random.Generator, request: Request, frozen: FrozenTiles, things: TileArray
    ) -> Iterator[Proposal]:
        """Proposals without level, each after a chunk of attempts, then one with a level."""
        from pcg import random_kernel as kernel  # noqa: PLC0415  # importing pcg must not load Numba

        band, frozen_walls = _feasible_density(request, frozen), _count(frozen, Tile.WALL)
        density = rng.uniform(*band)
        tiles = np.empty(frozen.shape, dtype=np.uint8)
        dependency = {None: kernel.EITHER, False: kernel.NEVER, True: kernel.ALWAYS}[request.dependency]
        limit = (
            default_max_states(Level(np.zeros(frozen.shape, np.uint8))) if self.max_states is None else self.max_states
        )
        level = None
        while level is None:
            walls = round(density * request.cells) - frozen_walls
            counts = np.zeros(len(_REASONS), dtype=np.int64)
            found = kernel.draw_until(
                rng, frozen.tiles, walls, things, *request.pushes, dependency, limit, CHUNK, tiles, counts
            )
            rejected = Counter({reason.value: n for reason, n in zip(_REASONS, counts.tolist(), strict=True) if n})
            solution = None
            attempts = int(counts.sum()) + found
            if found:
                # The independent test of all that was asked for; the kernel leaves out the line of sight.
                outcome = examined(Level(tiles), request, self.max_states)
                if isinstance(outcome, Rejection):
                    rejected[outcome.value] += 1
                else:
                    level, solution = outcome
            steps = attempts * (walls + things.size)
            yield Proposal(level, solution, attempts, dict(rejected), steps, {"wall_density": density})
            if self.redraws_density:
                density = rng.uniform(*band)


def _start(request: Request) -> tuple[FrozenTiles, TileArray]:
    """The frozen tiles, and the tiles to place in the order of placing."""
    frozen = request.frozen or FrozenTiles.none(request.rows, request.columns)
    kept = Level(np.where(frozen.is_open, Tile.FLOOR, frozen.tiles))
    missing = []
    for name, wanted, tile, held in (
        ("player", 1, Tile.PLAYER, kept.is_player),
        ("crate", request.crates, Tile.CRATE, kept.is_crate),
        ("target", request.targets, Tile.TARGET, kept.is_target),
    ):
        if (n := int(held.sum())) > wanted:
            raise InputError("frozen", f"found {n} times {name}, but a level has {wanted}")
        missing += [tile] * (wanted - n)
    if count_regions(~kept.is_wall) > 1:
        raise InputError("frozen", "the fixed walls divide the other cells; no level has its free cells in one region")
    return frozen, np.array(missing, dtype=np.uint8)


def _feasible_density(request: Request, frozen: FrozenTiles) -> tuple[float, float]:
    """The band of the walls, without what the frozen walls exceed."""
    low, high = request.wall_density
    least = _count(frozen, Tile.WALL) / request.cells
    if least > high:
        raise InputError("frozen", f"{least:.0%} of the cells are walls, but at most {high:.0%} are wanted")
    return max(low, least), high


def _count(frozen: FrozenTiles, tile: Tile) -> int:
    return int((frozen.tiles == tile).sum())

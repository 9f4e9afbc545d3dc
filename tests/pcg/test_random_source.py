from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from pcg.compare import two_rooms
from pcg.dependency import has_dependency
from pcg.errors import InputError
from pcg.frozen import OPEN, FrozenTiles
from pcg.level import Tile
from pcg.metrics import occluded
from pcg.random_source import CHUNK, RandomSource
from pcg.request import Rejection, Request


@pytest.mark.parametrize(
    "request_",
    [
        Request(pushes=(5, 7), wall_density=(0.1, 0.12)),
        Request(occluded=True),
        Request(occluded=False, wall_density=(0.2, 0.2)),
        Request(dependency=True, wall_density=(0.25, 0.3)),
        Request(dependency=False),
        Request(frozen=two_rooms(), pushes=(4, 30)),
    ],
    ids=["bands", "occluded", "visible", "dependency", "no dependency", "frozen"],
)
def test_levels_are_what_was_asked_for(request_: Request):
    """Bands, sight, dependency and frozen tiles, tested one by one."""
    levels = [p for p in islice(RandomSource().proposals(request_, 1), 60) if p.level is not None][:5]
    assert levels
    for proposal in levels:
        level, solution = proposal.level, proposal.solution
        assert level is not None
        assert solution is not None
        assert level.goal_crate is not None
        assert solution.pushes is not None
        assert request_.pushes[0] <= solution.pushes <= request_.pushes[1]
        low, high = request_.wall_density
        assert round(100 * low) <= level.is_wall.sum() <= round(100 * high)
        assert request_.occluded in {None, occluded(level, level.goal_crate)}
        assert request_.dependency in {None, has_dependency(level)}
        assert request_.frozen is None or request_.frozen.kept_by(level)


def test_attempts_are_accounted_for():
    """Every attempt is a level or has a reason, and chunks without success are told too."""
    proposals = list(islice(RandomSource().proposals(Request(pushes=(14, 100)), 3), 12))
    for proposal in proposals:
        assert proposal.attempts == sum(proposal.rejected.values()) + (proposal.level is not None)
        assert proposal.attempts <= CHUNK
        assert proposal.steps > proposal.attempts
    assert any(proposal.level is None for proposal in proposals)


def test_density_stays_until_a_level_is_found_unless_told_otherwise():
    """By default rejection does not prefer densities with many levels; redrawing after each chunk does."""
    hard = Request(pushes=(30, 1000))
    for redraws in (False, True):
        proposals = islice(RandomSource(redraws_density=redraws).proposals(hard, 0), 4)
        densities = {proposal.targets["wall_density"] for proposal in proposals if proposal.level is None}
        assert (len(densities) > 1) == redraws


@pytest.mark.parametrize(
    ("tiles", "problem"),
    [
        ([[Tile.WALL, OPEN], [OPEN, Tile.WALL]], "divide the other cells"),
        ([[Tile.PLAYER, Tile.PLAYER], [OPEN, OPEN]], "found 2 times player, but a level has 1"),
        ([[Tile.WALL, Tile.WALL], [OPEN, OPEN]], "50% of the cells are walls, but at most 30% are wanted"),
    ],
)
def test_frozen_tiles_that_no_level_can_keep(tiles: list[list[int]], problem: str):
    """One line says why, before any attempt."""
    frozen = FrozenTiles(np.kron(np.array(tiles), np.ones((1, 1), dtype=np.int64)))
    request = Request(rows=2, columns=2, crates=1, frozen=frozen)
    with pytest.raises(InputError, match=problem):
        next(RandomSource().proposals(request, 0))


def test_undecided_levels_are_thrown_away():
    """A solver without states decides nothing."""
    first = next(RandomSource(max_states=1).proposals(replace(Request(), pushes=(2, 9)), 0))
    assert first.rejected.keys() <= {Rejection.UNDECIDED, Rejection.UNSOLVABLE, Rejection.EASY}
    assert first.rejected[Rejection.UNDECIDED] > 0

import numpy as np
import pytest

from pcg.level import Tile, TileArray
from pcg.representation import KEEP, N_TILES, REPRESENTATIONS, Flip, Narrow, Turtle, Wide

SHAPE = (3, 4)


def empty(n: int) -> TileArray:
    """Maps of floor."""
    return np.full((n, *SHAPE), Tile.FLOOR, dtype=np.uint8)


def test_narrow_visits_every_cell_once_a_round_in_an_order_of_its_own():
    """Twelve steps visit twelve cells; the next round repeats the order; episodes differ."""
    narrow = Narrow(SHAPE, 2)
    narrow.begin(np.random.default_rng(0), np.array([0, 1]))
    visited = np.array([narrow.step(np.array([0, 0]), empty(2))[0] for _ in range(24)])
    assert all(sorted(visited[:12, k]) == list(range(12)) for k in (0, 1))
    assert (visited[:12] == visited[12:]).all()
    assert (visited[:, 0] != visited[:, 1]).any()


def test_narrow_keeps_or_writes():
    """Action 0 keeps the tile, action 1 + t writes tile t."""
    narrow = Narrow(SHAPE, 6)
    assert narrow.step(np.arange(6), empty(6))[1].tolist() == [KEEP, 0, 1, 2, 3, 4]


def test_an_order_depends_on_the_generator_alone():
    """The order of an episode does not depend on the one before."""
    narrow = Narrow(SHAPE, 1)
    orders = []
    for _ in range(2):
        narrow.begin(np.random.default_rng(5), np.array([0]))
        orders.append([int(narrow.step(np.array([0]), empty(1))[0][0]) for _ in range(12)])
    assert orders[0] == orders[1]


def test_turtle_walks_and_stops_at_the_edge():
    """Left, up, right, down move by one cell; over the edge nothing happens; writing stays."""
    turtle = Turtle(SHAPE, 1)
    turtle.begin(np.random.default_rng(0), np.array([0]))
    for _ in range(4):
        for action in (0, 1):
            turtle.step(np.array([action]), empty(1))
    places = [int(turtle.positions()[0])]
    for action in (2, 3, 0, 1, 1, 0, 4):
        turtle.step(np.array([action]), empty(1))
        places.append(int(turtle.positions()[0]))
    assert places == [0, 1, 5, 4, 0, 0, 0, 0]


def test_turtle_writes_where_it_stands():
    """Actions from 4 on write tiles at the position, the others nothing."""
    turtle = Turtle(SHAPE, 9)
    turtle.begin(np.random.default_rng(1), np.arange(9))
    here = turtle.positions()
    cells, tiles = turtle.step(np.arange(9), empty(9))
    assert cells.tolist() == here.tolist()
    assert tiles.tolist() == [KEEP] * 4 + [0, 1, 2, 3, 4]


def test_wide_reaches_every_tile_of_every_cell():
    """All actions together write each tile on each cell once."""
    wide = Wide(SHAPE, 60)
    cells, tiles = wide.step(np.arange(wide.n_actions), empty(60))
    assert wide.n_actions == 60
    assert set(zip(cells.tolist(), tiles.tolist(), strict=True)) == {(c, t) for c in range(12) for t in range(N_TILES)}


def test_flip_exchanges_wall_and_floor_and_keeps_things():
    """The tile written at the cell of the action is floor for a wall, a wall for floor, and nothing on anything else."""
    flip = Flip(SHAPE, len(Tile))
    maps = empty(len(Tile))
    maps[:, 2, 1] = list(Tile)
    cells, tiles = flip.step(np.full(len(Tile), 9), maps)
    assert flip.n_actions == 12
    assert cells.tolist() == [9] * len(Tile)
    assert tiles.tolist() == [Tile.WALL, Tile.FLOOR, *[KEEP] * 5]


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_positions_are_cells(name: str):
    """Whatever is done, positions and written cells are on the map."""
    rng = np.random.default_rng(2)
    representation = REPRESENTATIONS[name](SHAPE, 5)
    representation.begin(rng, np.arange(5))
    maps = rng.integers(N_TILES, size=(5, *SHAPE), dtype=np.uint8)
    for _ in range(50):
        cells, tiles = representation.step(rng.integers(representation.n_actions, size=5), maps)
        for found in (cells, representation.positions()):
            assert ((found >= 0) & (found < 12)).all()
        assert ((tiles >= KEEP) & (tiles < N_TILES)).all()

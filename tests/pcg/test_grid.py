import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from pcg.arrays import BoolArray
from pcg.grid import DIRECTIONS, Cell, cells_of, count_regions, reachable, shortest_walk

MASKS = hnp.arrays(np.bool_, hnp.array_shapes(min_dims=2, max_dims=2, max_side=6))


def distances(passable: BoolArray, start: Cell) -> dict[Cell, int]:
    """Walking distance to every cell that can be reached, by relaxing all neighbours until nothing changes."""
    found = {start: 0} if passable[start] else {}
    changed = True
    while changed:
        changed = False
        for row, column in cells_of(passable):
            near = [(row + down, column + right) for down, right in DIRECTIONS.values()]
            best = min((found[cell] + 1 for cell in near if cell in found), default=None)
            if best is not None and best < found.get((row, column), best + 1):
                found[row, column] = best
                changed = True
    return found


@given(MASKS, st.data())
def test_walks_and_reachable_cells_agree_with_relaxation(passable: BoolArray, data: st.DataObject):
    """Exactly the cells at a finite distance are reachable, by walks of that length over passable cells."""
    cells = [(row, column) for row, column in np.ndindex(passable.shape)]
    start, end = data.draw(st.sampled_from(cells)), data.draw(st.sampled_from(cells))
    found = distances(passable, start)
    assert set(cells_of(reachable(passable, [start]))) == set(found)
    if not passable[start]:
        return
    walk = shortest_walk(passable, start, end)
    assert (walk is None) == (end not in found)
    if walk is not None:
        assert len(walk) == found[end]
        cell = start
        for letter in walk:
            cell = cell[0] + DIRECTIONS[letter][0], cell[1] + DIRECTIONS[letter][1]
            assert passable[cell]
        assert cell == end


@given(MASKS)
def test_regions_partition_the_passable_cells(passable: BoolArray):
    """As many regions are counted as floods are needed to cover all passable cells."""
    rest, floods = passable.copy(), 0
    while rest.any():
        rest &= ~reachable(passable, cells_of(rest)[:1])
        floods += 1
    assert count_regions(passable) == floods


def test_diagonal_cells_are_no_neighbours():
    """Cells that share a corner only are two regions."""
    assert count_regions(np.eye(3, dtype=bool)) == 3


def test_equal_walks_are_broken_in_lurd_order():
    """Of two shortest walks the one whose first letter comes first in LURD is taken, every time."""
    assert shortest_walk(np.ones((2, 2), dtype=bool), (1, 1), (0, 0)) == "lu"


def test_cells_are_in_reading_order():
    """Cells are listed row by row as plain integers."""
    cells = cells_of(np.array([[False, True], [True, True]]))
    assert cells == [(0, 1), (1, 0), (1, 1)]
    assert type(cells[0][0]) is int

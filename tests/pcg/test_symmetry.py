from itertools import product

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from pcg.level import Level, Tile
from pcg.symmetry import canonical, content_hash, symmetries

TILES = hnp.arrays(
    np.uint8, hnp.array_shapes(min_dims=2, max_dims=2, max_side=4), elements=st.integers(0, len(Tile) - 1)
)


def test_the_eight_symmetries_by_hand():
    """Four turns counter-clockwise, then the four of the mirror image; the goal crate follows."""
    level = Level(np.array([[3, 1, 0], [2, 4, 0]]), "a", (0, 0))
    images = symmetries(level)
    assert images[0] == level
    assert images[1] == Level(np.array([[0, 0], [1, 4], [3, 2]]), "a", (2, 0))
    assert images[2] == Level(np.array([[0, 4, 2], [0, 1, 3]]), "a", (1, 2))
    assert images[4] == Level(np.array([[0, 1, 3], [0, 4, 2]]), "a", (0, 2))
    assert len(set(images)) == 8


@given(TILES, st.integers(0, 7), st.data())
def test_symmetric_levels_have_one_representative(tiles: np.ndarray, which: int, data: st.DataObject):
    """Canonical level and hash are the same for all eight, the representative is one of them."""
    crates = Level(tiles).crates
    level = Level(tiles, "a", data.draw(st.sampled_from(crates)) if crates else None)
    image = symmetries(level)[which]
    assert canonical(image) == canonical(level)
    assert content_hash(image) == content_hash(level)
    assert canonical(level) in symmetries(level)


def test_hashes_differ_for_levels_that_are_not_symmetric():
    """Among all levels of 2 x 3 and 3 x 2 floors, walls and crates there are as many hashes as orbits."""
    levels = [
        Level(np.array(tiles).reshape(shape)) for shape in ((2, 3), (3, 2)) for tiles in product((0, 1, 3), repeat=6)
    ]
    orbits = {frozenset(symmetries(level)) for level in levels}
    assert len({content_hash(level) for level in levels}) == len(orbits)
    # Burnside: of the 2 * 3**6 levels, the four symmetries that keep the shape fix all, 3**3, 3**4 and 3**3 in each
    # shape; those that exchange the shapes fix none.
    assert len(orbits) == 2 * (3**6 + 3**3 + 3**4 + 3**3) / 8


def test_names_and_goal_crates_do_not_count():
    """The hash is over tiles alone."""
    tiles = np.array([[3, 0, 3]])
    assert content_hash(Level(tiles)) == content_hash(Level(tiles, "a", (0, 2)))


def test_hashes_keep_their_value():
    """Hashes are written to manifests, so they must not change between versions."""
    assert content_hash(Level(np.array([[2, 3, 4]]))) == "020eceb14ba93b89"

from pathlib import Path

import numpy as np
import pytest

from pcg.errors import InputError
from pcg.frozen import OPEN, FrozenTiles, read_frozen
from pcg.level import Level, Tile

TEXT = "text before\n######\n#?# .#\n#@??$#\n######\n\n"


def test_frozen_tiles_are_read(tmp_path: Path):
    """Question marks are open, all other characters those of levels; the outer wall is left out."""
    (tmp_path / "f.txt").write_text(TEXT)
    frozen = read_frozen(tmp_path / "f.txt")
    assert frozen.tiles.tolist() == [
        [OPEN, Tile.WALL, Tile.FLOOR, Tile.TARGET],
        [Tile.PLAYER, OPEN, OPEN, Tile.CRATE],
    ]
    assert frozen.is_open.tolist() == [[True, False, False, False], [False, True, True, False]]


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "no frozen tiles found"),
        ("####\n####\n", "no frozen tiles found"),
        ("####\n#?x#\n####\n", "line 2: column 3 holds 'x'"),
        ("####\n#?#\n####\n", "line 2: 3 characters, but the first line has 4"),
        ("####\n#???\n####\n", "line 2: the outer wall has a gap"),
        ("####\n#??#\n#??#\n", "line 3: the outer wall has a gap"),
        ("####\n ??#\n#??#\n####\n", "line 2: the outer wall has a gap"),
        ("####\n#??#\nremark\n####\n", "line 3: 6 characters, but the first line has 4"),
        ("##\n##\n##\n", "the walls enclose no cell"),
        ("#" * 1001 + "\n#\n#\n", "at most 1000 x 1000"),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, text: str, problem: str):
    """One line with file, line and reason."""
    (tmp_path / "f.txt").write_text(text)
    with pytest.raises(InputError, match=rf"f\.txt: .*{problem}|f\.txt: {problem}"):
        read_frozen(tmp_path / "f.txt")


def test_levels_keep_frozen_tiles_or_not():
    """Every fixed tile counts, open cells do not, nor does a level of another shape."""
    frozen = FrozenTiles(np.array([[OPEN, Tile.WALL], [Tile.FLOOR, OPEN]]))
    assert frozen.kept_by(Level(np.array([[Tile.CRATE, Tile.WALL], [Tile.FLOOR, Tile.WALL]])))
    assert not frozen.kept_by(Level(np.array([[Tile.CRATE, Tile.FLOOR], [Tile.FLOOR, Tile.WALL]])))
    assert not frozen.kept_by(Level(np.array([[Tile.CRATE, Tile.WALL]])))
    assert FrozenTiles.none(3, 2).kept_by(Level(np.zeros((3, 2), dtype=np.uint8)))


@pytest.mark.parametrize("tile", [77, 256, -1, 0.5])
def test_unknown_tiles_are_refused(tile: float):
    """A number that is no tile is a mistake of the programmer; none wraps around into a valid one."""
    with pytest.raises(ValueError, match="Tile values or OPEN"):
        FrozenTiles(np.array([[tile]]))

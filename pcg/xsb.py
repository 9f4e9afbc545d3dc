"""Reading and writing levels as XSB text, the format that every Sokoban tool knows.

`#` wall, space, `-` or `_` floor, `@` player, `+` player on target, `$` crate, `*` crate on target, `.` target. A level
is a block of lines that begin with a wall, after any floor, or hold nothing but the characters above; a blank or any
other line ends it. All other lines are text, those of asterisks alone too, which part the mazes of XSokoban. Two kinds of text name a level, and the first of these found is its name:

1. a `Title:` line below the level, with no blank line between them and the level;
2. the last `; name` line above it, again with no blank line between (Boxoban);
3. the first `; name` line below it, again with no blank line between;
4. the last `; name` line anywhere between the level before and this one (Microban).

In 2 to 4 a `Title:` line will do too. A line names one level only. A level without a name is called after the file and
its number, counted from 1: `file-1`.
"""

import codecs
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import takewhile
from os.path import commonprefix
from pathlib import Path

import numpy as np

from pcg.errors import InputError
from pcg.files import read_bytes, write_text
from pcg.grid import cells_of, reachable
from pcg.level import Level, Tile, TileArray

MAX_SIDE = 1_000
"""Rows and columns of a level, with its outer wall."""
MAX_CELLS = 20_000_000
"""Cells of all levels in a file; also the bytes of a file."""

_CHARACTERS = {
    Tile.FLOOR: " ",
    Tile.WALL: "#",
    Tile.PLAYER: "@",
    Tile.CRATE: "$",
    Tile.TARGET: ".",
    Tile.CRATE_ON_TARGET: "*",
    Tile.PLAYER_ON_TARGET: "+",
}
TILE_OF_CHARACTER = {character: tile for tile, character in _CHARACTERS.items()} | {"-": Tile.FLOOR, "_": Tile.FLOOR}
_ROW = re.compile(r"[ \t_-]*#|(?!\*+[ \t]*$)[ _-]*[@+$*.][ _@+$*.#-]*$")
_TITLE = re.compile(r"title\s*:(.*)", re.IGNORECASE)


def read_levels(path: Path) -> list[Level]:
    """Reads every level of an XSB file.

    Raises:
        InputError: naming file and line; see `parse_levels`.
    """
    return list(iter_levels(path))


def iter_levels(path: Path) -> Iterator[Level]:
    """The levels of an XSB file one by one, so that only its text is held.

    Raises:
        InputError: naming file and line, when that line is reached; see `parse_levels`.
    """
    yield from _levels(_decoded(read_bytes(path, max_bytes=MAX_CELLS)), str(path))


def _decoded(data: bytes) -> str:
    """Text as old collections have it too: in UTF-8, in UTF-16 with its mark, or else in Latin-1, for names of people."""
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        text = data.decode("utf-16", errors="replace")
    else:
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = data.decode("latin-1")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def write_levels(path: Path, levels: Iterable[Level]) -> None:
    """Writes levels to an XSB file, which `read_levels` reads back but for their goal crates.

    Raises:
        ValueError: two levels have the same name.
        InputError: the file cannot be written.
    """
    levels = list(levels)
    names = [level.name for level in levels if level.name]
    if repeated := sorted({name for name in names if names.count(name) > 1}):
        raise ValueError(f"level names must differ, found {', '.join(repeated)} twice")
    write_text(path, "\n".join(format_level(level) for level in levels))


def format_level(level: Level) -> str:
    """The XSB text of a level: a `; name` line if it has a name, then its rows within the outer wall."""
    tiles = np.pad(level.tiles, 1, constant_values=Tile.WALL)
    rows = ["".join(_CHARACTERS[Tile(tile)] for tile in row) for row in tiles.tolist()]
    return "\n".join([*([f"; {level.name}"] if level.name else []), *rows, ""])


def parse_levels(text: str, where: str) -> list[Level]:
    """The levels of an XSB text, without their outer walls.

    Cells outside of the walls that enclose a level become walls.

    Args:
        text: Lines end with LF or CR LF.
        where: The file's path; it begins every error message, and unnamed levels are called after its stem.

    Raises:
        InputError: there is no level, a row holds an unknown character, a level is too large, is not enclosed by
            walls, is not playable (`Level.require_playable`), or has the name of an earlier one.
    """
    return list(_levels(text, where))


def _levels(text: str, where: str) -> Iterator[Level]:
    lines_of_names: dict[str, int] = {}
    cells = 0
    for number, block in enumerate(_named_blocks(text), start=1):
        level = _level(block, where)
        cells += level.tiles.size
        if cells > MAX_CELLS:
            raise InputError(_at(where, block.line), f"the levels have more than {MAX_CELLS} cells")
        name = block.name or _as_name(f"{Path(where).stem}-{number}")
        if (first := lines_of_names.setdefault(name, block.line)) != block.line:
            raise InputError(_at(where, block.line), f"name {name!r} is taken by the level at line {first}")
        yield replace(level, name=name)
    if not lines_of_names:
        raise InputError(where, "no level found: no line begins with a wall '#'")


@dataclass(frozen=True)
class _Block:
    """Consecutive rows, the first of them on line `line` counted from 1, and the name that the text gives them."""

    line: int
    rows: list[str]
    name: str


def _named_blocks(text: str) -> Iterator[_Block]:
    lines = text.replace("\r\n", "\n").split("\n")
    used: set[int] = set()
    end = 0
    while (start := next((i for i in range(end, len(lines)) if _ROW.match(lines[i])), None)) is not None:
        before = end
        # One row too many is enough to refuse it.
        last = min(start + MAX_SIDE + 1, len(lines))
        end = next((i for i in range(start, last) if not _ROW.match(lines[i])), last)
        named = next((i for i in _naming_lines(lines, before, start, end) if i not in used), None)
        if named is not None:
            used.add(named)
        yield _Block(start + 1, lines[start:end], "" if named is None else _offered_name(lines[named]))


def _naming_lines(lines: list[str], before: int, start: int, end: int) -> Iterator[int]:
    """The lines that may name the rows `start` to `end`, best first; the rows before them ended at `before`."""
    text_above = range(start - 1, before - 1, -1)
    above = list(takewhile(lambda i: lines[i].strip(), text_above))
    below = list(takewhile(lambda i: lines[i].strip() and not _ROW.match(lines[i]), range(end, len(lines))))
    yield from (i for i in below if _TITLE.match(lines[i].strip()))
    yield from (i for i in (*above, *below, *text_above) if _offered_name(lines[i]))


def _offered_name(line: str) -> str:
    line = line.strip()
    title = _TITLE.match(line)
    return _as_name(title[1] if title else line[1:] if line.startswith(";") else "")


def _as_name(text: str) -> str:
    kept = "".join(character for character in text if character.isprintable() or character.isspace())
    return " ".join(kept.split())


def _level(block: _Block, where: str) -> Level:
    tiles = _tiles(block, where)
    # The ring of floor around the rows joins all that is outside.
    is_wall = tiles == Tile.WALL
    outside = reachable(~is_wall, [(0, 0)])
    if lost := cells_of(outside & (tiles != Tile.FLOOR)):
        row, column = lost[0]
        thing = Tile(tiles[row, column]).name.lower().replace("_", " ")
        problem = f"the {thing} in column {column} is not enclosed by walls"
        raise InputError(_at(where, block.line + row - 1), problem)
    rows, columns = (np.flatnonzero(is_wall.any(axis=axis)) for axis in (1, 0))
    inner = np.where(outside, Tile.WALL, tiles)[rows[0] + 1 : rows[-1], columns[0] + 1 : columns[-1]]
    if inner.size == 0:
        raise InputError(_at(where, block.line), "the walls enclose no cell")
    level = Level(inner)
    level.require_playable(_at(where, block.line))
    return level


def _tiles(block: _Block, where: str) -> TileArray:
    """The (rows + 2, columns + 2) tiles of a block within a ring of floor."""
    # Tabs in front of all rows alike are a margin, whatever their width.
    margins = [row[: len(row) - len(row.lstrip(" \t"))] for row in block.rows]
    margin = len(commonprefix(margins))  # noqa: RUF071  # of texts, not of paths
    rows = [" " * margin + row[margin:].rstrip(" \t-_") for row in block.rows]
    columns = max(map(len, rows))
    if max(len(rows), columns) > MAX_SIDE:
        problem = f"the level has {len(rows)} x {columns} cells; at most {MAX_SIDE} x {MAX_SIDE} are read"
        raise InputError(_at(where, block.line), problem)
    tiles = np.full((len(rows) + 2, columns + 2), Tile.FLOOR, dtype=np.uint8)
    for i, row in enumerate(rows):
        if unknown := set(row) - TILE_OF_CHARACTER.keys():
            column = min(map(row.index, unknown))
            allowed = "use spaces" if row[column] == "\t" else "allowed are # @ + $ * . and, for floor, space - _"
            problem = f"column {column + 1} holds {row[column]!r}; {allowed}"
            raise InputError(_at(where, block.line + i), problem)
        tiles[i + 1, 1 : len(row) + 1] = [TILE_OF_CHARACTER[character] for character in row]
    return tiles


def _at(where: str, line: int) -> str:
    return f"{where}: line {line}"

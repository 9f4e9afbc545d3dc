from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pcg.errors import InputError
from pcg.level import Level
from pcg.xsb import MAX_CELLS, MAX_SIDE, format_level, iter_levels, parse_levels, read_levels, write_levels

A = "#####\n#@$.#\n#####"
B = "#####\n#.$@#\n#####"


def names(text: str) -> list[str]:
    """Names of the levels of a text from `file.xsb`, after checking that they are A and B."""
    levels = parse_levels(text, "folder/file.xsb")
    assert [level.tiles.tolist() for level in levels] == [[[2, 3, 4]], [[4, 3, 2]]]
    return [level.name for level in levels]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (f"; 0\n{A}\n\n; 1\n{B}\n", ["0", "1"]),
        (f"; 0\n{A}\n; 1\n{B}\n", ["0", "1"]),
        (f"; All\n\n; 1\n\n{A}\n\n; 2\n\n{B}\n\n", ["1", "2"]),
        (f"{A}\n; 1\n\n{B}\n; 2\n", ["1", "2"]),
        (f"{A}\n; 1\n{B}\n; 2\n", ["1", "2"]),
        (f"; All\n\n{A}\n; 1\n\n{B}\n; 2\n", ["1", "2"]),
        (f"Author: Me\nCollection: Mine\n\n{A}\nAuthor: Me\nTitle: One\n\n{B}\ntitle : Two\n", ["One", "Two"]),
        (f"Level 1\n\n{A}\nEasy.\n\n\n{B}", ["file-1", "file-2"]),
        (f"{A}\n\n{B}\n; 2", ["file-1", "2"]),
        (f";\n{A}\n;  \n\n;x:  y\t z \n{B}", ["file-1", "x: y z"]),
        (f"; remark\n; 1\n{A}\n; note\n\n{B}", ["1", "note"]),
        (f"Maze: 1\nLength: 9\n\n{A}\n\n*****\nMaze: 2\n\n{B}\n*****\n", ["file-1", "file-2"]),
    ],
    ids=[
        "boxoban", "no blank lines", "microban", "below", "below, no blank lines", "headed, below", "sok", "plain text",
        "one named", "empty remarks", "nearest", "xsokoban",
    ],
)  # fmt: skip
def test_names(text: str, expected: list[str]):
    """Names are found above and below levels, whichever way a collection writes them."""
    assert names(text) == expected
    assert names(text.replace("\n", "\r\n")) == expected


@pytest.mark.parametrize("title", ["\0 a b", "a\u200b \u200b b\xa0", "\x1ba\x1f\0 b \0"])
def test_names_keep_what_can_be_printed(title: str):
    """What cannot be is left out together with the space that it held apart."""
    assert names(f"; {title}\n{A}\n\n{B}")[0] == "a b"


def test_ragged_lines_and_all_floors():
    """Indented levels, open corners and the three characters of floor are read; what is outside becomes wall."""
    (level,) = parse_levels(
        """
          ####
        ###  ####-
        #  -$ _ #
        #.#  @###__
        ###  *#
          ####
        """,
        "file.xsb",
    )
    assert format_level(replace(level, name="")).splitlines() == [
        "#########",
        "###  ####",
        "#   $   #",
        "#.#  @###",
        "###  *###",
        "#########",
    ]


def test_only_one_ring_of_wall_is_stripped():
    """Levels keep their size, with walls beside the outer wall."""
    (level,) = parse_levels("######\n######\n#@$.##\n######", "file.xsb")
    assert level.shape == (2, 4)


def test_enclosed_floor_out_of_reach_stays_floor():
    """Only what is open to the outside becomes wall."""
    (level,) = parse_levels("#######\n#@$.# #\n#######", "file.xsb")
    assert level.tiles.tolist() == [[2, 3, 4, 1, 0]]


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "file.xsb: no level found"),
        ("3#|#@$.#", "file.xsb: no level found"),
        ("\n" + A.replace("$", "B"), "file.xsb: line 3: column 3 holds 'B'; allowed are # "),
        (A + "\t#", r"line 3: column 6 holds '\\t'"),
        ("\t" + A, r"line 1: column 1 holds '\\t'"),
        ("####\n#@$.\n####", "line 2: the player in column 2 is not enclosed by walls"),
        ("## ##\n#@$.#\n#####", "line 2: the player in column 2"),
        (" @$.", "line 1: the player in column 2"),
        (A + "\n#   $", "line 4: the crate in column 5"),
        ("####\n####", "line 1: the walls enclose no cell"),
        ("#", "line 1: the walls enclose no cell"),
        ("#####\n# $.#\n#####", "line 1: the level has no players"),
        (f"{A}\n\n#####\n#@@.#\n#####", "line 5: the level has 2 players"),
        ("######\n#@$..#\n######", "line 1: the level has fewer crates"),
        ("#####\n#@$ #\n#####", "line 1: the level has no target"),
        (f"; 1\n{A}\n\n; 1\n{B}", "line 7: name '1' is taken by the level at line 2"),
        ("#" * (MAX_SIDE + 1), f"line 1: the level has 1 x {MAX_SIDE + 1} cells"),
        ("#\n" * (MAX_SIDE + 1), f"line 1: the level has {MAX_SIDE + 1} x 1 cells"),
    ],
)
def test_bad_files_are_refused(text: str, problem: str):
    """The one-line message names file, line, what was found and, where it helps, what is allowed."""
    with pytest.raises(InputError, match=problem) as error:
        parse_levels(text, "file.xsb")
    assert "\n" not in str(error.value)


def test_the_cells_of_a_file_are_bounded(monkeypatch: pytest.MonkeyPatch):
    """Many large levels in little text do not fill the memory."""
    monkeypatch.setattr("pcg.xsb.MAX_CELLS", 5)
    parse_levels(A, "file.xsb")
    with pytest.raises(InputError, match="line 5: the levels have more than 5 cells"):
        parse_levels(f"{A}\n\n{B}", "file.xsb")


def test_large_files_are_not_read(tmp_path: Path):
    """A file beyond the limit is refused by its size alone."""
    path = tmp_path / "large.xsb"
    with path.open("wb") as file:
        file.truncate(MAX_CELLS + 1)
    with pytest.raises(InputError, match=r"large\.xsb: larger than 20 MB"):
        read_levels(path)


def test_a_missing_file_is_named(tmp_path: Path):
    """The path is part of the message."""
    with pytest.raises(InputError, match=r"absent\.xsb: no such file"):
        read_levels(tmp_path / "absent.xsb")


@st.composite
def playable_levels(draw: st.DrawFn) -> Level:
    """Levels that may be written and read: one player, and no fewer crates than targets."""
    shape = draw(st.tuples(st.integers(1, 5), st.integers(3, 5)))
    player, crate, *rest = draw(st.permutations(list(np.ndindex(shape))))
    target = draw(st.sampled_from([player, crate, *rest]))
    is_wall = np.zeros(shape, dtype=np.bool_)
    for cell in draw(st.lists(st.sampled_from([cell for cell in rest if cell != target] or rest[:0] or [None]))):
        if cell is not None:
            is_wall[cell] = True
    return Level.of(is_wall, players=[player], crates=[crate], targets=[target])


@given(st.lists(playable_levels(), min_size=1, max_size=4), st.data())
def test_files_are_read_back_as_written(levels: list[Level], data: st.DataObject):
    """Writing and reading levels with any names changes nothing."""
    name = st.text(max_size=8).map(lambda text: "".join(c for c in " ".join(text.split()) if c.isprintable()).strip())
    chosen = data.draw(st.lists(name.filter(bool), min_size=len(levels), max_size=len(levels), unique=True))
    named = [replace(level, name=name) for level, name in zip(levels, chosen, strict=True)]
    assert parse_levels("\n".join(map(format_level, named)), "file.xsb") == named


def test_written_files_are_standard(tmp_path: Path):
    """Every character by hand, with the outer wall and a title line."""
    path = tmp_path / "new" / "levels.xsb"
    first = Level(np.array([[0, 1, 2, 3], [0, 4, 5, 3]]), "first")
    write_levels(path, [first, replace(first, name="")])
    rows = "######\n# #@$#\n# .*$#\n######\n"
    assert path.read_text(encoding="utf-8") == f"; first\n{rows}\n{rows}"
    assert read_levels(path) == [first, replace(first, name="levels-2")]
    assert "+" in format_level(Level(np.array([[6]])))


def test_two_levels_of_one_name_are_not_written(tmp_path: Path):
    """Nobody could tell them apart; nothing is written."""
    level = Level(np.array([[2, 3, 4]]), "same")
    with pytest.raises(ValueError, match="found same twice"):
        write_levels(tmp_path / "levels.xsb", [level, level])
    assert not list(tmp_path.iterdir())


def test_levels_come_one_by_one(tmp_path: Path):
    """The levels before a broken one are there before it is reached."""
    path = tmp_path / "levels.xsb"
    path.write_text("#####\n#@$.#\n#####\n\n#####\n#@$?#\n#####\n")
    levels = iter_levels(path)
    assert next(levels).name == "levels-1"
    with pytest.raises(InputError, match=r"line 6: column 4 holds '\?'"):
        next(levels)


def test_tabs_are_a_margin_only():
    """In front of all rows alike, or behind them; elsewhere nobody knows how wide they are."""
    plain = "######\n#@ $.#\n######\n"
    (level,) = parse_levels("".join(f"\t{row}\t\n" for row in plain.splitlines()), "file.xsb")
    np.testing.assert_array_equal(level.tiles, parse_levels(plain, "file.xsb")[0].tiles)
    with pytest.raises(InputError, match=r"file.xsb: line 2: column 3 holds '\\t'; use spaces"):
        parse_levels(plain.replace("@ ", "@\t"), "file.xsb")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_old_encodings_are_read(tmp_path: Path, encoding: str):
    """Titles of collections hold names of people, in whatever encoding was usual."""
    file = tmp_path / "a.xsb"
    file.write_bytes("; Ren\xe9\r\n######\r\n#@ $.#\r\n######".encode(encoding))
    (level,) = read_levels(file)
    assert level.name == "Ren\xe9"

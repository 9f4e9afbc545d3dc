from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pcg.level import Level
from pcg.sokoban import IllegalMoveError, apply_moves, is_solved
from pcg.xsb import format_level, parse_levels

ROOM = """
#######
#.  $ #
# @$  #
# #*  #
#######
"""


def level(text: str, goal_crate: tuple[int, int] | None = None) -> Level:
    """The only level of an XSB text, with a goal crate."""
    (parsed,) = parse_levels(text, "test.xsb")
    return replace(parsed, goal_crate=goal_crate)


def corridor(row: str, goal_crate: tuple[int, int] | None = None) -> Level:
    """A level of one row."""
    wall = "#" * (len(row) + 2)
    return level(f"{wall}\n#{row}#\n{wall}", goal_crate)


def rows(position: Level) -> list[str]:
    """The inner rows of a level as XSB text."""
    return [row[1:-1] for row in format_level(replace(position, name="")).splitlines()[1:-1]]


@pytest.mark.parametrize(
    ("lurd", "after"),
    [
        ("", [".  $ ", " @$  ", " #*  "]),
        ("u", [".@ $ ", "  $  ", " #*  "]),
        ("ul", ["+  $ ", "  $  ", " #*  "]),
        ("R", [".  $ ", "  @$ ", " #*  "]),
        ("Ru", [". @$ ", "   $ ", " #*  "]),
        ("urR", [".  @$", "  $  ", " #*  "]),
    ],
)
def test_moves_by_hand(lurd: str, after: list[str]):
    """A walk moves the player alone and a push the crate too; targets stay where they are."""
    assert rows(apply_moves(level(ROOM), lurd)) == after


def test_crates_move_between_targets():
    """A crate that leaves one target for the next uncovers the first, where the player now stands."""
    assert rows(apply_moves(corridor("@*.$"), "R")) == [" +*$"]


@pytest.mark.parametrize(
    ("lurd", "problem"),
    [
        ("ux", "move 2: 'x' is none of"),
        ("r", "move 1 .*a crate, which takes an upper-case letter"),
        ("U", "move 1 .*no crate to push"),
        ("d", "move 1 .*wall"),
        ("uu", "move 2 .*wall"),
        ("RD", "move 2 .*blocked"),
        ("urRR", "move 4 .*blocked"),
    ],
)
def test_illegal_moves_are_refused(lurd: str, problem: str):
    """The message names the number of the move and the reason."""
    with pytest.raises(IllegalMoveError, match=problem):
        apply_moves(level(ROOM), lurd)


def test_two_crates_in_a_row_cannot_be_pushed():
    """The player pushes one crate only."""
    with pytest.raises(IllegalMoveError, match="blocked"):
        apply_moves(corridor("@$$ ."), "R")


def test_the_goal_crate_is_followed():
    """The goal crate's cell moves with its pushes and with no others."""
    assert apply_moves(level(ROOM, (1, 2)), "R").goal_crate == (1, 3)
    assert apply_moves(level(ROOM, (0, 3)), "R").goal_crate == (0, 3)


@given(st.lists(st.sampled_from("lurdLURD"), max_size=30))
def test_legal_moves_keep_walls_targets_and_the_number_of_crates(letters: list[str]):
    """Whatever is played, only player and crates move, and the player and none of the crates can get lost."""
    position = level(ROOM)
    for letter in letters:
        try:
            position = apply_moves(position, letter)
        except IllegalMoveError:
            continue
        assert (position.is_wall == level(ROOM).is_wall).all()
        assert position.targets == level(ROOM).targets
        assert len(position.crates) == 3
        assert len(position.players) == 1


@pytest.mark.parametrize(
    ("row", "goal_crate", "solved"),
    [
        ("@*", None, True),
        ("@* $", None, True),
        ("@* $", (0, 1), True),
        ("@* $", (0, 3), False),
        ("@**", (0, 1), True),
        ("@**", (0, 2), False),
        ("@*.$", None, False),
        ("@.$", None, False),
    ],
)
def test_solved_levels(row: str, goal_crate: tuple[int, int] | None, solved: bool):  # noqa: FBT001  # a parametrised value
    """Every target is covered, and the first one in reading order by the goal crate if one is named."""
    assert is_solved(corridor(row, goal_crate)) == solved

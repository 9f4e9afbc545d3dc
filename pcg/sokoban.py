"""The rules of Sokoban: one player walks between four-connected cells and pushes single crates.

Moves are written in LURD notation: `l`, `u`, `r`, `d` walk to a free cell, `L`, `U`, `R`, `D` push the crate there one
cell further.
"""

from pcg.grid import DIRECTIONS, Cell
from pcg.level import Level


class IllegalMoveError(ValueError):
    """A move that the rules do not allow; the message gives its place in the sequence, counted from 1."""


def apply_moves(level: Level, lurd: str) -> Level:
    """The level after the moves of `lurd`; the goal crate, if one is named, is followed.

    Raises:
        IllegalMoveError: a letter is unknown, the way is blocked, or the letter's case does not fit (lower case into
            a crate, upper case without one).
        ValueError: the level has not exactly one player.
    """
    player, crates, goal_crate = level.player, set(level.crates), level.goal_crate
    for number, letter in enumerate(lurd, start=1):
        if letter.lower() not in DIRECTIONS:
            raise IllegalMoveError(f"move {number}: {letter!r} is none of {', '.join('lurdLURD')}")
        ahead = _step(player, letter)
        if not _is_floor(level, ahead):
            raise IllegalMoveError(f"move {number} ({letter}): {ahead} is a wall")
        if letter.isupper() != (ahead in crates):
            found = "a crate, which takes an upper-case letter" if ahead in crates else "no crate to push"
            raise IllegalMoveError(f"move {number} ({letter}): {ahead} holds {found}")
        if letter.isupper():
            beyond = _step(ahead, letter)
            if beyond in crates or not _is_floor(level, beyond):
                raise IllegalMoveError(f"move {number} ({letter}): the crate at {ahead} is blocked")
            crates.remove(ahead)
            crates.add(beyond)
            goal_crate = beyond if goal_crate == ahead else goal_crate
        player = ahead
    return Level.of(
        level.is_wall, players=[player], crates=crates, targets=level.targets, name=level.name, goal_crate=goal_crate
    )


def is_solved(level: Level) -> bool:
    """Whether every target holds a crate, the first one in reading order the goal crate if one is named."""
    targets = level.targets
    covered = bool((level.is_crate | ~level.is_target).all())
    return covered and (level.goal_crate is None or level.goal_crate in targets[:1])


def _step(cell: Cell, letter: str) -> Cell:
    down, right = DIRECTIONS[letter.lower()]
    return cell[0] + down, cell[1] + right


def _is_floor(level: Level, cell: Cell) -> bool:
    row, column = cell
    rows, columns = level.shape
    return 0 <= row < rows and 0 <= column < columns and not level.is_wall[cell]

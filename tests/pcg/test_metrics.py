from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pcg.grid import Cell, cells_of
from pcg.level import Level
from pcg.metrics import LevelStatistics, occluded, statistics
from pcg.symmetry import symmetries


def test_statistics_by_hand():
    """Things on targets count twice, walls divide regions, players and crates do not."""
    level = Level(np.array([[2, 3, 1, 6], [1, 1, 1, 5], [0, 0, 0, 1]]))
    assert statistics(level) == LevelStatistics(
        rows=3, columns=4, players=2, crates=2, targets=2, walls=5, regions=3, wall_density=5 / 12
    )


def test_a_level_of_walls_has_no_region():
    """Nothing is free where everything is wall."""
    assert statistics(Level(np.ones((2, 2), dtype=int))).regions == 0


@pytest.mark.parametrize(
    ("goal", "walls", "crates", "hidden"),
    [
        ((0, 3), [], [], False),
        ((0, 3), [(0, 1)], [], True),
        ((0, 3), [], [(0, 2)], True),
        ((0, 2), [(0, 3), (1, 1)], [], False),  # behind the goal crate, and beside the ray
        ((1, 1), [(0, 1), (1, 0)], [], False),  # between two corners
        ((2, 2), [(1, 1)], [], True),
        ((3, 1), [(1, 0)], [], True),  # the ray crosses that row from 1/6 to 1/2 of a cell beside the centre
        ((3, 1), [(2, 1)], [], True),
        ((3, 1), [(2, 0)], [], False),  # meets its corner only
        ((3, 1), [(1, 1)], [], False),  # likewise
        ((3, 1), [], [(1, 0), (2, 1)], False),  # meets one corner of each crate
        ((2, 3), [], [(1, 1)], True),
        ((2, 3), [], [(1, 2)], True),
    ],
)
def test_occlusion_by_hand(goal: Cell, walls: list[Cell], crates: list[Cell], hidden: bool):  # noqa: FBT001  # a parametrised value
    """Seen from the upper left cell, interiors block the ray, corners do not."""
    is_wall = np.zeros((4, 4), dtype=np.bool_)
    for cell in walls:
        is_wall[cell] = True
    assert occluded(Level.of(is_wall, players=[(0, 0)], crates=[goal, *crates]), goal) == hidden


def crosses(start: Cell, end: Cell, centre: Cell, half_width: Fraction) -> bool:
    """Whether a stretch of the segment lies within an open square, by clipping in exact fractions."""
    enter, leave = Fraction(0), Fraction(1)
    for p, q, c in zip(start, end, centre, strict=True):
        if p == q:
            if abs(p - c) >= half_width:
                return False
            continue
        first, second = sorted((c + side - p) / (q - p) for side in (-half_width, half_width))
        enter, leave = max(enter, first), min(leave, second)
    return enter < leave


@st.composite
def crowded_levels(draw: st.DrawFn) -> tuple[Level, Cell]:
    """A level with a player, and a goal crate among other crates and walls."""
    cells = draw(st.permutations(list(np.ndindex(draw(st.integers(1, 7)), draw(st.integers(2, 7))))))
    walls, crates = draw(st.integers(0, 6)), draw(st.integers(0, 3))
    player, goal, *others = cells
    is_wall = np.zeros(np.max(cells, axis=0) + 1, dtype=np.bool_)
    for cell in others[:walls]:
        is_wall[cell] = True
    return Level.of(is_wall, players=[player], crates=[goal, *others[walls : walls + crates]]), goal


@settings(max_examples=500)
@given(crowded_levels())
def test_occlusion_agrees_with_exact_clipping(crowded: tuple[Level, Cell]):
    """Separating axes and clipping the ray in exact fractions give the same answer."""
    level, goal = crowded
    walls = [(cell, Fraction(1, 2)) for cell in cells_of(level.is_wall)]
    crates = [(cell, Fraction(1, 4)) for cell in level.crates if cell != goal]
    expected = any(crosses(level.player, goal, cell, half_width) for cell, half_width in walls + crates)
    assert occluded(level, goal) == expected


@given(crowded_levels())
def test_occlusion_is_the_same_for_symmetric_levels(crowded: tuple[Level, Cell]):
    """Turning or mirroring a level does not change what the player sees."""
    level, goal = crowded
    images = symmetries(replace(level, goal_crate=goal))
    assert len({occluded(image, image.goal_crate) for image in images if image.goal_crate}) == 1


def test_occlusion_needs_a_crate_and_one_player():
    """The ends of the ray must exist."""
    with pytest.raises(ValueError, match="not a crate"):
        occluded(Level(np.array([[2, 3]])), (0, 0))
    with pytest.raises(ValueError, match="not one"):
        occluded(Level(np.array([[0, 3]])), (0, 1))

import numpy as np
import pytest
from shapely import LineString, box

from pcg.generate import random_levels
from pcg.level import Level
from pcg.metrics import occluded
from pcg.request import Request
from pcg.swept_disc import RADIUS, UNIT, disc_occluded


def level_of(walls: list[tuple[int, int]], crates: list[tuple[int, int]], player: tuple[int, int]) -> Level:
    """A 5 x 5 level; the first crate is the goal crate."""
    is_wall = np.zeros((5, 5), dtype=np.bool_)
    for cell in walls:
        is_wall[cell] = True
    return Level.of(is_wall, players=[player], crates=crates, goal_crate=crates[0])


def test_a_corridor_is_wide_enough():
    """Between walls one cell apart a disc of less than a cell drives straight on; one of a cell touches them."""
    level = level_of([(1, 1), (1, 2), (3, 1), (3, 2), (2, 4)], [(2, 3)], (2, 0))
    assert not disc_occluded(level, (2, 3))
    assert not disc_occluded(level, (2, 3), radius=UNIT // 2)
    assert disc_occluded(level, (2, 3), radius=UNIT // 2 + 1)


def test_a_diagonal_gap_lets_light_through_but_no_disc():
    """Past the corner of a wall the ray is free; the disc is not."""
    level = level_of([(0, 1), (1, 0)], [(2, 2)], (0, 0))
    assert not occluded(level, (2, 2))
    assert disc_occluded(level, (2, 2))
    assert not disc_occluded(level, (2, 2), radius=0)


def test_other_crates_are_half_a_cell_wide():
    """A crate one cell beside the way is 3/4 of a cell away, one on the way blocks, the goal crate itself does not."""
    assert not disc_occluded(level_of([], [(2, 4), (1, 2)], (2, 0)), (2, 4))
    assert disc_occluded(level_of([], [(2, 4), (1, 2)], (2, 0)), (2, 4), radius=25)
    assert disc_occluded(level_of([], [(2, 4), (2, 2)], (2, 0)), (2, 4))


@pytest.mark.parametrize("radius", [1, RADIUS, UNIT // 2])
def test_agrees_with_polygons(radius: int):
    """Distances between segment and squares by another library, on random levels."""
    for generated, _ in zip(random_levels(9, Request(pushes=(0, 1000))), range(40), strict=False):
        level = generated.level
        assert level.goal_crate is not None
        ray = LineString([level.player, level.goal_crate])
        squares = [(cell, 0.5) for cell in np.argwhere(level.is_wall).tolist()]
        squares += [(cell, 0.25) for cell in level.crates if cell != level.goal_crate]
        gap = min(ray.distance(box(r - half, c - half, r + half, c + half)) for (r, c), half in squares)
        # A ray along an edge or through a corner touches: distance 0 but no interior point, which the ray test decides.
        expected = gap * UNIT < radius - 1e-9 or occluded(level, level.goal_crate)
        assert disc_occluded(level, level.goal_crate, radius) == expected


def test_only_crates_are_goal_crates():
    """Another cell is a mistake of the programmer."""
    with pytest.raises(ValueError, match="not a crate"):
        disc_occluded(level_of([], [(2, 4)], (2, 0)), (0, 0))

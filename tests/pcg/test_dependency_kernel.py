from dataclasses import replace

import numpy as np
import pytest

from pcg.dependency import has_dependency
from pcg.dependency_kernel import depends
from pcg.level import Level
from pcg.push_search import fewest_pushes
from pcg.solver import solve
from pcg.solver_kernel import make_board
from pcg.xsb import parse_levels
from tests.pcg.maps import solvable


def by_kernel(level: Level) -> bool:
    """What the kernel says about the solution with the fewest pushes."""
    bordered = np.pad(level.tiles, 1, constant_values=1)
    width = bordered.shape[1]

    def numbers(mask: np.ndarray, kind: type) -> np.ndarray:
        return np.flatnonzero(np.pad(mask, 1)).astype(kind)

    wall = (bordered == 1).astype(np.uint8).ravel()
    (player,), crates = numbers(level.is_player, np.int64), numbers(level.is_crate, np.int16)
    targets = numbers(level.is_target, np.int32)
    _, _, path = fewest_pushes(make_board(wall, width, targets), player, crates, 0, 100_000)
    return depends(wall, width, player, crates, targets[0], path, 100_000)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("########\n#  $   #\n#@$   .#\n########", False),
        ("#######\n#  #  #\n#@$ $.#\n#  #  #\n#######", True),
        ("########\n#@  *  #\n#   $  #\n#      #\n########", False),
    ],
    ids=["a free way", "a crate in the way", "solved already"],
)
def test_dependencies_by_hand(text: str, expected: bool):  # noqa: FBT001  # a parametrised value
    """Another crate that has to move is a dependency; where no crate has to move there is none."""
    (level,) = parse_levels(text, "t")
    assert by_kernel(level) is expected


def test_the_same_verdict_as_on_levels():
    """Of random levels the kernel says what `has_dependency` says about the crate that the solver chose."""
    levels = solvable(60)
    verdicts = [by_kernel(level) for level in levels]
    assert verdicts == [has_dependency(replace(level, goal_crate=solve(level).goal_crate)) for level in levels]
    assert any(verdicts)

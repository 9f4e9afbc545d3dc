from dataclasses import replace

import numpy as np
import pytest

from pcg.examine import examined
from pcg.frozen import OPEN, FrozenTiles
from pcg.level import Level, Tile
from pcg.request import Rejection, Request
from pcg.xsb import parse_levels

(LEVEL,) = parse_levels("########\n#@  #  #\n#  $  .#\n#  $   #\n########\n", "t")
REQUEST = Request(rows=3, columns=6, wall_density=(1 / 18, 0.2), pushes=(1, 20))


def test_a_level_that_meets_the_request():
    """It comes back with the crate that the solution brings to the target."""
    outcome = examined(LEVEL, REQUEST)
    assert isinstance(outcome, tuple)
    level, solution = outcome
    assert (level.goal_crate, solution.pushes) == ((1, 2), 3)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"crates": 3}, Rejection.UNFINISHED),
        ({"rows": 4}, Rejection.UNFINISHED),
        ({"wall_density": (0.2, 0.3)}, Rejection.WALLS),
        ({"wall_density": (0.0, 0.0)}, Rejection.WALLS),
        ({"pushes": (4, 20)}, Rejection.EASY),
        ({"pushes": (0, 2)}, Rejection.HARD),
        ({"occluded": True}, Rejection.SIGHT),
        ({"dependency": True}, Rejection.DEPENDENCY),
        ({"frozen": FrozenTiles(np.where(np.eye(3, 6) > 0, Tile.WALL, OPEN))}, Rejection.FROZEN),
    ],
)
def test_the_first_reason_is_named(changes: dict[str, object], reason: Rejection):
    """One thing is asked for that the level is not."""
    assert examined(LEVEL, replace(REQUEST, **changes)) is reason  # type: ignore[arg-type]  # fields of any type


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("########\n#@  ####\n#  $  .#\n#  $ ###\n########\n", Rejection.WALLS),
        ("########\n#@#    #\n##$   .#\n#  $   #\n########\n", Rejection.UNFINISHED),
        ("########\n#@    .#\n# $$   #\n#     ##\n########\n", None),
        ("########\n#$    .#\n# @    #\n#$    ##\n########\n", Rejection.UNSOLVABLE),
    ],
)
def test_other_levels(text: str, reason: Rejection | None):
    """Divided free cells, too many walls, crates in corners."""
    (level,) = parse_levels(text, "t")
    outcome = examined(level, replace(REQUEST, pushes=(0, 100)))
    assert (outcome if isinstance(outcome, Rejection) else None) is reason


def test_unfinished_maps_are_no_error():
    """Whatever a policy leaves has a reason: here there is nothing on the floor."""
    assert examined(Level(np.zeros((3, 6), dtype=np.uint8)), REQUEST) is Rejection.UNFINISHED


def test_a_solver_that_gives_up_is_a_reason():
    """With one state nothing is decided."""
    assert examined(LEVEL, REQUEST, max_states=1) is Rejection.UNDECIDED

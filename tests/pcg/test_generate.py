from dataclasses import replace
from itertools import islice

import pytest

from pcg.errors import InputError
from pcg.generate import generated_levels, random_levels
from pcg.level_set import GeneratedLevel
from pcg.metrics import statistics
from pcg.random_source import RandomSource
from pcg.request import Rejection, Request
from pcg.sokoban import apply_moves, is_solved
from pcg.symmetry import content_hash

LEVELS = tuple(islice(random_levels(3), 20))


def test_levels_are_what_was_asked_for():
    """Size, numbers, density, one region and pushes are as in the settings, and the recorded solution is one."""
    request = Request()
    for generated in LEVELS:
        counted = statistics(generated.level)
        assert (counted.rows, counted.columns) == (10, 10)
        assert (counted.players, counted.crates, counted.targets, counted.regions) == (1, 2, 1, 1)
        assert counted.walls == round(100 * generated.control_targets["wall_density"])
        assert request.wall_density[0] - 0.005 <= counted.wall_density <= request.wall_density[1] + 0.005
        assert generated.solution.pushes is not None
        assert generated.solution.lurd is not None
        assert generated.solution.pushes >= request.pushes[0]
        # Replayed with the goal crate named: it has to be the one on the target.
        assert generated.level.goal_crate is not None
        assert is_solved(apply_moves(generated.level, generated.solution.lurd))


def test_levels_are_distinct_up_to_symmetry():
    """No level repeats another one, turned or mirrored or not, and no name occurs twice."""
    assert len({content_hash(generated.level) for generated in LEVELS}) == len(LEVELS)
    assert len({generated.level.name for generated in LEVELS}) == len(LEVELS)


def test_a_level_depends_on_seed_and_number_alone():
    """Fewer levels are the beginning of more; another seed gives others."""
    assert tuple(islice(random_levels(3), 5)) == LEVELS[:5]
    assert content_hash(next(random_levels(4)).level) != content_hash(LEVELS[0].level)


def test_levels_keep_their_value():
    """The same seed gives the same levels in every version."""
    assert [(g.level.name, content_hash(g.level), g.solution.lurd) for g in islice(random_levels(7), 2)] == [
        ("random-7-0", "8d8129b2061959e5", "dddlUUUUluRdrUluRRR"),
        ("random-7-1", "2bc3d335d9e3748c", "ldddRRurDldR"),
    ]


def test_rejected_attempts_are_counted():
    """Each attempt that was thrown away since the level before has its reason."""
    assert sum(generated.rejected.get(Rejection.UNSOLVABLE, 0) for generated in LEVELS) > 0
    assert {reason for generated in LEVELS for reason in generated.rejected} <= set(Rejection)


def test_symmetric_levels_are_rejected():
    """A corridor of five cells has ten levels of one crate, C(5, 3) for player, crate and target in that order."""
    corridor = Request(rows=1, columns=5, crates=1, targets=1, wall_density=(0, 0), pushes=(1, 100))
    found: list[GeneratedLevel] = []
    with pytest.raises(InputError, match=r"no level in \d+ attempts \(.*duplicate"):
        found.extend(random_levels(0, corridor, max_attempts=500))
    assert len(found) == 10


def test_other_shapes_and_numbers():
    """Rows and columns are not exchanged, and several targets are allowed."""
    settings = Request(rows=5, columns=8, crates=3, targets=2, pushes=(1, 100))
    level = next(random_levels(0, settings)).level
    assert level.shape == (5, 8)
    assert (len(level.crates), len(level.targets)) == (3, 2)


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"rows": 0}, "at least 1"),
        ({"targets": 0}, "at least 1"),
        ({"crates": 1, "targets": 2}, "cannot cover"),
        ({"wall_density": (0.3, 0.2)}, "range"),
        ({"wall_density": (0.3, 1.2)}, "range"),
        ({"rows": 1, "columns": 3}, "cannot hold 4 things"),
        ({"rows": 101, "columns": 100}, "101 x 100 cells are too many"),
        ({"pushes": (5, 3)}, "range"),
    ],
)
def test_settings_that_make_no_sense_are_refused(changes: dict[str, object], problem: str):
    """The message names the setting."""
    with pytest.raises(ValueError, match=problem):
        replace(Request(), **changes)


@pytest.mark.parametrize(
    ("changes", "max_states", "reason"),
    [({"wall_density": (1, 1)}, None, "walls"), ({"pushes": (1000, 2000)}, None, "easy"), ({}, 1, "undecided")],
)
def test_hopeless_requests_end_with_the_reasons(changes: dict[str, object], max_states: int | None, reason: str):
    """After `max_attempts` the generator gives up with one line that counts the reasons."""
    request = replace(Request(), **changes)
    with pytest.raises(InputError, match=rf"no level in 100 attempts .*\d+ {reason}"):
        next(generated_levels(RandomSource(max_states), request, 0, max_attempts=5))

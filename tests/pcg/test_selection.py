from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from pcg.diversity import Descriptors
from pcg.errors import InputError
from pcg.generate import random_levels
from pcg.level import Level
from pcg.metrics import occluded
from pcg.selection import selected
from pcg.symmetry import symmetries

GROUPS = [[g.level for g in islice(random_levels(seed), 20)] for seed in (1, 2)]


def is_occluded(level: Level) -> bool:
    """Of a level with a goal crate."""
    assert level.goal_crate is not None
    return occluded(level, level.goal_crate)


def test_quotas_are_kept():
    """Of each group as many as asked for, so many of them occluded."""
    choices = selected(GROUPS, 6, [2, 5])
    for group, places, quota in zip(GROUPS, choices, [2, 5], strict=True):
        assert places == sorted(set(places))
        assert len(places) == 6
        assert sum(is_occluded(group[place]) for place in places) == quota


def test_every_choice_is_the_farthest():
    """Replayed by brute force: no other candidate was farther from those chosen before."""
    group = GROUPS[0]
    (places,) = selected([group], 5, [2])
    descriptors = Descriptors.of(group)
    distances = np.array([descriptors.distances_to(index) for index in range(len(group))])
    chosen: list[int] = []
    left = {True: 2, False: 3}
    for _ in range(5):
        allowed = [k for k in range(len(group)) if k not in chosen and left[is_occluded(group[k])]]
        pick = max(allowed, key=lambda k: distances[k, chosen].min() if chosen else 0)
        chosen.append(pick)
        left[is_occluded(group[pick])] -= 1
    assert sorted(chosen) == places


def test_the_choice_is_more_diverse_than_the_first_levels():
    """The nearest two of the chosen are farther apart than the nearest two of the first ones."""
    group = GROUPS[0] + GROUPS[1]
    quota = sum(is_occluded(level) for level in group[:8])
    (places,) = selected([group], 8, [quota])
    descriptors = Descriptors.of(group)
    matrix = np.array([descriptors.distances_to(index) for index in range(len(group))]) + np.eye(len(group))
    assert matrix[np.ix_(places, places)].min() > matrix[:8, :8].min()


def test_symmetric_levels_are_chosen_once():
    """The second group repeats the first one, turned; only its own level is left for it."""
    first = GROUPS[0][:3]
    turned = [symmetries(level)[1] for level in first]
    own = next(level for level in GROUPS[1] if not is_occluded(level))
    visible = [level for level in first if not is_occluded(level)]
    assert visible
    choices = selected([visible, [*turned, own]], 1, [0, 0])
    taken = visible[choices[0][0]]
    assert [*turned, own][choices[1][0]] not in symmetries(taken)


def test_goal_crates_are_needed():
    """What is hidden cannot be told of a level without one."""
    with pytest.raises(ValueError, match="level 'a' names no goal crate"):
        selected([[replace(GROUPS[0][0], name="a", goal_crate=None)]], 1, [0])


def test_too_few_levels_of_a_kind():
    """The group and what is missing are named."""
    with pytest.raises(InputError, match=r"group 0: \d+ occluded and 0 visible levels are missing"):
        selected([GROUPS[0]], 20, [20])

"""Choosing a few levels of many: as different from each other as possible, with a quota of occluded ones.

Greedy farthest-point selection (Gonzalez 1985, at most twice as far from the best choice as possible): the next level is
the one whose nearest chosen level is farthest away; of equals, the first. Levels of several groups are chosen group by
group, but the distances count over all groups, so that no group repeats what another one has.
"""

from collections.abc import Sequence

import numpy as np

from pcg.diversity import Descriptors
from pcg.errors import InputError
from pcg.level import Level
from pcg.metrics import occluded
from pcg.symmetry import content_hash


def selected(groups: Sequence[Sequence[Level]], keep: int, occluded_quotas: Sequence[int]) -> list[list[int]]:
    """The places, in ascending order, of the chosen levels of each group.

    Args:
        groups: Levels with goal crates, square and of one shape.
        keep: Levels to choose of each group.
        occluded_quotas: Of each group, how many of those have to be occluded.

    Raises:
        ValueError: a level names no goal crate.
        InputError: a group has too few levels of a kind; it is named by its number.
    """
    levels = [level for group in groups for level in group]
    descriptors = Descriptors.of(levels)
    is_occluded = np.array([_is_occluded(level) for level in levels])
    hashes = np.array([content_hash(level) for level in levels])
    nearest = np.full(len(levels), np.inf)
    available = np.ones(len(levels), dtype=np.bool_)
    chosen: list[list[int]] = []
    begin = 0
    for number, (group, quota) in enumerate(zip(groups, occluded_quotas, strict=True)):
        members = np.zeros(len(levels), dtype=np.bool_)
        members[begin : begin + len(group)] = True
        left = {True: quota, False: keep - quota}
        picks: list[int] = []
        while any(left.values()):
            kinds = [kind for kind, n in left.items() if n]
            candidates = np.flatnonzero(members & available & np.isin(is_occluded, kinds))
            if len(candidates) == 0:
                raise InputError("selection", _too_few(number, left))
            # argmax takes the first of equals: the choice is the same everywhere.
            pick = int(candidates[np.argmax(nearest[candidates])])
            picks.append(pick - begin)
            left[bool(is_occluded[pick])] -= 1
            available &= hashes != hashes[pick]
            nearest = np.minimum(nearest, descriptors.distances_to(pick))
        chosen.append(sorted(picks))
        begin += len(group)
    return chosen


def _is_occluded(level: Level) -> bool:
    if level.goal_crate is None:
        raise ValueError(f"level {level.name!r} names no goal crate")
    return occluded(level, level.goal_crate)


def _too_few(number: int, left: dict[bool, int]) -> str:
    return f"group {number}: {left[True]} occluded and {left[False]} visible levels are missing"

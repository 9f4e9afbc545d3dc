"""The table of states: what the searches rely on, where different states fall into one slot."""

import numpy as np
import pytest

from pcg.solver_kernel import slot_of

STATE = ([20, 30], 20, 25)
"""Crates, goal crate and player."""


@pytest.mark.parametrize(
    "other",
    [
        ([19, 30], 20, 25),
        ([21, 30], 20, 25),
        ([20, 29], 20, 25),
        ([20, 31], 20, 25),
        ([20, 30], 0, 25),
        ([20, 30], 30, 25),
        ([20, 30], 20, 24),
        ([20, 30], 20, 26),
    ],
)
def test_states_in_one_slot_are_told_apart(other: tuple[list[int], int, int]):
    """In a table full of one state that state is found, and one that differs anywhere gets the only empty slot."""
    table = np.zeros(64, dtype=np.int32)
    table[7] = -1

    def slot(crates: list[int], goal: int, player: int) -> int:
        states, goals, players = (np.array([part], dtype=np.int16) for part in STATE)
        return int(slot_of(table, states, goals, players, np.array(crates, dtype=np.int16), goal, player))

    assert slot(*STATE) != 7
    assert slot(*other) == 7

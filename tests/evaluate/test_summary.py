"""What became of some trials."""

from pathlib import Path

import pytest

from evaluate.summary import NOTHING, Summary, summaries, time_text
from evaluate.trial_frame import read_trials


def test_means_are_over_solved_runs(two_methods: Path):
    """Mean and deviation are over solved runs, the rate over all; one run has no deviation."""
    found = summaries(read_trials(two_methods), "scene", "method")
    assert set(found) == {("wall", "A"), ("wall", "Btl"), ("corner", "A"), ("corner", "Btl"), ("open", "A")}
    assert found["wall", "Btl"] == Summary(2, 1, 4.0, None, net_mean=1.0, pick_places=2.0, path_length=3.0)
    assert found["wall", "Btl"].rate == 0.5
    assert found["corner", "A"] == Summary(2, 0, None, None)
    assert found["wall", "A"].deviation == pytest.approx(2**0.5)


def test_totals_add_up(two_methods: Path):
    """By method alone a summary holds all trials of the method."""
    found = summaries(read_trials(two_methods), "method")
    assert {method: (summary.solved, summary.trials) for (method,), summary in found.items()} == {
        "A": (3, 5),
        "Btl": (3, 4),
    }


def test_nearly_all_is_not_all():
    """A rate below 100 % is never printed as 100 %."""
    assert time_text(Summary(10_000, 9_999, 1.0, 0.0)) == "1.00 (0) 99.9%"


def test_no_trials_at_all():
    """Nothing is solved of nothing."""
    assert (NOTHING.rate, time_text(NOTHING)) == (0.0, "-")

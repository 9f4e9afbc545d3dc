"""Statistics of trials."""

import math
import statistics

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evaluate.statistics import NORMAL_95, deviation, mean, wilson_interval

finite = st.floats(-1e6, 1e6)


@given(st.lists(finite, min_size=2, max_size=30))
def test_mean_and_deviation_are_those_of_the_standard_library(values: list[float]):
    """An independent implementation gives the same numbers."""
    assert mean(values) == pytest.approx(statistics.fmean(values), abs=1e-6)
    assert deviation(values) == pytest.approx(statistics.stdev(values), rel=1e-9, abs=1e-6)


def test_few_values():
    """One value has no spread; no value has neither mean nor spread."""
    assert (mean([3.0]), deviation([3.0])) == (3.0, 0.0)
    assert (mean([]), deviation([])) == (None, None)


def test_wilson_interval_of_a_published_example():
    """Newcombe (Statistics in Medicine 17, 1998, table I): 81 of 263 gives 0.2553 to 0.3662."""
    assert wilson_interval(81, 263) == pytest.approx((0.2553, 0.3662), abs=5e-5)


def test_wilson_interval_at_its_ends():
    """No success gives a lower limit of 0, only successes an upper one of 1; no trial says nothing."""
    low, high = wilson_interval(0, 20)
    assert low == 0
    assert high == pytest.approx(NORMAL_95**2 / (20 + NORMAL_95**2))
    assert wilson_interval(20, 20) == pytest.approx((1 - high, 1.0))
    assert wilson_interval(0, 0) == (0.0, 1.0)


@given(st.integers(1, 500), st.data())
def test_wilson_interval_solves_the_score_equation(trials: int, data: st.DataObject):
    """At both limits p the observed rate is z standard errors sqrt(p (1 - p) / n) away, unless cut at 0 or 1."""
    successes = data.draw(st.integers(0, trials))
    rate = successes / trials
    for limit in wilson_interval(successes, trials):
        assert 0 <= limit <= 1
        error = math.sqrt(limit * (1 - limit) / trials)
        assert abs(rate - limit) == pytest.approx(NORMAL_95 * error, abs=1e-6)


def test_impossible_counts_are_refused():
    """More successes than trials are a programming error."""
    with pytest.raises(ValueError, match="3 successes in 2 trials"):
        wilson_interval(3, 2)

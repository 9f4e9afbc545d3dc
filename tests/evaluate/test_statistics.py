"""Statistics of trials."""

import math
import statistics

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from evaluate.statistics import (
    NORMAL_95,
    FloatArray,
    bootstrap_interval,
    compare,
    deviation,
    mean,
    mean_time,
    median_time,
    par2,
    solved_within,
    wilson_interval,
)

finite = st.floats(-1e6, 1e6)


@given(st.lists(finite, min_size=2, max_size=30))
def test_mean_and_deviation_are_those_of_the_standard_library(values: list[float]):
    """An independent implementation gives the same numbers."""
    assert mean(values) == pytest.approx(statistics.fmean(values), abs=1e-6)
    assert deviation(values) == pytest.approx(statistics.stdev(values), rel=1e-9, abs=1e-6)


def test_few_values():
    """One value has no spread; no value has neither mean nor spread."""
    assert (mean([3.0]), deviation([3.0])) == (3.0, None)
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


TIMES = np.array([[1.0, np.inf, 2.0], [3.0, 5.0, np.nan]])
"""Two runs on three scenes: one is unsolved, one was not run."""


def test_times_of_a_small_matrix():
    """The mean of the four solved runs of five is 11 / 4, the middle of all five is 3, PAR2 counts 20 for the other."""
    assert mean_time(TIMES) == 2.75
    assert median_time(TIMES) == 3.0
    assert par2(TIMES, limit=10.0) == (11 + 20) / 5


def test_without_runs_there_is_no_number():
    """What was not run has no mean, and no bootstrap interval either."""
    nothing = np.full((2, 2), np.nan)
    values = [mean_time(nothing), median_time(nothing), par2(nothing, 1.0)]
    assert all(math.isnan(value) for value in values)
    interval = bootstrap_interval(nothing, mean_time, np.random.default_rng(0), resamples=10)
    assert all(math.isnan(limit) for limit in interval)


def test_median_of_mostly_unsolved_runs_is_infinite():
    """More than half of the runs without a plan leave no finite median, whatever the others took; half of them do."""
    assert median_time(np.array([[1.0], [np.inf], [np.inf]])) == math.inf
    assert median_time(np.array([[np.inf], [1.0]])) == 1.0
    assert median_time(np.array([[4.0, np.nan], [2.0, 1.0]])) == 2.0


def test_bootstrap_of_equal_values_has_no_width():
    """Where every run takes the same time, so does every sample."""
    times = np.full((5, 3), 2.5)
    for resampled in ("runs", "scenes"):
        assert bootstrap_interval(times, mean_time, np.random.default_rng(0), resampled=resampled) == (2.5, 2.5)


def test_bootstrap_of_runs_stays_within_scenes():
    """Scenes of 1 s and 9 s: no draw of runs changes the mean, a draw of scenes does."""
    times = np.tile([1.0, 9.0], (4, 1))
    assert bootstrap_interval(times, mean_time, np.random.default_rng(0), resampled="runs") == (5.0, 5.0)
    assert bootstrap_interval(times, mean_time, np.random.default_rng(0), resampled="scenes") == (1.0, 9.0)


def test_bootstrap_interval_of_a_mean_is_that_of_the_normal_distribution():
    """For 400 normal values the interval of the mean is 1.96 deviations / 20 to either side."""
    rng = np.random.default_rng(1)
    values = rng.normal(10.0, 1.0, size=(400, 1))
    low, high = bootstrap_interval(values, mean_time, rng, resamples=4000)
    assert (low + high) / 2 == pytest.approx(values.mean(), abs=0.01)
    assert (high - low) / 2 == pytest.approx(NORMAL_95 * values.std() / 20, rel=0.08)


def test_comparison_counts_pairs():
    """Of five pairs A alone solves one, is clearly faster in one, alike in one, slower in one; one neither solves."""
    a = np.array([[1.0, 1.0, 1.0, 5.0, np.inf, 1.0]])
    b = np.array([[np.inf, 2.0, 1.05, 1.0, np.inf, np.nan]])
    found = compare(a, b, 10.0, np.random.default_rng(0))
    assert (found.pairs, found.wins, found.ties, found.losses) == (5, 2, 2, 1)
    assert found.scenes == (2, 2, 1)
    assert found.difference == pytest.approx((-19 - 1 - 0.05 + 4 + 0) / 5)
    assert found.interval[0] <= found.difference <= found.interval[1]


@given(arrays(float, (3, 4), elements=st.sampled_from([0.5, 1.0, 2.0, math.inf, math.nan])), st.integers(0, 9))
def test_comparison_is_antisymmetric(times: FloatArray, seed: int):
    """Swapping the methods swaps wins and losses and turns the sign of the difference."""
    other = np.roll(times, 1, axis=0)
    forth = compare(times, other, 5.0, np.random.default_rng(seed), resamples=20)
    back = compare(other, times, 5.0, np.random.default_rng(seed), resamples=20)
    assert (forth.wins, forth.ties, forth.losses) == (back.losses, back.ties, back.wins)
    assert forth.scenes == back.scenes[::-1]
    assert np.isclose(forth.difference, -back.difference, equal_nan=True)


def test_comparison_needs_the_same_runs():
    """Matrices of different shapes cannot be paired."""
    with pytest.raises(ValueError, match="cannot be paired"):
        compare(np.ones((2, 2)), np.ones((2, 3)), 1.0, np.random.default_rng(0))


def test_curve_ends_at_the_share_solved():
    """Solved times in order; the shares count all runs."""
    seconds, shares = solved_within(TIMES)
    assert seconds.tolist() == [1.0, 2.0, 3.0, 5.0]
    assert shares.tolist() == [0.2, 0.4, 0.6, 0.8]

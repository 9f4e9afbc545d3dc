"""Statistics of trials, as small pure functions.

Those of a method work on its times `(runs, scenes)` [s]: one column a scene, one row a run (a seed). A run that did not
solve its scene is `inf`, a run that does not exist NaN. The same seeds of two methods stand in the same rows.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
Statistic = Callable[[FloatArray], float]
"""A number from a matrix of times; NaN where there is none."""

NORMAL_95 = 1.959963984540054
"""The 97.5 % quantile of the standard normal distribution."""

RESAMPLES = 1000
"""Bootstrap samples; enough for two digits of a 95 % interval."""

TIE = 0.1
"""Times that differ by no more than this share of the longer one are a tie."""


def mean(values: Sequence[float]) -> float | None:
    """Arithmetic mean; None without values."""
    return math.fsum(values) / len(values) if values else None


def deviation(values: Sequence[float]) -> float | None:
    """Sample standard deviation (n - 1); None without two values."""
    if len(values) < 2:
        return None
    centre = math.fsum(values) / len(values)
    squares = math.fsum((value - centre) ** 2 for value in values)
    return math.sqrt(squares / (len(values) - 1))


def wilson_interval(successes: int, trials: int, z: float = NORMAL_95) -> tuple[float, float]:
    """Confidence interval of a success rate (Wilson, JASA 22, 1927), sensible near 0 and 1 and for few trials.

    Args:
        successes: Trials that succeeded, 0..`trials`.
        trials: All trials; without any the interval is (0, 1).
        z: Quantile of the standard normal distribution; the default gives 95 %.

    Raises:
        ValueError: the counts are negative or there are more successes than trials.
    """
    if not 0 <= successes <= trials:
        raise ValueError(f"{successes} successes in {trials} trials")
    if trials == 0:
        return 0.0, 1.0
    rate, z2 = successes / trials, z * z
    centre = (rate + z2 / (2 * trials)) / (1 + z2 / trials)
    half = z * math.sqrt(rate * (1 - rate) / trials + z2 / (4 * trials * trials)) / (1 + z2 / trials)
    # Rounding must not push the limits beyond what a rate can be.
    return max(0.0, centre - half), min(1.0, centre + half)


def mean_time(times: FloatArray) -> float:
    """Mean time of the solved runs [s]."""
    solved = times[np.isfinite(times)]
    return float(solved.mean()) if len(solved) else math.nan


def median_time(times: FloatArray) -> float:
    """Median time of all runs, the lower of two; `inf` if more than half of them are unsolved [s]."""
    ran = times[~np.isnan(times)]
    # A time that was measured, not one in between, which might be infinite.
    middle = (len(ran) - 1) // 2
    return float(np.partition(ran, middle)[middle]) if len(ran) else math.nan


def par2(times: FloatArray, limit: float) -> float:
    """Penalised average runtime [s]: the mean over all runs, where an unsolved one counts twice the time limit."""
    ran = times[~np.isnan(times)]
    return float(np.where(np.isfinite(ran), ran, 2 * limit).mean()) if len(ran) else math.nan


def bootstrap_interval(
    times: FloatArray,
    statistic: Statistic,
    rng: np.random.Generator,
    *,
    resampled: Literal["runs", "scenes"] = "runs",
    resamples: int = RESAMPLES,
    level: float = 0.95,
) -> tuple[float, float]:
    """Percentile bootstrap interval of a statistic (Efron 1979); NaN where the statistic has no value.

    Args:
        times: (runs, scenes) [s].
        statistic: What is estimated.
        rng: Source of the samples.
        resampled: `runs` draws anew within each scene and tells how much other seeds would change the value on these
            scenes (the stratified bootstrap of Agarwal et al., NeurIPS 2021); `scenes` draws whole columns and tells
            how much other scenes would.
        resamples: Number of samples.
        level: Share of the interval.
    """
    draw = _RESAMPLED[resampled]
    values = np.array([statistic(draw(times, rng)) for _ in range(resamples)])
    return _percentiles(values, level)


def _resampled_runs(times: FloatArray, rng: np.random.Generator) -> FloatArray:
    rows = rng.integers(len(times), size=times.shape)
    return np.asarray(np.take_along_axis(times, rows, axis=0))


def _resampled_scenes(times: FloatArray, rng: np.random.Generator) -> FloatArray:
    return np.asarray(times[:, rng.integers(times.shape[1], size=times.shape[1])])


_RESAMPLED = {"runs": _resampled_runs, "scenes": _resampled_scenes}


def _percentiles(values: FloatArray, level: float) -> tuple[float, float]:
    # Some samples may have no solved run; they say nothing about the time of solved runs.
    values = values[~np.isnan(values)]
    if len(values) == 0:
        return math.nan, math.nan
    low, high = np.quantile(values, [(1 - level) / 2, (1 + level) / 2], method="inverted_cdf")
    return float(low), float(high)


@dataclass(frozen=True)
class Comparison:
    """Two methods on the same scenes and seeds.

    Attributes:
        pairs: Runs that both have.
        wins: Pairs in which the first method is better: it alone solves, or both do and it takes less time.
        ties: Pairs that neither solves, or that both solve in about the same time.
        losses: Pairs in which the second method is better.
        difference: Mean over the scenes of PAR2 of the first less that of the second [s]; negative is better.
        interval: 95 % bootstrap interval of the difference over the scenes [s]; over the runs if there is one scene.
        scenes: Scenes that the first method wins, that are ties, and that it loses, by mean PAR2.
    """

    pairs: int
    wins: int
    ties: int
    losses: int
    difference: float
    interval: tuple[float, float]
    scenes: tuple[int, int, int]


def compare(
    first: FloatArray, second: FloatArray, limit: float, rng: np.random.Generator, *, resamples: int = RESAMPLES
) -> Comparison:
    """Compares two methods run by run.

    Args:
        first: (runs, scenes) [s] of one method.
        second: The same of the other one; the same shape, the same seeds in the same rows.
        limit: Time limit [s]; an unsolved run counts twice as much.
        rng: Source of the bootstrap samples.
        resamples: Number of samples.

    Raises:
        ValueError: the shapes differ.
    """
    if first.shape != second.shape:
        raise ValueError(f"times of shapes {first.shape} and {second.shape} cannot be paired")
    both = ~np.isnan(first) & ~np.isnan(second)
    a, b = (np.where(both, np.where(np.isfinite(t), t, 2 * limit), np.nan) for t in (first, second))
    signs = _signs(a[both], b[both])
    a, b = a[:, both.any(axis=0)], b[:, both.any(axis=0)]
    scene_signs = _signs(_column_means(a), _column_means(b))
    differences = a - b
    return Comparison(
        pairs=int(both.sum()),
        wins=int((signs < 0).sum()),
        ties=int((signs == 0).sum()),
        losses=int((signs > 0).sum()),
        difference=_mean_of_scenes(differences),
        interval=bootstrap_interval(
            differences,
            _mean_of_scenes,
            rng,
            resampled="runs" if differences.shape[1] == 1 else "scenes",
            resamples=resamples,
        ),
        scenes=(int((scene_signs < 0).sum()), int((scene_signs == 0).sum()), int((scene_signs > 0).sum())),
    )


def _signs(a: FloatArray, b: FloatArray) -> FloatArray:
    """-1 where a is less than b, 1 where it is more, 0 where they are about the same."""
    return np.where(np.abs(a - b) <= TIE * np.maximum(a, b), 0.0, np.sign(a - b))


def _column_means(values: FloatArray) -> FloatArray:
    present = ~np.isnan(values)
    return np.asarray(np.where(present, values, 0.0).sum(axis=0) / np.maximum(present.sum(axis=0), 1))


def _mean_of_scenes(values: FloatArray) -> float:
    present = ~np.isnan(values).all(axis=0)
    return float(_column_means(values[:, present]).mean()) if present.any() else math.nan


def solved_within(times: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The solved-versus-time curve (cactus plot): after `seconds[i]` the share `shares[i]` of the runs is solved.

    Returns:
        Seconds (n,), rising, and shares (n,) of all runs.
    """
    ran = times[~np.isnan(times)]
    seconds = np.sort(ran[np.isfinite(ran)])
    return seconds, np.arange(1, len(seconds) + 1) / max(len(ran), 1)

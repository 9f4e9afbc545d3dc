"""Statistics of trials, as small functions of plain numbers."""

import math
from collections.abc import Sequence

NORMAL_95 = 1.959963984540054
"""The 97.5 % quantile of the standard normal distribution."""


def mean(values: Sequence[float]) -> float | None:
    """Arithmetic mean; None without values."""
    return math.fsum(values) / len(values) if values else None


def deviation(values: Sequence[float]) -> float | None:
    """Sample standard deviation (n - 1); 0 for one value, None without values."""
    if not values:
        return None
    centre = math.fsum(values) / len(values)
    squares = math.fsum((value - centre) ** 2 for value in values)
    return math.sqrt(squares / max(len(values) - 1, 1))


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

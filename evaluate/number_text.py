"""Numbers as people read them."""

import math

MAX_DECIMALS = 5


def three_digits(value: float) -> str:
    """A number with three significant digits down to 0.001, never in exponent notation: `0.00123`, `12.3`, `1234`."""
    if value == 0:
        return "0"
    decimals = min(max(2 - math.floor(math.log10(abs(value))), 0), MAX_DECIMALS)
    return f"{value:.{decimals}f}"


def duration(seconds: float) -> str:
    """A time with three significant digits in a unit that suits it: `310 ns`, `12.3 ms`, `1.50 s`."""
    for unit, factor in (("ns", 1e9), ("us", 1e6), ("ms", 1e3)):
        if seconds * factor < 1000:
            return f"{three_digits(seconds * factor)} {unit}"
    return f"{three_digits(seconds)} s"

"""Numbers as people read them."""

import pytest

from evaluate.number_text import duration, three_digits


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (0.000123, "0.00012"),
        (0.00123, "0.00123"),
        (0.5, "0.500"),
        (-10.0, "-10.0"),
        (99.97, "100.0"),
        (234.56, "235"),
        (1e7, "10000000"),
    ],
)
def test_numbers_have_three_digits(value: float, text: str):
    """Numbers read well over ten orders of magnitude, whole numbers keep all digits."""
    assert three_digits(value) == text


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0, "0 ns"),
        (7.25e-8, "72.5 ns"),
        (1.234e-5, "12.3 us"),
        (0.0456, "45.6 ms"),
        (1.5, "1.50 s"),
        (7200.0, "7200 s"),
    ],
)
def test_times_have_a_unit_that_suits_them(seconds: float, text: str):
    """Three digits before and behind the point, from nanoseconds to hours."""
    assert duration(seconds) == text

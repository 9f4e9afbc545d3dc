"""Numbers as people read them."""

import pytest

from evaluate.number_text import three_digits


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

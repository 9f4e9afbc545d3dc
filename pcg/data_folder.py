"""Where the data that comes with the product is: puzzles, scenes, demonstrations, policies, studies."""

import sys
from pathlib import Path

from pcg.errors import InputError

_PLACES = (Path(__file__).parents[1] / "data", Path(sys.prefix) / "share" / "manipuzzle" / "data")
"""In a checkout beside the packages; in an installation where the wheel puts shared data."""


def data_folder() -> Path:
    """The folder `data` of the checkout or of the installation.

    Raises:
        InputError: it was not installed.
    """
    for place in _PLACES:
        if place.is_dir():
            return place
    raise InputError("data", f"not installed; looked in {' and '.join(map(str, _PLACES))}")

"""Where the data that comes with the product is: puzzles, corpus, demonstrations, policies, studies."""

from pathlib import Path

from pcg.errors import InputError

_PLACES = (Path(__file__).parent / "data", Path(__file__).parents[1] / "data")
"""In an installation inside this package; in a checkout beside the packages."""


def data_folder() -> Path:
    """The folder `data` of the installation or of the checkout.

    Raises:
        InputError: it was not installed.
    """
    for place in _PLACES:
        if place.is_dir():
            return place
    raise InputError("data", f"not installed; looked in {' and '.join(map(str, _PLACES))}")

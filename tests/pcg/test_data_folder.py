"""Where the product's data is."""

from pathlib import Path

import pytest

from pcg import data_folder
from pcg.errors import InputError


def test_the_checkout_holds_the_puzzles():
    """Beside the packages of a checkout there is the folder with the puzzles."""
    assert (data_folder.data_folder() / "puzzles" / "wall.yaml").is_file()


def test_the_first_place_that_exists_is_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """An installation's own data come before a folder `data` that happens to lie beside the packages."""
    monkeypatch.setattr(data_folder, "_PLACES", (tmp_path / "installed", tmp_path / "beside"))
    (tmp_path / "beside").mkdir()
    assert data_folder.data_folder() == tmp_path / "beside"
    (tmp_path / "installed").mkdir()
    assert data_folder.data_folder() == tmp_path / "installed"


def test_missing_data_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Where data was not installed the message says where it was looked for."""
    monkeypatch.setattr(data_folder, "_PLACES", (tmp_path / "nowhere",))
    with pytest.raises(InputError, match=r"^data: not installed; looked in .*nowhere$"):
        data_folder.data_folder()

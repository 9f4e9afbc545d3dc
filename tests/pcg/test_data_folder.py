"""Where the product's data is."""

from pathlib import Path

import pytest

from pcg import data_folder
from pcg.errors import InputError


def test_the_checkout_holds_the_puzzles():
    """Beside the packages of a checkout there is the folder with the puzzles."""
    assert (data_folder.data_folder() / "puzzles" / "wall.yaml").is_file()


def test_the_first_place_that_exists_is_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Without a checkout the installation's shared data is used."""
    (tmp_path / "installed").mkdir()
    monkeypatch.setattr(data_folder, "_PLACES", (tmp_path / "checkout", tmp_path / "installed"))
    assert data_folder.data_folder() == tmp_path / "installed"


def test_missing_data_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Where data was not installed the message says where it was looked for."""
    monkeypatch.setattr(data_folder, "_PLACES", (tmp_path / "nowhere",))
    with pytest.raises(InputError, match=r"^data: not installed; looked in .*nowhere$"):
        data_folder.data_folder()

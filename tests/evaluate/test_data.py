"""The command data."""

import json
from pathlib import Path

from typer.testing import CliRunner

from evaluate.cli import app
from pcg.data_folder import data_folder


def test_the_folder_is_printed_for_shells():
    """Standard output is the path and nothing else, so that `cp -r "$(manipuzzle data)" data` works."""
    assert CliRunner().invoke(app, ["data"]).stdout == f"{data_folder()}\n"


def test_the_document_lists_what_is_there():
    """With --json the parts are named."""
    document = json.loads(CliRunner().invoke(app, ["data", "--json"]).stdout)
    assert Path(document["folder"]) == data_folder()
    assert {"corpus", "human", "policies", "puzzles", "studies"} <= set(document["contents"])

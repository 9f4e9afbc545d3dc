"""Tables with one row a scene."""

import csv
import io
from pathlib import Path

import pytest

from evaluate.published import PublishedTime, read_times
from evaluate.table import Table, as_csv
from evaluate.tables_scenes import plans_table, times_table
from evaluate.trial_frame import read_trials


def texts(table: Table) -> list[list[str]]:
    """The texts of a table; bold ones between asterisks."""
    return [[f"*{entry.text}*" if entry.bold else entry.text for entry in row] for row in table.rows]


def test_times(two_methods: Path):
    """Mean (deviation) of solved runs, of one run the time, Btl without subgoals in brackets, % below 100, - for none."""
    table = times_table(read_trials(two_methods))
    assert table.columns == ("scene", "A", "Btl")
    assert texts(table) == [
        ["wall", "*2.00 (1.41)*", "4.00 [1.00] 50%"],
        ["corner", "-", "*0.600 (0.141) [0.350]*"],
        ["open", "0.100", ""],
    ]


def test_published_times_stand_beside(two_methods: Path):
    """A method with published numbers gets a second column, found under the paper's names of the scenes."""
    published = {
        ("wall", "A"): PublishedTime(190.1, 130.6, 90.0, 32.6),
        ("corner", "A"): PublishedTime(None, None, 0, None),
    }
    table = times_table(read_trials(two_methods), published)
    assert table.columns == ("scene", "A", "A (paper)", "Btl")
    assert [row[2].text for row in table.rows] == ["190.1 (130.6) [32.6] 90%", "-", ""]


def test_csv_has_the_format_of_published_times(two_methods: Path, tmp_path: Path):
    """A study's table can stand beside another study's: what is written reads back as the same numbers."""
    text = as_csv(times_table(read_trials(two_methods)))
    assert len(list(csv.reader(io.StringIO(text)))) == 1 + 5
    path = tmp_path / "times.csv"
    path.write_text(text, encoding="utf-8")
    times = read_times(path)
    assert times["wall", "Btl"] == PublishedTime(4.0, None, 50.0, 1.0)
    assert times["corner", "A"] == PublishedTime(None, None, 0.0, None)
    assert times["wall", "A"].deviation == pytest.approx(2**0.5)


def test_plans(two_methods: Path):
    """Means of pick-places and way over the solved runs, the least of each in bold."""
    table = plans_table(read_trials(two_methods))
    assert table.columns[1:3] == ("A pick-places", "A path [m]")
    assert texts(table)[0] == ["wall", "*1.5*", "3.5", "2.0", "*3.0*"]
    assert texts(table)[1] == ["corner", "-", "-", "*2.0*", "*3.5*"]

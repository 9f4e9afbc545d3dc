"""What commands print."""

import json

import pytest

from evaluate.output import loading, print_json, print_table, progress


def test_tables_show_values_as_people_write_them(capsys: pytest.CaptureFixture[str]):
    """Nothing is a dash, truth is a word, numbers stand to the right, and brackets are no markup."""
    print_table(["name", "time [s]", "ok"], [("[bold]a[/bold]", 0.5, True), ("b", None, False)], title="Results")
    captured = capsys.readouterr()
    assert captured.out.splitlines()[0] == "Results"
    assert [line.split() for line in captured.out.splitlines() if "─" not in line][1:] == [
        ["name", "time", "[s]", "ok"],
        ["[bold]a[/bold]", "0.500", "yes"],
        ["b", "-", "no"],
    ]
    assert captured.err == ""


def test_long_cells_are_not_cut(capsys: pytest.CaptureFixture[str]):
    """Without a terminal a row is one line, however long."""
    print_table(["path"], [("x" * 500,)])
    assert "x" * 500 in capsys.readouterr().out


def test_json_is_one_document_of_plain_characters(capsys: pytest.CaptureFixture[str]):
    """Any encoding can carry it, and numbers that JSON lacks are refused."""
    print_json({"name": "Möbius"})
    out = capsys.readouterr().out
    assert out.isascii()
    assert json.loads(out) == {"name": "Möbius"}
    with pytest.raises(ValueError, match="not JSON compliant"):
        print_json({"time": float("inf")})


def test_no_progress_in_a_pipe(capsys: pytest.CaptureFixture[str]):
    """A progress display prints nothing unless stderr is a terminal."""
    with loading():
        pass
    with progress("extra") as bar:
        assert list(bar.track(range(3))) == [0, 1, 2]
    assert capsys.readouterr() == ("", "")

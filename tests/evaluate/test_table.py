"""Tables as text."""

import csv
import io

import pytest

from evaluate.table import Entry, Table, as_csv, as_latex, as_markdown

TABLE = Table(
    "name",
    "Times & more",
    "In `s`.",
    ("scene", "Rnd+R"),
    ((Entry("a|b_1"), Entry("1.5 (0.1) 90%", bold=True)), (Entry("<b>"), Entry("-"))),
)


def test_markdown():
    """Bold entries get asterisks; what would be markup or end a cell is escaped."""
    assert as_markdown(TABLE).splitlines()[4:] == [
        "| scene | Rnd+R |",
        "| --- | ---: |",
        r"| a\|b\_1 | **1.5 (0.1) 90%** |",
        r"| \<b\> | - |",
    ]


def test_latex():
    """Special characters are escaped, bold entries set so, columns but the first to the right."""
    text = as_latex(TABLE)
    assert r"\begin{tabular}{lr}" in text
    assert r"a|b\_1 & \textbf{1.5 (0.1) 90\%} \\" in text
    assert r"$<$b$>$ & - \\" in text
    assert r"\caption{Times \& more. In s.}" in text


def test_csv():
    """The texts, or the numbers that the table brings along, read back as they were."""
    assert list(csv.reader(io.StringIO(as_csv(TABLE))))[1] == ["a|b_1", "1.5 (0.1) 90%"]
    numbers = Table("n", "t", "", ("a",), (), data=(("x", "y"), ((1.5, None), ("a,b", 2))))
    assert as_csv(numbers) == 'x,y\n1.5,\n"a,b",2\n'


def test_rows_are_complete():
    """A row with an entry too few is a programming error."""
    with pytest.raises(ValueError, match="does not have 2 entries"):
        Table("n", "t", "", ("a", "b"), ((Entry("1"),),))

"""Tables for papers: rows of texts, and how to write them as Markdown, LaTeX and CSV."""

import csv
import io
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pcg.printable import printable

_LATEX = str.maketrans(
    {
        "\\": r"\textbackslash{}",
        "&": r"\&",
        "%": r"\%",
        "$": r"\$",
        "#": r"\#",
        "_": r"\_",
        "{": r"\{",
        "}": r"\}",
        "~": r"\textasciitilde{}",
        "^": r"\textasciicircum{}",
        "±": r"$\pm$",
        "<": r"$<$",
        ">": r"$>$",
        "≥": r"$\geq$",
        "≤": r"$\leq$",
        "∞": r"$\infty$",
    }
)

_NUMBERS = re.compile(r"[-+]?[0-9][-+.0-9 ()%to/]*")
"""A number, or several such as an estimate and its interval."""

_MARKDOWN = str.maketrans({character: "\\" + character for character in "\\`*_[]<>|~#"})


@dataclass(frozen=True)
class Entry:
    """What stands in one place of a table.

    Attributes:
        text: The text.
        bold: Whether it is the best of its row.
        value: What the column is sorted by; None comes last, and a column without any value is sorted by text.
    """

    text: str
    bold: bool = False
    value: float | None = None


BLANK = Entry("")


@dataclass(frozen=True)
class Table:
    """A table whose first column names the rows.

    Attributes:
        name: Stem of its files.
        title: What it shows.
        note: How to read it.
        columns: Heads of the columns.
        rows: As many entries each as there are columns.
        data: What a CSV file holds instead of the texts: heads and rows of plain values.
    """

    name: str
    title: str
    note: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Entry, ...], ...]
    data: tuple[tuple[str, ...], tuple[tuple[object, ...], ...]] | None = None

    def __post_init__(self) -> None:
        if any(len(row) != len(self.columns) for row in self.rows):
            raise ValueError(f"table {self.name!r}: a row does not have {len(self.columns)} entries")


def as_markdown(table: Table) -> str:
    """The table with title and note as a Markdown document."""
    head = [_markdown_line([_markdown_text(column) for column in table.columns])]
    head.append(_markdown_line(["---", *["---:"] * (len(table.columns) - 1)]))
    rows = [_markdown_line([_markdown_entry(entry) for entry in row]) for row in table.rows]
    return "\n".join([f"# {_markdown_text(table.title)}", "", table.note, "", *head, *rows, ""])


def as_latex(table: Table) -> str:
    """A `table*` environment in the style of the package booktabs, to be read into a paper."""
    rows = [" & ".join(map(_latex_entry, row)) + r" \\" for row in table.rows]
    lines = [
        f"% {' '.join(table.title.split())}; needs \\usepackage{{booktabs}}",
        r"\begin{table*}",
        r"\centering",
        rf"\caption{{{table.title.translate(_LATEX)}. {_latex_note(table.note)}}}",
        rf"\label{{tab:{table.name}}}",
        rf"\begin{{tabular}}{{l{'r' * (len(table.columns) - 1)}}}",
        r"\toprule",
        " & ".join(_plain(column).translate(_LATEX) for column in table.columns) + r" \\",
        r"\midrule",
        *rows,
        r"\bottomrule",
        r"\end{tabular}",
        r"\end{table*}",
        "",
    ]
    return "\n".join(lines)


def as_csv(table: Table) -> str:
    """Heads and rows, without title and note."""
    columns, rows = table.data or (table.columns, [[entry.text for entry in row] for row in table.rows])
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(map(_csv_value, columns))
    writer.writerows(map(_csv_value, row) for row in rows)
    return file.getvalue()


WRITERS: dict[str, Callable[[Table], str]] = {"md": as_markdown, "tex": as_latex, "csv": as_csv}
"""The text of a table's file by its suffix."""


def _csv_value(value: object) -> object:
    """The value; text that a spreadsheet would take for a formula gets an apostrophe in front."""
    is_formula = isinstance(value, str) and value.startswith(("=", "+", "-", "@")) and not _NUMBERS.fullmatch(value)
    return f"'{value}" if is_formula else value


def _plain(text: str) -> str:
    return printable(" ".join(text.split()))


def _markdown_text(text: str) -> str:
    return _plain(text).translate(_MARKDOWN)


def _markdown_entry(entry: Entry) -> str:
    text = _markdown_text(entry.text)
    return f"**{text}**" if entry.bold and text else text


def _markdown_line(texts: Sequence[str]) -> str:
    return "| " + " | ".join(texts) + " |"


def _latex_entry(entry: Entry) -> str:
    text = _plain(entry.text).translate(_LATEX)
    return rf"\textbf{{{text}}}" if entry.bold and text else text


def _latex_note(note: str) -> str:
    return note.replace("`", "").translate(_LATEX)

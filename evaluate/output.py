"""What commands print: results on stdout as a table or as JSON, everything else on stderr."""

import io
import json
import sys
from collections.abc import Iterable, Sequence
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Table
from rich.text import Text

from evaluate.number_text import three_digits
from pcg.printable import printable

__all__ = ["Progress", "counted", "loading", "log", "print_json", "print_line", "print_table", "progress"]

PIPE_WIDTH = 10_000
"""Line width where no terminal limits it, so that no table is cut."""


def print_json(document: Any) -> None:
    """Prints one JSON document."""
    sys.stdout.write(json.dumps(document, indent=1, allow_nan=False) + "\n")


def print_table(columns: Sequence[str], rows: Iterable[Sequence[object]], title: str | None = None) -> None:
    """Prints a table: None as `-`, Booleans as yes and no, numbers to the right."""
    table = Table(title=title, box=SIMPLE_HEAD, title_justify="left", pad_edge=False)
    rows = [list(row) for row in rows]
    for i, column in enumerate(columns):
        numeric = any(_is_number(row[i]) for row in rows)
        table.add_column(Text(column), justify="right" if numeric else "left", overflow="fold")
    for row in rows:
        # Text objects, because cells may hold square brackets, which rich would take for markup.
        table.add_row(*(Text(_cell(value)) for value in row))
    sys.stdout.write(_rendered(table))


def print_line(text: str) -> None:
    """Prints a line of results for people."""
    sys.stdout.write(printable(text) + "\n")


def counted(number: int, thing: str) -> str:
    """A number of things: `1 level`, `2 levels`."""
    return f"{number} {thing}{'' if number == 1 else 's'}"


def log(text: str) -> None:
    """Prints a line on stderr."""
    sys.stderr.write(printable(text) + "\n")


def progress(*extra: str) -> Progress:
    """A progress display on stderr; it shows nothing unless that is a terminal.

    Args:
        extra: Names of fields that tasks show behind the time that remains.
    """
    console = Console(file=sys.stderr)
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        *(TextColumn(f"{{task.fields[{name}]}}") for name in extra),
        console=console,
        disable=not console.is_terminal,
        transient=True,
    )


def loading() -> Progress:
    """Says on a terminal why nothing happens yet, for as long as it is entered."""
    console = Console(file=sys.stderr)
    columns = SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn()
    shown = Progress(*columns, console=console, disable=not console.is_terminal, transient=True)
    shown.add_task("loading; the first run also compiles", total=None)
    return shown


def _rendered(table: Table) -> str:
    """The text of a table; rich itself would end the program when a pipe is closed, so it does not write."""
    terminal = sys.stdout.isatty()
    width = None if terminal else PIPE_WIDTH
    console = Console(file=io.StringIO(), width=width, force_terminal=terminal, highlight=False)
    with console.capture() as capture:
        console.print(table)
    lines = (line.rstrip() for line in capture.get().splitlines())
    return "".join(f"{line}\n" for line in lines if line)


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _cell(value: object) -> str:
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return three_digits(value) if isinstance(value, float) else printable(str(value))

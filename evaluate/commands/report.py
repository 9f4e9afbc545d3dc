"""`manipuzzle report`: tables, plots and one HTML page from the trials of a study."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from evaluate.commands.options import Json, application
from evaluate.inputs import require_choice, require_writable
from evaluate.output import print_json, print_line, print_table, progress
from evaluate.plot_style import FORMATS as PLOT_FORMATS
from evaluate.plot_style import write_figure
from evaluate.published import read_times, table_one
from evaluate.report import Report, gallery, read_report
from evaluate.report_html import write_page
from evaluate.table import WRITERS, Table
from evaluate.trial_frame import write_parquet
from pcg.files import write_text

FORMATS = ("html", *WRITERS, *PLOT_FORMATS, "parquet")
PAPER = "paper"
"""What stands for the numbers of the paper, which come with the product."""


app = application()


@app.command()
def run(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a study.")],
    *,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder for the results.", show_default="DIR/report")
    ] = None,
    format_: Annotated[
        list[str] | None,
        typer.Option(
            "--format",
            metavar="NAME",
            help="html, md, tex, csv, svg, pdf, png or parquet; repeat for several.",
            show_default="all",
        ),
    ] = None,
    published: Annotated[
        str | None,
        typer.Option(
            metavar="FILE", help="CSV file of published times to stand beside, or `paper`.", show_default=False
        ),
    ] = None,
    json: Json = False,
) -> bool:
    """Write the tables and plots of a study, and report.html: all of them on one page, with every scene and its plan.

    Example:  manipuzzle report out/study --published paper
    """
    for name in format_ or []:
        require_choice("--format", name, FORMATS)
    chosen = format_ or FORMATS
    beside = None if published is None else read_times(table_one() if published == PAPER else Path(published))
    out = out or folder / "report"
    with progress() as bar:
        task = bar.add_task("scenes", total=None)
        report = read_report(folder, beside, lambda: bar.update(task, advance=1))
    require_writable(out)
    files = [*_write_tables(report, out, chosen), *_write_plots(report, out, chosen)]
    if "parquet" in chosen:
        files.append(out / "trials.parquet")
        write_parquet(folder, files[-1])
    if "html" in chosen:
        files.insert(0, out / "report.html")
        write_page(files[0], report, gallery(folder, report.methods))
    if json:
        print_json({"trials": report.trials, "solved": report.solved, "files": [str(file) for file in files]})
    else:
        _print(report.tables[0])
        print_line(f"{len(files)} files written to {out}, {files[0].name} first")
    return True


def _write_tables(report: Report, out: Path, formats: Sequence[str]) -> list[Path]:
    written = []
    for table in report.tables:
        for suffix, text_of in WRITERS.items():
            if suffix in formats:
                written.append(out / "tables" / f"{table.name}.{suffix}")
                write_text(written[-1], text_of(table))
    return written


def _write_plots(report: Report, out: Path, formats: Sequence[str]) -> list[Path]:
    written = []
    for plot in report.plots:
        for suffix in PLOT_FORMATS:
            if suffix in formats:
                written.append(out / "plots" / f"{plot.name}.{suffix}")
                write_figure(written[-1], plot.figure, suffix)
    return written


def _print(table: Table) -> None:
    print_table(table.columns, [[entry.text for entry in row] for row in table.rows])

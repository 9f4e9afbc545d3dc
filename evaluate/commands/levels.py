"""`manipuzzle levels`: what is known about levels."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from evaluate.commands.options import Json, application
from evaluate.inputs import read_playable_levels
from evaluate.output import counted, print_json, print_line, print_table, progress
from pcg.report import report_levels, summarise

app = application()


@app.command()
def run(
    files: Annotated[list[Path], typer.Argument(metavar="FILE", help="XSB files or level sets.")],
    *,
    json: Json = False,
) -> bool:
    """Report on levels: solvable, solution, statistics, duplicates. Exit status 1 if one is not solvable.

    Example:  manipuzzle levels out/levels
    """
    levels = [level for path in files for level in read_playable_levels(path)]
    with progress() as bar:
        reports = list(bar.track(report_levels(levels), total=len(levels), description="levels"))
    summary = summarise(reports)
    if json:
        print_json({"levels": [asdict(report) for report in reports], "summary": asdict(summary)})
    else:
        columns = ["level", "solvable", "pushes", "moves", "crates", "targets", "walls", "regions", "occluded"]
        rows = [
            (r.name, r.solvable, r.pushes, r.moves, r.crates, r.targets, r.walls, r.regions, r.occluded, r.duplicate_of)
            for r in reports
        ]
        print_table([*columns, "duplicate of"], rows)
        print_line(
            f"{counted(summary.levels, 'level')}: {summary.solvable} solvable, {summary.occluded} occluded, "
            f"{counted(summary.duplicates, 'duplicate')}"
        )
        if undecided := sum(report.solvable is None for report in reports):
            print_line(f"solvable -: undecided, the solver gave up on {counted(undecided, 'level')}")
    return all(report.solvable is True for report in reports)

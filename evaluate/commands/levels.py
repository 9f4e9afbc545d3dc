"""`manipuzzle levels`: what is known about levels."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from evaluate.inputs import read_playable_levels
from evaluate.output import print_json, print_line, print_table, progress
from pcg.report import report_levels, summarise


def run(files: Sequence[Path], *, as_json: bool) -> bool:
    """Runs the command; see `evaluate.cli.levels`."""
    levels = [level for path in files for level in read_playable_levels(path)]
    with progress() as bar:
        reports = list(bar.track(report_levels(levels), total=len(levels), description="levels"))
    summary = summarise(reports)
    if as_json:
        print_json({"levels": [asdict(report) for report in reports], "summary": asdict(summary)})
    else:
        columns = ["level", "solvable", "pushes", "moves", "crates", "targets", "walls", "regions", "occluded"]
        rows = [
            (r.name, r.solvable, r.pushes, r.moves, r.crates, r.targets, r.walls, r.regions, r.occluded, r.duplicate_of)
            for r in reports
        ]
        print_table([*columns, "duplicate of"], rows)
        print_line(
            f"{summary.levels} levels: {summary.solvable} solvable, {summary.occluded} occluded, "
            f"{summary.duplicates} duplicates"
        )
    return all(report.solvable is True for report in reports)

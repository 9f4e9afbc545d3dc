"""`manipuzzle merge`: several results folders as one."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from evaluate.merge import merge
from evaluate.output import print_json, print_line
from evaluate.store import StoredTrials, TrialStore
from pcg.errors import InputError


def run(folders: Sequence[Path], out: Path, *, as_json: bool) -> bool:
    """Runs the command; see `evaluate.cli.merge`."""
    for folder in folders:
        if folder.resolve() == out.resolve():
            raise InputError("--out", f"{out} is one of the folders to be merged")
        with StoredTrials(folder):
            pass
    with TrialStore(out) as target:
        merged = merge(folders, target)
        trials = len(target)
    if as_json:
        print_json({"out": str(out), "trials": trials, **asdict(merged)})
    else:
        print_line(f"{merged.added} trials added to {out}, {merged.repeated} were there already; it holds {trials}")
    return True

"""`manipuzzle merge`: several results folders as one."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from evaluate.commands.options import Json, Out, application
from evaluate.merge import merge
from evaluate.output import print_json, print_line
from evaluate.store import StoredTrials, TrialStore
from pcg.errors import InputError

app = application()


@app.command()
def run(
    folders: Annotated[list[Path], typer.Argument(metavar="DIR", help="Results of studies.")],
    *,
    out: Out,
    json: Json = False,
) -> bool:
    """Merge the results of several studies, run on several machines for example, into one folder.

    Example:  manipuzzle merge out/study out/more --out out/all
    """
    for folder in folders:
        if folder.resolve() == out.resolve():
            raise InputError("--out", f"{out} is one of the folders to be merged")
        with StoredTrials(folder):
            pass
    with TrialStore(out) as target:
        merged = merge(folders, target)
        trials = len(target)
    if json:
        print_json({"out": str(out), "trials": trials, **asdict(merged)})
    else:
        print_line(f"{merged.added} trials added to {out}, {merged.repeated} were there already; it holds {trials}")
    return True

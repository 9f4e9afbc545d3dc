"""`manipuzzle diff`: two results folders trial by trial."""

from pathlib import Path
from typing import Annotated

import typer

from evaluate.commands.options import Json, application
from evaluate.compare import Comparison, compare
from evaluate.output import print_json, print_line, print_table
from evaluate.store import StoredTrials

app = application()


@app.command()
def run(
    first: Annotated[Path, typer.Argument(metavar="DIR", help="Results of a study.")],
    second: Annotated[Path, typer.Argument(metavar="DIR", help="Results of another one.")],
    *,
    json: Json = False,
) -> bool:
    """Compare two results trial by trial: same scene, method and seed. Exit status 1 if one solves what the other not.

    Example:  manipuzzle diff out/study out/more
    """
    with StoredTrials(first) as one, StoredTrials(second) as other:
        found = compare(one, other)
    if json:
        print_json(
            {
                "methods": {name: _document(each) for name, each in found.methods.items()},
                "first_alone": found.first_alone,
                "second_alone": found.second_alone,
                "agree": found.agree,
            }
        )
        return found.agree
    columns = ["method", "trials of both", "solved first", "solved second", "only first", "only second", "same plans",
               "time second / first"]  # fmt: skip
    rows = [
        (name, c.both, *c.solved, c.only_first, c.only_second, c.same_plans, c.time_ratio)
        for name, c in found.methods.items()
    ]
    print_table(columns, rows)
    print_line(f"trials of {first} alone: {found.first_alone}, of {second} alone: {found.second_alone}")
    return found.agree


def _document(each: Comparison) -> dict[str, object]:
    return {
        "both": each.both,
        "solved_first": each.solved[0],
        "solved_second": each.solved[1],
        "only_first": each.only_first,
        "only_second": each.only_second,
        "same_plans": each.same_plans,
        "time_ratio": each.time_ratio,
    }

"""`manipuzzle demonstrate`: writes down where a person would put the objects of a scene."""

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from converter.plan import Subgoal
from evaluate.commands.options import Json, SceneFile, application
from evaluate.inputs import read_scene_file
from evaluate.output import log, print_json, print_line
from pcg.errors import InputError
from planner.demonstration import Demonstration, require_suitable, write_demonstration
from planner.problem import Problem

app = application()

FORM = "object:x,y"


@app.command()
def run(
    scene: SceneFile,
    *,
    out: Annotated[Path, typer.Option(metavar="FILE", help="Demonstration file (.yaml).")],
    point: Annotated[
        list[str] | None,
        typer.Option(
            metavar="OBJECT:X,Y", help="Where an object is put next [m]; repeat in order.", show_default=False
        ),
    ] = None,
    json: Json = False,
) -> bool:
    """Write a demonstration for method Hum: positions of objects, in order, from --point or from lines on stdin.

    Method Hum+R takes those of data/human, called after their scenes.

    Example:  manipuzzle demonstrate data/puzzles/wall.yaml --point obj:-1.75,-1.0 --out out/human/wall.yaml
    """
    setting = read_scene_file(scene)
    problem = Problem(setting)
    if not point and sys.stdin.isatty():
        log(f"{FORM}, one a line, in order ({', '.join(setting.object_names)}); Ctrl-D ends")
    demonstration = Demonstration(setting.name, typed_subgoals(point or [], sys.stdin))
    require_suitable(problem, demonstration, "demonstration")
    write_demonstration(out, demonstration)
    if json:
        print_json({"scene": setting.name, "subgoals": len(demonstration.subgoals), "file": str(out)})
    else:
        print_line(f"{len(demonstration.subgoals)} subgoals of {setting.name} written to {out}")
    return True


def subgoal_of(text: str, where: str) -> Subgoal:
    """The subgoal that `text`, such as `obj:-1.2,0.5`, describes.

    Raises:
        InputError: it has another form; `where` begins the message.
    """
    name, _, place = text.strip().rpartition(":")
    try:
        return Subgoal(name, np.array([float(number) for number in place.split(",")]))
    except ValueError:
        raise InputError(where, f"found {text.strip()!r}, wanted is {FORM} in metres") from None


def typed_subgoals(points: Sequence[str], lines: Iterable[str]) -> tuple[Subgoal, ...]:
    """The subgoals of the command's `points`, or else of the non-empty `lines`.

    Raises:
        InputError: one cannot be read, or there are none.
    """
    texts = [("--point", text) for text in points]
    texts = texts or [(f"line {i}", line) for i, line in enumerate(lines, start=1) if line.strip()]
    if not texts:
        raise InputError("subgoals", f"none given; use --point {FORM} or one {FORM} a line on stdin")
    return tuple(subgoal_of(text, where) for where, text in texts)

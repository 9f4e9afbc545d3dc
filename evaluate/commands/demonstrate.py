"""`manipuzzle demonstrate`: writes down where a person would put the objects of a scene."""

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from converter.plan import Subgoal
from evaluate.inputs import read_scene_file
from evaluate.output import log, print_json, print_line
from pcg.errors import InputError
from planner.demonstration import Demonstration, require_suitable, write_demonstration
from planner.problem import Problem

FORM = "object:x,y"


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


def run(path: Path, out: Path, points: Sequence[str], *, as_json: bool) -> bool:
    """Runs the command; see `evaluate.cli.demonstrate`."""
    scene = read_scene_file(path)
    problem = Problem(scene)
    if not points and sys.stdin.isatty():
        log(f"{FORM}, one a line, in order ({', '.join(scene.object_names)}); Ctrl-D ends")
    demonstration = Demonstration(scene.name, typed_subgoals(points, sys.stdin))
    require_suitable(problem, demonstration, "demonstration")
    write_demonstration(out, demonstration)
    if as_json:
        print_json({"scene": scene.name, "subgoals": len(demonstration.subgoals), "file": str(out)})
    else:
        print_line(f"{len(demonstration.subgoals)} subgoals of {scene.name} written to {out}")
    return True

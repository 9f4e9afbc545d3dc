"""Demonstrations: where a person would put the objects of a scene, in order, and their file.

    format: 1
    scene: wall
    subgoals:
    - {object: obj, position: [-1.8, -1.2]}
    - {object: obj, position: [-1.8, 0.9]}

Positions are centres of footprints [m], world.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from converter.formats.body_document import Name, Number
from converter.plan import Subgoal
from converter.shape import FloatArray
from pcg import yaml_text
from pcg.errors import InputError
from pcg.files import read_text, write_text
from pcg.validation import Document, validated
from planner.problem import Problem

MAX_BYTES = 1_000_000
MAX_SUBGOALS = 10_000


@dataclass(frozen=True)
class Demonstration:
    """Subgoals for the objects of a scene.

    Attributes:
        scene: Name of the scene.
        subgoals: In the order of the demonstration.
    """

    scene: str
    subgoals: tuple[Subgoal, ...]

    def positions(self, name: str) -> FloatArray:
        """Where object `name` is put, (n, 2) [m], world, in order."""
        return np.array([subgoal.position for subgoal in self.subgoals if subgoal.object == name]).reshape(-1, 2)


class _Subgoal(Document):
    object: Name
    position: tuple[Number, Number]


class _Demonstration(Document):
    format: Literal[1]
    scene: Name
    subgoals: Annotated[tuple[_Subgoal, ...], Field(min_length=1, max_length=MAX_SUBGOALS)]


def read_demonstration(path: Path) -> Demonstration:
    """Reads and validates a demonstration's file.

    Raises:
        InputError: naming file, field or line, and reason.
    """
    document = validated(_Demonstration, yaml_text.parse(read_text(path, MAX_BYTES), str(path)), str(path))
    return Demonstration(document.scene, tuple(Subgoal(s.object, np.array(s.position)) for s in document.subgoals))


def write_demonstration(path: Path, demonstration: Demonstration) -> None:
    """Writes a demonstration's file.

    Raises:
        InputError: the path cannot be written, or a name or number is beyond what a file may hold.
    """
    subgoals = [{"object": s.object, "position": s.position.tolist()} for s in demonstration.subgoals]
    document = {"format": 1, "scene": demonstration.scene, "subgoals": subgoals}
    validated(_Demonstration, document, demonstration.scene)
    document["subgoals"] = [yaml_text.Flow(subgoal) for subgoal in subgoals]
    write_text(path, yaml_text.dump(document))


def require_suitable(problem: Problem, demonstration: Demonstration, where: str) -> None:
    """Refuses a demonstration of another scene, of unknown objects, or of places in walls or out of bounds.

    Raises:
        InputError: naming the field and the reason; `where` begins the message.
    """
    names = problem.scene.object_names
    if demonstration.scene != problem.scene.name:
        raise InputError(where, f"scene: found {demonstration.scene!r}, the scene is {problem.scene.name!r}")
    for i, subgoal in enumerate(demonstration.subgoals):
        field, place = f"subgoals[{i}]", subgoal.position.tolist()
        if subgoal.object not in names:
            raise InputError(where, f"{field}.object: found {subgoal.object!r}, the scene has {', '.join(names)}")
        if not problem.wall_space(names.index(subgoal.object)).point_free(subgoal.position):
            raise InputError(where, f"{field}.position: at {place} {subgoal.object!r} is in a wall or out of bounds")

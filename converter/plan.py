"""Plans: what a planner returns for a scene, and their JSON file.

A plan is a sequence of segments. In a `move` the agent drives alone; in a `carry` it holds one object from the first
way-point to the last, where it releases it. `path` holds agent centres joined by straight lines, and consecutive
segments share their end point.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from converter.formats import scene_yaml
from converter.formats.body_document import Name, Number, Text
from converter.polyline import path_length
from converter.scene import Scene
from converter.shape import FloatArray, frozen_array
from pcg import json_text
from pcg.errors import InputError
from pcg.files import read_text, write_text
from pcg.validation import Document, PlainText, PlainValues, validated

TOUCH_SLACK = 1e-6
"""Agent and object touch if their gap is no more than the scene's tolerance plus this [m]."""

MAX_SEGMENTS = 10_000
"""Segments, and subgoals, of a plan's file."""


class Status(StrEnum):
    """How a planning attempt ended."""

    SOLVED = "solved"
    EXHAUSTED = "exhausted"
    """Nothing was left to expand; another seed or larger budgets may help."""
    TIMEOUT = "timeout"
    INFEASIBLE = "infeasible"
    """No plan exists; the plan's `certificate` says why."""
    ERROR = "error"


@dataclass(frozen=True, eq=False)
class Segment:
    """A piece of motion in one mode.

    Attributes:
        mode: `move` (agent alone) or `carry` (agent and `object` as one body).
        object: Name of the carried object; None in a `move`.
        path: (n, 2) [m], world: agent centres, n >= 1.
    """

    mode: Literal["move", "carry"]
    object: str | None
    path: FloatArray

    def __post_init__(self) -> None:
        path = frozen_array(self.path, (None, 2))
        if len(path) == 0:
            raise ValueError("path needs at least one point")
        if (self.mode == "carry") != (self.object is not None):
            raise ValueError(f"a {self.mode} segment {'needs an' if self.mode == 'carry' else 'has no'} object")
        object.__setattr__(self, "path", path)

    @property
    def length(self) -> float:
        """Distance driven [m]."""
        return path_length(self.path)


@dataclass(frozen=True, eq=False)
class Subgoal:
    """A placement that the plan passes through: `object` rests with its centre at `position` (2,) [m], world."""

    object: str
    position: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", frozen_array(self.position, (2,)))


@dataclass(frozen=True, eq=False)
class Plan:
    """The outcome of one planning attempt; without `segments` unless `status` is `solved`.

    Attributes:
        scene: Name of the scene.
        scene_hash: `Scene.geometry_hash` of the scene that was solved.
        method: Name of the planner, such as `Rnd+FPR`.
        seed: Seed of the trial.
        status: How the attempt ended.
        time_s: Wall time of planning [s].
        settings: Every setting of the planner.
        preset: Geometry preset of the scene.
        tolerance: Penetration that was taken for touching [m].
        certificate: With `infeasible`, what proves it; with `exhausted`, what ran out.
        counters: Work done: nodes, subproblems, calls.
        subgoals: Placements in order, the last one in the goal.
        segments: The motion.
        scene_data: The scene itself, so that the file can be drawn and replayed alone; optional in a file.
    """

    scene: str
    scene_hash: str
    method: str
    seed: int
    status: Status
    time_s: float
    tolerance: float
    settings: Mapping[str, Any] = field(default_factory=dict)
    preset: str | None = None
    certificate: str | None = None
    counters: Mapping[str, float] = field(default_factory=dict)
    subgoals: tuple[Subgoal, ...] = ()
    segments: tuple[Segment, ...] = ()
    scene_data: Scene | None = None

    @property
    def solved(self) -> bool:
        """Whether the plan claims to solve its scene; `planner.verify` finds out."""
        return self.status is Status.SOLVED

    @property
    def path_length(self) -> float:
        """Distance that the agent drives [m]."""
        return sum(segment.length for segment in self.segments)

    @property
    def pick_places(self) -> int:
        """How often an object is picked, carried and placed."""
        return sum(segment.mode == "carry" for segment in self.segments)


def write_plan(path: Path, plan: Plan) -> None:
    """Writes a plan as JSON."""
    write_text(path, json.dumps(plan_document(plan), indent=1) + "\n")


def plan_document(plan: Plan) -> dict[str, Any]:
    """The plain values of a plan's file."""
    return {
        "format": 1,
        "scene": plan.scene,
        "scene_hash": plan.scene_hash,
        "method": plan.method,
        "seed": plan.seed,
        "status": plan.status.value,
        "time_s": plan.time_s,
        "settings": dict(plan.settings),
        "preset": plan.preset,
        "tolerance": plan.tolerance,
        "certificate": plan.certificate,
        "counters": dict(plan.counters),
        "cost": {"path_length_m": plan.path_length, "pick_places": plan.pick_places} if plan.solved else None,
        "subgoals": [{"object": s.object, "position": s.position.tolist()} for s in plan.subgoals],
        "segments": [{"mode": s.mode, "object": s.object, "path": s.path.tolist()} for s in plan.segments],
        "scene_data": None if plan.scene_data is None else scene_yaml.to_document(plan.scene_data),
    }


class SubgoalDocument(Document):
    """A placement: `object` rests with its centre at `position`."""

    object: Name
    position: tuple[Number, Number]


class SegmentDocument(Document):
    """A piece of motion: agent centres joined by straight lines; in a `carry` the agent holds `object`."""

    mode: Literal["move", "carry"]
    object: Name | None = None
    path: list[tuple[Number, Number]]


class PlanDocument(Document):
    """The outcome of one planning attempt; lengths in metres, times in seconds."""

    format: Literal[1]
    scene: Text
    scene_hash: Text
    method: Text
    seed: int
    status: Status
    time_s: float
    settings: PlainValues = Field(default_factory=dict)
    preset: str | None = None
    tolerance: float
    certificate: PlainText | None = None
    counters: dict[PlainText, float] = Field(default_factory=dict)
    cost: dict[str, float] | None = None
    subgoals: Annotated[list[SubgoalDocument], Field(max_length=MAX_SEGMENTS)] = Field(default_factory=list)
    segments: Annotated[list[SegmentDocument], Field(max_length=MAX_SEGMENTS)] = Field(default_factory=list)
    scene_data: dict[str, Any] | None = None


def read_plan(path: Path) -> Plan:
    """Reads and validates a plan file.

    Raises:
        InputError: naming file, field and reason.
    """
    return plan_from_document(json_text.parse(read_text(path), str(path)), str(path))


def plan_from_document(data: Any, where: str) -> Plan:
    """The plan of a document as `plan_document` makes it; `where` begins every error message.

    Raises:
        InputError: naming the field and the reason.
    """
    document = validated(PlanDocument, data, where)
    scene = None
    if document.scene_data is not None:
        scene = scene_yaml.from_document(document.scene_data, f"{where}: scene_data")
        if scene.geometry_hash != document.scene_hash:
            raise InputError(where, "scene_data: not the scene that scene_hash names")
    segments = []
    for i, segment in enumerate(document.segments):
        try:
            segments.append(Segment(segment.mode, segment.object, np.array(segment.path).reshape(-1, 2)))
        except ValueError as error:
            raise InputError(where, f"segments[{i}]: {error}") from None
    return Plan(
        scene=document.scene,
        scene_hash=document.scene_hash,
        method=document.method,
        seed=document.seed,
        status=document.status,
        time_s=document.time_s,
        tolerance=document.tolerance,
        settings=document.settings,
        preset=document.preset,
        certificate=document.certificate,
        counters=document.counters,
        subgoals=tuple(Subgoal(s.object, np.array(s.position)) for s in document.subgoals),
        segments=tuple(segments),
        scene_data=scene,
    )

"""Where the scenes of a study come from: scene files and level sets by path, filtered, in one or both geometries.

`${NAME}` in a path stands for an environment variable. Levels are converted on the fly with the default sizes. Scenes
that are invalid at the start are left out, and said to be: in the geometry `published` the outer walls reach into the
border cells, so that a level whose robot begins there makes no valid scene.
"""

import glob
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from converter.convert import ConversionSettings, convert_level
from converter.preset import CLEAR
from converter.scene import Scene
from evaluate.inputs import adapted, is_scene, read_playable_levels, read_scene_file
from evaluate.names import safe_name
from evaluate.scene_filter import Condition, by_cost, fulfils, require_facts
from pcg.errors import InputError
from pcg.validation import Document
from planner.problem import Problem

PresetName = Literal["clear", "published"]
Presets = Annotated[list[PresetName], Field(min_length=1)]

MAX_FILES = 100_000
"""Files that a pattern may match."""

_VARIABLE = re.compile(r"\$\{([A-Za-z_][A-Za-z0-9_]*)\}")


class SceneSourceDocument(Document):
    """An entry of `scenes` in a study's file.

    Attributes:
        files: Scene files, XSB files or folders of level sets; may hold `*`, `?` and `**`.
        presets: Geometries; by default those of the study.
        where: Conditions that scenes have to meet.
        take: How many of those that meet them belong to the study, spread evenly over their order; None for all.
        optional: Whether the study goes on without these scenes if there are no such files.
    """

    files: Annotated[str, Field(min_length=1)]
    presets: Presets | None = None
    where: dict[str, Condition] = Field(default_factory=dict)
    take: Annotated[int, Field(ge=1)] | None = None
    optional: bool = False


@dataclass(frozen=True)
class Reading:
    """How scenes are read.

    Attributes:
        folder: Where relative paths begin.
        presets: Geometries of the sources that name none; None keeps that of scene files, and takes `clear` for levels.
        tolerance: Penetration that counts as touching [m]; None keeps the scene's.
    """

    folder: Path
    presets: Sequence[str | None] = (None,)
    tolerance: float | None = None


@dataclass
class FoundScenes:
    """The scenes of some sources, and what a person should know about what is missing."""

    scenes: list[Scene] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def read_sources(sources: Sequence[SceneSourceDocument], reading: Reading, where: str) -> FoundScenes:
    """All scenes of all sources; `where` names the study's file in messages.

    Raises:
        InputError: nothing matches a path, a file cannot be read, or a condition is about an unknown fact.
    """
    found = FoundScenes()
    for i, source in enumerate(sources):
        place = f"{where}: scenes[{i}]"
        require_facts(source.where, f"{place}.where")
        try:
            paths = _matches(source.files, reading.folder)
        except InputError as error:
            if not source.optional:
                raise InputError(place, str(error)) from None
            found.notes.append(f"{place}: left out: {error}")
            continue
        _take(found, source, paths, reading, place)
    return found


def _take(found: FoundScenes, source: SceneSourceDocument, paths: Sequence[Path], reading: Reading, place: str) -> None:
    presets: Sequence[str | None] = source.presets or reading.presets
    easy, hard = by_cost(source.where)
    before = len(found.scenes)
    for preset in presets:
        scenes = [scene for path in paths for scene in _read(path, preset, reading.tolerance)]
        suitable = [scene for scene in scenes if fulfils(scene, easy)]
        faults = {id(scene): fault for scene in suitable if (fault := _fault(scene)) is not None}
        if faults:
            found.notes.append(_left_out(place, preset, len(suitable), list(faults.values())))
        valid = [scene for scene in suitable if id(scene) not in faults and fulfils(scene, hard)]
        found.scenes += _spread(valid, source.take, f"{place}.take")
    if len(found.scenes) == before:
        wanted = "meets the conditions and is valid" if source.where else "is valid"
        raise InputError(place, f"none of the scenes in {source.files!r} {wanted}")


def _fault(scene: Scene) -> str | None:
    """Why a scene is invalid at the start; None if it is not."""
    try:
        Problem(scene)
    except InputError as error:
        return str(error)
    return None


def _left_out(place: str, preset: str | None, n: int, faults: Sequence[str]) -> str:
    geometry = "" if preset is None else f" in the geometry {preset}"
    return (
        f"{place}: left out: {len(faults)} of {n} scenes{geometry}, which are invalid at the start; first {faults[0]}"
    )


def _read(path: Path, preset: str | None, tolerance: float | None) -> Iterator[Scene]:
    if is_scene(path):
        yield read_scene_file(path, preset, tolerance)
        return
    settings = ConversionSettings(preset=preset or CLEAR.name)
    for level in read_playable_levels(path):
        yield adapted(replace(convert_level(level, settings), name=safe_name(level.name)), None, tolerance)


def _spread(scenes: list[Scene], take: int | None, where: str) -> list[Scene]:
    if take is None or take == len(scenes):
        return scenes
    if take > len(scenes):
        raise InputError(where, f"{take} scenes are wanted, but there are {len(scenes)}")
    return [scenes[i] for i in np.linspace(0, len(scenes) - 1, take).round().astype(np.int64)]


def _matches(pattern: str, folder: Path) -> list[Path]:
    expanded = _expanded(pattern, os.environ)
    if expanded.count("**") > 1:
        raise InputError("", f"more than one ** in {expanded!r}")
    matches = glob.iglob(expanded, root_dir=folder, recursive=True)  # noqa: PTH207  # takes absolute patterns
    found = sorted(islice(matches, MAX_FILES + 1))
    if len(found) > MAX_FILES:
        raise InputError("", f"{expanded!r} matches more than {MAX_FILES} files")
    if not found:
        raise InputError("", f"nothing matches {expanded!r} (relative to {folder})")
    return [folder / path for path in found]


def _expanded(pattern: str, variables: Mapping[str, str]) -> str:
    def value(match: re.Match[str]) -> str:
        if match[1] not in variables:
            raise InputError("", f"the environment variable {match[1]} in {pattern!r} is not set")
        return variables[match[1]]

    return _VARIABLE.sub(value, pattern)

"""The file of a study: which scenes, methods, seeds and limits.

    name: example
    scenes:
      - ../puzzles/*.yaml                 # scene files
      - files: ../corpus/levels.xsb       # levels are converted on the fly
        presets: [clear, published]       # in both geometries
        where: {occluded: true, narrowest_passage_m: {max: 0.5}}
        take: 60                          # that many, evenly spread
      - files: ${MY_SCENES}/*.g           # an environment variable
        optional: true                    # the study goes on without them
    methods:
      - Rnd+FPR
      - {method: Rnd+FPR, name: wide, set: {candidates: 400}}
      - {method: Rnd+FPR, sweep: {keep_share: [0.1, 0.2, 0.5], near_share: [0.0, 0.5]}}
      - {method: Rnd+FPR, name: mine, subgoals: "my_module:Generator"}
      - {name: theirs, planner: "their_package:solve", options: {depth: 5}}
      - {name: program, command: [./their_planner, "{scene}"]}
    seeds: 10                # 0..9; or a list
    settings: fast           # or faithful
    time_limit: 60           # planning time of a trial [s]
    iterations: 100000       # the setting max_expansions
    improve: 0               # time for improving each plan [s], as of `solve`
    hard_limit: 2            # a trial is killed after this many times both
    memory_mb: 4096          # memory of a worker; leave out for no limit

Paths are relative to the file, and may hold `*`, `?` and `**`. `evaluate.scene_source` says more about scenes,
`evaluate.method_document` about methods.
"""

from itertools import islice
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, field_validator

from converter.formats.body_document import Name
from evaluate.method_document import MethodDocument, Shared, methods_of
from evaluate.names import require_distinct
from evaluate.scene_source import Presets, Reading, SceneSourceDocument, read_sources
from evaluate.study import Study
from pcg import yaml_text
from pcg.errors import InputError
from pcg.files import read_text
from pcg.validation import Document, validated

MAX_SEEDS = 1_000_000
MAX_METHODS = 10_000


class _Study(Document):
    name: Annotated[Name, Field(max_length=100)]
    scenes: Annotated[list[SceneSourceDocument], Field(min_length=1)]
    methods: Annotated[list[MethodDocument], Field(min_length=1)]
    seeds: Annotated[list[Annotated[int, Field(ge=0)]], Field(min_length=1, max_length=MAX_SEEDS)]
    presets: Presets | None = None
    tolerance: Annotated[float, Field(ge=0)] | None = None
    settings: Literal["fast", "faithful"] = "fast"
    time_limit: Annotated[float, Field(gt=0)] = 60.0
    iterations: Annotated[int, Field(ge=1)] | None = None
    improve: Annotated[float, Field(ge=0)] = 0.0
    demonstrations: str | None = None
    hard_limit: Annotated[float, Field(ge=1)] = 2.0
    memory_mb: Annotated[int, Field(ge=256)] | None = None

    @field_validator("seeds", mode="before")
    @classmethod
    def _counted(cls, value: Any) -> Any:
        is_count = isinstance(value, int) and not isinstance(value, bool)
        return list(range(min(value, MAX_SEEDS + 1))) if is_count else value

    @field_validator("scenes", mode="before")
    @classmethod
    def _paths(cls, value: Any) -> Any:
        if not isinstance(value, list):
            return value
        return [{"files": entry} if isinstance(entry, str) else entry for entry in value]

    @field_validator("seeds")
    @classmethod
    def _distinct(cls, values: list[int]) -> list[int]:
        if len(set(values)) != len(values):
            raise ValueError("an entry is given twice")
        return values


def read_study(path: Path, demonstrations: Path | None = None) -> Study:
    """Reads a specification and all of its scenes.

    Args:
        path: The file.
        demonstrations: Folder with the demonstrations of method Hum, instead of what the file says.

    Raises:
        InputError: naming file, field and reason.
    """
    spec = validated(_Study, yaml_text.parse(read_text(path), str(path)), str(path))
    presets = (None,) if spec.presets is None else tuple(spec.presets)
    found = read_sources(spec.scenes, Reading(path.parent, presets, spec.tolerance), str(path))
    if not found.scenes:
        raise InputError(str(path), "scenes: none is left")
    require_distinct([f"{scene.name} {scene.preset}" for scene in found.scenes], f"{path}: scenes")
    folder = path.parent.resolve()
    shared = Shared(spec.settings, _changes(spec, folder, demonstrations), folder)
    found_methods = (
        method
        for i, document in enumerate(spec.methods)
        for method in methods_of(document, shared, f"{path}: methods[{i}]")
    )
    methods = list(islice(found_methods, MAX_METHODS + 1))
    if len(methods) > MAX_METHODS:
        raise InputError(str(path), f"methods: more than {MAX_METHODS}, sweeps counted out")
    require_distinct([method.name for method in methods], f"{path}: methods")
    return Study(
        name=spec.name,
        scenes=tuple(found.scenes),
        methods=tuple(methods),
        seeds=tuple(spec.seeds),
        hard_limit=spec.hard_limit,
        memory_mb=spec.memory_mb,
        notes=tuple(found.notes),
    )


def _changes(spec: _Study, folder: Path, demonstrations: Path | None) -> dict[str, Any]:
    changes: dict[str, Any] = {"time_limit": spec.time_limit, "improve": spec.improve}
    if spec.iterations is not None:
        changes["max_expansions"] = spec.iterations
    if spec.demonstrations is not None:
        changes["demonstrations"] = str(folder / spec.demonstrations)
    if demonstrations is not None:
        changes["demonstrations"] = str(demonstrations.resolve())
    return changes

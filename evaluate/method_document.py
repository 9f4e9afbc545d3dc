"""Entries of `methods` in a study's file: what they may say, and the methods that they stand for."""

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from converter.formats.body_document import Name
from evaluate.method import ImportedPlanner, Method, OwnPlanner, Planner
from evaluate.program import Program
from evaluate.references import HEURISTICS, PLANNERS, SUBGOALS, Reference
from evaluate.setting_values import changed
from pcg.errors import InputError
from pcg.printable import printable
from pcg.validation import Document, PlainValues
from planner import METHODS, Settings, settings_for

MAX_GRID = 10_000
"""Methods that one sweep may stand for."""

LIMITS = ("time_limit", "max_expansions")
"""Settings that planners of other people get."""

Scalar = bool | int | float | str


class MethodDocument(Document):
    """One method, or with `sweep` one for each point of a grid.

    Attributes:
        method: One of the product's own methods; or instead:
        planner: A function `(scene, settings, rng, **options) -> PlanResult`, as `module:function` or entry point;
        command: A program with its arguments; see `evaluate.program`.
        name: In rows and tables; by default the method, the function or the program's name.
        subgoals: With `method`: a factory of subgoal generators instead of that of the method.
        heuristic: With `method`: a heuristic instead of that of the paper.
        settings: With `method`: preset of its settings; by default that of the study.
        set_: With `method` (in files `set`): single settings; with the others the limits alone.
        options: With `planner` and `command`: plain values that are passed on.
        sweep: Lists of values by name, of settings with `method`, else of options; every combination is a method.
    """

    method: str | None = None
    planner: str | None = None
    command: Annotated[list[str], Field(min_length=1)] | None = None
    name: Annotated[Name, Field(max_length=100)] | None = None
    subgoals: str | None = None
    heuristic: str | None = None
    settings: Literal["fast", "faithful"] | None = None
    set_: dict[str, Scalar] = Field(default_factory=dict, alias="set")
    options: PlainValues = Field(default_factory=dict)
    sweep: dict[str, Annotated[list[Scalar], Field(min_length=1)]] = Field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _named(cls, value: Any) -> Any:
        return {"method": value} if isinstance(value, str) else value

    @model_validator(mode="after")
    def _consistent(self) -> "MethodDocument":
        given = [name for name in ("method", "planner", "command") if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(
                f"exactly one of method, planner, command is needed, found {' and '.join(given) or 'none'}"
            )
        if self.method is not None and self.method not in METHODS:
            raise ValueError(f"unknown method {self.method!r}, allowed are {', '.join(METHODS)}")
        others = ("options",) if self.method is not None else ("subgoals", "heuristic", "settings")
        if misplaced := [name for name in others if getattr(self, name)]:
            raise ValueError(f"{misplaced[0]} does not go with {given[0]}")
        if (self.subgoals or self.heuristic) and "+" not in (self.method or ""):
            raise ValueError(f"subgoals and heuristic go with methods of the forward search, found {self.method}")
        return self


@dataclass(frozen=True)
class Shared:
    """What the methods of a study have in common.

    Attributes:
        settings: Preset of the settings.
        changes: Settings of all methods: limits.
        folder: The study's folder, where modules are looked for and programs are started.
    """

    settings: str
    changes: Mapping[str, Any]
    folder: Path


def methods_of(document: MethodDocument, shared: Shared, where: str) -> Iterator[Method]:
    """The methods that an entry stands for; `where` begins every message.

    Raises:
        InputError: a setting does not exist or is not allowed, or a function cannot be imported.
    """
    if (size := _grid_size(document)) > MAX_GRID:
        raise InputError(where, f"sweep: a grid of {size} methods, allowed are {MAX_GRID}")
    base = document.name or document.method or document.planner or Path((document.command or [""])[0]).name
    for point in itertools.product(*document.sweep.values()):
        chosen = dict(zip(document.sweep, point, strict=True))
        tail = ",".join(f"{key}={value}" for key, value in chosen.items())
        yield _method(document, printable(f"{base}[{tail}]" if tail else base), chosen, shared, where)


def _method(document: MethodDocument, name: str, chosen: Mapping[str, Any], shared: Shared, where: str) -> Method:
    own = document.method is not None
    settings = settings_for(document.settings or shared.settings, **shared.changes)
    if not own and (unused := sorted(document.set_.keys() - LIMITS)):
        raise InputError(
            where, f"set: {unused[0]} does not go with planner or command, allowed are {', '.join(LIMITS)}"
        )
    settings = changed(settings, document.set_ | (dict(chosen) if own else {}), where)
    if document.method is not None:
        settings = replace(settings, method=document.method)
        planner: Planner = OwnPlanner(
            _reference(document.subgoals, SUBGOALS, shared, where),
            _reference(document.heuristic, HEURISTICS, shared, where),
        )
        if settings.improve and planner != OwnPlanner():
            raise InputError(where, "improve: not together with subgoals or heuristic")
        return Method(name, settings, planner)
    return Method(name, _limits_alone(settings), _foreign(document, document.options | dict(chosen), shared, where))


def _foreign(document: MethodDocument, options: Mapping[str, Any], shared: Shared, where: str) -> Planner:
    function = _reference(document.planner, PLANNERS, shared, where)
    if function is not None:
        return ImportedPlanner(function, options)
    return Program(tuple(document.command or ()), options, str(shared.folder))


def _limits_alone(settings: Settings) -> Settings:
    """Settings of a planner that is not ours: the search's own would only make equal trials look different."""
    return Settings(**{name: getattr(settings, name) for name in LIMITS})


def _reference(text: str | None, group: str, shared: Shared, where: str) -> Reference | None:
    if text is None:
        return None
    reference = Reference(text, group, str(shared.folder))
    try:
        reference.load()
    except InputError as error:
        raise InputError(where, str(error)) from None
    return reference


def _grid_size(document: MethodDocument) -> int:
    size = 1
    for values in document.sweep.values():
        size *= len(values)
    return size

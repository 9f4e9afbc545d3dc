"""Conditions on scenes, such as `occluded: true`, that say which of them belong to a study.

A condition is a value that the fact must have, a list of such values, or a range `{min: 0.4, max: 0.5}` with one end or
both. Text may hold the wild cards `*`, `?` and `[...]`.
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict, fields
from fnmatch import fnmatchcase
from typing import Annotated, Any

from pydantic import Discriminator, Field, Tag, model_validator

from converter.occlusion import occluded
from converter.scene import Scene
from evaluate.scene_statistics import SceneStatistics, generator_of, geometry_statistics_of, statistics_of
from pcg.errors import InputError
from pcg.validation import Document


class Range(Document):
    """A range of numbers; at least one end is given."""

    min: float | None = None
    max: float | None = None

    @model_validator(mode="after")
    def _bounded(self) -> "Range":
        if self.min is None and self.max is None:
            raise ValueError("a range needs min or max")
        return self


Value = bool | int | float | str


def _form(condition: Any) -> str:
    if isinstance(condition, (dict, Range)):
        return "range"
    return "list" if isinstance(condition, list) else "value"


Condition = Annotated[
    Annotated[Value, Tag("value")]
    | Annotated[list[Value], Field(min_length=1), Tag("list")]
    | Annotated[Range, Tag("range")],
    Discriminator(_form),
]

_EASY: dict[str, Callable[[Scene], Any]] = {
    "name": lambda scene: scene.name,
    "agent": lambda scene: generator_of(scene.name),
    "preset": lambda scene: scene.preset,
    "objects": lambda scene: len(scene.objects),
    "occluded": occluded,
}
"""Facts that every scene has, and that take no time."""

_PLANNED = ("pick_places", "monotone")
"""Facts about a plan, which has to be found first."""

_TEXTS = ("name", "agent", "preset")
"""Facts that have no order."""

_STATISTICS = tuple(field.name for field in fields(SceneStatistics))
FACTS = tuple(dict.fromkeys((*_EASY, *_STATISTICS)))
"""What conditions may be about."""


def require_facts(conditions: Mapping[str, Condition], where: str) -> None:
    """Refuses conditions on what is not known of scenes.

    Raises:
        InputError: naming the facts that there are.
    """
    for name, condition in conditions.items():
        if name not in FACTS:
            raise InputError(where, f"no fact {name!r} of a scene, allowed are {', '.join(FACTS)}")
        if name in _TEXTS and isinstance(condition, Range):
            raise InputError(where, f"{name}: found a range, but {name} is text")


def by_cost(conditions: Mapping[str, Condition]) -> tuple[dict[str, Condition], dict[str, Condition]]:
    """The conditions on what can be said of any scene at once, and those that need time and a valid scene."""
    easy, hard = (
        {name: condition for name, condition in conditions.items() if (name in _EASY) is wanted}
        for wanted in (True, False)
    )
    return easy, hard


def fulfils(scene: Scene, conditions: Mapping[str, Condition]) -> bool:
    """Whether a scene meets all conditions; the next costlier ones are asked if the others are met.

    Raises:
        InputError: a condition needs a valid scene (`by_cost`), and this one is not.
    """
    easy, hard = by_cost(conditions)
    if not all(_meets(_EASY[name](scene), condition) for name, condition in easy.items()):
        return False
    geometric = [name for name in hard if name not in _PLANNED]
    for names, statistics in ((geometric, geometry_statistics_of), (_PLANNED, statistics_of)):
        if asked := [name for name in names if name in hard]:
            facts = asdict(statistics(scene))
            if not all(_meets(facts[name], hard[name]) for name in asked):
                return False
    return True


def _meets(fact: Any, condition: Condition) -> bool:
    if isinstance(condition, Range):
        low = condition.min is None or (fact is not None and fact >= condition.min)
        high = condition.max is None or (fact is not None and fact <= condition.max)
        return low and high
    values = condition if isinstance(condition, list) else [condition]
    return any(fnmatchcase(fact, value) if _are_text(fact, value) else fact == value for value in values)


def _are_text(fact: Any, value: Value) -> bool:
    return isinstance(fact, str) and isinstance(value, str)

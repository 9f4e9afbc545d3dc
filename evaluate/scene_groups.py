"""Ways to group the scenes of a study: by occlusion, by how they were made, and by how hard they are."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from evaluate.scene_statistics import SceneStatistics, generator_of

OCCLUSION = "occlusion"
"""Name of the grouping by occlusion, and what the names of those of one geometry begin with."""

Facts = Mapping[str, SceneStatistics]
"""Statistics by the name of the scene."""


@dataclass(frozen=True)
class Grouping:
    """Scenes in groups.

    Attributes:
        name: Short, for file names.
        title: By what they are grouped.
        groups: Names of the scenes by name of the group, in a sensible order; no group is empty.
    """

    name: str
    title: str
    groups: Mapping[str, Sequence[str]]


def groupings(facts: Facts, presets: Mapping[str, str | None] | None = None) -> list[Grouping]:
    """All groupings that tell scenes apart: those with at least two groups, and occlusion in any case.

    Args:
        facts: The scenes.
        presets: Their geometries; where there are several, each has a grouping by occlusion of its own.
    """
    found = [Grouping(name, title, _grouped(facts, names, group_of)) for name, title, names, group_of in _groupings()]
    return [*_by_occlusion(facts, presets or {}), *(grouping for grouping in found if len(grouping.groups) > 1)]


def _by_occlusion(facts: Facts, presets: Mapping[str, str | None]) -> Iterator[Grouping]:
    def grouped(names: Iterable[str]) -> dict[str, list[str]]:
        of_names = {name: facts[name] for name in names}
        return _grouped(of_names, tuple(_OCCLUDED.values()), lambda _, statistics: _OCCLUDED[statistics.occluded])

    geometries = dict.fromkeys(presets.values())
    if len(geometries) < 2:
        yield Grouping(OCCLUSION, "occlusion", grouped(facts))
        return
    for geometry in geometries:
        title = f"occlusion in the geometry {geometry or 'other'}"
        names = [name for name in facts if presets.get(name) == geometry]
        yield Grouping(f"{OCCLUSION}-{geometry or 'other'}", title, grouped(names))


def _groupings() -> list[tuple[str, str, Sequence[str] | None, Callable[[str, SceneStatistics], str | None]]]:
    """Name, title, order of the groups (None for that of the scenes), and what group a scene belongs to."""
    density, passage, pick_places = (0.0, 0.1, 0.15, 0.2, 0.3), (0.0, 0.41, 0.5, 0.7, 1.0), (1, 2, 3, 4, 6)
    return [
        ("agent", "generator of the level", None, lambda name, _: generator_of(name)),
        ("density", "wall density", _ranges(density), lambda _, s: _range(density, s.wall_density)),
        ("passage", "narrowest passage [m]", _ranges(passage), lambda _, s: _range(passage, s.narrowest_passage_m)),
        ("must-move", "objects that must move", None, lambda _, s: None if s.must_move is None else str(s.must_move)),
        ("monotone", "monotone", ("monotone", "not monotone"), lambda _, s: _MONOTONE.get(s.monotone)),
        (
            "pick-places",
            "fewest pick-places known",
            [*_ranges(pick_places), "none known"],
            lambda _, s: "none known" if s.pick_places is None else _range(pick_places, s.pick_places),
        ),
    ]


_OCCLUDED = {False: "not occluded", True: "occluded"}
_MONOTONE: dict[bool | None, str] = {True: "monotone", False: "not monotone"}


def _grouped(
    facts: Facts, order: Sequence[str] | None, group_of: Callable[[str, SceneStatistics], str | None]
) -> dict[str, list[str]]:
    groups: dict[str, list[str]] = {}
    for name, statistics in facts.items():
        if (group := group_of(name, statistics)) is not None:
            groups.setdefault(group, []).append(name)
    return {group: groups[group] for group in (sorted(groups) if order is None else order) if group in groups}


def _ranges(starts: Sequence[float]) -> list[str]:
    """Names of the ranges that begin at `starts` and end before the next one; the last one has no end."""
    return [_between(a, b) for a, b in pairwise(starts)] + [f"{starts[-1]:g} or more"]


def _between(a: float, b: float) -> str:
    whole = isinstance(a, int) and isinstance(b, int)
    if whole:
        return f"{a}" if b == a + 1 else f"{a} to {int(b) - 1}"
    return f"below {b:g}" if a == 0 else f"{a:g} to {b:g}"


def _range(starts: Sequence[float], value: float) -> str:
    index = sum(value >= start for start in starts) - 1
    return _ranges(starts)[max(index, 0)]

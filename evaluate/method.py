"""The planners that a study compares: ours by name and settings, and other people's.

A `Method` is a name for the tables, settings, and a `Planner` that makes plans by them. There is one kind of planner
per class: the product's own (here, with a subgoal generator or a heuristic of somebody else's if wanted), an imported
function (here), and any program (`evaluate.program`).
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any, Protocol

import numpy as np

from converter.plan import Plan, PlanDocument, Status, plan_document
from converter.scene import Scene
from evaluate.digest import digest
from evaluate.placements import with_placements
from evaluate.references import Reference
from pcg.files import is_file
from pcg.printable import one_line
from pcg.validation import validated
from planner import PlanResult, Settings, search, solve
from planner.infeasible import with_proof
from planner.subgoals_human import demonstration_path


class Planner(Protocol):
    """Makes plans."""

    def plan(self, scene: Scene, settings: Settings, seed: int) -> Plan:
        """The plan for a scene, or how planning failed; what it raises is the trial's error."""

    def document(self) -> dict[str, Any]:
        """What tells this planner from others, as plain values; empty for the product's own."""

    def suits(self, scene: Scene, settings: Settings) -> bool:
        """Whether there is everything that the planner needs for a scene; otherwise there are no such trials."""

    def prepare(self, scene: Scene, settings: Settings) -> None:
        """Loads and compiles what planning needs, with a small scene, so that no trial's time includes it."""


@dataclass(frozen=True)
class OwnPlanner:
    """`planner.solve`; with a generator or a heuristic from outside `planner.search.solve`.

    Attributes:
        subgoals: A `planner.subgoals.GeneratorFactory`, or None for the generator of the settings' method.
        heuristic: A `planner.heuristics.Heuristic`, or None for that of the paper.
    """

    subgoals: Reference | None = None
    heuristic: Reference | None = None

    def plan(self, scene: Scene, settings: Settings, seed: int) -> Plan:
        """See `Planner`."""
        rng = generator_of(seed)
        if self.subgoals is None and self.heuristic is None:
            return solve(scene, settings, rng).to_plan(scene, settings, seed)
        subgoals = None if self.subgoals is None else self.subgoals.load()
        heuristic = None if self.heuristic is None else self.heuristic.load()
        solver = partial(search.solve, scene, settings, rng, generator=subgoals, heuristic=heuristic)
        result = with_proof(lambda stop: solver(should_stop=stop), scene, lambda: False)
        return result.to_plan(scene, settings, seed)

    def document(self) -> dict[str, Any]:
        """See `Planner`."""
        given = {"subgoals": self.subgoals, "heuristic": self.heuristic}
        return {name: reference.text for name, reference in given.items() if reference is not None}

    def suits(self, scene: Scene, settings: Settings) -> bool:
        """Whether Hum has a demonstration, and Push a level."""
        if settings.generator == "Hum" and self.subgoals is None:
            return is_file(demonstration_path(scene, settings))
        return settings.method != "Push" or "xsb" in scene.source

    def prepare(self, scene: Scene, settings: Settings) -> None:
        """Imports what is not ours, and plans by what is: whether the other works, trials will tell."""
        for reference in (self.subgoals, self.heuristic):
            if reference is not None:
                reference.load()
        # Nobody demonstrates a scene like this one, and no level is its source.
        method = "Rnd+R" if settings.generator in {"Hum", "Push"} else settings.method
        small = replace(settings, method=method, improve_rounds=1)
        OwnPlanner().plan(scene, small, 0)
        if not small.generator.startswith("MBTS"):
            # Where the goal is occupied, an expansion has to propose subgoals and to score them.
            OwnPlanner().plan(_with_occupied_goal(scene), replace(small, max_expansions=1), 0)


def _with_occupied_goal(scene: Scene) -> Scene:
    """The scene with its last object, which must not be the goal-object, in the middle of the goal."""
    last = scene.objects[-1]
    moved = replace(last, position=np.append(scene.goal.position, last.position[2]))
    return replace(scene, objects=(*scene.objects[:-1], moved))


@dataclass(frozen=True, eq=False)
class ImportedPlanner:
    """Somebody else's function `(scene, settings, rng, **options) -> PlanResult`.

    Its time is measured here, whatever the result says. Numbers of NumPy and the text of a status will do.

    Attributes:
        function: The function.
        options: Its keyword arguments, plain values.
    """

    function: Reference
    options: Mapping[str, Any] = field(default_factory=dict)

    def plan(self, scene: Scene, settings: Settings, seed: int) -> Plan:
        """See `Planner`."""
        function = self.function.load()
        started = time.perf_counter()
        result = function(scene, settings, generator_of(seed), **self.options)
        time_s = time.perf_counter() - started
        if not isinstance(result, PlanResult):
            raise TypeError(
                f"{self.function.text} returned {one_line(repr(result), 100)}, allowed is a planner.PlanResult"
            )
        counters = {name: v.item() if isinstance(v, np.generic) else v for name, v in result.counters.items()}
        result = replace(result, time_s=time_s, status=Status(result.status), counters=counters)
        return with_placements(result.to_plan(scene, settings, seed))

    def document(self) -> dict[str, Any]:
        """See `Planner`."""
        return {"planner": self.function.text, "options": dict(self.options)}

    def suits(self, scene: Scene, settings: Settings) -> bool:
        """Every scene."""
        del scene, settings
        return True

    def prepare(self, scene: Scene, settings: Settings) -> None:
        """Imports the function."""
        del scene, settings
        self.function.load()


@dataclass(frozen=True, eq=False)
class Method:
    """A planner with its settings.

    Attributes:
        name: In rows and tables.
        settings: Every setting of the product's own planners; others take what they need of them, the time limit above
            all.
        planner: What makes the plans.
    """

    name: str
    settings: Settings
    planner: Planner = field(default_factory=OwnPlanner)

    @cached_property
    def document(self) -> dict[str, Any]:
        """Every setting, and which planner it is if not the product's own; plain values."""
        return self.settings.as_document() | self.planner.document()

    @cached_property
    def hash(self) -> str:
        """Identity of the settings: sixteen hexadecimal digits."""
        return digest(self.document)

    def plan(self, scene: Scene, seed: int) -> Plan:
        """The plan for a scene, in the name of the method.

        Raises:
            InputError: other people's code has put something into it that no plan's file may hold, such as NaN.
        """
        plan = replace(self.planner.plan(scene, self.settings, seed), method=self.name, settings=self.document)
        validated(PlanDocument, plan_document(replace(plan, scene_data=None)), f"plan of {self.name}")
        return plan


def method_named(name: str, settings: Settings) -> Method:
    """The product's own method called `name`, with other settings as given."""
    return Method(name, replace(settings, method=name))


def generator_of(seed: int) -> np.random.Generator:
    """The only random generator of a trial."""
    return np.random.default_rng(np.random.SeedSequence(seed))

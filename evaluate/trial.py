"""One trial: one planner on one scene with one seed, and the independent verification of its plan."""

from collections.abc import Sequence
from dataclasses import dataclass, is_dataclass
from functools import cached_property
from typing import Any

import numpy as np

from converter.plan import Plan
from converter.scene import Agent, Body, Goal, Scene
from converter.shape import Part
from evaluate.digest import digest
from evaluate.method import Method, OwnPlanner
from pcg.errors import InputError
from planner import Settings
from planner.problem import Problem
from planner.push import SourceLevel
from planner.subgoals_human import HumanSubgoals
from planner.verify import Violation, verify


@dataclass(frozen=True, eq=False)
class Trial:
    """What to do; the same trial gives the same plan unless a time limit cuts it short.

    Attributes:
        scene: The scene to solve.
        method: The planner with its settings.
        seed: Seed of the trial's only random generator, >= 0.
    """

    scene: Scene
    method: Method
    seed: int

    @cached_property
    def key(self) -> str:
        """Identity: geometry and name of the scene, method, seed and settings."""
        scene, method = self.scene, self.method
        return digest([scene.geometry_hash, scene.name, method.name, self.seed, method.hash])

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        _freeze(self.scene)

    def run(self) -> "TrialOutcome":
        """Plans and verifies.

        Raises:
            InputError: the initial configuration is invalid (a body inside another one).
        """
        return _verified(self.scene, self.method.plan(self.scene, self.seed))


@dataclass(frozen=True, eq=False)
class TrialOutcome:
    """What came of a trial.

    Attributes:
        plan: The plan, or how the planner failed.
        violations: What the verification found; None if there was no plan to verify.
    """

    plan: Plan
    violations: tuple[Violation, ...] | None

    @property
    def verified(self) -> bool | None:
        """Whether the plan passed verification; None without a plan."""
        return None if self.violations is None else not self.violations

    @property
    def solved(self) -> bool:
        """Whether there is a plan that passed verification."""
        return self.verified is True


def _freeze(value: Any) -> None:
    """Makes all arrays in a scene read-only again, which they are no longer when it comes from another process.

    To Numba arrays that can be written to are of another type, for which it would compile everything once more.
    """
    if isinstance(value, np.ndarray):
        value.setflags(write=False)
    elif isinstance(value, tuple):
        for each in value:
            _freeze(each)
    elif is_dataclass(value):
        for each in vars(value).values():
            _freeze(each)


def run_trial(scene: Scene, settings: Settings, seed: int) -> TrialOutcome:
    """Plans by the product's own planner, and verifies.

    Raises:
        InputError: the initial configuration is invalid (a body inside another one).
    """
    return _verified(scene, OwnPlanner().plan(scene, settings, seed))


def _verified(scene: Scene, plan: Plan) -> TrialOutcome:
    return TrialOutcome(plan, tuple(verify(scene, plan)) if plan.solved else None)


def require_plannable(scene: Scene, settings: Settings, where: str) -> None:
    """Refuses what the planner would refuse, before any planning.

    Args:
        scene: The scene.
        settings: Settings of the planner.
        where: What the scene was read from; it begins the message.

    Raises:
        InputError: two bodies overlap at the start, one is out of bounds, or the method lacks its
            demonstration or its level.
    """
    try:
        problem = Problem(scene)
        if settings.generator == "Hum":
            HumanSubgoals(problem, settings)
        if settings.method == "Push":
            SourceLevel.of(scene)
    except InputError as error:
        raise InputError(where, str(error).removeprefix(f"{scene.name}: ")) from None


def warm_up(*every: Settings) -> None:
    """Solves a small scene with each of the settings, so that no trial's time includes loading and compiling."""
    prepare([Method(settings.method, settings) for settings in every])


def prepare(methods: Sequence[Method]) -> None:
    """Loads and compiles what trials with these methods need, the verification included."""
    scene = warm_up_scene()
    for method in methods:
        method.planner.prepare(scene, method.settings)
    run_trial(scene, Settings(method="Rnd+R"), 0)


def warm_up_scene() -> Scene:
    """A scene that every method can plan for at once."""
    cube = (Part.box((0.2, 0.2)),)
    return Scene(
        name="warm-up",
        bounds=np.array([[-1.0, -1.0], [1.0, 1.0]]),
        tolerance=1e-4,
        agent=Agent(np.array([-0.5, 0.0]), 0.1),
        walls=(Body("wall", np.array([0.0, 0.5, 0.1]), 0.2, cube),),
        objects=(
            Body("obj", np.array([0.0, 0.0, 0.1]), 0.2, cube),
            Body("obstacle", np.array([0.5, 0.5, 0.1]), 0.2, cube),
        ),
        goal=Goal("obj", np.array([0.5, 0.0]), np.array([0.2, 0.2])),
    )

"""One trial: one planner on one scene with one seed, and the independent verification of its plan."""

import hashlib
import json
from dataclasses import dataclass, replace

import numpy as np

from converter.plan import Plan
from converter.scene import Agent, Body, Goal, Scene
from converter.shape import Part
from pcg.errors import InputError
from planner import Settings, solve
from planner.problem import Problem
from planner.push import SourceLevel
from planner.subgoals_human import HumanSubgoals
from planner.verify import Violation, verify


@dataclass(frozen=True, eq=False)
class Trial:
    """What to do; the same trial gives the same plan unless a time limit cuts it short.

    Attributes:
        scene: The scene to solve.
        settings: Every setting of the planner, among them the method.
        seed: Seed of the trial's only random generator, >= 0.
    """

    scene: Scene
    settings: Settings
    seed: int

    @property
    def key(self) -> str:
        """Identity: geometry and name of the scene, method, seed and settings."""
        scene = self.scene
        return _digest([scene.geometry_hash, scene.name, self.settings.method, self.seed, settings_hash(self.settings)])


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


def settings_hash(settings: Settings) -> str:
    """Sixteen hexadecimal digits over every setting."""
    return _digest(settings.as_document())


def run_trial(scene: Scene, settings: Settings, seed: int) -> TrialOutcome:
    """Plans and verifies.

    Raises:
        InputError: the initial configuration is invalid (a body inside another one).
    """
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    plan = solve(scene, settings, rng).to_plan(scene, settings, seed)
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
    for settings in every:
        # Nobody demonstrates a scene like this one, and no level is its source.
        method = "Rnd+R" if settings.generator in {"Hum", "Push"} else settings.method
        run_trial(_warm_up_scene(), replace(settings, method=method, improve_rounds=1), 0)


def _warm_up_scene() -> Scene:
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


def _digest(document: object) -> str:
    return hashlib.sha256(json.dumps(document, sort_keys=True).encode()).hexdigest()[:16]

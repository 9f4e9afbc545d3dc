"""Trials."""

import json
import pickle
from dataclasses import replace

import numpy as np
import pytest

from converter.plan import Plan, plan_document
from converter.scene import Scene
from evaluate import method as method_module
from evaluate.method import Method
from evaluate.trial import Trial, TrialOutcome, require_plannable, run_trial, warm_up
from pcg.errors import InputError
from planner import METHODS, PRESETS, PlanResult, Settings
from planner.verify import ViolationKind


def without_times(plan: Plan) -> str:
    """The text of a plan's file but for its time."""
    return json.dumps(plan_document(replace(plan, time_s=0.0)))


def test_a_trial_is_solved_and_verified(small_room: Scene):
    """An easy scene is solved, and the plan names scene, method and seed."""
    outcome = run_trial(small_room, Settings(method="Rnd+FP"), 7)
    assert outcome.solved
    assert outcome.verified is True
    assert (outcome.plan.scene, outcome.plan.method, outcome.plan.seed) == ("small-room", "Rnd+FP", 7)


def test_a_seed_fixes_the_plan(small_room: Scene):
    """The same trial gives the same bytes, whatever the process did before."""
    first = run_trial(small_room, Settings(), 3).plan
    run_trial(small_room, Settings(), 4)
    assert without_times(run_trial(small_room, Settings(), 3).plan) == without_times(first)


def test_improvement_is_repeatable(small_room: Scene):
    """With a number of rounds a seed fixes the improved plan; all that differs are times."""
    settings = Settings(improve=1e6, improve_rounds=2)
    first, second = (run_trial(small_room, settings, 3) for _ in range(2))
    assert first.solved
    times = {"subgoal_time_s": 0.0, "improve_time_s": 0.0}
    plans = [replace(o.plan, counters={**o.plan.counters, **times}) for o in (first, second)]
    assert without_times(plans[0]) == without_times(plans[1])
    assert plans[0].path_length < run_trial(small_room, Settings(), 3).plan.path_length


def test_a_wrong_plan_does_not_count(small_room: Scene, small_plan: Plan, monkeypatch: pytest.MonkeyPatch):
    """A plan that claims to solve the scene but fails verification is not solved."""
    through_the_wall = (
        *small_plan.segments[:-1],
        replace(small_plan.segments[-1], path=np.array([[-0.8, 1.1], [1, 0]])),
    )
    result = PlanResult(small_plan.status, 0.0, through_the_wall)
    monkeypatch.setattr(method_module, "solve", lambda *_: result)
    outcome = run_trial(small_room, Settings(), 0)
    assert outcome.plan.solved
    assert outcome.verified is False
    assert not outcome.solved
    assert ViolationKind.COLLISION in [violation.kind for violation in outcome.violations or ()]


def test_without_a_plan_nothing_is_verified(small_plan: Plan):
    """Neither verified nor refuted: there is no plan."""
    outcome = TrialOutcome(small_plan, None)
    assert outcome.verified is None
    assert not outcome.solved


def test_identity_of_a_trial(small_room: Scene):
    """Geometry, name, method, seed and every setting make another trial; colours and presets' names do not."""
    trial = Trial(small_room, Method("Rnd+FPR", Settings()), 0)
    others = [
        replace(trial, seed=1),
        replace(trial, method=Method("Rnd+R", Settings(method="Rnd+R"))),
        replace(trial, method=Method("Rnd+FPR", Settings(time_limit=1.0))),
        replace(trial, scene=replace(small_room, name="other")),
        replace(trial, scene=replace(small_room, tolerance=0.0)),
    ]
    assert len({trial.key, *(other.key for other in others)}) == 6
    assert replace(trial, scene=replace(small_room, source={"level": "x"})).key == trial.key


def test_scenes_stay_read_only_between_processes(small_room: Scene):
    """Otherwise every worker would compile the planner again, inside the time of its first trial."""
    trial = Trial(small_room, Method("Rnd+FPR", Settings()), 0)
    assert trial.key
    scene = pickle.loads(pickle.dumps(trial)).scene  # noqa: S301  # our own bytes
    bodies = (*scene.walls, *scene.objects)
    arrays = [scene.bounds, scene.agent.position, scene.goal.position, scene.goal.size]
    arrays += [array for body in bodies for array in (body.position, *body.cores, *(p.core for p in body.parts))]
    assert not any(array.flags.writeable for array in arrays)
    assert scene.geometry_hash == small_room.geometry_hash


def test_an_invalid_start_names_the_file(small_room: Scene):
    """The message says where the scene came from and what overlaps."""
    require_plannable(small_room, Settings(), "room.yaml")
    inside = replace(small_room, objects=(small_room.objects[0].at(np.array([1.0, 0.0])), small_room.objects[1]))
    with pytest.raises(InputError, match=r"^room\.yaml: object 'obj' overlaps 'wall'"):
        require_plannable(inside, Settings(), "room.yaml")


def test_a_missing_demonstration_names_the_file(small_room: Scene):
    """A method that needs to be shown how is refused for a scene that nobody solved."""
    with pytest.raises(InputError, match=r"^room\.yaml: method Hum needs a demonstration"):
        require_plannable(small_room, Settings(method="Hum+R"), "room.yaml")


@pytest.mark.parametrize("settings", [*(Settings(method=method) for method in METHODS), *PRESETS.values()])
def test_warm_up_works_with_every_method(settings: Settings):
    """The scene that warms the planner up is a valid one, and needs no demonstration."""
    warm_up(settings)

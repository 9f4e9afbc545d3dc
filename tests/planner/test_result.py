"""Results become plans."""

import numpy as np

from converter.plan import Segment, Status, Subgoal, plan_document, plan_from_document
from planner.result import PlanResult
from planner.settings import Settings
from planner.verify import require_same_scene
from tests.planner.scenes import room, vectors


def test_a_result_and_its_scene_make_a_plan():
    """The plan carries everything that its file needs to be verified, drawn and repeated."""
    scene = room(tolerance=1e-4)
    settings = Settings(method="Rnd+FP", candidates=7)
    segments = (Segment("move", None, vectors([0, 0], [1, 0])),)
    subgoals = (Subgoal("obj", np.array([1.0, 2.0])),)
    result = PlanResult(Status.SOLVED, 0.25, segments, subgoals, None, {"nodes": 3})
    plan = result.to_plan(scene, settings, 5)
    assert (plan.scene, plan.method, plan.seed, plan.status) == ("room", "Rnd+FP", 5, Status.SOLVED)
    assert (plan.time_s, plan.tolerance, plan.certificate) == (0.25, 1e-4, None)
    assert (plan.segments, plan.subgoals, plan.counters) == (segments, subgoals, {"nodes": 3})
    assert plan.settings["candidates"] == 7
    assert plan.scene_data is scene
    require_same_scene(scene, plan)


def test_a_failure_is_a_plan_without_motion():
    """Failing to plan is a value, with what proves it."""
    scene = room()
    plan = PlanResult(Status.EXHAUSTED, 1.0, certificate="no object could be reached").to_plan(scene, Settings(), 0)
    assert not plan.solved
    assert plan.certificate == "no object could be reached"
    assert plan.segments == ()


def test_the_document_of_a_result_can_be_read():
    """A plan's document with its settings and its scene reads back the same."""
    document = plan_document(PlanResult(Status.TIMEOUT, 1.0).to_plan(room(), Settings(preset="faithful"), 3))
    again = plan_document(plan_from_document(document, "plan"))
    assert again == document

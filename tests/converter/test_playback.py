"""Plans played back in the physics engine: good ones move nothing else, and every kind of fault is named."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from converter.plan import Plan, Segment
from converter.preview.playback import PlaybackProblemKind, play_back
from converter.scene import Body, Scene
from converter.shape import Part
from pcg.errors import InputError

Kind = PlaybackProblemKind


@pytest.fixture
def small_plan(small_plan: Plan) -> Plan:
    """Carries the goal-object straight to the goal, with a regrasp on the way, and comes back."""
    segments = (
        move((0, -1), (-1, -1), (-1, -0.4)),
        Segment("carry", "obj", np.array([[-1.0, -0.4], [-1.0, 0.6]])),
        move((-1, 0.6), (-1, 0.5), (-1, 0.6)),
        Segment("carry", "obj", np.array([[-1.0, 0.6], [-1.0, 1.1]])),
        move((-1, 1.1), (0, -1)),
    )
    return replace(small_plan, segments=segments)


def kinds(scene: Scene, plan: Plan) -> set[PlaybackProblemKind]:
    """Kinds of all problems."""
    return {problem.kind for problem in play_back(scene, plan).problems}


def move(*points: tuple[float, float]) -> Segment:
    """A drive of the agent alone."""
    return Segment("move", None, np.array(points))


def with_segments(plan: Plan, segments: Sequence[Segment]) -> Plan:
    """The plan with another motion."""
    return replace(plan, segments=tuple(segments))


def test_a_good_plan(small_room: Scene, small_plan: Plan):
    """Nothing moves but the carried object, which follows the agent."""
    found = play_back(small_room, small_plan)
    assert found.valid
    assert found.problems == ()
    assert found.moved < 1e-4
    assert 0 < found.slipped < 1e-4
    assert found.time_s > small_plan.path_length


def test_an_object_in_the_way_is_moved(small_room: Scene, small_plan: Plan):
    """The agent drives against the obstacle, which is pushed by what it is driven too far."""
    plan = with_segments(small_plan, [*small_plan.segments, move((0, -1), (0, 0.75))])
    found = play_back(small_room, plan)
    (problem,) = [problem for problem in found.problems if problem.kind is Kind.MOVED]
    assert (problem.segment, problem.bodies) == (5, ("obstacle",))
    assert problem.amount == pytest.approx(0.1, abs=2e-3)
    assert found.moved == problem.amount


def test_a_carried_object_pushes_others(small_room: Scene, small_plan: Plan):
    """The carried object slips no more than the other one yields."""
    push = Segment("carry", "obj", np.array([[-1.0, 0.6], [-0.25, 0.6]]))
    found = play_back(small_room, with_segments(small_plan, [*small_plan.segments[:3], push]))
    moved = [problem for problem in found.problems if problem.kind is Kind.MOVED]
    assert [problem.bodies for problem in moved] == [("obstacle",)]
    # The gap between the two was 1 - 0.2 - 0.15.
    assert moved[0].amount == pytest.approx(0.75 - (1 - 0.2 - 0.15), abs=5e-3)


def test_the_agent_in_a_wall(small_room: Scene, small_plan: Plan):
    """It drives on, but the penetration is reported with its depth."""
    plan = with_segments(small_plan, [*small_plan.segments, move((0, -1), (0.8, 0.0), (0, -1))])
    (problem,) = [p for p in play_back(small_room, plan).problems if p.kind is Kind.PENETRATION]
    assert (problem.segment, problem.bodies) == (5, ("agent", "wall"))
    assert problem.amount == pytest.approx(0.1, abs=0.02)
    assert problem.message.startswith("segment 5: agent penetrates wall by 0.")


def test_a_carried_object_at_a_wall(small_room: Scene, small_plan: Plan):
    """The wall holds it up while the agent goes on: it slips, and is pulled into the wall."""
    segments = [
        move((0, -1), (-1.4, -1), (-1.4, 0)),
        Segment("carry", "obj", np.array([[-1.4, 0.0], [0.4, 0.0], [-1.4, 0.0]])),
    ]
    found = play_back(small_room, with_segments(small_plan, segments))
    assert {(problem.kind, problem.bodies) for problem in found.problems} >= {
        (Kind.SLIPPED, ("obj",)),
        (Kind.PENETRATION, ("obj", "wall")),
    }
    assert found.slipped > 1e-3


def test_a_grasp_from_afar(small_room: Scene, small_plan: Plan):
    """The gap is reported, also of an object at another height."""
    segments = [move((0, -1), (-1, -1)), Segment("carry", "obj", np.array([[-1.0, -1.0], [-1.0, -0.9]]))]
    problems = play_back(small_room, with_segments(small_plan, segments)).problems
    assert problems[0].kind is Kind.NO_TOUCH
    assert problems[0].amount == pytest.approx(0.6, abs=1e-6)


def test_a_jump(small_room: Scene, small_plan: Plan):
    """A segment that starts elsewhere."""
    segments = [move((0, -1.1), (-1, -1), (-1, -0.4)), *small_plan.segments[1:]]
    assert kinds(small_room, with_segments(small_plan, segments)) == {Kind.JUMP}
    assert play_back(small_room, with_segments(small_plan, segments)).problems[0].amount == pytest.approx(0.1)


def test_the_goal_is_missed(small_room: Scene, small_plan: Plan):
    """Without its last carry the goal-object is not there."""
    (problem,) = play_back(small_room, with_segments(small_plan, small_plan.segments[:3])).problems
    assert (problem.kind, problem.segment, problem.bodies) == (Kind.GOAL_MISSED, None, ("obj",))
    assert problem.amount == pytest.approx(1.3 - 1.0, abs=1e-3)


def test_high_walls_are_no_obstacle(small_room: Scene, small_plan: Plan):
    """A beam over the floor meets neither agent nor objects."""
    beam = Body("beam", np.array([-1.0, 0.5, 0.5]), 0.2, (Part.box((2.0, 0.1)),))
    assert play_back(replace(small_room, walls=(*small_room.walls, beam)), small_plan).valid


def test_contacts_within_the_tolerance_count_as_touching(small_room: Scene, small_plan: Plan):
    """An agent that slides along an object, by less than the tolerance inside it, does not take it along."""
    beside = move((0, -1), (-0.35 + 5e-4, 0.5), (-0.35 + 5e-4, 1.2))
    found = play_back(small_room, with_segments(small_plan, [*small_plan.segments, beside]))
    assert found.valid


def test_an_unknown_object_is_refused(small_room: Scene, small_plan: Plan):
    """As in every replay."""
    segments = [Segment("carry", "ghost", np.zeros((1, 2)))]
    with pytest.raises(InputError, match="no object 'ghost'"):
        play_back(small_room, with_segments(small_plan, segments))

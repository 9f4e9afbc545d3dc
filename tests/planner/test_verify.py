"""The independent verifier: correct plans are accepted, each kind of broken plan is rejected for its reason."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from converter.formats import read_scene
from converter.plan import Plan, Segment, Status, Subgoal
from converter.scene import Agent, Body, Goal, Scene
from converter.shape import FloatArray, Part
from pcg.errors import InputError
from planner.verify import Violation, ViolationKind, require_same_scene, verify

PUZZLES = Path(__file__).parents[2] / "data" / "puzzles"


def body(name: str, x: float, y: float, *parts: Part, z: float = 0.1, yaw: float = 0.0) -> Body:
    """A body of height 0.2 at (x, y), by default a sharp box of side 0.3."""
    return Body(name, np.array([x, y, z]), 0.2, parts or (Part.box((0.3, 0.3)),), yaw)


def room(*walls: Body, objects: Sequence[Body] = (), tolerance: float = 1e-3) -> Scene:
    """A room of 4.1 x 4.1 with outer walls as in the published puzzles; agent in the middle, goal at (1, 1)."""
    outer = [
        Body("outwall_right", np.array([0.0, -2.0, 0.2]), 0.4, (Part.box((4.1, 0.1), 0.04),)),
        Body("outwall_left", np.array([0.0, 2.0, 0.2]), 0.4, (Part.box((4.1, 0.1), 0.04),)),
        Body("outwall_front", np.array([-2.0, 0.0, 0.2]), 0.4, (Part.box((0.1, 4.1), 0.04),)),
        Body("outwall_back", np.array([2.0, 0.0, 0.2]), 0.4, (Part.box((0.1, 4.1), 0.04),)),
    ]
    return Scene(
        name="room",
        bounds=np.array([[-2.0, -2.0], [2.0, 2.0]]),
        tolerance=tolerance,
        agent=Agent(np.zeros(2), 0.2),
        walls=(*outer, *walls),
        objects=tuple(objects) or (body("obj", 1, 0),),
        goal=Goal("obj", np.array([1.0, 1.0]), np.array([0.2, 0.2])),
    )


def move(*path: tuple[float, float]) -> Segment:
    """The agent alone."""
    return Segment("move", None, np.array(path))


def carry(name: str, *path: tuple[float, float]) -> Segment:
    """The agent with an object."""
    return Segment("carry", name, np.array(path))


def plan_of(scene: Scene, *segments: Segment, subgoals: Sequence[Subgoal] = ()) -> Plan:
    """A plan that claims to solve the scene."""
    return Plan(
        scene=scene.name,
        scene_hash=scene.geometry_hash,
        method="hand",
        seed=0,
        status=Status.SOLVED,
        time_s=0.0,
        tolerance=scene.tolerance,
        subgoals=tuple(subgoals),
        segments=segments,
    )


def kinds(scene: Scene, *segments: Segment, subgoals: Sequence[Subgoal] = ()) -> set[str]:
    """Kinds of all violations."""
    return {violation.kind.value for violation in verify(scene, plan_of(scene, *segments, subgoals=subgoals))}


def only(scene: Scene, *segments: Segment) -> Violation:
    """The single violation of a plan."""
    violations = verify(scene, plan_of(scene, *segments))
    assert len(violations) == 1, violations
    return violations[0]


GOOD = (move((0, 0), (0.65, 0)), carry("obj", (0.65, 0), (0.65, 1.0)))
"""Solves `room()`: grasp the object from the left, carry it up by 1."""


def test_a_correct_plan_is_accepted():
    """Grasping in exact contact and carrying to the goal is valid, with and without the list of subgoals."""
    subgoal = Subgoal("obj", np.array([1.0, 1.0]))
    assert verify(room(), plan_of(room(), *GOOD)) == []
    assert verify(room(), plan_of(room(), *GOOD, subgoals=[subgoal])) == []
    assert verify(room(tolerance=0.0), plan_of(room(tolerance=0.0), *GOOD)) == []


def test_cube_free_is_solved_by_one_pick_and_place():
    """In the empty room of Cube-Free the object is carried straight from one corner to the other."""
    scene = read_scene(PUZZLES / "cube-free.yaml")
    drive = move((0, 0), (1.4, 0), (1.4, -1.5), (1.25, -1.5))
    assert verify(scene, plan_of(scene, drive, carry("obj", (1.25, -1.5), (-1.25, 1.6)))) == []


def test_corner_needs_a_regrasp():
    """The object of Corner is brought out from the left, regrasped from the right and carried into the other corner."""
    scene = read_scene(PUZZLES / "corner.yaml")
    out = carry("obj", (1.25, -1.6), (-0.35, 0))
    around = move((-0.35, 0), (-0.35, 0.5), (0.35, 0.5), (0.35, 0))
    into = carry("obj", (0.35, 0), (-1.25, 1.6))
    assert verify(scene, plan_of(scene, move((0, 0), (1.25, -1.6)), out, around, into)) == []
    direct = carry("obj", (1.25, -1.6), (-1.95, 1.6))
    assert kinds(scene, move((0, 0), (1.25, -1.6)), direct) == {"collision"}


def test_empty_plan_is_valid_only_in_the_goal():
    """Doing nothing solves a scene whose object already lies in the goal, and no other."""
    solved = room(objects=[body("obj", 1, 1)])
    assert verify(solved, plan_of(solved)) == []
    violation = only(room())
    assert violation.kind is ViolationKind.GOAL_MISSED
    assert violation.amount == pytest.approx(0.9)
    assert violation.where == (1.0, 0.0)


def test_not_solved():
    """A plan that does not claim success is not valid, whatever its segments do."""
    plan = replace(plan_of(room(), *GOOD), status=Status.TIMEOUT)
    assert [violation.kind for violation in verify(room(), plan)] == [ViolationKind.NOT_SOLVED]


def test_unknown_object():
    """A carry of an object that the scene does not have is reported with its segment."""
    violation = only(room(), move((0, 0), (0.65, 0)), carry("box", (0.65, 0), (0.65, 1.0)))
    assert (violation.kind, violation.segment) == (ViolationKind.UNKNOWN_OBJECT, 1)
    assert "'box'" in violation.message


def test_shifted_way_point():
    """One way-point moved into a wall is a collision in its segment, as deep as it was moved."""
    scene = room(body("block", -1, 0))
    violation = only(scene, move((0, 0), (-0.65 - 0.03, 0), (0.65, 0)), GOOD[1])
    assert (violation.kind, violation.segment) == (ViolationKind.COLLISION, 0)
    assert violation.amount == pytest.approx(0.03)
    assert violation.where == pytest.approx((-0.85, 0))
    assert violation.message == "segment 0: agent penetrates block by 0.03 m"


def test_two_millimetres_more_than_the_tolerance():
    """The tolerance itself is allowed, to the nanometre; 2 mm more are not."""
    scene = room(body("block", -1, 0))
    assert kinds(scene, move((0, 0), (-0.65 - 1e-3, 0), (0.65, 0)), GOOD[1]) == set()
    violation = only(scene, move((0, 0), (-0.65 - 3e-3, 0), (0.65, 0)), GOOD[1])
    assert violation.kind is ViolationKind.COLLISION
    assert violation.amount == pytest.approx(3e-3)


def test_zero_clearance_corridor():
    """With tolerance 0 an agent passes a corridor exactly as wide as itself, and none that is 1 um narrower."""
    path = (move((0, 0), (0, -1.3), (0, 0), (0.65, 0)), GOOD[1])
    for narrower, expected in ((0.0, set()), (1e-6, {"collision"})):
        posts = [body("left", -0.35, -1), body("right", 0.35 - narrower, -1)]
        assert kinds(room(*posts, tolerance=0.0), *path) == expected


def test_start_elsewhere():
    """The plan has to begin where the agent stands; the jump's length is reported."""
    violation = only(room(), move((0.3, 0), (0.65, 0)), GOOD[1])
    assert (violation.kind, violation.segment) == (ViolationKind.DISCONTINUITY, 0)
    assert violation.amount == pytest.approx(0.3)


def test_discontinuity_between_segments():
    """A segment has to start where the one before ended."""
    violation = only(room(), move((0, 0), (0.5, 0)), GOOD[1])
    assert (violation.kind, violation.segment) == (ViolationKind.DISCONTINUITY, 1)
    assert violation.amount == pytest.approx(0.15)


def test_teleported_object():
    """Objects rest where they were released: one that is grasped elsewhere is not touched."""
    back = move((0.65, 1.0), (0, 1.0), (0, -1.5))
    scene = replace(room(), goal=Goal("obj", np.array([0.35, -0.5]), np.array([0.1, 0.1])))
    assert "no_touch" in kinds(scene, *GOOD, back, carry("obj", (0, -1.5), (0, -0.5)))


def test_grasp_without_touch():
    """A gap of 2 mm is no grasp; one of the tolerance is."""
    scene = room()
    violation = only(scene, move((0, 0), (0.648, 0)), carry("obj", (0.648, 0), (0.648, 1)))
    assert (violation.kind, violation.segment) == (ViolationKind.NO_TOUCH, 1)
    assert violation.amount == pytest.approx(2e-3)
    assert violation.message == "segment 1: the agent grasps obj, which is 0.002 m away"
    assert kinds(scene, move((0, 0), (0.649, 0)), carry("obj", (0.649, 0), (0.649, 1))) == set()


def test_grasp_at_another_height():
    """An agent that is lower than the object's bottom cannot touch it."""
    scene = room(objects=[body("obj", 1, 1, z=0.4), body("other", 1, 0, z=0.4)])
    found = verify(scene, plan_of(scene, move((0, 0), (0.65, 0)), carry("other", (0.65, 0), (0.65, -1.0))))
    assert [(v.kind, v.amount) for v in found] == [
        (ViolationKind.NO_TOUCH, None),
        (ViolationKind.GOAL_MISSED, pytest.approx(0.3)),
    ]
    assert found[0].message == "segment 1: the agent grasps other, which is at another height"


def test_grasp_that_penetrates():
    """The agent may not sink into what it grasps."""
    violations = verify(room(), plan_of(room(), move((0, 0), (0.66, 0)), carry("obj", (0.66, 0), (0.66, 1))))
    assert [(v.kind, v.segment) for v in violations] == [(ViolationKind.COLLISION, 0), (ViolationKind.COLLISION, 1)]
    assert [v.amount for v in violations] == pytest.approx([0.01, 0.01])


def test_missing_release_leaves_the_object_behind():
    """Driving on without a carry does not take the object along: the goal is missed, or the next grasp fails."""
    held_on = move((0.65, 0.5), (0.65, 1.0))
    assert kinds(room(), GOOD[0], carry("obj", (0.65, 0), (0.65, 0.5)), held_on) == {"goal_missed"}
    later = carry("obj", (0.65, 0.8), (0.65, 1.3))
    gone = move((0.65, 0.5), (0.65, 0.8))
    assert kinds(room(), GOOD[0], carry("obj", (0.65, 0), (0.65, 0.5)), gone, later) == {"no_touch"}


def test_change_of_the_held_object_needs_touch():
    """A carry may follow a carry at once, but only of an object that the agent touches there."""
    near = room(objects=[body("obj", 1, 0), body("other", 0.3, 0.5)])
    far = room(objects=[body("obj", 1, 0), body("other", -1, 0.5)])
    swap = (
        move((0, 0), (0.65, 0)),
        carry("obj", (0.65, 0), (0.65, 0.5)),
        carry("other", (0.65, 0.5), (0.65, 0.51)),
        carry("obj", (0.65, 0.51), (0.65, 1.0)),
    )
    assert kinds(far, *swap) == {"no_touch"}
    assert kinds(near, *swap) == set()


def test_regrasp_in_place():
    """Releasing and grasping again without moving, even by a path of one point, is allowed."""
    again = carry("obj", (0.65, 0.5))
    first, second = carry("obj", (0.65, 0), (0.65, 0.5)), carry("obj", (0.65, 0.5), (0.65, 1))
    assert kinds(room(), GOOD[0], first, again, second) == set()


def test_wrong_goal():
    """Missing the goal rectangle by 5 mm is reported with the distance; its border belongs to it."""
    violation = only(room(), GOOD[0], carry("obj", (0.65, 0), (0.65, 0.895)))
    assert violation.kind is ViolationKind.GOAL_MISSED
    assert violation.amount == pytest.approx(5e-3)
    assert kinds(room(), GOOD[0], carry("obj", (0.65, 0), (0.65, 0.9))) == set()


def test_another_object_in_the_goal():
    """Only the goal-object counts."""
    scene = room(objects=[body("other", 1, 0), body("obj", -1, 0)])
    assert kinds(scene, GOOD[0], carry("other", (0.65, 0), (0.65, 1))) == {"goal_missed"}


def test_held_object_through_a_wall():
    """The agent passes beside the wall, what it holds does not."""
    violation = only(room(body("block", 1.2, 0.5, Part.box((0.3, 0.1)))), *GOOD)
    assert (violation.kind, violation.segment) == (ViolationKind.COLLISION, 1)
    assert violation.message.startswith("segment 1: obj penetrates block")
    assert violation.amount == pytest.approx(0.1)


def test_held_object_through_another_object():
    """Objects that are not held stay where they are and stand in the way."""
    violation = only(room(objects=[body("obj", 1, 0), body("other", 1.2, 0.6)]), *GOOD)
    assert (violation.kind, violation.segment) == (ViolationKind.COLLISION, 1)
    assert violation.message.startswith("segment 1: obj penetrates other")


def test_agent_through_a_resting_object():
    """Without grasping it the agent may not push an object."""
    scene = room(objects=[body("obj", 1, 0), body("other", 0.3, 0, Part.box((0.01, 0.01)))])
    violations = verify(scene, plan_of(scene, *GOOD))
    assert [(v.kind, v.segment) for v in violations] == [(ViolationKind.COLLISION, 0)]
    assert "agent penetrates other" in violations[0].message


def test_low_objects_pass_below_a_beam():
    """Bodies meet only if they overlap in height."""
    for z, expected in ((0.3, set()), (0.25, {"collision"})):
        assert kinds(room(body("beam", 0.8, 0.6, Part.box((1, 0.1)), z=z)), *GOOD) == expected


def test_out_of_bounds():
    """The agent's centre and that of what it holds have to stay in the bounds."""
    open_room = replace(room(), walls=())
    violation = only(open_room, move((0, 0), (-2.1, 0), (0, 0), (0.65, 0)), GOOD[1])
    assert (violation.kind, violation.segment, violation.where) == (ViolationKind.OUT_OF_BOUNDS, 0, (-2.1, 0))
    assert violation.amount == pytest.approx(0.1)
    violation = only(open_room, GOOD[0], carry("obj", (0.65, 0), (1.7, 0), (0.65, 1)))
    assert violation.message == "segment 1: the centre of obj leaves the bounds by 0.05 m"


def test_corner_cutting():
    """Two free way-points joined through a wall's corner: nothing between them is skipped, however short."""
    scene = room(body("block", -0.5, -0.5))
    for depth, expected in ((2e-3, {"collision"}), (0.5e-3, set())):
        # The disc's centre passes the corner (-0.35, -0.35) at 0.2 - depth, along the diagonal.
        s = -0.7 + np.sqrt(2) * (0.2 - depth)
        path = move((0, 0), (0, s), (s, 0), (0, 0), (0.65, 0))
        assert kinds(scene, path, GOOD[1]) == expected


def test_turned_wall():
    """A wall turned by 45 degrees reaches out by its diagonal."""
    path = (move((0, 0), (0, -1), (0, 0), (0.65, 0)), GOOD[1])
    box = Part.box((0.3, 0.3))
    assert kinds(room(body("block", -0.38, -1, box)), *path) == set()
    violation = only(room(body("block", -0.38, -1, box, yaw=np.pi / 4)), *path)
    assert violation.kind is ViolationKind.COLLISION
    assert violation.amount == pytest.approx(0.2 + 0.15 * np.sqrt(2) - 0.38)


ELL = (Part.box((0.3, 0.3)), Part(np.array([[0.15, 0.05], [0.75, 0.05], [0.75, 0.15], [0.15, 0.15]])))


def test_compound_object():
    """All parts of a held object move along, and a grasp may touch any of them."""
    scene = room(body("post", 1.6, 0.6), objects=[body("obj", 1, 0, *ELL)])
    violation = only(scene, *GOOD)
    assert violation.kind is ViolationKind.COLLISION
    assert kinds(room(objects=[body("obj", 1, 0, *ELL)]), *GOOD) == set()
    by_the_arm = (
        move((0, 0), (0, 0.35), (1.5, 0.35)),
        carry("obj", (1.5, 0.35), (1.5, 1.35)),
    )
    assert kinds(room(objects=[body("obj", 1, 0, *ELL)]), *by_the_arm) == set()


@pytest.mark.parametrize(("overlap", "expected"), [(0.5, set()), (1.0, set()), (2.0, {"collision"})])
def test_sharp_boxes_within_tolerance(overlap: float, expected: set[str]):
    """Sharp boxes may overlap by the tolerance, although their radii sum to 0; twice that is a collision."""
    scene = room(body("block", 1.3 - overlap * 1e-3, 1, Part.box((0.3, 0.3))))
    assert kinds(scene, *GOOD) == expected


def test_invalid_start():
    """Overlaps in the start configuration belong to no segment."""
    scene = room(body("block", 1.2, -0.2), objects=[body("obj", 1, 1), body("a", 1, -0.1), body("b", -1, 0)])
    violation = only(scene)
    assert (violation.kind, violation.segment) == (ViolationKind.COLLISION, None)
    assert violation.amount == pytest.approx(0.1)
    assert violation.message == "a penetrates block by 0.1 m"
    assert kinds(room(objects=[body("obj", 1, 1), body("a", 1.2, 1.2)])) == {"collision"}
    assert kinds(room(objects=[body("obj", 1, 1), body("a", 0.3, 0)])) == {"collision"}


@pytest.mark.parametrize(
    ("subgoals", "amount"),
    [
        ([("obj", 1.0, 1.01)], pytest.approx(0.01)),
        ([("other", 1.0, 1.0)], None),
        ([("a", 1.0, 1.0)], None),
        ([("obj", 1.0, 0.5), ("obj", 1.0, 1.0)], None),
    ],
)
def test_subgoals_that_the_carries_do_not_make(subgoals: list[tuple[str, float, float]], amount: object):
    """Another place, another object whatever its name, or more placements than carries."""
    claimed = [Subgoal(name, np.array([x, y])) for name, x, y in subgoals]
    violations = verify(room(), plan_of(room(), *GOOD, subgoals=claimed))
    assert [(v.kind, v.amount) for v in violations] == [(ViolationKind.SUBGOAL_MISMATCH, amount)]


def test_a_carry_without_its_subgoal():
    """Subgoals that leave out a placement are not those of the plan, even where the rest agree."""
    half_way = carry("obj", (0.65, 0), (0.65, 0.5)), carry("obj", (0.65, 0.5), (0.65, 1))
    for y in (0.5, 1.0):
        claimed = [Subgoal("obj", np.array([1.0, y]))]
        assert kinds(room(), GOOD[0], *half_way, subgoals=claimed) == {"subgoal_mismatch"}


@pytest.mark.parametrize("z", [0.15, 0.05])
def test_object_above_or_below_the_floor_is_not_placed(z: float):
    """A goal-object that hovers or is sunk into the floor does not rest in the goal."""
    violation = only(room(objects=[body("obj", 1, 1, z=z)]))
    assert (violation.kind, violation.where) == (ViolationKind.GOAL_MISSED, (1, 1))
    assert violation.amount == pytest.approx(0.05)


def test_each_pair_is_reported_once_a_segment():
    """Of several way-points in one wall the deepest is reported."""
    scene = room(body("block", -1, 0))
    violation = only(scene, move((0, 0), (-0.7, 0), (-0.8, 0), (-0.75, 0), (0.65, 0)), GOOD[1])
    assert violation.amount == pytest.approx(0.15)


def test_where_and_when_a_plan_fails():
    """Every violation of a single segment names it and the place; those of a placement name the carry's."""
    drive, far = move((0, 0), (0.6, 0)), carry("obj", (0.6, 0), (0.6, 1))
    assert _place(only(room(), drive, far)) == ("no_touch", 1, (0.6, 0))
    unknown = carry("box", (0.65, 0), (0.65, 1))
    assert _place(only(room(), move((0, 0), (0.65, 0)), unknown)) == ("unknown_object", 1, (0.65, 0))
    assert _place(only(room(), move((0, 0.2), (0.65, 0)), GOOD[1])) == ("discontinuity", 0, (0, 0.2))
    assert _place(only(room(), GOOD[0], carry("obj", (0.65, 0), (0.65, 0.8)))) == ("goal_missed", None, (1.0, 0.8))
    claimed = [Subgoal("obj", np.array([1.0, 0.99]))]
    assert [_place(v) for v in verify(room(), plan_of(room(), *GOOD, subgoals=claimed))] == [
        ("subgoal_mismatch", 1, (1.0, 1.0))
    ]


def _place(violation: Violation) -> tuple[str, int | None, object]:
    return violation.kind.value, violation.segment, pytest.approx(violation.where)


def test_what_the_agent_pushes_ahead_is_carried():
    """An object that is carried forward gives way: the agent may go where it was."""
    ahead = carry("obj", (0.65, 0), (1.0, 0), (1.0, 1.0), (0.65, 1.0))
    assert kinds(room(), GOOD[0], ahead) == set()


def test_a_micrometre_is_touch_two_are_none():
    """Gaps and placements have a micrometre of slack, beyond the tolerance for the former."""
    for slack, expected in ((0.9e-6, set()), (1.1e-6, {"no_touch"})):
        x = 0.65 - 1e-3 - slack
        assert kinds(room(), move((0, 0), (x, 0)), carry("obj", (x, 0), (x, 1))) == expected
    for slack, expected in ((0.9e-6, set()), (1.1e-6, {"subgoal_mismatch"})):
        assert kinds(room(), *GOOD, subgoals=[Subgoal("obj", np.array([1.0 + slack, 1.0]))]) == expected
    for slack, expected in ((0.9e-6, set()), (1.1e-6, {"goal_missed"})):
        assert kinds(room(objects=[body("obj", 1, 1, z=0.1 + slack)])) == expected


@pytest.mark.parametrize(("x", "y"), [(0.89, 1), (1.11, 1), (1, 0.89), (1, 1.11)])
def test_every_side_of_the_goal_counts(x: float, y: float):
    """The goal rectangle ends on all four sides."""
    violation = only(room(objects=[body("obj", x, y)]))
    assert (violation.kind, violation.amount) == (ViolationKind.GOAL_MISSED, pytest.approx(0.01))


@pytest.mark.parametrize(("x", "y"), [(-2.1, 0.0), (2.1, 0.0), (0.0, -2.1), (0.0, 2.1)])
def test_every_side_of_the_bounds_counts(x: float, y: float):
    """The bounds end on all four sides."""
    violation = only(replace(room(objects=[body("obj", 1, 1)]), walls=()), move((0, 0), (x, y)))
    assert (violation.kind, violation.amount) == (ViolationKind.OUT_OF_BOUNDS, pytest.approx(0.1))
    assert violation.where == (x, y)


def test_plan_of_another_scene():
    """The scene's hash has to be the plan's; a mere difference of tolerance is named, with the remedy."""
    scene = room()
    plan = plan_of(scene, *GOOD)
    require_same_scene(scene, plan)
    require_same_scene(replace(scene, name="other name"), plan)
    other = room(body("block", -1, 0))
    for here, there in ((other, scene), (scene, other)):
        with pytest.raises(InputError, match=r"^p\.json: plan of another scene: it was made for 'room'"):
            require_same_scene(here, plan_of(there, *GOOD), "p.json")
    with pytest.raises(InputError, match=r"tolerance 0\.001 m, but the scene has 0\.0001 m; pass --tolerance 0\.001 "):
        require_same_scene(replace(scene, tolerance=1e-4), plan)
    exact = plan_of(room(tolerance=0.0), *GOOD)
    with pytest.raises(InputError, match=r"^plan: made with tolerance 0\.0 m"):
        require_same_scene(scene, exact)
    for tolerance in (-1.0, np.inf, np.nan):
        with pytest.raises(InputError, match=r"^plan: plan of another scene"):
            require_same_scene(other, replace(plan, tolerance=tolerance))


places = st.tuples(*[st.floats(-1.9, 1.9).map(lambda x: round(x, 2))] * 2)
shapes = st.sampled_from([(Part.box((0.3, 0.3)),), (Part.box((0.5, 0.2), 0.02),), (Part(np.zeros((1, 2)), 0.15),), ELL])


@st.composite
def problems(draw: st.DrawFn) -> tuple[Scene, Plan]:
    """Cluttered scenes with plans that hit things: random way-points, grasps near and far."""
    yaw = st.sampled_from([0.0, 0.3, np.pi / 2])
    walls = [body(f"w{i}", *draw(places), *draw(shapes), yaw=draw(yaw)) for i in range(draw(st.integers(0, 4)))]
    objects = [body(name, *draw(places), *draw(shapes), yaw=draw(yaw)) for name in ("obj", "other")]
    scene = room(*walls, objects=objects)
    here, segments = (0.0, 0.0), []
    for held in draw(st.lists(st.sampled_from([None, "obj", "other"]), max_size=4)):
        path = np.array([here, *draw(st.lists(places, min_size=1, max_size=3))])
        segments.append(Segment("move" if held is None else "carry", held, path))
        here = tuple(path[-1])
    return scene, plan_of(scene, *segments)


def turned_body(original: Body, matrix: FloatArray) -> Body:
    """The body under a rotation or reflection of the world, as plain polygons."""
    parts = []
    for core, part in zip(original.cores, original.parts, strict=True):
        image = core @ matrix.T
        parts.append(Part(image if np.linalg.det(matrix) > 0 else image[::-1], part.edge_radius))
    return Body(original.name, np.array([*matrix @ original.position[:2], original.position[2]]), 0.2, tuple(parts))


def turned(scene: Scene, plan: Plan, matrix: FloatArray) -> tuple[Scene, Plan]:
    """Scene and plan under a symmetry of the square."""
    outer = scene.walls[:4]
    image = replace(
        scene,
        walls=(*outer, *(turned_body(wall, matrix) for wall in scene.walls[4:])),
        objects=tuple(turned_body(each, matrix) for each in scene.objects),
        goal=Goal("obj", matrix @ scene.goal.position, scene.goal.size),
    )
    return image, replace(plan, segments=tuple(replace(s, path=s.path @ matrix.T) for s in plan.segments))


@pytest.mark.parametrize("matrix", [[[0, -1], [1, 0]], [[-1, 0], [0, 1]], [[0, 1], [1, 0]]])
@settings(max_examples=40)
@given(problem=problems())
def test_symmetric_problems_have_the_same_violations(matrix: list[list[int]], problem: tuple[Scene, Plan]):
    """A rotation by 90 degrees and reflections keep kinds, segments and amounts."""
    images, originals = (sorted(verify(*case), key=_key) for case in (turned(*problem, np.array(matrix)), problem))
    assert [_key(violation)[:2] for violation in images] == [_key(violation)[:2] for violation in originals]
    assert [_key(violation)[2] for violation in images] == pytest.approx(
        [_key(violation)[2] for violation in originals]
    )


def _key(violation: Violation) -> tuple[str, int, float]:
    segment = -1 if violation.segment is None else violation.segment
    return violation.kind.value, segment, violation.amount or 0.0


@given(st.floats(0, 2 * np.pi), st.sampled_from([0.0, 0.02]))
def test_exact_contact_is_free_with_tolerance_zero(angle: float, edge_radius: float):
    """From whatever side an agent drives up to an object until it touches, it may grasp there and carry."""
    scene = room(objects=[body("obj", 0.8, 0.8, Part.box((0.3, 0.3), edge_radius))], tolerance=0.0)
    scene = replace(scene, goal=Goal("obj", np.array([0.8, 0.8]), np.array([0.4, 0.4])))
    direction = np.array([np.cos(angle), np.sin(angle)])
    contact = np.array([0.8, 0.8]) + direction * _reach(direction, 0.15 - edge_radius, 0.2 + edge_radius)
    scene = replace(scene, agent=Agent(contact + 0.4 * direction, 0.2))
    grasp = tuple(contact)
    path = move(tuple(scene.agent.position), grasp), carry("obj", grasp, tuple(contact + 0.1 * direction))
    assert verify(scene, plan_of(scene, *path)) == []


def _reach(direction: FloatArray, half: float, radius: float) -> float:
    """Distance from the centre of a square of half-width `half` to the border of its inflation by `radius`."""
    x, y = sorted(np.abs(direction), reverse=True)
    flat = (half + radius) / x
    if flat * y <= half:
        return float(flat)
    # On the arc about the corner c: |s u - c| = radius, the greater root.
    along = half * (x + y)
    return float(along + np.sqrt(max(along**2 - 2 * half**2 + radius**2, 0.0)))

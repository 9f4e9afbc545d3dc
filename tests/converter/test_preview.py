"""The physics preview: published and own puzzles are valid, each kind of broken scene is named."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from converter.formats import read_scene
from converter.preview import ENGINE_SLACK, Problem, ProblemKind, check_scene
from converter.scene import Agent, Body, Goal, Scene
from converter.shape import FloatArray, Part

REPOSITORY = Path(__file__).parents[2]
PUZZLES = sorted((REPOSITORY / "data" / "puzzles").glob("*.yaml"))
AUTHORS = REPOSITORY.parent / "shared" / "scenes"


def body(name: str, x: float, y: float, *parts: Part, z: float = 0.1, yaw: float = 0.0) -> Body:
    """A body of height 0.2 at (x, y), by default a sharp box of side 0.4."""
    return Body(name, np.array([x, y, z]), 0.2, parts or (Part.box((0.4, 0.4)),), yaw)


def room(*walls: Body, objects: Sequence[Body] = (), tolerance: float = 1e-4) -> Scene:
    """A closed room with inner faces at +-1.95; agent of radius 0.2 in the middle, object and goal apart."""
    outer = [
        body("outwall_right", 0, -2, Part.box((4.1, 0.1))),
        body("outwall_left", 0, 2, Part.box((4.1, 0.1))),
        body("outwall_front", -2, 0, Part.box((0.1, 4.1))),
        body("outwall_back", 2, 0, Part.box((0.1, 4.1))),
    ]
    return Scene(
        name="room",
        bounds=np.array([[-2.0, -2.0], [2.0, 2.0]]),
        tolerance=tolerance,
        agent=Agent(np.zeros(2), 0.2),
        walls=(*outer, *walls),
        objects=tuple(objects) or (body("obj", 1, -1),),
        goal=Goal("obj", np.array([1.0, 1.0]), np.array([0.3, 0.3])),
    )


def with_agent(scene: Scene, x: float, y: float) -> Scene:
    """The scene with the agent elsewhere."""
    return replace(scene, agent=replace(scene.agent, position=np.array([x, y])))


def kinds(scene: Scene) -> set[str]:
    """Kinds of all problems."""
    return {problem.kind.value for problem in check_scene(scene).problems}


def only(scene: Scene) -> Problem:
    """The single problem of a scene."""
    problems = check_scene(scene).problems
    assert len(problems) == 1, problems
    return problems[0]


def test_there_are_nine_puzzles():
    """The parametrised test below runs over all of them."""
    assert len(PUZZLES) == 9


@pytest.mark.parametrize("path", PUZZLES, ids=lambda path: path.stem)
def test_puzzles_are_valid(path: Path):
    """Every puzzle of the product can be set up."""
    check = check_scene(read_scene(path))
    assert check.valid, check.problems
    assert check.scene == path.stem


@pytest.mark.skipif(not AUTHORS.is_dir(), reason="the authors' scenes are not beside the checkout")
@pytest.mark.parametrize("folder", ["puzzles", "pcg"])
def test_published_scenes_are_valid(folder: str):
    """So can the authors' scenes, although agents start in contact with walls."""
    paths = [path for path in sorted((AUTHORS / folder).glob("*.g")) if not path.stem.startswith("base")]
    assert len(paths) == {"puzzles": 9, "pcg": 6}[folder]
    assert {path.stem: check_scene(read_scene(path)).problems for path in paths} == {path.stem: () for path in paths}


def test_valid_scene():
    """A plain room has no problems."""
    check = check_scene(room())
    assert check.valid
    assert check.problems == ()
    assert check.scene == "room"


@pytest.mark.parametrize(("overlap", "valid"), [(0.0, True), (0.9e-3, True), (1.1e-3, False)])
def test_overlap_beyond_the_tolerance(overlap: float, valid: bool):  # noqa: FBT001  # a column of the table
    """Penetration up to the tolerance is touching; more is reported with the two bodies."""
    scene = with_agent(room(body("block", 0, 0), tolerance=1e-3), 0, -0.4 + overlap)
    if valid:
        assert check_scene(scene).valid
    else:
        problem = only(scene)
        assert problem.kind is ProblemKind.OVERLAP
        assert problem.bodies == ("agent", "block")
        assert problem.amount == pytest.approx(overlap, abs=ENGINE_SLACK)
        assert problem.message == "agent and block overlap by 0.0011 m"


def test_contact_with_tolerance_zero():
    """Exact contact on four sides, of sharp and of round shapes, is no overlap."""
    sides = [body("w", -0.4, 0), body("e", 0.4, 0), body("s", 0, -0.4), body("n", 0, 0.4, Part(np.zeros((1, 2)), 0.2))]
    assert "overlap" not in kinds(room(*sides, tolerance=0.0))
    assert kinds(room(body("block", 1, -0.6), tolerance=0.0)) == set()


def test_overlaps_among_objects():
    """A pair of objects is reported once, with the depth of its deepest parts; the engine pushes them apart."""
    bar = (Part.box((0.4, 0.4)), Part(np.array([[-1.0, -0.05], [0.0, -0.05], [0.0, 0.05], [-1.0, 0.05]])))
    problems = check_scene(room(objects=[body("obj", 1, -1, *bar), body("other", -0.15, -1)])).problems
    overlaps = [problem for problem in problems if problem.kind is ProblemKind.OVERLAP]
    assert [(overlap.bodies, overlap.amount) for overlap in overlaps] == [(("obj", "other"), pytest.approx(0.05))]
    assert {problem.bodies for problem in problems if problem.kind is ProblemKind.NOT_AT_REST} == {("obj",), ("other",)}


@pytest.mark.parametrize(("z", "valid"), [(0.3, True), (0.29, False)])
def test_bodies_at_different_heights_do_not_collide(z: float, valid: bool):  # noqa: FBT001  # a column of the table
    """A beam that rests on an object is no overlap, and the engine moves neither."""
    assert check_scene(room(body("beam", 1.1, -1, z=z))).valid is valid


@pytest.mark.parametrize("yaw", np.linspace(0.1, 1.5, 8))
def test_walls_with_a_vertex_on_a_side(yaw: float):
    """However they are turned, they can be set up."""
    core = np.array([[-0.3, -0.2], [0.1, -0.2], [0.3, -0.2], [0.3, 0.2], [-0.3, 0.2]])
    assert check_scene(room(body("block", -1, 1, Part(core), yaw=yaw))).valid


def test_out_of_bounds():
    """Centres have to lie in the bounds."""
    scene = replace(room(), walls=(), bounds=np.array([[-2.0, -0.9], [2.0, 2.0]]))
    problem = only(scene)
    assert (problem.kind, problem.bodies) == (ProblemKind.OUT_OF_BOUNDS, ("obj",))
    assert problem.amount == pytest.approx(0.1)


def test_outside_the_outer_walls():
    """A body beyond the outer walls is reported, even if wide bounds contain its centre."""
    scene = replace(room(objects=[body("obj", 2.5, 0)]), bounds=np.array([[-9.0, -9.0], [9.0, 9.0]]))
    problem = only(scene)
    assert (problem.kind, problem.bodies) == (ProblemKind.OUTSIDE_WALLS, ("obj",))
    assert problem.amount == pytest.approx(2.7 - 2.05)


@pytest.mark.parametrize("z", [0.15, 0.05])
def test_objects_stand_on_the_floor(z: float):
    """Neither above the floor nor in it."""
    problem = only(room(objects=[body("obj", 1, -1, z=z)]))
    assert (problem.kind, problem.bodies) == (ProblemKind.NOT_ON_FLOOR, ("obj",))
    assert problem.amount == pytest.approx(z - 0.1)


def test_deep_overlap_is_not_at_rest():
    """The engine pushes an object out of a wall."""
    scene = room(body("block", 1, -0.65))
    assert kinds(scene) == {"overlap", "not_at_rest"}
    moved = next(problem for problem in check_scene(scene).problems if problem.kind is ProblemKind.NOT_AT_REST)
    assert moved.bodies == ("obj",)
    assert moved.amount == pytest.approx(0.05, rel=0.1)


def walled_in(gap: float, yaw: float) -> Scene:
    """The agent in the middle of four blocks, `gap` wider than itself, all turned by `yaw`."""
    turn = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    places = (0.4 + gap / 2) * np.array([[1, 0], [-1, 0], [0, 1], [0, -1]]) @ turn
    return room(*(body(f"block{i}", *place, yaw=yaw) for i, place in enumerate(places)))


@pytest.mark.parametrize("yaw", [0.0, 0.3])
def test_walled_in(yaw: float):
    """An agent that walls hold from four sides is stuck; with a wider gap it is not."""
    problem = only(walled_in(0.0, yaw))
    assert (problem.kind, problem.bodies) == (ProblemKind.AGENT_STUCK, ("agent",))
    assert kinds(walled_in(0.01, yaw)) == {"agent_stuck"}
    assert kinds(walled_in(0.08, yaw)) == set()


@pytest.mark.parametrize("yaw", [0.0, 0.3, 1.234])
def test_zero_clearance_corridor(yaw: float):
    """In a corridor exactly as wide as itself, at any angle, the agent can move along it."""
    scene = walled_in(0.0, yaw)
    assert check_scene(replace(scene, walls=scene.walls[:-1], tolerance=0.0)).valid


def test_objects_do_not_hold_the_agent():
    """Objects around the agent can be carried away."""
    sides = [body("w", -0.4, 0), body("e", 0.4, 0), body("s", 0, -0.4), body("obj", 0, 0.4)]
    assert check_scene(room(objects=sides)).valid


def test_high_walls_do_not_hold_the_agent():
    """Walls above the agent leave it free to move."""
    sides = [body(f"block{i}", x, y, z=0.5) for i, (x, y) in enumerate([(0.4, 0), (-0.4, 0), (0, 0.4), (0, -0.4)])]
    assert check_scene(room(*sides)).valid


def test_agent_in_a_wall_is_an_overlap_but_not_stuck():
    """If it could drive out, its place is the only thing wrong with it."""
    assert kinds(with_agent(room(body("block", 0, 0)), 0, -0.35)) == {"overlap", "not_at_rest"}


def test_goal_out_of_bounds():
    """A goal that no centre can reach is reported; one that overlaps the bounds is not."""
    scene = room()
    far = replace(scene, goal=replace(scene.goal, position=np.array([2.25, 0.0])))
    assert only(far).kind is ProblemKind.GOAL_OUT_OF_BOUNDS
    assert only(far).amount == pytest.approx(0.1)
    partly = replace(scene, goal=replace(scene.goal, position=np.array([1.85, 0.0])))
    assert check_scene(partly).valid


def test_goal_covered():
    """Walls over the goal leave no place for the object: one big wall, or two that meet in its middle."""
    big = body("block", 1, 1, Part.box((0.6, 0.6)))
    assert only(room(big)).kind is ProblemKind.GOAL_COVERED
    halves = [body("left", 0.85, 1, Part.box((0.3, 0.6))), body("right", 1.15, 1, Part.box((0.3, 0.6)))]
    assert only(room(*halves)).kind is ProblemKind.GOAL_COVERED


def test_goal_partly_covered():
    """A wall over a part of the goal, or above the object, leaves a place."""
    assert check_scene(room(body("block", 1.3, 1))).valid
    assert check_scene(room(body("block", 1, 1, Part.box((0.6, 0.6)), z=0.4))).valid


def test_goal_covered_though_its_rectangle_is_free():
    """A slot narrower than the object is no place, although centres in it are outside of walls."""
    slot = [body("left", 0.75, 1), body("right", 1.25, 1)]
    narrow = replace(room(*slot), goal=Goal("obj", np.array([1.0, 1.0]), np.array([0.1, 0.1])))
    assert only(narrow).kind is ProblemKind.GOAL_COVERED
    low = replace(narrow, objects=(body("obj", 1, -1, Part.box((0.1, 0.4))),))
    assert check_scene(low).valid


sides = st.sampled_from([0.1, 0.2, 0.4, 0.8])
places = st.tuples(*[st.floats(-0.6, 0.6).map(lambda x: round(x, 2))] * 2)


@st.composite
def parts(draw: st.DrawFn) -> Part:
    """Boxes, polygons with up to 7 vertices, capsules and discs, sharp and round."""
    n = draw(st.integers(1, 7))
    if n == 4:
        return Part.box((draw(sides), draw(sides)), draw(st.sampled_from([0.0, 0.02])))
    radius = draw(st.sampled_from([0.0, 0.02, 0.1])) if n > 2 else draw(st.sampled_from([0.02, 0.1]))
    angles = np.arange(n) * 2 * np.pi / n + draw(st.floats(0, 1))
    return Part(draw(st.floats(0.05, 0.6)) * np.column_stack([np.cos(angles), np.sin(angles)]), radius)


@settings(max_examples=300)
@given(parts(), parts(), places, places, st.sampled_from([0.0, 0.3, np.pi / 4]), st.sampled_from([0.0, 1e-3]))
def test_same_verdict_as_shapely(
    first: Part, second: Part, place: tuple[float, float], other: tuple[float, float], yaw: float, tolerance: float
):
    """Overlap of a wall and an object, and its depth, are those of an exact computation up to the engine's slack."""
    wall, obj = body("wall", *place, first, yaw=yaw), body("obj", *other, second)
    scene = Scene(
        name="pair",
        bounds=np.array([[-9.0, -9.0], [9.0, 9.0]]),
        tolerance=tolerance,
        agent=Agent(np.array([5.0, 5.0]), 0.2),
        walls=(wall,),
        objects=(obj,),
        goal=Goal("obj", np.array([5.0, 0.0]), np.array([1.0, 1.0])),
    )
    found = [problem.amount for problem in check_scene(scene).problems if problem.kind is ProblemKind.OVERLAP]
    expected = _depth(wall, obj)
    if found:
        assert found == [pytest.approx(expected, abs=ENGINE_SLACK)]
    else:
        assert expected <= tolerance + 2 * ENGINE_SLACK


def _depth(first: Body, second: Body) -> float:
    """Penetration [m] of two bodies of one part, from the hull of all differences of their vertices; < 0: apart."""
    a, b = (part.cores[0] + part.position[:2] for part in (first, second))
    difference: FloatArray = (a[:, np.newaxis] - b[np.newaxis]).reshape(-1, 2)
    hull, origin = shapely.convex_hull(shapely.multipoints(difference)), shapely.Point(0, 0)
    inside = hull.geom_type == "Polygon" and hull.contains(origin)
    core = hull.boundary.distance(origin) if inside else -hull.distance(origin)
    return float(core) + first.parts[0].edge_radius + second.parts[0].edge_radius

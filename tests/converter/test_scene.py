import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity
from hypothesis import given, settings
from hypothesis import strategies as st

from converter.scene import Agent, Body, Goal, Scene
from converter.shape import Part

BOX = Part.box((0.4, 0.2), 0.02)
BODY = Body("obj", np.array([0.5, 0.0, 0.1]), 0.2, (BOX,))
SCENE = Scene(
    name="test",
    bounds=np.array([[-1.0, -1.0], [1.0, 1.0]]),
    tolerance=1e-3,
    agent=Agent(np.zeros(2), 0.2),
    walls=(Body("w1", np.array([0.0, -1.0, 0.2]), 0.4, (BOX,)), Body("w2", np.array([0.0, 1.0, 0.2]), 0.4, (BOX,))),
    objects=(BODY,),
    goal=Goal("obj", np.zeros(2), np.array([0.2, 0.1])),
)
replace = dataclasses.replace


@given(st.from_type(Body))
def test_cores_are_turned_counter_clockwise(body: Body):
    """The turned polygons are those of an independent rotation about the body's position."""
    for core, part in zip(body.cores, body.parts, strict=True):
        turned = [
            shapely.affinity.rotate(shapely.Point(p), body.yaw, origin=(0, 0), use_radians=True) for p in part.core
        ]
        np.testing.assert_allclose(core, [(point.x, point.y) for point in turned], atol=1e-9)


@pytest.mark.parametrize(("x", "y", "inside"), [(0, 0, True), (0.1, 0.05, True), (0.1001, 0, False), (0, -0.06, False)])
def test_the_border_of_the_goal_belongs_to_it(x: float, y: float, inside: bool):  # noqa: FBT001  # pytest passes by name
    """Closed in x and y."""
    assert SCENE.goal.contains(np.array([x, y])) is inside


@settings(max_examples=40)
@given(st.from_type(Scene))
def test_the_hash_ignores_what_is_no_geometry(scene: Scene):
    """Names of scene and walls, their order, colours, source and preset do not count."""
    walls = tuple(replace(wall, name=f"w-{i}", color=(1.0, 0.0, 0.0)) for i, wall in enumerate(reversed(scene.walls)))
    other = replace(scene, name="other", walls=walls, source={"a": 1}, preset=None)
    assert other.geometry_hash == scene.geometry_hash


@pytest.mark.parametrize(
    "change",
    [
        lambda scene: replace(scene, tolerance=1e-4),
        lambda scene: replace(scene, bounds=scene.bounds * 1.01),
        lambda scene: replace(scene, agent=replace(scene.agent, radius=0.21)),
        lambda scene: replace(scene, agent=replace(scene.agent, position=np.array([1e-8, 0]))),
        lambda scene: replace(scene, agent=replace(scene.agent, height=0.3)),
        lambda scene: replace(scene, walls=scene.walls[:1]),
        lambda scene: replace(scene, walls=(*scene.walls[:1], replace(scene.walls[1], yaw=0.1))),
        lambda scene: replace(scene, walls=(*scene.walls[:1], replace(scene.walls[1], height=0.5))),
        lambda scene: replace(scene, objects=(BODY.at(np.array([0.5, 1e-8])),)),
        lambda scene: replace(scene, objects=(replace(BODY, parts=(Part.box((0.4, 0.2), 0.03),)),)),
        lambda scene: replace(
            scene,
            objects=(
                replace(
                    BODY,
                    parts=(BOX, Part.box((0.2, 0.4))),
                ),
            ),
        ),
        lambda scene: replace(scene, goal=replace(scene.goal, size=np.array([0.2, 0.2]))),
    ],
)
def test_the_hash_sees_every_change_of_geometry(change: Callable[[Scene], Scene]):
    """From 10 nm up."""
    assert change(SCENE).geometry_hash != SCENE.geometry_hash


def test_geometry_is_what_a_body_fills():
    """The first vertex of a polygon, the order of parts, and half a turn of a box make no difference."""
    rolled = Part(np.roll(BOX.core, 1, axis=0), BOX.edge_radius)
    other = Part.box((0.1, 0.1))
    assert replace(BODY, parts=(rolled,)).geometry == BODY.geometry
    assert replace(BODY, yaw=np.pi).geometry == BODY.geometry
    assert replace(BODY, parts=(BOX, other)).geometry == replace(BODY, parts=(other, BOX)).geometry


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: replace(BODY, name=""), "needs a name"),
        (lambda: replace(BODY, parts=()), "at least one part"),
        (lambda: replace(BODY, height=0.0), "height 0.0 must be positive"),
        (lambda: replace(BODY, yaw=float("nan")), "yaw nan must be finite"),
        (lambda: replace(BODY, position=np.array([0.0, np.inf, 0.0])), "finite"),
        (lambda: Agent(np.zeros(3), 0.2), "numbers wanted"),
        (lambda: Agent(np.zeros(2), -0.2), "radius -0.2 must be positive"),
        (lambda: Goal("obj", np.zeros(2), np.array([0.1, 0.0])), "must be positive"),
        (lambda: replace(SCENE, tolerance=-1e-9), "tolerance -1e-09 must be >= 0"),
        (lambda: replace(SCENE, bounds=-SCENE.bounds), "the lower corner must be below the upper one"),
        (lambda: replace(SCENE, objects=(BODY, replace(BODY, name="w1"))), "names must be unique, found w1 twice"),
        (
            lambda: replace(SCENE, objects=(BODY, replace(BODY, name="agent"))),
            "no wall or object may be called 'agent'",
        ),
        (lambda: replace(SCENE, objects=(replace(BODY, name="box"),)), r"'obj' is not an object; there are \['box'\]"),
    ],
)
def test_invariants_hold_at_construction(make: Callable[[], Any], message: str):
    """What makes no sense is refused with what was found."""
    with pytest.raises(ValueError, match=message):
        make()


def test_arrays_are_copies_that_cannot_be_written():
    """A scene does not change with the array it was made from."""
    position = np.zeros(2)
    agent = Agent(position, 0.2)
    position[0] = 1
    assert agent.position[0] == 0
    with pytest.raises(ValueError, match="read-only"):
        agent.position[0] = 1


def test_objects_are_found_by_name():
    """An unknown name lists those that there are."""
    assert SCENE.goal_object is BODY
    with pytest.raises(KeyError, match="no object 'w1'"):
        SCENE.object("w1")

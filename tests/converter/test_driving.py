"""Driving in the physics engine: what stands in the way holds the disc up or is pushed, and is reported."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from converter.preview.driving import Drive, drive
from converter.preview.simulation import MOVED
from converter.scene import Agent, Body, Goal, Scene
from converter.shape import Part


def block(name: str, x: float, y: float, size: tuple[float, float] = (0.4, 0.4), z: float = 0.1) -> Body:
    """A sharp box of height 0.2."""
    return Body(name, np.array([x, y, z]), 0.2, (Part.box(size),))


def hall(walls: Sequence[Body] = (), objects: Sequence[Body] = (), tolerance: float = 1e-4) -> Scene:
    """An open floor with an agent of radius 0.2 at the origin; the goal-object is out of the way."""
    return Scene(
        name="hall",
        bounds=np.array([[-9.0, -9.0], [9.0, 9.0]]),
        tolerance=tolerance,
        agent=Agent(np.zeros(2), 0.2),
        walls=tuple(walls),
        objects=(*objects, block("obj", 0, 8)),
        goal=Goal("obj", np.array([5.0, 8.0]), np.array([1.0, 1.0])),
    )


def along(scene: Scene, *points: tuple[float, float]) -> Drive:
    """A drive from the origin over some points."""
    return drive(scene, np.array([(0.0, 0.0), *points]))


def test_free_floor():
    """The disc arrives, at the speed that it is told, and touches nothing."""
    found = along(hall(), (1.0, 0.0), (1.0, 1.0))
    assert (found.reached, found.touches, found.moved) == (True, (), ())
    np.testing.assert_allclose(found.end, (1, 1), atol=1e-9)
    assert found.time_s == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("tolerance", [0.0, 1e-3])
@pytest.mark.parametrize("yaw", [0.0, 0.3])
def test_corridor_as_wide_as_the_disc(tolerance: float, yaw: float):
    """Touching both walls all the way, it arrives."""
    turn = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    places = np.array([[0.5, 0.3], [0.5, -0.3]]) @ turn
    walls = [
        Body(f"wall{i}", np.array([x, y, 0.1]), 0.2, (Part.box((2.0, 0.2)),), yaw) for i, (x, y) in enumerate(places)
    ]
    end = np.array([1.5, 0.0]) @ turn
    found = along(hall(walls, tolerance=tolerance), (end[0], end[1]))
    assert found.reached
    assert all(touch.depth <= tolerance + 1e-6 for touch in found.touches)


def test_a_wall_holds_the_disc_up():
    """It stops in front of the wall, which is named with the place of the contact."""
    found = along(hall([block("wall", 1, 0)]), (2.0, 0.0))
    assert not found.reached
    np.testing.assert_allclose(found.end, (0.6, 0), atol=2e-3)
    assert found.short_by == pytest.approx(1.4, abs=2e-3)
    (touch,) = found.touches
    assert touch.bodies == ("agent", "wall")
    np.testing.assert_allclose(touch.where, (0.8, 0), atol=5e-3)


def test_what_is_at_another_height_is_no_obstacle():
    """The disc drives under a beam."""
    found = along(hall([block("beam", 1, 0, z=0.35)]), (2.0, 0.0))
    assert (found.reached, found.touches) == (True, ())


@settings(max_examples=20)
@given(st.floats(0.05, 0.6), st.sampled_from([0.2, 0.4]))
def test_a_central_push_moves_straight(distance: float, side: float):
    """The object goes as far as the disc drives after touching it, and does not turn."""
    start = 0.5 + side / 2
    found = along(hall(objects=[block("box", start, 0, (side, side))]), (0.3 + distance, 0.0))
    assert found.reached
    (moved,) = found.moved
    assert (moved.object, moved.start) == ("box", (start, 0.0))
    np.testing.assert_allclose(moved.end, (start + distance, 0), atol=2e-3)
    assert abs(moved.turned) < 1e-3
    assert moved.distance == pytest.approx(distance, abs=2e-3)


@pytest.mark.parametrize("side", [1, -1])
def test_an_eccentric_push_turns_the_object(side: int):
    """Pushed right of its centre, as seen from the disc, it turns to the left, and the other way round."""
    found = along(hall(objects=[block("box", 0.8, 0.1 * side, (0.4, 0.4))]), (0.6, 0.0))
    (moved,) = found.moved
    assert moved.turned * side > 0.1
    assert moved.distance < 0.3


def test_a_push_ends_at_a_wall():
    """The object is pressed against the wall and holds the disc up; who touched whom is told once for each pair."""
    scene = hall([block("wall", 2, 0)], [block("box", 0.6, 0)])
    found = along(scene, (2.0, 0.0))
    assert not found.reached
    (moved,) = found.moved
    np.testing.assert_allclose(moved.end, (1.6, 0), atol=3e-3)
    assert {touch.bodies for touch in found.touches} == {("agent", "box"), ("box", "wall")}


def test_pushed_objects_push_others():
    """Both are reported; they stop when the disc does."""
    found = along(hall(objects=[block("near", 0.6, 0), block("far", 1.2, 0)]), (0.6, 0.0))
    ends = {moved.object: moved.end[0] for moved in found.moved}
    assert ends == {"near": pytest.approx(1.0, abs=3e-3), "far": pytest.approx(1.4, abs=4e-3)}


def test_touching_on_the_way_moves_nothing():
    """A disc that slides along objects within the tolerance leaves them where they are."""
    row = [block(f"box{i}", 0.3 + 0.4 * i, 0.4 - 5e-4) for i in range(3)]
    found = along(hall(objects=row, tolerance=1e-3), (1.5, 0.0))
    assert found.reached
    assert found.moved == ()
    assert {touch.bodies[1] for touch in found.touches} == {"box0", "box1", "box2"}
    assert max(touch.depth for touch in found.touches) < MOVED


def test_drives_are_repeatable():
    """To the last bit, contacts and all."""
    scene = hall([block("wall", 1.8, 0.1)], [block("a", 0.6, 0.1), block("b", 1.2, -0.15)])
    assert along(scene, (1.5, 0.1)) == along(scene, (1.5, 0.1))

"""Scenes in the physics engine: exact distances, contacts, heights, and which bodies turn."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from converter.preview.world import ENGINE_SLACK, World, signed_distance
from converter.scene import AGENT, Agent, Body, Goal, Scene
from converter.shape import FloatArray, Part, rotation


@st.composite
def polygons(draw: st.DrawFn) -> FloatArray:
    """Points, segments and convex polygons at any place."""
    n = draw(st.integers(1, 6))
    angles = (np.arange(n) + [draw(st.floats(0, 0.5)) for _ in range(n)]) * 2 * np.pi / n
    axes = [draw(st.floats(0.05, 1)), draw(st.floats(0.05, 1))]
    center = [draw(st.floats(-1, 1)), draw(st.floats(-1, 1))]
    return np.column_stack([np.cos(angles), np.sin(angles)]) * axes + center


def shapely_distance(first: FloatArray, second: FloatArray) -> float:
    """The distance of the origin to the border of the difference of the polygons, negative inside."""
    difference = shapely.convex_hull(shapely.multipoints((second[:, None] - first[None]).reshape(-1, 2)))
    origin = shapely.Point(0, 0)
    inside = difference.geom_type == "Polygon" and difference.contains(origin)
    return -float(difference.exterior.distance(origin)) if inside else float(difference.distance(origin))


@given(polygons(), polygons())
def test_signed_distances_agree_with_shapely(first: FloatArray, second: FloatArray):
    """Apart it is the distance, overlapping the least way to separate the two; it does not depend on the order."""
    found = signed_distance(first, second)
    assert found == pytest.approx(shapely_distance(first, second), abs=1e-9)
    assert signed_distance(second, first) == pytest.approx(found, abs=1e-12)


def world_with(*objects: Body, density: float | None = None) -> World:
    """A room whose only wall stands to the right of the agent; the first object has to go to the goal."""
    wall = Body("wall", np.array([1.0, 0.0, 0.2]), 0.4, (Part.box((0.4, 0.4)),))
    scene = Scene(
        name="room",
        bounds=np.array([[-2.0, -2.0], [2.0, 2.0]]),
        tolerance=1e-4,
        agent=Agent(np.zeros(2), 0.2),
        walls=(wall,),
        objects=objects,
        goal=Goal(objects[0].name, np.array([-1.0, -1.0]), np.array([0.3, 0.3])),
    )
    return World(scene, density)


def cube(name: str, x: float, y: float, z: float = 0.1, yaw: float = 0.0) -> Body:
    """A cube of 0.2 m."""
    return Body(name, np.array([x, y, z]), 0.2, (Part.box((0.2, 0.2)),), yaw)


@pytest.mark.parametrize("yaw", [0.0, 0.3, math.pi / 4])
@pytest.mark.parametrize("depth", [0.01, 0.05])
def test_contacts_have_the_depth_of_the_overlap(yaw: float, depth: float):
    """A turned cube that is pushed into the wall by its foremost corner or side is that deep in it."""
    reach = float((Part.box((0.2, 0.2)).core @ rotation(yaw))[:, 0].max())
    world = world_with(cube("obj", 0.8 - reach + depth, 0.0, yaw=yaw))
    (contact,) = world.contacts(world.objects[0])
    assert contact.other.name == "wall"
    assert contact.depth == pytest.approx(depth, abs=ENGINE_SLACK)
    exact = world.depth(world.objects[0].shapes[0], world.walls[0].shapes[0])
    assert exact == pytest.approx(depth, abs=1e-12)


def test_the_agent_is_a_disc():
    """Beside its flank it touches what is a radius away, at its box's corner it does not."""
    touching, apart = world_with(cube("obj", -0.29, 0.0)), world_with(cube("obj", -0.25, 0.25))
    assert [contact.other.name for contact in touching.contacts(touching.agent)] == ["obj"]
    assert apart.contacts(apart.agent) == []
    assert touching.agent.name == AGENT


def test_bodies_above_each_other_do_not_meet():
    """They overlap in the plane, which `contacts` tells, but not in height."""
    world = world_with(cube("obj", -1.0, 0.0), cube("above", -1.0, 0.05, z=0.3))
    below, above = world.objects
    assert [contact.other.name for contact in world.contacts(below)] == ["above"]
    assert not below.meets_in_height(above)
    for _ in range(50):
        world.space.step(0.01)
    assert below.place == pytest.approx((-1.0, 0.0))


def test_only_objects_with_a_density_turn():
    """Without one nothing turns; with one objects do and have the mass of their volume, and the agent never turns."""
    still, moving = world_with(cube("obj", -1.0, 0.0)), world_with(cube("obj", -1.0, 0.0), density=500.0)
    assert still.objects[0].body.moment == math.inf
    assert moving.objects[0].body.moment < math.inf
    assert moving.objects[0].body.mass == pytest.approx(500.0 * 0.2**3)
    assert moving.agent.body.moment == math.inf

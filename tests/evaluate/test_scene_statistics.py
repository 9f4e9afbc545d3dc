"""Statistics of scenes, against cases that can be worked out by hand."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from converter.plan import Plan, Segment
from converter.scene import Agent, Body, Goal, Scene
from converter.shape import Part
from evaluate.inputs import read_scene_file
from evaluate.passage import narrowest_passage
from evaluate.scene_statistics import generator_of, is_monotone, must_move, statistics_of

PUZZLES = Path(__file__).parents[2] / "data" / "puzzles"


def box(name: str, x: float, y: float, width: float, height: float, radius: float = 0.0) -> Body:
    """A wall or an object of outer size `width` x `height`."""
    return Body(name, np.array([x, y, 0.1]), 0.2, (Part.box((width, height), radius),))


def two_rooms(*gaps: float, objects: tuple[Body, ...] = (), radius: float = 0.0) -> Scene:
    """A 4 m room with a wall across at x = 0, whose doors are as wide as `gaps`; agent left, object and goal right.

    The doors begin at y = -1.5 and stand 1 m apart.
    """
    edges = [-2.0]
    for i, gap in enumerate(gaps):
        edges += [-1.5 + i, -1.5 + i + gap]
    edges.append(2.0)
    across = [
        box(f"wall{i}", 0.0, (low + high) / 2, 0.1, high - low, radius)
        for i, (low, high) in enumerate(zip(edges[::2], edges[1::2], strict=True))
    ]
    outer = [
        box("outwall_left", -2.05, 0, 0.1, 4.2),
        box("outwall_right", 2.05, 0, 0.1, 4.2),
        box("outwall_bottom", 0, -2.05, 4.2, 0.1),
        box("outwall_top", 0, 2.05, 4.2, 0.1),
    ]
    return Scene(
        name="two-rooms",
        bounds=np.array([[-2.0, -2.0], [2.0, 2.0]]),
        tolerance=1e-4,
        agent=Agent(np.array([-1.2, 0.0]), 0.1),
        walls=(*outer, *across),
        objects=(box("obj", 1.0, 0.0, 0.2, 0.2), *objects),
        goal=Goal("obj", np.array([1.0, 1.2]), np.array([0.3, 0.3])),
    )


@pytest.mark.parametrize("radius", [0.0, 0.02])
def test_the_passage_is_the_wider_door(radius: float):
    """Of two doors the agent takes the wider one; rounded edges do not change the width between flat faces."""
    assert narrowest_passage(two_rooms(0.3, 0.5, radius=radius)) == pytest.approx(0.5, abs=1e-5)


def test_being_close_to_a_wall_is_no_passage():
    """An agent that starts in a corner of an open room has no narrow way."""
    scene = two_rooms(0.8)
    cornered = replace(scene, agent=replace(scene.agent, position=np.array([-1.89, -1.89])))
    assert narrowest_passage(cornered) == pytest.approx(0.8, abs=1e-5)


def test_without_a_way_there_is_no_passage():
    """A closed wall lets nothing through."""
    assert narrowest_passage(two_rooms()) == 0.0


def test_passages_of_the_puzzles():
    """Maze has corridors as wide as the agent, Cube-Free none at all."""
    assert narrowest_passage(read_scene_file(PUZZLES / "maze.yaml")) == pytest.approx(0.4, abs=1e-4)
    assert narrowest_passage(read_scene_file(PUZZLES / "cube-free.yaml")) > 3


def test_an_object_in_the_only_door_must_move():
    """The goal-object alone where the way is free, a second object where it blocks the door, none in the goal."""
    assert must_move(two_rooms(0.5)) == 1
    plug = box("plug", 0.0, -1.25, 0.3, 0.3)
    assert must_move(two_rooms(0.5, objects=(plug,))) == 2
    assert must_move(two_rooms(0.5, 0.5, objects=(plug,))) == 1
    scene = two_rooms(0.5)
    done = replace(scene, goal=replace(scene.goal, position=np.array([1.0, 0.0])))
    assert must_move(done) == 0
    assert must_move(two_rooms()) is None


def test_objects_around_the_goal_object_must_move():
    """Between two bars: the lower one keeps the agent out, which comes through the door below, the upper one is next."""
    bars = tuple(box(f"bar{i}", 1.0, y, 1.9, 0.1) for i, y in enumerate((-0.4, 0.4)))
    assert must_move(two_rooms(0.5, objects=bars)) == 3
    assert must_move(two_rooms(0.5, objects=bars[1:])) == 2


def test_monotone(small_plan: Plan):
    """An object that is carried twice makes a plan not monotone."""
    assert not is_monotone(small_plan)
    first = replace(small_plan, segments=small_plan.segments[:3])
    assert is_monotone(first)
    other = Segment("carry", "obstacle", np.zeros((1, 2)))
    assert is_monotone(replace(first, segments=(*first.segments, other)))


def test_statistics_of_a_puzzle():
    """Wall-Easy: two walls, the goal-object hidden behind one of them; one carry is enough."""
    found = statistics_of(read_scene_file(PUZZLES / "wall-easy.yaml"))
    assert (found.objects, found.walls, found.occluded, found.must_move) == (1, 2, True, 1)
    assert (found.pick_places, found.monotone) == (1, True)
    assert found.narrowest_passage_m == pytest.approx(0.46, abs=1e-3)
    assert 0 < found.wall_density < 0.05


def test_wall_density_is_an_area():
    """Walls of 0.1 m across 4 m less a door of 0.5 m, in 16 square metres; rounded edges lose their corners."""
    assert statistics_of(two_rooms(0.5)).wall_density == pytest.approx(0.35 / 16)
    lost = 2 * (4 - np.pi) * 0.02**2
    assert statistics_of(two_rooms(0.5, radius=0.02)).wall_density == pytest.approx((0.35 - lost) / 16)


@pytest.mark.parametrize(("name", "agent"), [("m3-17", "m3"), ("random-1-0", "random"), ("wall-easy", None)])
def test_generator_of_a_name(name: str, agent: str | None):
    """Generated levels are called after their agent."""
    assert generator_of(name) == agent

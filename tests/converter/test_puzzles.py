"""The nine puzzles of `data/puzzles`."""

from pathlib import Path

import numpy as np
import pytest
import shapely

from converter.formats import read_scene

PUZZLES = Path(__file__).parents[2] / "data" / "puzzles"
PUBLISHED = Path(__file__).parents[3] / "shared" / "scenes" / "puzzles"

# File of the authors; inner walls; sizes of the objects other than obj; start of the agent; start of obj; its size; goal.
FACTS = {
    "cube-free": ("p9-cube-free", 0, [], (0, 0), (0.9, -1.5), (0.3, 0.3), (-1.6, 1.6)),
    "corner": ("p8-corner", 0, [], (0, 0), (1.6, -1.6), (0.3, 0.3), (-1.6, 1.6)),
    "two-blocks": ("p1-two-blocks", 0, [(0.8, 0.2), (0.2, 1)], (0, 0), (1.5, -0.5), (0.3, 0.3), (-1.5, 1.5)),
    "four-blocks": (
        "p4-four-blocks",
        0,
        [(1, 0.2), (0.2, 1), (0.2, 1), (1, 0.2)],
        (-1.3, -1.3),
        (1.6, -0.5),
        (0.3, 0.3),
        (-1.5, 1.5),
    ),
    "maze-easy": ("p2-maze-easy", 7, [], (0, 0), (1.5, -0.5), (0.3, 0.3), (-1.7, 1.7)),
    "wall-easy": ("p5-wall-easy", 2, [], (0, 0), (-0.9, -1.5), (0.3, 0.3), (-1.2, 1.3)),
    "o-room": ("p7-o-room", 4, [], (1.7, 0), (1.5, -1.5), (0.3, 0.3), (-1.6, 1.6)),
    "maze": ("p3-maze", 7, [], (0, 0), (1.5, -0.5), (0.4, 0.3), (-1.5, 1.5)),
    "wall": ("p6-wall", 2, [], (0, 0), (-0.9, -1.5), (0.3, 0.3), (-1.2, 1.3)),
}


def test_there_are_nine():
    """One file for each."""
    assert {path.stem for path in PUZZLES.iterdir()} == set(FACTS)


@pytest.mark.parametrize("name", FACTS)
def test_dimensions(name: str):
    """Walls, objects, agent and goal as published."""
    _, inner_walls, others, agent, start, size, goal = FACTS[name]
    scene = read_scene(PUZZLES / f"{name}.yaml")
    assert (scene.name, scene.preset, scene.tolerance) == (name, "published", 1e-3)
    assert scene.bounds.tolist() == [[-2.05, -2.05], [2.05, 2.05]]
    inner = [wall for wall in scene.walls if not wall.name.startswith("outwall_")]
    assert (len(inner), len(scene.walls) - len(inner)) == (inner_walls, 4)
    assert all(wall.bottom_top == (0, 0.6) and wall.parts[0].edge_radius == 0.02 for wall in inner)
    assert all(min(wall.parts[0].box_size or ()) == pytest.approx(0.1) for wall in inner)
    boxes = {body.name: np.round(body.parts[0].box_size or (), 9).tolist() for body in scene.objects}
    assert boxes.pop("obj") == list(size)
    assert sorted(boxes.values()) == sorted(map(list, others))
    assert scene.agent.position.tolist() == list(agent)
    assert (scene.agent.radius, scene.agent.height) == (0.2, 0.2)
    assert scene.goal_object.position.tolist() == [*start, 0.1]
    assert (scene.goal.object, scene.goal.position.tolist(), scene.goal.size.tolist()) == (
        "obj",
        list(goal),
        [0.2, 0.2],
    )


@pytest.mark.parametrize("name", FACTS)
def test_the_start_is_free(name: str):
    """At the start nothing overlaps by more than the tolerance."""
    scene = read_scene(PUZZLES / f"{name}.yaml")
    fixed = [body for body in scene.walls if not body.name.startswith("outwall_")]
    shapes = {
        body.name: shapely.Polygon(body.cores[0] + body.position[:2]).buffer(body.parts[0].edge_radius)
        for body in (*scene.objects, *fixed)
    }
    shapes["agent"] = shapely.Point(scene.agent.position).buffer(scene.agent.radius)
    movable = [*scene.object_names, "agent"]
    overlaps = [
        (a, b) for a in movable for b in shapes if a != b and shapes[a].buffer(-scene.tolerance).intersects(shapes[b])
    ]
    assert overlaps == []
    room = shapely.box(-1.95, -1.95, 1.95, 1.95)
    assert all(room.buffer(scene.tolerance).covers(shapes[a]) for a in movable)


@pytest.mark.skipif(not PUBLISHED.is_dir(), reason="the authors' scenes are not beside the checkout")
@pytest.mark.parametrize("name", FACTS)
def test_same_geometry_as_the_authors_files(name: str):
    """The hash over all geometry is that of the imported file."""
    imported = read_scene(PUBLISHED / f"{FACTS[name][0]}.g")
    assert read_scene(PUZZLES / f"{name}.yaml").geometry_hash == imported.geometry_hash

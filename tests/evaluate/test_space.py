"""The pictures of configuration spaces."""

import json
from pathlib import Path

import numpy as np
from typer.testing import CliRunner

from converter.formats import write_scene
from converter.scene import Scene
from evaluate.cli import app
from evaluate.commands.space import carrying_space, driving_space, rounded
from planner.problem import Problem


def test_what_the_panels_show_is_free(small_room: Scene):
    """Free stretches touch the object and lie in free space, the tree's motions are free, and the path ends in the goal."""
    problem = Problem(small_room)
    index = problem.goal_index
    panel, grasps = driving_space(problem, index)
    space = problem.agent_space(problem.initial)
    assert len(panel.edges) > 0
    assert space.segments_free(panel.edges[:, 0], panel.edges[:, 1]).all()
    held = problem.agent_space(problem.initial, held=index)
    assert all(held.points_free(stretch[1:-1]).all() for stretch in panel.free)
    assert space.points_free(problem.initial.objects[index] + grasps).all()
    carried = carrying_space(problem, index, grasps)
    assert carried.path is not None
    grasp = carried.agent - problem.initial.objects[index]
    np.testing.assert_allclose(carried.path[-1] - grasp, small_room.goal.position)
    assert len(rounded(space)) == len(space.obstacles)


def test_the_command_draws_both_spaces(tmp_path: Path, small_room: Scene):
    """One file called after scene and object; an unknown object is refused."""
    scene = tmp_path / "room.yaml"
    write_scene(scene, small_room)
    result = CliRunner().invoke(app, ["space", str(scene), "--out", str(tmp_path), "--format", "svg", "--json"])
    assert result.exit_code == 0
    document = json.loads(result.stdout)
    assert (document["arrives"], Path(document["file"]).name) == (True, "room-obj-space.svg")
    assert "the agent alone" in Path(document["file"]).read_text()
    refused = CliRunner().invoke(app, ["space", str(scene), "--out", str(tmp_path), "--object", "none"])
    assert refused.exit_code == 2

"""`manipuzzle tree`."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from converter.formats import read_scene, write_scene
from converter.render_tree import Mark
from converter.scene import Scene
from evaluate.cli import app
from evaluate.commands.tree import tree_of
from planner.problem import Problem
from planner.search import Search
from planner.settings import Settings

PUZZLES = Path(__file__).resolve().parents[2] / "data" / "puzzles"


def test_the_tree_of_a_search(small_room: Scene):
    """Parents come earlier, configurations are those of the search, and the solution is the last, solved node."""
    search = Search(Problem(small_room), Settings(), np.random.default_rng(0))
    search.run()
    nodes = tree_of(search)
    assert search.solution is not None
    assert nodes[-1].mark is Mark.SOLVED
    assert nodes[-1].parent is not None
    assert nodes[nodes[-1].parent].mark is Mark.SOLVED
    assert small_room.goal.contains(nodes[-1].objects[0])
    assert nodes[0].parent is None
    assert all(node.parent < i for i, node in enumerate(nodes) if node.parent is not None)
    assert [node.agent.tolist() for node in nodes[:-1]] == [node.configuration.agent.tolist() for node in search.nodes]


def test_a_search_without_solution_has_no_solved_node():
    """Expanded nodes are unsolved, the others were never expanded."""
    search = Search(Problem(read_scene(PUZZLES / "wall.yaml")), Settings(max_expansions=1), np.random.default_rng(0))
    search.run()
    marks = [node.mark for node in tree_of(search)]
    assert len(marks) > 1
    assert marks == [Mark.UNSOLVED] + [Mark.OPEN] * (len(marks) - 1)


def test_the_document_and_the_picture(tmp_path: Path):
    """The same search as that of solve, as a picture."""
    arguments = ["tree", str(PUZZLES / "corner.yaml"), "--seed", "1", "--out", str(tmp_path), "--json"]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0
    found = json.loads(result.stdout)
    assert (found["scene"], found["status"]) == ("corner", "solved")
    assert 2 <= found["expanded"] <= found["nodes"]
    assert Path(found["file"]) == tmp_path / "corner-Rnd+FPR-1-tree.png"
    assert Path(found["file"]).stat().st_size > 0


def test_what_is_not_solved_is_drawn_and_negative(tmp_path: Path):
    """A time limit that ends the search at once: the tree is its root, the exit status 1."""
    arguments = ["tree", str(PUZZLES / "maze.yaml"), "--time-limit", "1e-9", "--out", str(tmp_path), "--json"]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 1
    found = json.loads(result.stdout)
    assert (found["status"], found["nodes"], found["expanded"]) == ("timeout", 1, 0)
    assert Path(found["file"]).is_file()


def test_only_forward_searches_have_such_trees(tmp_path: Path, small_room: Scene):
    """Other methods are refused with the ones that are allowed."""
    write_scene(tmp_path / "room.yaml", small_room)
    result = CliRunner().invoke(app, ["tree", str(tmp_path / "room.yaml"), "--method", "MBTS", "--out", str(tmp_path)])
    assert result.exit_code == 2
    assert "MBTS is no forward search; Rnd, Btl, Hum are" in result.stderr


@pytest.mark.parametrize("method", ["Btl+FPR", "Hum+R"])
def test_every_generator_draws_a_tree(tmp_path: Path, method: str):
    """The method's name is part of the file's."""
    result = CliRunner().invoke(app, ["tree", str(PUZZLES / "corner.yaml"), "--method", method, "--out", str(tmp_path)])
    assert result.exit_code == 0
    assert (tmp_path / f"corner-{method}-0-tree.png").is_file()


def test_trees_as_vectors(tmp_path: Path):
    """SVG with the caption as text."""
    arguments = ["tree", str(PUZZLES / "cube-free.yaml"), "--format", "svg", "--out", str(tmp_path)]
    assert CliRunner().invoke(app, arguments).exit_code == 0
    assert "configurations, " in (tmp_path / "cube-free-Rnd+FPR-0-tree.svg").read_text()

import logging
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from converter.convert import ConversionSettings, convert_level
from converter.formats import read_scene, write_scene
from converter.scene import Scene
from pcg.errors import InputError
from pcg.level import Level
from pcg.xsb import parse_levels

GOLDEN = Path(__file__).parents[1] / "golden" / "level-to-scene.yaml"
TINY = """
; tiny
#######
#@ #  #
# $ $ #
#  .  #
#######
"""


def convert(text: str, settings: ConversionSettings | None = None) -> Scene:
    """The scene of the only level in a text."""
    (level,) = parse_levels(text, "levels.xsb")
    return convert_level(level, settings)


def test_a_small_level_becomes_the_golden_scene(tmp_path: Path):
    """The whole file of a converted level, character for character."""
    write_scene(tmp_path / "tiny.yaml", convert(TINY))
    assert (tmp_path / "tiny.yaml").read_text() == GOLDEN.read_text()


def test_cells_become_places():
    """Column 0 is left and row 0 is up; the grid is centred at the origin with cells of 0.4 m."""
    scene = convert(TINY)
    np.testing.assert_array_equal(scene.bounds, [[-1.05, -0.65], [1.05, 0.65]])
    np.testing.assert_array_equal(scene.agent.position, [-0.8, 0.4])
    np.testing.assert_array_equal(scene.goal.position, [0, -0.4])
    np.testing.assert_array_equal(scene.goal_object.position, [-0.4, 0, 0.1])
    np.testing.assert_array_equal(scene.object("obj1").position, [0.4, 0, 0.1])
    (block,) = (wall for wall in scene.walls if wall.name.startswith("block_"))
    np.testing.assert_array_equal(block.position, [0, 0.4, 0.2])
    assert block.name == "block_3_3"


def test_default_sizes():
    """Those of the authors' generated scenes: cubes of 0.4 and 0.2 m on the floor, a goal of 0.35 m."""
    scene = convert(TINY)
    assert {wall.bottom_top for wall in scene.walls} == {(0, 0.4)}
    assert scene.walls[-1].parts[0].box_size == (0.4, 0.4)
    for body in scene.objects:
        assert body.bottom_top == (0, 0.2)
        assert body.parts[0].box_size == (0.2, 0.2)
    assert scene.goal.size.tolist() == [0.35, 0.35]
    assert (scene.agent.radius, scene.agent.height, scene.tolerance) == (0.1875, 0.2, 1e-4)
    assert scene.goal_object.color == (0, 0, 1)


def test_ten_by_ten_cells_make_a_floor_of_4_1_metres():
    """The published room."""
    tiles = np.zeros((10, 10), dtype=np.uint8)
    tiles[0, :3] = [2, 3, 4]
    assert convert_level(Level(tiles)).bounds.tolist() == [[-2.05, -2.05], [2.05, 2.05]]


@given(st.integers(1, 9), st.integers(1, 9), st.integers(0, 2**32 - 1), st.sampled_from([0.4, 0.35, 0.5]))
def test_every_wall_cell_becomes_one_block_that_fills_it(rows: int, columns: int, seed: int, cell: float):
    """A point of the room is in a block exactly where its cell is a wall."""
    generator = np.random.default_rng(seed)
    tiles = np.where(generator.random((rows, columns + 3)) < 0.4, 1, 0).astype(np.uint8)
    tiles[0, :3] = [2, 3, 4]
    scene = convert_level(Level(tiles, goal_crate=(0, 1)), ConversionSettings(cell=cell))
    blocks = [wall for wall in scene.walls if wall.name.startswith("block_")]
    assert len(blocks) == (tiles == 1).sum()
    column, row = generator.uniform(0, columns + 3), generator.uniform(0, rows)
    point = np.array([column - (columns + 3) / 2, rows / 2 - row]) * cell
    inside = any((np.abs(point - block.position[:2]) < np.array(block.parts[0].box_size) / 2).all() for block in blocks)
    assert inside == (tiles[int(row), int(column)] == 1)


def test_the_goal_object_is_the_crate_that_the_solver_brings_to_the_target():
    """Here only the right crate can be pushed onto the target; the left one is stuck in a corner."""
    scene = convert("######\n#$   #\n# .$@#\n#    #\n######\n")
    assert scene.source["goal_crate"] == [1, 2]
    assert (scene.source["goal_crate_from"], scene.source["solvable"]) == ("solution", True)
    np.testing.assert_allclose(scene.goal_object.position[:2], [0.2, 0])


def test_a_named_goal_crate_is_kept():
    """What the level says counts, even if another crate would be easier."""
    (level,) = parse_levels(TINY, "levels.xsb")
    scene = convert_level(Level(level.tiles, "tiny", goal_crate=(1, 3)))
    assert (scene.source["goal_crate"], scene.source["goal_crate_from"]) == ([1, 3], "level")
    np.testing.assert_array_equal(scene.goal_object.position, [0.4, 0, 0.1])


def test_an_unsolvable_level_is_converted_with_a_warning(caplog: pytest.LogCaptureFixture):
    """The first crate in reading order becomes the goal-object."""
    with caplog.at_level(logging.WARNING):
        scene = convert("; stuck\n#####\n#$ $#\n#@. #\n#####\n")
    assert "stuck: the level is unsolvable, so the first crate becomes the goal-object" in caplog.text
    assert scene.source["goal_crate"] == [0, 0]
    assert (scene.source["goal_crate_from"], scene.source["solvable"]) == ("first crate", False)


def test_the_goal_is_the_first_target():
    """Of several targets the first in reading order."""
    scene = convert("######\n#@$ .#\n# $. #\n#    #\n######\n")
    np.testing.assert_allclose(scene.goal.position, [0.6, 0.4])


def test_occlusion_is_recorded_twice():
    """By the level's test and by the scene's; a wall between agent and crate hides it in both."""
    text = "########\n#@  #  #\n#   #$ #\n#     .#\n#      #\n########\n"
    assert convert(text).source["occluded"] == {"level": True, "scene": True}
    assert convert(TINY).source["occluded"] == {"level": False, "scene": False}


def test_the_level_is_recorded():
    """As XSB text that gives the level back, so that its push solution is never lost."""
    (level,) = parse_levels(TINY, "levels.xsb")
    (back,) = parse_levels(convert(TINY).source["xsb"], "source")
    np.testing.assert_array_equal(back.tiles, level.tiles)


def test_the_settings_are_recorded():
    """Every size, with the radius that was used."""
    settings = ConversionSettings(preset="published", cell=0.5, object_size=0.3, goal_size=0.2, wall_height=0.6)
    scene = convert(TINY, settings)
    assert scene.source["settings"] == {
        "preset": "published",
        "cell": 0.5,
        "wall_height": 0.6,
        "object_size": 0.3,
        "goal_size": 0.2,
        "agent_radius": 0.2,
        "agent_height": 0.2,
    }
    assert convert(TINY, ConversionSettings(agent_radius=0.15)).agent.radius == 0.15


def test_conversion_is_deterministic_and_survives_its_file(tmp_path: Path):
    """The same level gives the same scene, and the file gives it back."""
    scene = convert(TINY)
    write_scene(tmp_path / "tiny.yaml", scene)
    back = read_scene(tmp_path / "tiny.yaml")
    assert back.geometry_hash == scene.geometry_hash == convert(TINY).geometry_hash
    assert back.source == scene.source


@pytest.mark.parametrize(
    ("tiles", "message"),
    [
        ([[3, 4, 0]], "no player"),
        ([[2, 2, 3, 4]], "2 players"),
        ([[2, 4, 0]], "crates"),
        ([[2, 3, 0]], "no target"),
    ],
)
def test_an_incomplete_level_is_refused(tiles: list[list[int]], message: str):
    """One player, a crate and a target are needed; the message names the level."""
    with pytest.raises(InputError, match=rf"^half: .*{message}"):
        convert_level(Level(np.array(tiles), "half"))


def test_a_level_of_too_many_walls_is_refused():
    """What no scene file may hold is refused before it is built."""
    tiles = np.ones((101, 101), dtype=np.uint8)
    tiles[0, :3] = [2, 3, 4]
    with pytest.raises(InputError, match="more than 10000 walls"):
        convert_level(Level(tiles, goal_crate=(0, 1)))


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"preset": "loose"}, "preset: 'loose' is none of clear, published"),
        ({"cell": 0.0}, "cell: 0.0 m must be between"),
        ({"goal_size": float("nan")}, "goal_size: nan m must be between"),
        ({"agent_radius": -1.0}, "agent_radius: -1.0 m must be between"),
        ({"object_size": 0.5}, "object_size: 0.5 m must fit a cell"),
        ({"cell": 0.01, "object_size": 0.01, "preset": "published"}, "cell: 0.01 m must be more than two edge radii"),
        ({"object_size": 0.04, "preset": "published"}, "object_size: 0.04 m must fit a cell and exceed"),
    ],
)
def test_impossible_settings_are_refused(fields: dict[str, float | str], message: str):
    """The message names the setting, what was found and what is allowed."""
    with pytest.raises(InputError, match=re.escape(message)):
        ConversionSettings(**fields)  # type: ignore[arg-type]  # wrong values on purpose

import logging
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from converter.convert import ConversionSettings, convert_level
from converter.formats import read_scene, write_scene
from converter.preset import PRESETS
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
    np.testing.assert_array_equal(scene.goal_object.position, [0.4, 0, 0.1])
    np.testing.assert_array_equal(scene.object("obj1").position, [-0.4, 0, 0.1])
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
        "object_height": 0.3,
        "goal_size": 0.2,
        "agent_radius": 0.2,
        "agent_height": 0.2,
        "merge_walls": False,
        "size_jitter": 0.0,
        "yaw_jitter": 0.0,
        "seed": 0,
        "goal_crate": None,
        "drop_targets": False,
        "drop_crates": False,
    }
    assert convert(TINY, ConversionSettings(agent_radius=0.15)).agent.radius == 0.15


JITTERED = {
    "clear": ConversionSettings(size_jitter=0.4, yaw_jitter=0.8, seed=3),
    "published": ConversionSettings("published", object_size=0.15, size_jitter=0.4, yaw_jitter=np.pi, seed=3),
}


@pytest.mark.parametrize("preset", JITTERED)
@given(st.integers(3, 6), st.integers(3, 6), st.integers(0, 2**32 - 1))
def test_jittered_objects_stay_clear_of_everything(preset: str, rows: int, columns: int, seed: int):
    """However crowded a level is: every object keeps to the part of its cell that no outer wall covers."""
    settings = JITTERED[preset]
    tiles = np.random.default_rng(seed).choice([0, 1, 3], (rows, columns), p=[0.4, 0.3, 0.3]).astype(np.uint8)
    tiles[1, :3] = [2, 3, 4]
    scene = convert_level(Level(tiles, goal_crate=(1, 1)), settings)
    plain = convert_level(Level(tiles, goal_crate=(1, 1)), replace(settings, size_jitter=0.0, yaw_jitter=0.0))
    room = 0.4 - 2 * PRESETS[preset].outer_wall_overhang
    for body, cube in zip(scene.objects, plain.objects, strict=True):
        reach = np.abs(body.cores[0]).max() + body.parts[0].edge_radius
        assert reach <= room / 2 + 1e-12
        assert np.abs(np.array(body.parts[0].box_size) / settings.object_size - 1).max() <= 0.4 + 1e-12
        assert abs(body.yaw) <= settings.yaw_jitter
        np.testing.assert_array_equal(body.position[:2], cube.position[:2])


def test_every_object_has_its_own_draws():
    """They depend on the seed and the tiles, not on the name, the goal crate, the walls or the other options."""

    def sizes(settings: ConversionSettings, name: str = "tiny") -> dict[tuple[float, ...], tuple[object, float]]:
        (level,) = parse_levels(TINY.replace("tiny", name), "levels.xsb")
        bodies = convert_level(level, settings).objects
        return {tuple(body.position[:2]): (body.parts[0].box_size, body.yaw) for body in bodies}

    settings = JITTERED["clear"]
    found = sizes(settings)
    assert len({yaw for _, yaw in found.values()}) == len({size for size, _ in found.values()}) == 2
    assert found == sizes(settings, "other") == sizes(replace(settings, goal_crate=2, merge_walls=True))
    turned = sizes(replace(settings, size_jitter=0.0))
    assert {place: yaw for place, (_, yaw) in turned.items()} == {place: yaw for place, (_, yaw) in found.items()}
    assert {size for size, _ in turned.values()} == {(0.2, 0.2)}
    assert found != sizes(replace(settings, seed=4))


def test_heights():
    """Objects may be flat or tall; they stand on the floor."""
    scene = convert(TINY, ConversionSettings(object_height=0.5))
    assert {body.bottom_top for body in scene.objects} == {(0.0, 0.5)}
    assert scene.source["settings"]["object_height"] == 0.5


def test_the_goal_crate_may_be_chosen():
    """By its number in reading order, whatever the level says."""
    (level,) = parse_levels(TINY, "levels.xsb")
    scene = convert_level(replace(level, goal_crate=(1, 1)), ConversionSettings(goal_crate=2))
    assert (scene.source["goal_crate"], scene.source["goal_crate_from"]) == ([1, 3], "option")
    np.testing.assert_array_equal(scene.goal_object.position, [0.4, 0, 0.1])
    with pytest.raises(InputError, match=r"^level 'tiny': goal_crate: 3, but the level has only 2$"):
        convert_level(level, ConversionSettings(goal_crate=3))


TWO_GOALS = "; two\n#######\n#@ $. #\n#   $.#\n#     #\n#######\n"


def test_surplus_targets_are_kept_in_the_record_or_dropped():
    """The scene has one goal in both cases."""
    kept, dropped = (convert(TWO_GOALS, ConversionSettings(drop_targets=drop)) for drop in (False, True))
    np.testing.assert_array_equal(kept.goal.position, dropped.goal.position)
    assert "dropped" not in kept.source
    assert (kept.source["goal_crate"], dropped.source["goal_crate"]) == ([0, 2], [0, 2])
    assert dropped.source["dropped"] == {"crates": [], "targets": [[1, 4]]}
    (level,) = parse_levels(dropped.source["xsb"], "source")
    assert level.targets == [(0, 3)]


def test_surplus_crates_are_kept_as_obstacles_or_dropped():
    """Without them the recorded level is that of the scene: one crate, one target."""
    scene = convert(TWO_GOALS, ConversionSettings(drop_crates=True, goal_crate=1))
    assert [body.name for body in scene.objects] == ["obj"]
    assert scene.source["dropped"] == {"crates": [[1, 3]], "targets": [[1, 4]]}
    (level,) = parse_levels(scene.source["xsb"], "source")
    assert (level.crates, level.targets) == ([(0, 2)], [(0, 3)])


def test_solvability_without_the_other_crates():
    """A solvable level stays so; of an unsolvable one nothing is known any more."""
    stuck = "######\n#@$$ #\n#$ . #\n######\n"
    assert convert(stuck).source["solvable"] is False
    assert convert(stuck, ConversionSettings(drop_crates=True)).source["solvable"] is None
    assert convert(TWO_GOALS, ConversionSettings(drop_crates=True)).source["solvable"] is True


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
        ({"object_size": 0.04, "preset": "published"}, "object_size: 0.04 m must fit a cell of 0.4 m and exceed"),
        (
            {"object_size": 0.1, "size_jitter": 0.7, "preset": "published"},
            "object_size: 0.1 m must fit a cell of 0.4 m and exceed",
        ),
        ({"object_height": 0.0}, "object_height: 0.0 m must be between"),
        ({"size_jitter": 1.0}, "size_jitter: 1.0 must be at least 0 and less than 1"),
        ({"yaw_jitter": -0.1}, "yaw_jitter: -0.1 rad must be between 0 and pi"),
        ({"seed": -1}, "seed: -1 must not be negative"),
        ({"goal_crate": 0}, "goal_crate: 0 is not the number of a crate"),
        ({"object_size": 0.3, "yaw_jitter": 1.0}, "object_size: boxes of 0.3 m with this jitter may be 0.424 m wide"),
        (
            {"size_jitter": 0.6, "preset": "published"},
            "may be 0.32 m wide; beside the outer walls of preset published a cell of 0.4 m leaves 0.3 m",
        ),
    ],
)
def test_impossible_settings_are_refused(fields: dict[str, float | str], message: str):
    """The message names the setting, what was found and what is allowed."""
    with pytest.raises(InputError, match=re.escape(message)):
        ConversionSettings(**fields)  # type: ignore[arg-type]  # wrong values on purpose

import json
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from pcg.errors import InputError
from pcg.generate import random_levels
from pcg.level import Level
from pcg.level_set import GeneratedLevel, read_level_set, read_manifest, write_level_set
from pcg.metrics import LevelStatistics
from pcg.solver import solve
from pcg.symmetry import content_hash, symmetries, tiles_hash
from pcg.xsb import write_levels

# Two crates can reach the target; the recorded goal crate is not the one that the solver would choose.
LEVEL = Level(np.array([[3, 0, 2, 0], [0, 0, 0, 0], [0, 3, 4, 0]]), "a", (2, 1))
GENERATED = GeneratedLevel(LEVEL, solve(LEVEL), "m3", 5, "narrow", {"pushes": 8.0}, {"easy": 2}, steps=40)


def test_a_level_set_is_read_back_as_written(tmp_path: Path):
    """Folder and XSB file give the same levels, with names and goal crates."""
    levels = tuple(islice(random_levels(1), 5))
    write_level_set(tmp_path / "set", levels)
    expected = [generated.level for generated in levels]
    assert read_level_set(tmp_path / "set") == expected
    assert read_level_set(tmp_path / "set" / "levels.xsb") == expected
    assert sorted(path.name for path in (tmp_path / "set").iterdir()) == ["levels.xsb", "manifest.jsonl"]


def test_a_manifest_line_by_hand(tmp_path: Path):
    """Every field of the format, in one line of JSON per level."""
    write_level_set(tmp_path, [GENERATED])
    (line,) = (tmp_path / "manifest.jsonl").read_text(encoding="utf-8").splitlines()
    assert json.loads(line) == {
        "format": 1,
        "name": "a",
        "agent": "m3",
        "seed": 5,
        "representation": "narrow",
        "weights_hash": None,
        "control_targets": {"pushes": 8.0},
        "rejected": {"easy": 2},
        "steps": 40,
        "split": None,
        "statistics": {
            "rows": 3,
            "columns": 4,
            "players": 1,
            "crates": 2,
            "targets": 1,
            "walls": 0,
            "regions": 1,
            "wall_density": 0.0,
        },
        "occluded": False,
        "disc_occluded": False,
        "dependency": False,
        "movable_critical": False,
        "solvable": True,
        "solvable_by_any": True,
        "pushes": 1,
        "moves": 5,
        "solution": "ldldR",
        "goal_crate": [2, 1],
        "content_hash": content_hash(LEVEL),
        "tiles_hash": tiles_hash(LEVEL),
    }
    (entry,) = read_manifest(tmp_path / "manifest.jsonl")
    assert entry.statistics == LevelStatistics(3, 4, 1, 2, 1, 0, 1, 0.0)


@pytest.mark.parametrize("change", ["edited", "turned", "renamed"])
def test_changed_levels_lose_their_goal_crate(tmp_path: Path, change: str):
    """A record counts for a level of that name with those very tiles; the cell of another one may be wrong."""
    write_level_set(tmp_path, [GENERATED])
    changed = {
        "edited": Level.of(LEVEL.is_wall, players=[(0, 1)], crates=LEVEL.crates, targets=LEVEL.targets, name="a"),
        "turned": replace(symmetries(LEVEL)[2], goal_crate=None),
        "renamed": replace(LEVEL, name="b", goal_crate=None),
    }[change]
    write_levels(tmp_path / "levels.xsb", [changed])
    assert read_level_set(tmp_path) == [changed]


def test_other_files_beside_a_manifest(tmp_path: Path):
    """The manifest counts for an unchanged level in any XSB file of its folder."""
    write_level_set(tmp_path, [GENERATED])
    other = Level(np.array([[2, 3, 4]]), "other")
    write_levels(tmp_path / "copy.xsb", [other, LEVEL])
    assert read_level_set(tmp_path / "copy.xsb") == [other, LEVEL]


def test_a_manifest_is_not_needed(tmp_path: Path):
    """Without one, levels have no goal crate."""
    write_levels(tmp_path / "levels.xsb", [LEVEL])
    assert read_level_set(tmp_path) == [replace(LEVEL, goal_crate=None)]


def test_a_folder_without_levels_is_refused(tmp_path: Path):
    """The missing file is named."""
    with pytest.raises(InputError, match=r"levels\.xsb: no such file"):
        read_level_set(tmp_path)


def test_unsolved_levels_are_recorded(tmp_path: Path):
    """Unsolvable levels get the first crate as goal crate, null for what is unknown."""
    level = Level(np.array([[3, 0, 2, 3, 1, 4]]), "dead")
    limit = replace(level, name="limit")
    write_level_set(
        tmp_path,
        [
            GeneratedLevel(level, solve(level), "m3", 0),
            GeneratedLevel(limit, solve(Level(np.array([[2, 3, 0, 4]])), max_states=1), "m3", 0),
        ],
    )
    dead, undecided = read_manifest(tmp_path / "manifest.jsonl")
    assert (dead.solvable, dead.pushes, dead.solution, dead.goal_crate) == (False, None, None, (0, 0))
    assert undecided.solvable is None


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"format": 2}, "line 2: format"),
        ({"goal_crate": [0]}, "line 2: goal_crate"),
        ({"goal_crate": [0, 1]}, "level 'a': goal_crate: .*not a crate"),
        ({"goal_crate": [-1, 1]}, "level 'a': goal_crate: .*not a crate"),
        ({"statistics": {}}, "line 2: statistics"),
        ({"color": "red"}, "line 2: color"),
        ({"control_targets": {"pushes": float("nan")}}, "line 2: control_targets.pushes"),
    ],
)
def test_bad_manifests_are_refused(tmp_path: Path, change: dict[str, object], problem: str):
    """The message names file, line, field and reason."""
    write_level_set(tmp_path, [GENERATED])
    manifest = tmp_path / "manifest.jsonl"
    document = json.loads(manifest.read_text(encoding="utf-8")) | change
    manifest.write_text("\n" + json.dumps(document), encoding="utf-8")
    with pytest.raises(InputError, match=rf"manifest\.jsonl: {problem}"):
        read_level_set(tmp_path)


@pytest.mark.parametrize("line", ["{", "[" * 100_000, "1" * 5000, "[]"])
def test_lines_that_are_no_json_objects_are_refused(tmp_path: Path, line: str):
    """Broken, deeply nested, overlong or other JSON is one clear line, too."""
    write_level_set(tmp_path, [GENERATED])
    (tmp_path / "manifest.jsonl").write_text(line, encoding="utf-8")
    with pytest.raises(InputError, match=r"manifest\.jsonl: line 1: "):
        read_level_set(tmp_path)


def test_two_lines_for_one_level_are_refused(tmp_path: Path):
    """Nobody could say which one counts."""
    write_level_set(tmp_path, [GENERATED])
    manifest = tmp_path / "manifest.jsonl"
    manifest.write_text(manifest.read_text(encoding="utf-8") * 2, encoding="utf-8")
    with pytest.raises(InputError, match="line 2: name: a line before names the level 'a' too"):
        read_manifest(manifest)


def test_sets_without_levels_or_names_are_not_written(tmp_path: Path):
    """A manifest finds its levels by name."""
    unnamed = replace(GENERATED, level=replace(LEVEL, name=""))
    for levels in ([], [unnamed]):
        with pytest.raises(ValueError, match="every level a name"):
            write_level_set(tmp_path / "set", levels)
    with pytest.raises(ValueError, match="names must differ"):
        write_level_set(tmp_path / "set", [GENERATED, GENERATED])
    assert not (tmp_path / "set").exists()

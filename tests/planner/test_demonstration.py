"""Demonstrations: their file, what is refused, and those that come with the product."""

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from converter.formats import read_scene
from converter.plan import Subgoal
from pcg.errors import InputError
from planner.demonstration import Demonstration, read_demonstration, require_suitable, write_demonstration
from planner.problem import Problem
from tests.planner.scenes import body, room, wall

DATA = Path(__file__).resolve().parents[2] / "data"
PROBLEM = Problem(room(wall(0, 1, 0.4, 0.4), objects=(body("obj", -1, -1), body("other", 1, -1))))

names = st.text(st.characters(categories=["L", "N", "P", "Zs"]), min_size=1, max_size=20).filter(str.isprintable)
coordinates = st.floats(-1e4, 1e4)


def demonstration(*subgoals: tuple[str, float, float], scene: str = "room") -> Demonstration:
    """A demonstration of some places."""
    return Demonstration(scene, tuple(Subgoal(name, np.array([x, y])) for name, x, y in subgoals))


@given(names, st.lists(st.tuples(names, coordinates, coordinates), min_size=1, max_size=5))
def test_a_file_gives_back_what_was_written(
    tmp_path_factory: pytest.TempPathFactory, scene: str, places: list[tuple[str, float, float]]
):
    """Names, positions and order survive, bit by bit."""
    path = tmp_path_factory.mktemp("demonstrations") / "scene.yaml"
    written = demonstration(*places, scene=scene)
    write_demonstration(path, written)
    read = read_demonstration(path)
    assert read.scene == scene
    assert [(s.object, *s.position) for s in read.subgoals] == places


def test_the_file_is_read_and_edited_by_people(tmp_path: Path):
    """One subgoal a line."""
    write_demonstration(tmp_path / "a.yaml", demonstration(("obj", -1.75, 0.5), ("other", 0.0, 1.0)))
    assert (tmp_path / "a.yaml").read_text() == (
        "format: 1\nscene: room\nsubgoals:\n"
        "- {object: obj, position: [-1.75, 0.5]}\n- {object: other, position: [0.0, 1.0]}\n"
    )


def test_positions_of_each_object_in_order():
    """Each object has its own positions; one that is never moved has none."""
    shown = demonstration(("a", 1, 2), ("b", 3, 4), ("a", 5, 6))
    assert shown.positions("a").tolist() == [[1, 2], [5, 6]]
    assert shown.positions("c").shape == (0, 2)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("scene: a\nsubgoals: []\n", "format: is missing"),
        ("format: 2\nscene: a\nsubgoals: [{object: o, position: [0, 0]}]\n", "format: Input should be 1 (found 2)"),
        ("format: 1\nscene: a\nsubgoals: []\n", "subgoals: Tuple should have at least 1 item"),
        ("format: 1\nscene: a\nsubgoals: [{object: o, position: [0]}]\n", "subgoals[0].position[1]: is missing"),
        ("format: 1\nscene: a\nsubgoals: [{object: o, position: [0, .nan]}]\n", "subgoals[0].position[1]"),
        (
            "format: 1\nscene: a\nsubgoals: [{object: o, position: [0, 0], x: 1}]\n",
            "subgoals[0].x: there is no such field",
        ),
        ("format: 1\nscene: [\n", "line 3: not a YAML file"),
    ],
)
def test_errors_name_file_and_field(tmp_path: Path, text: str, message: str):
    """One line says which file and field, and what is wrong."""
    path = tmp_path / "bad.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match=re.escape(message)) as raised:
        read_demonstration(path)
    assert str(raised.value).startswith(str(path))
    assert "\n" not in str(raised.value)


def test_huge_files_are_refused_unread(tmp_path: Path):
    """A file of more than a megabyte is no demonstration."""
    (tmp_path / "huge.yaml").write_text("#" * 1_000_001)
    with pytest.raises(InputError, match="larger than 1 MB"):
        read_demonstration(tmp_path / "huge.yaml")


def test_what_cannot_be_read_back_is_not_written(tmp_path: Path):
    """A demonstration without subgoals is refused before a file is made."""
    with pytest.raises(InputError, match=r"room: subgoals"):
        write_demonstration(tmp_path / "a.yaml", demonstration())
    assert not (tmp_path / "a.yaml").exists()


@pytest.mark.parametrize(
    ("place", "message"),
    [
        (("box", 0.0, 0.0), r"subgoals\[1\]\.object: found 'box', the scene has obj, other$"),
        (("obj", 0.0, 0.9), r"subgoals\[1\]\.position: at \[0\.0, 0\.9\] 'obj' is in a wall or out of bounds$"),
        (("obj", 0.0, 2.1), r"subgoals\[1\]\.position: .* out of bounds$"),
    ],
)
def test_a_demonstration_has_to_suit_the_scene(place: tuple[str, float, float], message: str):
    """Unknown objects and places in walls are named; a place where another object stands now is fine."""
    with pytest.raises(InputError, match=f"^here: {message}"):
        require_suitable(PROBLEM, demonstration(("obj", 1.0, -1.0), place), "here")


def test_a_demonstration_belongs_to_one_scene():
    """One that was recorded for another scene is refused, even if its places would do."""
    with pytest.raises(InputError, match=r"^here: scene: found 'hall', the scene is 'room'$"):
        require_suitable(PROBLEM, demonstration(("obj", 1.0, -1.0), scene="hall"), "here")


@pytest.mark.parametrize("path", sorted((DATA / "puzzles").glob("*.yaml")), ids=lambda path: path.stem)
def test_every_puzzle_has_a_demonstration_that_suits_it(path: Path):
    """The nine puzzles can be solved by method Hum without recording anything."""
    shown = read_demonstration(DATA / "human" / path.name)
    assert shown.scene == path.stem
    require_suitable(Problem(read_scene(path)), shown, path.stem)

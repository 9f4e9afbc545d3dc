"""Plans: what a segment has to be, measures of plans, and files that read back the same."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from converter.plan import Plan, Segment, Status, Subgoal, plan_document, plan_from_document, read_plan, write_plan
from converter.scene import Scene
from pcg.errors import InputError

coordinates = st.floats(-9, 9, allow_subnormal=False)
places = st.tuples(coordinates, coordinates)
names = st.text(st.characters(categories=["L", "N"]), min_size=1, max_size=8)


@st.composite
def segments(draw: st.DrawFn) -> Segment:
    """Moves and carries of a few way-points."""
    path = np.array(draw(st.lists(places, min_size=1, max_size=4)))
    carried = draw(st.none() | names)
    return Segment("move" if carried is None else "carry", carried, path)


@st.composite
def plans(draw: st.DrawFn) -> Plan:
    """Plans of every status, without their scenes."""
    return Plan(
        scene=draw(names),
        scene_hash=draw(names),
        method=draw(names),
        seed=draw(st.integers(0, 2**32)),
        status=draw(st.sampled_from(Status)),
        time_s=draw(st.floats(0, 1e6)),
        tolerance=draw(st.floats(0, 0.1)),
        settings=draw(st.dictionaries(names, st.none() | st.booleans() | st.integers(0, 9) | names, max_size=3)),
        preset=draw(st.sampled_from([None, "clear", "published"])),
        certificate=draw(st.none() | names),
        counters=draw(st.dictionaries(names, st.integers(0, 10**6), max_size=3)),
        subgoals=tuple(draw(st.lists(st.builds(Subgoal, names, places.map(np.array)), max_size=3))),
        segments=tuple(draw(st.lists(segments(), max_size=3))),
    )


@pytest.mark.parametrize(
    ("mode", "carried", "path", "problem"),
    [
        ("carry", None, [[0.0, 0.0]], "a carry segment needs an object"),
        ("move", "obj", [[0.0, 0.0]], "a move segment has no object"),
        ("move", None, np.empty((0, 2)), "at least one point"),
        ("move", None, [[0.0, 0.0, 0.0]], "n x 2 numbers wanted"),
        ("move", None, [[0.0, np.nan]], "finite"),
    ],
)
def test_segments_that_say_nothing_are_refused(
    mode: Literal["move", "carry"], carried: str | None, path: Any, problem: str
):
    """Mode and object belong together, and a path has points of the plane."""
    with pytest.raises(ValueError, match=problem):
        Segment(mode, carried, np.array(path))


def test_lengths_and_pick_places_are_counted(small_plan: Plan):
    """A 3-4-5 triangle has 12 m however it is cut into segments; every carry is a pick-place."""
    triangle = [[0.0, 0.0], [3.0, 0.0], [3.0, 4.0], [0.0, 0.0]]
    first, second = Segment("move", None, np.array(triangle[:2])), Segment("carry", "obj", np.array(triangle[1:]))
    plan = replace(small_plan, segments=(first, second, second))
    assert [segment.length for segment in plan.segments] == [3.0, 9.0, 9.0]
    assert (plan.path_length, plan.pick_places) == (21.0, 2)
    assert plan_document(plan)["cost"] == {"path_length_m": 21.0, "pick_places": 2}


@given(plans())
def test_documents_read_back_the_same(plan: Plan):
    """Whatever a plan holds, its JSON text gives the same plan; only a solved one has a cost."""
    document = json.loads(json.dumps(plan_document(plan)))
    again = plan_from_document(document, "plan")
    assert plan_document(again) == document
    assert (document["cost"] is None) == (plan.status is not Status.SOLVED)
    assert [s.path.tolist() for s in again.segments] == [s.path.tolist() for s in plan.segments]


def test_files_hold_scenes_and_repeat_themselves(small_room: Scene, small_plan: Plan, tmp_path: Path):
    """Written, read and written again a plan gives the same bytes, with its scene inside."""
    plan = replace(small_plan, scene_data=small_room, scene_hash=small_room.geometry_hash)
    first, second = tmp_path / "a.json", tmp_path / "b.json"
    write_plan(first, plan)
    found = read_plan(first)
    write_plan(second, found)
    assert first.read_bytes() == second.read_bytes()
    assert found.scene_data is not None
    assert found.scene_data.geometry_hash == small_room.geometry_hash


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"scene_hash": "0" * 16}, "scene_data: not the scene that scene_hash names"),
        ({"segments": [{"mode": "move", "path": []}]}, r"segments\[0\]: path needs at least one point"),
        ({"segments": [{"mode": "carry", "path": [[0.0, 0.0]]}]}, r"segments\[0\]: a carry segment needs an object"),
        ({"status": "done"}, "status: "),
        ({"format": 2}, "format: "),
        ({"color": "red"}, "color: "),
    ],
)
def test_what_is_wrong_with_a_document_is_named(
    small_room: Scene, small_plan: Plan, change: dict[str, Any], problem: str
):
    """The message begins with the file and the field."""
    plan = replace(small_plan, scene_data=small_room, scene_hash=small_room.geometry_hash)
    with pytest.raises(InputError, match=f"^plan: {problem}"):
        plan_from_document({**plan_document(plan), **change}, "plan")

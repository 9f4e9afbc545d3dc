import dataclasses
import json
import re
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from converter.formats.scene_yaml import (
    MAX_BYTES,
    from_document,
    read_scene_yaml,
    to_document,
    write_scene_yaml,
)
from converter.scene import Agent, Body, Goal, Scene
from converter.shape import Part
from pcg import yaml_text
from pcg.errors import InputError

BOX = Part.box((0.2, 0.2), 0.02)
SCENE = Scene(
    name="small",
    bounds=np.array([[-1.05, -1.05], [1.05, 1.05]]),
    tolerance=1e-3,
    agent=Agent(np.array([0.1 + 0.2, -0.5]), 0.2),
    walls=(Body("outwall_right", np.array([0.0, -1.0, 0.2]), 0.4, (Part.box((2.1, 0.1), 0.04),)),),
    objects=(Body("obj", np.array([0.0, 0.5, 0.1]), 0.2, (BOX,), color=(0.0, 0.0, 1.0)),),
    goal=Goal("obj", np.array([0.5, 0.5]), np.array([0.35, 0.35])),
    preset="published",
    source={"level": "tiny", "cells": (3, 4)},
)
TEXT = """\
format: 1
name: small
preset: published
bounds:
- [-1.05, -1.05]
- [1.05, 1.05]
tolerance: 0.001
agent: {position: [0.3, -0.5], radius: 0.2, height: 0.2}
walls:
- {name: outwall_right, position: [0.0, -1.0, 0.2], size: [2.1, 0.1, 0.4], edge_radius: 0.04}
objects:
- {name: obj, position: [0.0, 0.5, 0.1], size: [0.2, 0.2, 0.2], edge_radius: 0.02, color: [0.0, 0.0, 1.0]}
goal: {object: obj, position: [0.5, 0.5], size: [0.35, 0.35]}
source:
  level: tiny
  cells: [3, 4]
"""


def written(scene: Scene) -> str:
    """The text that is written for a scene."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.yaml"
        write_scene_yaml(path, scene)
        return path.read_text(encoding="utf-8")


def test_a_scene_is_written_one_body_a_line_with_short_numbers():
    """The text is what a person would write; float noise and default values are left out."""
    assert written(SCENE) == TEXT


@settings(max_examples=40)
@given(st.from_type(Scene))
def test_a_scene_survives_its_file(scene: Scene):
    """Reading what was written gives the same geometry, names and source; writing that gives the same text."""
    text = written(scene)
    back = from_document(yaml_text.parse(text, "scene.yaml"), "scene.yaml")
    assert back.geometry_hash == scene.geometry_hash
    assert (back.name, back.preset, dict(back.source)) == (scene.name, scene.preset, dict(scene.source))
    assert [body.name for body in back.walls] == [body.name for body in scene.walls]
    assert written(back) == text


@settings(max_examples=40)
@given(st.from_type(Scene))
def test_a_document_survives_json(scene: Scene):
    """The same plain values serve plan files, which are JSON."""
    document = json.loads(json.dumps(to_document(scene)))
    assert from_document(document, "plan.json: scene_data").geometry_hash == scene.geometry_hash


@given(st.from_type(Body))
def test_every_number_of_a_file_is_within_picometres(body: Body):
    """Shortening removes float noise only, so plans that touch exactly stay valid."""
    scene = dataclasses.replace(SCENE, walls=(body,))
    (back,) = from_document(to_document(scene), "scene").walls
    for core, original in zip(back.cores, body.cores, strict=True):
        assert np.abs(core - original).max() < 5e-12
    np.testing.assert_allclose(back.position, body.position, rtol=0, atol=1.1e-12)


def test_a_scene_without_a_name_is_called_after_its_file(tmp_path: Path):
    """`name` may be left out, as may walls, source and the agent's height."""
    path = tmp_path / "my-room.yaml"
    path.write_text(
        "format: 1\nbounds: [[-1, -1], [1, 1]]\ntolerance: 1e-3\nagent: {position: [0, 0], radius: 0.2}\n"
        "objects: [{name: obj, position: [0.5, 0, 0.1], size: [0.2, 0.2, 0.2]}]\n"
        "goal: {object: obj, position: [-0.5, 0], size: [0.3, 0.3]}\n"
    )
    scene = read_scene_yaml(path)
    assert (scene.name, scene.tolerance, scene.agent.height, scene.walls) == ("my-room", 1e-3, 0.2, ())


def changed(field: str, value: Any) -> dict[str, Any]:
    """The document of the small scene with another value for `field`, such as `walls.0.size`."""
    document = to_document(SCENE)
    *path, last = [int(key) if key.isdigit() else key for key in field.split(".")]
    place: Any = document
    for key in path:
        place = place[key]
    place[last] = value
    return document


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("format", 2, "format: Input should be 1 (found 2)"),
        ("agent.radius", -0.1, "agent.radius"),
        ("agent.radius", "0.2", "agent.radius"),
        ("agent.radius", True, "agent.radius"),
        ("tolerance", float("nan"), "tolerance"),
        ("agent.position", [0, 0, 0], "agent.position"),
        ("walls.0.position", [1e5, 0, 0.2], "walls[0].position[0]"),
        ("walls.0.size", [2.1, 0, 0.4], "walls[0].size[1]"),
        ("walls.0.size", [2.1, 0.05, 0.4], "walls[0]: outwall_right: size 2.1 x 0.05 is smaller than two edge radii"),
        ("walls.0.colour", [1, 1, 1], "walls[0].colour: there is no such field"),
        ("walls.0.height", 0.4, "walls[0]: polygon and parts need a height; with size it is the third number"),
        ("objects", [], "objects"),
        ("goal.object", "box", "goal.object 'box' is not an object; there are ['obj']"),
        ("objects.0.name", "outwall_right", "names must be unique"),
        ("objects.0.name", "a\nb", "objects[0].name: a name must be printable text"),
        ("bounds", [[1, 1], [-1, -1]], "bounds"),
        ("preset", "loose", "preset"),
    ],
)
def test_a_wrong_field_is_named(field: str, value: Any, message: str):
    """The error is one line that names file, field and what was found."""
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        from_document(changed(field, value), "room.yaml")
    assert str(caught.value).startswith("room.yaml: ")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("data", [None, [], "text", 3, {}])
def test_what_is_no_scene_is_refused(data: Any):
    """Any plain value but a complete mapping is an input error."""
    with pytest.raises(InputError, match=re.escape("room.yaml: ")):
        from_document(data, "room.yaml")


def test_a_huge_file_is_refused_unread(tmp_path: Path):
    """The size is checked before the content."""
    path = tmp_path / "huge.yaml"
    with path.open("wb") as file:
        file.truncate(MAX_BYTES + 1)
    with pytest.raises(InputError, match="larger than 8 MB"):
        read_scene_yaml(path)


def test_a_scene_that_no_file_may_hold_is_not_written(tmp_path: Path):
    """The writer refuses what the reader would refuse, and leaves no file."""
    far = dataclasses.replace(SCENE, agent=Agent(np.array([2e4, 0.0]), 0.2))
    with pytest.raises(InputError, match=re.escape("agent.position[0]")):
        write_scene_yaml(tmp_path / "far.yaml", far)
    assert not list(tmp_path.iterdir())

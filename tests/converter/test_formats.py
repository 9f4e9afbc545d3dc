import re
from pathlib import Path

import numpy as np
import pytest

from converter.formats import read_scene, write_scene
from converter.scene import Agent, Body, Goal, Scene
from converter.shape import Part
from pcg.errors import InputError

SCENE = Scene(
    name="tiny",
    bounds=np.array([[-1.0, -1.0], [1.0, 1.0]]),
    tolerance=0.0,
    agent=Agent(np.zeros(2), 0.2),
    walls=(),
    objects=(Body("obj", np.array([0.5, 0.5, 0.1]), 0.2, (Part.box((0.2, 0.2)),)),),
    goal=Goal("obj", np.zeros(2), np.ones(2)),
)


@pytest.mark.parametrize("name", ["tiny.yaml", "tiny.yml", "TINY.YAML"])
def test_the_suffix_chooses_the_format(tmp_path: Path, name: str):
    """What is written under a name is read under that name."""
    write_scene(tmp_path / name, SCENE)
    assert read_scene(tmp_path / name).geometry_hash == SCENE.geometry_hash


def test_an_unknown_suffix_is_refused_with_those_allowed(tmp_path: Path):
    """Reading and writing list the suffixes that they know."""
    with pytest.raises(InputError, match=re.escape("the suffix must be one of .yaml .yml .g")):
        read_scene(tmp_path / "tiny.json")
    with pytest.raises(InputError, match=re.escape("tiny.txt: scenes are written as .yaml .yml .g .xml")):
        write_scene(tmp_path / "tiny.txt", SCENE)


@pytest.mark.parametrize("name", ["none.yaml", "none.g", "folder.yaml", "folder.g", "bytes.yaml", "bytes.g"])
def test_what_cannot_be_read_is_an_input_error(tmp_path: Path, name: str):
    """Missing files, folders and binary files are refused by name."""
    (tmp_path / f"folder{Path(name).suffix}").mkdir()
    (tmp_path / f"bytes{Path(name).suffix}").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match=re.escape(str(tmp_path / name))):
        read_scene(tmp_path / name)

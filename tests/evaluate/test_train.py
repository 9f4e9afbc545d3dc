from importlib.util import find_spec
from pathlib import Path

import pytest

from evaluate.commands.train import run
from pcg.errors import InputError


def test_unknown_representations_are_refused(tmp_path: Path):
    """The message lists what there is, before anything is written."""
    with pytest.raises(InputError, match="found 'broad', allowed are narrow, turtle, wide, flip"):
        run(representation="broad", out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.skipif(find_spec("torch") is not None, reason="torch is installed")
def test_without_torch_one_line_says_what_to_install(tmp_path: Path):
    """The extra is named, and nothing is written."""
    with pytest.raises(InputError, match=r"torch, stable_baselines3, onnx not installed; .*manipuzzle\[rl\]"):
        run(representation="narrow", out=tmp_path / "out")
    assert not (tmp_path / "out").exists()

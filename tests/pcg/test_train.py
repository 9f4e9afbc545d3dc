"""Training; needs torch (make test-rl)."""

import json
import pickle
from dataclasses import asdict
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pcg.episodes import EpisodeSettings
from pcg.errors import InputError
from pcg.learning_curve import read_curve
from pcg.observation import observation_size
from pcg.policy import load_policy
from pcg.representation import REPRESENTATIONS

pytestmark = pytest.mark.rl


def small(name: str = "narrow", **settings: Any) -> Any:
    """Settings of a training of a few updates."""
    from pcg.train import TrainingSettings  # noqa: PLC0415  # torch may be missing

    return TrainingSettings(
        episode=EpisodeSettings(name, 5, 6), n_envs=4, n_steps=32, batch_size=64, hidden=32, **settings
    )


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_the_exported_policy_is_the_trained_one(name: str, tmp_path: Path):
    """ONNX and torch give the same logits, also for observations that no episode shows."""
    import torch  # noqa: PLC0415  # as above

    from pcg.train import train  # noqa: PLC0415  # as above

    settings = small(name)
    model = train(settings, 256, 0, tmp_path)
    observed = np.random.default_rng(0).normal(size=(7, observation_size(settings.episode))).astype(np.float32)
    with torch.no_grad():
        expected = model.policy.get_distribution(torch.from_numpy(observed)).distribution.logits.numpy()
    found = load_policy(tmp_path / f"{name}.onnx").logits(observed)
    # A distribution's logits are normalised.
    assert found - np.log(np.exp(found).sum(axis=1, keepdims=True)) == pytest.approx(expected, abs=1e-5)


def test_a_run_goes_on_where_it_stopped(tmp_path: Path):
    """Steps, processor time and the curve continue; weights are those of the checkpoint before they learn on."""
    from pcg.train import train  # noqa: PLC0415  # as above

    first = train(small(), 256, 0, tmp_path, checkpoint_steps=128)
    before = {name: value.clone() for name, value in first.policy.state_dict().items()}
    again = train(small(), 256, 0, tmp_path)
    assert all((value == before[name]).all() for name, value in again.policy.state_dict().items())
    onward = train(small(), 512, 0, tmp_path)
    assert onward.num_timesteps == 512
    assert any((value != before[name]).any() for name, value in onward.policy.state_dict().items())
    curve = read_curve(tmp_path / "curve.jsonl")
    assert [row.steps for row in curve] == [128, 256, 384, 512]
    assert all(earlier.cpu_s < later.cpu_s for earlier, later in pairwise(curve))
    assert {path.name for path in tmp_path.iterdir()} == {
        "checkpoint.pt",
        "curve.jsonl",
        "curve.png",
        "narrow.onnx",
        "run.json",
    }


def test_the_seed_decides(tmp_path: Path):
    """Two runs with one seed have the same weights, one with another seed has others."""
    from pcg.train import train  # noqa: PLC0415  # as above

    for folder, seed in (("a", 1), ("b", 1), ("c", 2)):
        train(small(), 256, seed, tmp_path / folder)
    one, same, other = ((tmp_path / folder / "narrow.onnx").read_bytes() for folder in "abc")
    assert one == same
    assert one != other


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_the_command_trains_with_the_committed_settings(name: str):
    """What a run recorded is what `manipuzzle train` uses today; settings that it did not know have their defaults."""
    from pcg.agents import policy_path  # noqa: PLC0415  # as above
    from pcg.train import TrainingSettings  # noqa: PLC0415  # as above

    now = json.loads(json.dumps(asdict(TrainingSettings.of(name))))
    recorded = json.loads(policy_path(name).with_suffix(".run.json").read_text(encoding="utf-8"))["settings"]
    assert {**now, **recorded, "episode": {**now["episode"], **recorded["episode"]}} == now
    assert recorded["episode"].get("takes_back", False) == (name == "flip")


def test_a_run_of_other_settings_is_not_continued(tmp_path: Path):
    """Another seed or another batch size needs another folder."""
    from pcg.train import train  # noqa: PLC0415  # as above

    train(small(), 1, 0, tmp_path)
    for settings, seed in ((small(), 1), (small(learning_rate=1e-3), 0)):
        with pytest.raises(InputError, match="another seed or other settings"):
            train(settings, 1, seed, tmp_path)
    assert json.loads((tmp_path / "run.json").read_text())["settings"]["episode"]["rows"] == 5


class Harmful:
    """Something that writes a file when it is unpickled."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> Any:
        return Path.touch, (self.path,)


def test_a_checkpoint_cannot_run_code(tmp_path: Path):
    """A checkpoint with anything but tensors and numbers is refused before anything in it is called."""
    from pcg.train import train  # noqa: PLC0415  # as above

    train(small(), 1, 0, tmp_path)
    (tmp_path / "checkpoint.pt").write_bytes(pickle.dumps(Harmful(tmp_path / "harm")))
    with pytest.raises(InputError, match="not a checkpoint"):
        train(small(), 500, 0, tmp_path)
    assert not (tmp_path / "harm").exists()


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_the_golden_logits_are_live_ones(name: str):
    """Torch computes the golden logits of the committed weights from the layers of the ONNX file."""
    import onnx  # noqa: PLC0415  # as above
    import torch  # noqa: PLC0415  # as above

    from pcg.agents import policy_path  # noqa: PLC0415  # as above

    golden = json.loads((Path(__file__).parents[1] / "golden" / "policy-logits.json").read_text())[name]
    arrays = {
        a.name: torch.tensor(onnx.numpy_helper.to_array(a)) for a in onnx.load(policy_path(name)).graph.initializer
    }
    size = observation_size(EpisodeSettings(name))
    flowing = torch.from_numpy(np.random.default_rng(0).random((4, size), dtype=np.float32))
    for k in range(3):
        flowing = torch.nn.functional.linear(flowing, arrays[f"weight{k}"], arrays[f"bias{k}"])
        flowing = torch.relu(flowing) if k < 2 else flowing
    assert flowing.numpy() == pytest.approx(np.array(golden["logits"]), abs=1e-4)

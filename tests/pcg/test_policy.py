import json
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from pcg.agents import policy_path
from pcg.errors import InputError
from pcg.examine import examined
from pcg.frozen import OPEN, FrozenTiles
from pcg.level import Tile
from pcg.observation import observation_size
from pcg.policy import Attempt, Policy, load_policy, policy_levels
from pcg.representation import REPRESENTATIONS
from pcg.request import Rejection, Request

GOLDEN = Path(__file__).parents[1] / "golden" / "policy-logits.json"
EASY = Request(pushes=(1, 1000), wall_density=(0.0, 0.5))


def policy(name: str) -> Policy:
    """The policy that comes with the product."""
    return load_policy(policy_path(name))


def attempts(name: str, request: Request, count: int, seed: int = 0) -> list[Attempt]:
    """The first attempts of that policy."""
    return list(islice(policy_levels(policy(name), request, np.random.default_rng(seed), batch=16), count))


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_logits_are_those_of_torch(name: str):
    """The committed weights give the logits that torch computed from the checkpoint that they were exported from."""
    golden = json.loads(GOLDEN.read_text(encoding="utf-8"))[name]
    found = policy(name)
    assert found.weights_hash == golden["weights_hash"]
    observed = np.random.default_rng(0).random((4, observation_size(found.settings)), dtype=np.float32)
    assert found.logits(observed) == pytest.approx(np.array(golden["logits"]), abs=1e-4)


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_a_generator_decides_about_everything(name: str):
    """The same seed gives the same attempts, another seed others."""
    first, again, other = (attempts(name, EASY, 24, seed) for seed in (1, 1, 2))
    assert first == again
    assert first != other


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_attempts_are_what_they_say(name: str):
    """What claims to meet the request does, by a test of its own; budgets are kept; the rest has a reason."""
    request = replace(EASY, pushes=(4, 12), wall_density=(0.08, 0.25))
    settings = policy(name).settings
    made = attempts(name, request, 64)
    assert any(attempt.met for attempt in made)
    for attempt in made:
        assert (attempt.level is None) == (attempt.rejection is not None)
        assert attempt.steps <= settings.max_steps
        assert attempt.changes <= settings.max_changes
        if attempt.level is None:
            assert not attempt.met
            assert attempt.rejection in {Rejection.UNFINISHED, Rejection.UNSOLVABLE}
        else:
            assert isinstance(examined(attempt.level, request), tuple) == attempt.met


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_frozen_tiles_are_kept(name: str):
    """Every level has them where they were asked for."""
    tiles = np.full((10, 10), OPEN)
    tiles[4, 2:8] = Tile.WALL
    tiles[7, 7] = Tile.TARGET
    frozen = FrozenTiles(tiles)
    levels = [attempt.level for attempt in attempts(name, replace(EASY, frozen=frozen), 64) if attempt.level]
    assert levels
    assert all(frozen.kept_by(level) for level in levels)


def test_taking_a_few_does_not_prefer_short_attempts():
    """The first attempts are the same however many are taken."""
    assert attempts("narrow", EASY, 40)[:10] == attempts("narrow", EASY, 10)


@pytest.mark.parametrize(("name", "fewest"), [("narrow", 1), ("flip", 14)])
def test_policies_make_levels_differ(name: str, fewest: int):
    """Goal crates and targets are not always in the same few cells, in long solutions neither."""
    made = attempts(name, replace(EASY, pushes=(fewest, 1000)), 200)
    levels = [attempt.level for attempt in made if attempt.level and attempt.met]
    assert len({level.goal_crate for level in levels}) > 20
    assert len({level.targets[0] for level in levels}) > 20


@pytest.mark.parametrize(
    ("request_", "message"), [(Request(rows=8), "asked for 8 x 10 cells"), (Request(crates=3), "3 crates")]
)
def test_requests_for_other_levels_are_refused(request_: Request, message: str):
    """A policy makes the size and the numbers that it was trained for, and says which."""
    with pytest.raises(InputError, match=message):
        attempts("narrow", request_, 1)


def test_files_that_are_no_policies_are_refused(tmp_path: Path):
    """A missing file, and one that holds something else."""
    with pytest.raises(InputError, match="no such file"):
        load_policy(tmp_path / "missing.onnx")
    path = tmp_path / "text.onnx"
    path.write_bytes(b"no model at all")
    with pytest.raises(InputError, match="not an ONNX model"):
        load_policy(path)


def test_metadata_have_to_fit_to_the_network(tmp_path: Path):
    """A file whose metadata name another size, or are none, is refused; the bytes are changed in place."""
    weights = policy_path("narrow").read_bytes()
    path = tmp_path / "policy.onnx"
    for old, new, message in (
        (b'"columns":10', b'"columns":12', "ask for"),
        (b'"representation":"narrow"', b'"representation":"barrow"', "representation"),
        (b'"columns":10', b'"columns"=10', "not a JSON document"),
        (b'"crates":2,"targets":1', b'"crates":1,"targets":2', "2 targets need as many crates"),
        (b"manipuzzle\x12", b"manipuzzl_\x12", "no policy"),
    ):
        assert old in weights
        path.write_bytes(weights.replace(old, new))
        with pytest.raises(InputError, match=message):
            load_policy(path)

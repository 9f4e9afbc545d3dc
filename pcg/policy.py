"""Trained policies as ONNX files, run by onnxruntime: no torch is needed, and no code is loaded with the weights.

The file's metadata say how to run it: the representation and the size that it was trained for, and what it counts as a
finished level. Actions are sampled from the logits by a NumPy generator (the Gumbel-max trick), so one generator gives
the same levels on the same machine.
"""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Literal, Self

import numpy as np
import onnxruntime
from pydantic import Field, model_validator

from pcg import json_text
from pcg.arrays import Float32Array, IntArray
from pcg.episodes import Episodes, EpisodeSettings
from pcg.errors import InputError
from pcg.files import read_bytes
from pcg.level import Level
from pcg.observation import observation_size, observations
from pcg.request import Rejection, Request
from pcg.reward import RewardSettings
from pcg.statistics_kernel import Column
from pcg.task import request_beginning, require_fitting
from pcg.validation import Document, validated

METADATA_KEY = "manipuzzle"

BATCH = 64
"""Episodes that are run together."""


class PolicyMetadata(Document):
    """What a policy file says about itself, besides its weights.

    Attributes:
        format: Version of the format.
        representation: How the policy edits levels.
        rows: Rows of the maps.
        columns: Columns of the maps.
        crates: Crates of a finished level.
        targets: Targets of a finished level.
        change_share: Budget of changes by cells.
        step_share: Budget of steps by cells.
        takes_back: Whether edits that lead away from what is wanted are taken back.
    """

    format: Literal[1] = 1
    representation: Literal["narrow", "turtle", "wide", "flip"]
    rows: int = Field(ge=1, le=100)
    columns: int = Field(ge=1, le=100)
    crates: int = Field(ge=1, le=100)
    targets: int = Field(ge=1, le=100)
    change_share: float = Field(gt=0, le=100)
    step_share: float = Field(gt=0, le=1000)
    takes_back: bool = False

    @model_validator(mode="after")
    def _possible(self) -> Self:
        self.settings()
        return self

    @classmethod
    def of(cls, settings: EpisodeSettings) -> Self:
        """The metadata of a policy that was trained with these settings."""
        return cls(
            representation=settings.representation,  # type: ignore[arg-type]  # checked by the settings
            rows=settings.rows,
            columns=settings.columns,
            crates=settings.reward.crates,
            targets=settings.reward.targets,
            change_share=settings.change_share,
            step_share=settings.step_share,
            takes_back=settings.takes_back,
        )

    def settings(self) -> EpisodeSettings:
        """The settings of the episodes that the policy is run in."""
        return EpisodeSettings(
            representation=self.representation,
            rows=self.rows,
            columns=self.columns,
            change_share=self.change_share,
            step_share=self.step_share,
            takes_back=self.takes_back,
            reward=RewardSettings(crates=self.crates, targets=self.targets),
        )


@dataclass(frozen=True)
class Policy:
    """A policy that can be run.

    Attributes:
        settings: Of the episodes that it is run in.
        weights_hash: SHA-256 of the file.
        session: The network: (n, observation_size) float32 to (n, n_actions) logits.
    """

    settings: EpisodeSettings
    weights_hash: str
    session: onnxruntime.InferenceSession

    @property
    def representation(self) -> str:
        """How it edits levels."""
        return self.settings.representation

    def logits(self, observed: Float32Array) -> Float32Array:
        """(n, n_actions) unnormalised log-probabilities."""
        (logits,) = self.session.run(None, {self._input: observed})
        return np.asarray(logits, dtype=np.float32)

    def sample(self, observed: Float32Array, rng: np.random.Generator) -> IntArray:
        """(n,) actions drawn by their probabilities."""
        logits = self.logits(observed)
        return np.asarray((logits + rng.gumbel(size=logits.shape)).argmax(axis=1), dtype=np.int64)

    @cached_property
    def _input(self) -> str:
        return str(self.session.get_inputs()[0].name)


def load_policy(path: Path) -> Policy:
    """Reads a policy.

    Raises:
        InputError: the file is missing, is no ONNX model, or is no policy.
    """
    weights = read_bytes(path)
    options = onnxruntime.SessionOptions()
    # One thread: the networks are small, and sums are added up in the same order everywhere.
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 4
    try:
        session = onnxruntime.InferenceSession(weights, options, providers=["CPUExecutionProvider"])
    except Exception as error:  # noqa: BLE001  # onnxruntime has many kinds, none of them documented
        raise InputError(str(path), f"not an ONNX model: {str(error).splitlines()[0]}") from None
    text = session.get_modelmeta().custom_metadata_map.get(METADATA_KEY)
    if text is None:
        raise InputError(str(path), f"an ONNX model, but no policy: it has no metadata {METADATA_KEY!r}")
    document = json_text.parse(text, f"{path}: metadata {METADATA_KEY!r}")
    settings = validated(PolicyMetadata, document, str(path)).settings()
    _require_shapes(session, settings, path)
    return Policy(settings, hashlib.sha256(weights).hexdigest(), session)


def _require_shapes(session: onnxruntime.InferenceSession, settings: EpisodeSettings, path: Path) -> None:
    found = [node.shape[1:] for node in (*session.get_inputs(), *session.get_outputs())]
    expected = [[observation_size(settings)], [settings.n_actions]]
    if found != expected:
        raise InputError(str(path), f"inputs and outputs have shapes {found}, its metadata ask for {expected}")


@dataclass(frozen=True)
class Attempt:
    """How an episode of a policy ended.

    Attributes:
        level: The level, with its goal crate; None if none was finished within the budgets.
        rejection: Why there is no level.
        met: Whether the level is all that was asked for.
        steps: Steps of the environment.
        changes: Tiles changed.
    """

    level: Level | None
    rejection: Rejection | None
    met: bool
    steps: int
    changes: int


def policy_levels(policy: Policy, request: Request, rng: np.random.Generator, batch: int = BATCH) -> Iterator[Attempt]:
    """Runs a policy for ever, one attempt after the other.

    Attempts come in the order in which they began, so that taking the first few does not prefer short ones.

    Args:
        policy: The policy.
        request: What the levels are to be; also of what is frozen.
        rng: Of start maps and actions.
        batch: Episodes that are run together.

    Raises:
        InputError: the policy was trained for another size or other numbers of crates and targets, or a frozen tile is
            a player or crate on a target.
    """
    settings = policy.settings
    require_fitting(request, settings, f"policy {policy.representation}")
    episodes = Episodes(settings, batch)
    number = np.arange(batch)
    started, next_number = batch, 0
    finished: dict[int, Attempt] = {}
    episodes.begin(rng, number, request_beginning(rng, batch, request, settings))
    while True:
        transition = episodes.step(policy.sample(observations(episodes), rng))
        ended = np.flatnonzero(transition.terminated | transition.truncated)
        for index in ended.tolist():
            finished[int(number[index])] = _attempt(episodes, index, bool(transition.terminated[index]))
        if len(ended):
            number[ended] = started + np.arange(len(ended))
            started += len(ended)
            episodes.begin(rng, ended, request_beginning(rng, len(ended), request, settings))
        while next_number in finished:
            yield finished.pop(next_number)
            next_number += 1


def _attempt(episodes: Episodes, index: int, met: bool) -> Attempt:  # noqa: FBT001  # a field of the result
    statistics = episodes.statistics[index]
    level, rejection = None, None
    if episodes.is_valid()[index]:
        row, column = divmod(int(statistics[Column.GOAL]), episodes.settings.columns)
        level = Level(episodes.maps[index], goal_crate=(row, column))
    else:
        wanted = episodes.settings.reward
        counts = statistics[[Column.PLAYERS, Column.CRATES, Column.TARGETS, Column.REGIONS]].tolist()
        furnished = counts == [1, wanted.crates, wanted.targets, 1]
        rejection = Rejection.UNSOLVABLE if furnished else Rejection.UNFINISHED
    return Attempt(level, rejection, met, int(episodes.steps[index]), int(episodes.changes[index]))

"""Training a policy by proximal policy optimisation (Schulman et al. 2017), with Stable-Baselines3.

The only module that imports torch and Stable-Baselines3 (the extra `rl`). A run is a folder:

- `run.json`: its settings and seed;
- `curve.jsonl`: one line an update, `CurveRow`; drawn in `curve.png`;
- `checkpoint.pt`: weights, the optimiser's state and the number of steps, tensors and numbers only. It is read with
  `weights_only`, so a foreign file cannot run code;
- `{representation}.onnx`: the policy, written with every checkpoint.

`train` on a folder with a checkpoint goes on from there; its episodes begin anew, with a generator of their own.

A spent budget ends an episode like success does: no value is bootstrapped from what would have come after it, because
the observation holds what is left of the budgets.
"""

import json
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch
from gymnasium import spaces
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from stable_baselines3.common.vec_env import VecEnv
from torch import nn

from pcg.arrays import BoolArray, Float32Array, FloatArray, IntArray
from pcg.episodes import Episodes, EpisodeSettings
from pcg.errors import InputError
from pcg.export_policy import Layer, write_policy
from pcg.files import read_text, replacing, write_text
from pcg.learning_curve import CurveRow, draw_curves, read_curve
from pcg.observation import observation_size, observations
from pcg.statistics_kernel import Column
from pcg.task_distribution import LONG_SOLUTIONS, TaskDistribution

RUN_FILE, CURVE_FILE, CHECKPOINT_FILE, PICTURE_FILE = "run.json", "curve.jsonl", "checkpoint.pt", "curve.png"


@dataclass(frozen=True)
class TrainingSettings:
    """How a policy is trained; the defaults learned to make levels in a few million steps.

    Attributes:
        episode: Size, budgets, reward.
        tasks: What is asked for.
        n_envs: Episodes that are stepped together.
        n_steps: Steps of each between two updates.
        batch_size: Steps in a gradient.
        n_epochs: Passes over the steps of an update.
        learning_rate: Of Adam.
        entropy: Weight of the entropy bonus.
        gamma: Discount.
        gae_lambda: Of generalised advantage estimation.
        clip: Clip range of the ratio.
        hidden: Units of each layer.
    """

    episode: EpisodeSettings = field(default_factory=EpisodeSettings)
    tasks: TaskDistribution = field(default_factory=TaskDistribution)
    n_envs: int = 64
    n_steps: int = 256
    batch_size: int = 1024
    n_epochs: int = 4
    learning_rate: float = 5e-4
    entropy: float = 0.01
    gamma: float = 0.99
    gae_lambda: float = 0.95
    clip: float = 0.2
    hidden: int = 256

    @classmethod
    def of(cls, representation: str, rows: int = 10, columns: int = 10) -> "TrainingSettings":
        """The settings for a representation.

        Flip begins with levels and learns to lengthen their solutions. What an edit is worth shows at once, since those
        for the worse are taken back: so little is made of what comes later, and a small network of the solution's
        cells will do.
        """
        if representation != "flip":
            return cls(EpisodeSettings(representation, rows, columns))
        return cls(
            EpisodeSettings(representation, rows, columns, step_share=0.6, takes_back=True),
            LONG_SOLUTIONS,
            n_epochs=3,
            entropy=0.005,
            gamma=0.95,
            gae_lambda=0.8,
            hidden=128,
        )


class EpisodeTally:
    """Sums over the episodes that ended since the last `means`."""

    def __init__(self) -> None:
        self._parts: list[FloatArray] = []

    def add(self, episodes: Episodes, ended: IntArray, success: BoolArray, returns: FloatArray) -> None:
        """Counts the episodes with the numbers `ended`."""
        s = episodes.statistics[ended]
        valid = episodes.is_valid()[ended]
        of_level = (s[:, column] * valid for column in (Column.PUSHES, Column.OCCLUDED, Column.DEPENDENCY))
        found = [success[ended], valid, *of_level, returns[ended], episodes.steps[ended]]
        self._parts.append(np.array(found, dtype=np.float64))

    def means(self) -> dict[str, Any]:
        """Means since the last call, by their names in `CurveRow`; those of levels are over solvable ones."""
        if not self._parts:
            return dict.fromkeys(("success", "valid", "pushes", "occluded", "dependency", "gained", "length"), 0.0)
        success, valid, pushes, occluded, dependency, gained, length = np.concatenate(self._parts, axis=1)
        self._parts = []
        n_valid = max(1.0, valid.sum())
        return {
            "episodes": len(success),
            "success": float(success.mean()),
            "valid": float(valid.mean()),
            "pushes": float(pushes.sum() / n_valid),
            "occluded": float(occluded.sum() / n_valid),
            "dependency": float(dependency.sum() / n_valid),
            "gained": float(gained.mean()),
            "length": float(length.mean()),
        }


class EpisodesVecEnv(VecEnv):  # type: ignore[misc]  # torch and its friends are not installed where types are checked
    """`Episodes` as Stable-Baselines3 steps them; an ended one begins again at once."""

    def __init__(self, settings: TrainingSettings, rng: np.random.Generator) -> None:
        self.episodes = Episodes(settings.episode, settings.n_envs)
        self.tally = EpisodeTally()
        self._tasks = settings.tasks
        self._rng = rng
        self._returns = np.zeros(settings.n_envs)
        self._infos: list[dict[str, Any]] = [{} for _ in range(settings.n_envs)]
        self._actions = np.zeros(settings.n_envs, dtype=np.int64)
        observation_space = spaces.Box(-np.inf, np.inf, (observation_size(settings.episode),), np.float32)
        action_space = spaces.Discrete(settings.episode.n_actions)
        self.render_mode = None
        super().__init__(settings.n_envs, observation_space, action_space)

    def reset(self) -> Float32Array:
        """Begins all episodes."""
        self._begin(np.arange(self.num_envs))
        return observations(self.episodes)

    def step_async(self, actions: IntArray) -> None:
        """Takes the actions of the next step."""
        self._actions = actions

    def step_wait(self) -> tuple[Float32Array, Float32Array, BoolArray, list[dict[str, Any]]]:
        """Carries them out."""
        transition = self.episodes.step(self._actions)
        self._returns += transition.reward
        done = transition.terminated | transition.truncated
        ended = np.flatnonzero(done)
        if len(ended):
            self.tally.add(self.episodes, ended, transition.terminated, self._returns)
            self._begin(ended)
        return observations(self.episodes), transition.reward.astype(np.float32), done, self._infos

    def _begin(self, episodes: IntArray) -> None:
        settings = self.episodes.settings
        self._returns[episodes] = 0.0
        self.episodes.begin(self._rng, episodes, self._tasks.beginning(self._rng, len(episodes), settings))

    def close(self) -> None:
        """Nothing is open."""

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """An attribute, once for each episode."""
        return [getattr(self, attr_name)] * len(self._get_indices(indices))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Refused: the episodes share everything."""
        raise NotImplementedError

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list[Any]:
        """Refused: an episode has no methods of its own."""
        raise NotImplementedError

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """Nothing is wrapped."""
        del wrapper_class
        return [False] * len(self._get_indices(indices))


class Trunk(BaseFeaturesExtractor):  # type: ignore[misc]  # as above
    """The layer that policy and value share."""

    def __init__(self, observation_space: spaces.Space[Any], features_dim: int) -> None:
        super().__init__(observation_space, features_dim)
        self.layers = nn.Sequential(nn.Linear(spaces.flatdim(observation_space), features_dim), nn.ReLU())

    def forward(self, observation: torch.Tensor) -> torch.Tensor:
        """(n, features_dim) features."""
        features: torch.Tensor = self.layers(observation)
        return features


def learner(settings: TrainingSettings, env: EpisodesVecEnv, seed: int) -> PPO:
    """The learner with fresh weights."""
    return PPO(
        "MlpPolicy",
        env,
        learning_rate=settings.learning_rate,
        n_steps=settings.n_steps,
        batch_size=settings.batch_size,
        n_epochs=settings.n_epochs,
        gamma=settings.gamma,
        gae_lambda=settings.gae_lambda,
        clip_range=settings.clip,
        ent_coef=settings.entropy,
        policy_kwargs={
            "features_extractor_class": Trunk,
            "features_extractor_kwargs": {"features_dim": settings.hidden},
            "net_arch": {"pi": [settings.hidden], "vf": [settings.hidden]},
            "activation_fn": nn.ReLU,
        },
        seed=seed,
        device="cpu",
    )


def layers_of(model: PPO) -> list[Layer]:
    """The layers that lead from an observation to the logits."""
    weights = model.policy.state_dict()
    names = ("features_extractor.layers.0", "mlp_extractor.policy_net.0", "action_net")
    return [(weights[f"{name}.weight"].numpy(), weights[f"{name}.bias"].numpy()) for name in names]


class _Recorder(BaseCallback):  # type: ignore[misc]  # as above
    """Appends a row to the curve after every rollout and says how far the run is."""

    def __init__(
        self, env: EpisodesVecEnv, curve: Path, before_s: float, progress: Callable[[CurveRow], None] | None
    ) -> None:
        super().__init__()
        self._env, self._curve, self._progress = env, curve, progress
        self._begin_s = time.process_time() - before_s

    def _on_step(self) -> bool:
        return True

    def _on_rollout_end(self) -> None:
        row = CurveRow(steps=self.num_timesteps, cpu_s=time.process_time() - self._begin_s, **self._env.tally.means())
        with self._curve.open("a", encoding="utf-8") as file:
            file.write(row.model_dump_json() + "\n")
        if self._progress is not None:
            self._progress(row)


def train(
    settings: TrainingSettings,
    steps: int,
    seed: int,
    out: Path,
    *,
    checkpoint_steps: int = 500_000,
    progress: Callable[[CurveRow], None] | None = None,
) -> PPO:
    """Trains a policy, or goes on with the run in `out`.

    Args:
        settings: How to train.
        steps: Steps in all, with those of earlier calls; rounded up to whole updates.
        seed: Of weights, episodes and actions.
        out: The run's folder; made if it is missing.
        checkpoint_steps: Steps between two checkpoints.
        progress: Called after every update.

    Returns:
        The learner, with its final weights.

    Raises:
        InputError: `out` cannot be written, or holds a run with other settings or another seed.
    """
    torch.set_num_threads(1)  # the networks are small: more threads cost more than they give
    _claim(out, settings, seed)
    checkpoint = _read_checkpoint(out / CHECKPOINT_FILE)
    done = int(checkpoint["steps"]) if checkpoint else 0
    # Every part of a run has generators of its own, so that it does not repeat the draws of the part before.
    env = EpisodesVecEnv(settings, np.random.default_rng([seed, done]))
    model = learner(settings, env, seed + done)
    if checkpoint:
        model.policy.load_state_dict(checkpoint["policy"])
        model.policy.optimizer.load_state_dict(checkpoint["optimizer"])
        model.num_timesteps = done
    before = [row for row in read_curve(out / CURVE_FILE) if row.steps <= done]
    write_text(out / CURVE_FILE, "".join(row.model_dump_json() + "\n" for row in before))
    recorder = _Recorder(env, out / CURVE_FILE, before[-1].cpu_s if before else 0.0, progress)
    while model.num_timesteps < steps:
        part = min(checkpoint_steps, steps - model.num_timesteps)
        model.learn(part, callback=recorder, reset_num_timesteps=False)
        _write_checkpoint(out, model, settings)
    return model


def _claim(out: Path, settings: TrainingSettings, seed: int) -> None:
    """Writes `run.json`, or compares with the one that is there."""
    text = json.dumps({"format": 1, "seed": seed, "settings": asdict(settings)}, indent=2) + "\n"
    path = out / RUN_FILE
    if path.exists() and read_text(path) != text:
        raise InputError(str(path), "the folder holds a run with another seed or other settings; choose another one")
    write_text(path, text)


def _read_checkpoint(path: Path) -> Mapping[str, Any] | None:
    if not path.exists():
        return None
    try:
        checkpoint: Mapping[str, Any] = torch.load(path, weights_only=True)
    except Exception as error:  # noqa: BLE001  # torch has no type of its own for files that it cannot read
        raise InputError(str(path), f"not a checkpoint: {str(error).splitlines()[0]}") from None
    if not isinstance(checkpoint, dict) or checkpoint.keys() != {"steps", "policy", "optimizer"}:
        raise InputError(str(path), "not a checkpoint: steps, policy and optimizer are needed")
    return checkpoint


def _write_checkpoint(out: Path, model: PPO, settings: TrainingSettings) -> None:
    state = {
        "steps": model.num_timesteps,
        "policy": model.policy.state_dict(),
        "optimizer": model.policy.optimizer.state_dict(),
    }
    with replacing(out / CHECKPOINT_FILE) as temporary:
        torch.save(state, temporary)
    write_policy(out / f"{settings.episode.representation}.onnx", layers_of(model), settings.episode)
    draw_curves(out / PICTURE_FILE, {settings.episode.representation: read_curve(out / CURVE_FILE)})

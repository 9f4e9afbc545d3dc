"""Many Sokoban environments as one: statistics in one compiled call, one cache of verdicts.

`gymnasium.make_vec("Sokoban-narrow-v0", num_envs=256)` makes it, with the arguments of `SokobanEnvironment`. The information
of a step says what that of a single environment says, as one array for all. An episode that ended begins anew in the same
step; as in Gymnasium's own vector environments the information then also holds, for each environment that `_final_obs`
marks, its last observation, `final_obs`, and, marked by `_final_info`, what was said about it, `final_info`.
"""

from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from pcg.arrays import BoolArray, FloatArray, IntArray
from pcg.environment import Observation, action_space, beginning, information, observation_space
from pcg.episodes import Episodes, EpisodeSettings
from pcg.level import TileArray
from pcg.observation import observation_parts
from pcg.request import Request
from pcg.reward import RewardSettings
from pcg.task_distribution import TaskDistribution


class SokobanVectorEnvironment(VectorEnv[Observation, IntArray, npt.NDArray[Any]]):
    """Edits `num_envs` maps; see `SokobanEnvironment` for the arguments.

    Attributes:
        episodes: The state of all environments.
    """

    metadata = {"autoreset_mode": AutoresetMode.SAME_STEP}  # noqa: RUF012  # Gymnasium's own declaration is no ClassVar

    def __init__(
        self,
        representation: str,
        num_envs: int = 1,
        *,
        rows: int = 10,
        columns: int = 10,
        reward: RewardSettings | None = None,
        request: Request | None = None,
        tasks: TaskDistribution | None = None,
        archive: TileArray | None = None,
        **settings: Any,
    ) -> None:
        self.settings = EpisodeSettings(representation, rows, columns, reward=reward or RewardSettings(), **settings)
        self.num_envs = num_envs
        self.single_observation_space = observation_space(self.settings)
        self.single_action_space = action_space(self.settings)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.episodes = Episodes(self.settings, num_envs, archive)
        self._request = request
        self._tasks = tasks or TaskDistribution()
        self._options: dict[str, Any] = {}

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begins all episodes.

        Args:
            seed: One for the whole batch, which has one generator.
            options: `request` and `start`, for all episodes until the next reset.

        Raises:
            ValueError: seeds are given one by one.
            InputError: the request does not fit to the environment.
        """
        if isinstance(seed, list):
            raise ValueError("the batch has one generator and takes one seed")  # noqa: TRY004  # a value, as documented
        super().reset(seed=seed)
        self._options = options or {}
        self._begin(np.arange(self.num_envs))
        return observation_parts(self.episodes), information(self.episodes)

    def step(self, actions: IntArray) -> tuple[Observation, FloatArray, BoolArray, BoolArray, dict[str, Any]]:
        """Carries out one action in each environment."""
        done = self.episodes.step(np.asarray(actions, dtype=np.int64))
        final: dict[str, Any] = {}
        has_ended = done.terminated | done.truncated
        if has_ended.any():
            final = self._final(has_ended)
            self._begin(np.flatnonzero(has_ended))
        said = {**information(self.episodes), **final}
        return observation_parts(self.episodes), done.reward, done.terminated, done.truncated, said

    def _final(self, has_ended: BoolArray) -> dict[str, Any]:
        """What is said about episodes that ended, before they begin anew."""
        observations = np.full(self.num_envs, None, dtype=object)
        numbers = np.flatnonzero(has_ended)
        parts = observation_parts(self.episodes, numbers)
        for k, number in enumerate(numbers):
            observations[number] = {name: part[k] for name, part in parts.items()}
        return {
            "final_obs": observations,
            "_final_obs": has_ended,
            "final_info": information(self.episodes),
            "_final_info": has_ended,
        }

    def _begin(self, numbers: IntArray) -> None:
        request, start = self._options.get("request", self._request), self._options.get("start")
        begun = beginning(self.np_random, len(numbers), self.settings, request, self._tasks, start)
        self.episodes.begin(self.np_random, numbers, begun)

"""Many Sokoban environments as one: statistics in one compiled call, one cache of verdicts.

`gymnasium.make_vec("Sokoban-narrow-v0", num_envs=256)` makes it, with the arguments of `SokobanEnvironment`. An episode
that ended begins anew in the same step; the step's information then holds the numbers of such environments, `ended`, and
their last observations, `final_obs`, in the same order.
"""

from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from pcg.environment import Observation, action_space, beginning, observation_space
from pcg.episodes import Episodes, EpisodeSettings
from pcg.grid import BoolArray
from pcg.level import TileArray
from pcg.observation import observation_parts
from pcg.representation import IntArray
from pcg.request import Request
from pcg.reward import FloatArray, RewardSettings
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
        return observation_parts(self.episodes), {}

    def step(self, actions: IntArray) -> tuple[Observation, FloatArray, BoolArray, BoolArray, dict[str, Any]]:
        """Carries out one action in each environment."""
        done = self.episodes.step(np.asarray(actions, dtype=np.int64))
        information: dict[str, Any] = {}
        ended = np.flatnonzero(done.terminated | done.truncated)
        if len(ended):
            information = {"ended": ended, "final_obs": observation_parts(self.episodes, ended)}
            self._begin(ended)
        return observation_parts(self.episodes), done.reward, done.terminated, done.truncated, information

    def _begin(self, numbers: IntArray) -> None:
        request, start = self._options.get("request", self._request), self._options.get("start")
        begun = beginning(self.np_random, len(numbers), self.settings, request, self._tasks, start)
        self.episodes.begin(self.np_random, numbers, begun)

"""Gymnasium environments: editing a map until it is the level that was asked for.

Importing this module registers `Sokoban-narrow-v0`, `Sokoban-turtle-v0`, `Sokoban-wide-v0` and `Sokoban-flip-v0`:

    import gymnasium
    import pcg.environment

    env = gymnasium.make("Sokoban-narrow-v0", rows=7, columns=9)
    envs = gymnasium.make_vec("Sokoban-wide-v0", num_envs=256)  # one compiled batch: pcg.vector_environment

An observation is a dictionary:

- `map`: (rows, columns) tiles, the first five of `Tile`;
- `frozen`: (rows, columns) flags of the cells that cannot be changed;
- `goal`: (rows, columns) flag of the goal crate, while the map is solved;
- `position`: (2,) row and column of the agent, only in `narrow` and `turtle`;
- `solution`: (rows, columns) the sum of 1 where the optimal solution moves crates and 2 where the player stands to push
  them, only in `flip`;
- `scalars`: what `observation.scalars` says about the map, the budgets and the request.

The information of a step is that of `information`. The actions are those of `pcg.representation`. An episode terminates
when everything that was asked for is met; it is truncated when a budget is spent.
"""

from dataclasses import replace
from typing import Any, Literal

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from pcg.arrays import IntArray
from pcg.episodes import Beginning, Episodes, EpisodeSettings
from pcg.level import Level, TileArray
from pcg.observation import observation_parts
from pcg.representation import N_TILES, REPRESENTATIONS
from pcg.request import Request
from pcg.reward import RewardSettings
from pcg.scalar_kernel import SCALAR_LIMIT, SCALARS
from pcg.statistics_kernel import CRATE_PASSES, PUSHED_FROM, Column
from pcg.task import request_beginning, require_fitting
from pcg.task_distribution import TaskDistribution
from pcg.xsb import format_level

Observation = dict[str, npt.NDArray[Any]]


_COUNTED = tuple(column.name.lower() for column in Column)


def information(episodes: Episodes) -> dict[str, IntArray]:
    """(n,) numbers by name: what is known about the maps, the columns of `Column`, and `steps` and `changes` done."""
    counted = zip(_COUNTED, episodes.statistics[:, : len(Column)].T.astype(np.int64), strict=True)
    return {**dict(counted), "steps": episodes.steps.copy(), "changes": episodes.changes.copy()}


def observation_space(settings: EpisodeSettings) -> "spaces.Dict[Any]":  # before 1.4 no generic class at run time
    """The space of one observation."""
    shape = settings.shape
    parts: dict[str, spaces.Space[Any]] = {
        "map": spaces.Box(0, N_TILES - 1, shape, np.uint8),
        "frozen": spaces.Box(0, 1, shape, np.uint8),
        "goal": spaces.Box(0, 1, shape, np.uint8),
        "scalars": spaces.Box(-SCALAR_LIMIT, SCALAR_LIMIT, (SCALARS,), np.float32),
    }
    if settings.sees_solution:
        parts["solution"] = spaces.Box(0, CRATE_PASSES + PUSHED_FROM, shape, np.uint8)
    if settings.has_position:
        parts["position"] = spaces.MultiDiscrete(list(shape))
    return spaces.Dict(parts)


def action_space(settings: EpisodeSettings) -> spaces.Discrete:
    """The space of one action."""
    return spaces.Discrete(settings.n_actions)


def beginning(
    rng: np.random.Generator,
    n: int,
    settings: EpisodeSettings,
    request: Request | None,
    tasks: TaskDistribution,
    start: TileArray | None = None,
) -> Beginning:
    """The beginning of n episodes: of the request, or of tasks that are drawn if there is none.

    Args:
        rng: Of all random choices.
        n: Number of episodes.
        settings: Of the episodes.
        request: What is asked for.
        tasks: What is asked for without a request.
        start: (rows, columns) tiles of the start map in place of random ones; frozen tiles go before.
    """
    if request is None:
        begun = tasks.beginning(rng, n, settings)
    else:
        require_fitting(request, settings, "request")
        begun = request_beginning(rng, n, request, settings)
    if start is None:
        return begun
    if start.shape != settings.shape or not np.isin(start, range(N_TILES)).all():
        raise ValueError(f"start must hold {settings.rows} x {settings.columns} tiles from 0 to {N_TILES - 1}")
    return replace(begun, maps=np.where(begun.frozen, begun.maps, start).astype(np.uint8))


class SokobanEnvironment(gymnasium.Env[Any, np.int64]):
    """Edits one map.

    Args:
        representation: narrow, turtle, wide or flip.
        rows: Rows of the map.
        columns: Columns of the map.
        reward: What is wanted, and what it is worth; None for the defaults.
        request: What every episode asks for; without it each draws a task of its own.
        tasks: What is drawn from; None for the defaults.
        archive: (m, rows, columns) maps that novelty is measured against.
        render_mode: `ansi` (XSB text) or None.
        **settings: Further fields of `EpisodeSettings`, such as `change_share` and `step_share`.

    Attributes:
        episodes: The state: a batch of one.
    """

    metadata = {"render_modes": ["ansi"], "render_fps": 4}  # noqa: RUF012  # Gymnasium's own declaration is no ClassVar

    def __init__(
        self,
        representation: str,
        *,
        rows: int = 10,
        columns: int = 10,
        reward: RewardSettings | None = None,
        request: Request | None = None,
        tasks: TaskDistribution | None = None,
        archive: TileArray | None = None,
        render_mode: Literal["ansi"] | None = None,
        **settings: Any,
    ) -> None:
        self.settings = EpisodeSettings(representation, rows, columns, reward=reward or RewardSettings(), **settings)
        self.observation_space = observation_space(self.settings)
        self.action_space = action_space(self.settings)
        self.render_mode = render_mode
        self._request = request
        self._tasks = tasks or TaskDistribution()
        self.episodes = Episodes(self.settings, 1, archive)

    @property
    def max_changes(self) -> int:
        """Tiles that may be changed in an episode."""
        return self.settings.max_changes

    @property
    def max_steps(self) -> int:
        """Steps of an episode."""
        return self.settings.max_steps

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begins an episode.

        Args:
            seed: Of this and all later random draws.
            options: `request` (a `Request`, also of what is frozen) and `start` (tiles of the start map), both for this
                episode only.

        Raises:
            InputError: the request does not fit to the environment.
        """
        super().reset(seed=seed)
        options = options or {}
        rng = self.np_random
        request = options.get("request", self._request)
        begun = beginning(rng, 1, self.settings, request, self._tasks, options.get("start"))
        self.episodes.begin(rng, np.array([0]), begun)
        return self._observation(), self._info()

    def step(self, action: np.int64) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Carries out an action."""
        done = self.episodes.step(np.array([action], dtype=np.int64))
        reward, terminated, truncated = float(done.reward[0]), bool(done.terminated[0]), bool(done.truncated[0])
        return self._observation(), reward, terminated, truncated, self._info()

    def render(self) -> str | None:
        """The map as XSB text."""
        return format_level(self.level()) if self.render_mode == "ansi" else None

    def level(self) -> Level:
        """The map, with its goal crate if it is solved."""
        goal = int(self.episodes.statistics[0, Column.GOAL])
        crate = divmod(goal, self.settings.columns)
        return Level(self.episodes.maps[0], goal_crate=None if goal < 0 else crate)

    def _observation(self) -> Observation:
        return {name: part[0] for name, part in observation_parts(self.episodes).items()}

    def _info(self) -> dict[str, Any]:
        # As `information`, without arrays of one number, which take a fifth of the time of a step.
        episodes = self.episodes
        counted = zip(_COUNTED, episodes.statistics[0, : len(Column)].tolist(), strict=True)
        return {**dict(counted), "steps": int(episodes.steps[0]), "changes": int(episodes.changes[0])}


for _name in REPRESENTATIONS:
    gymnasium.register(
        f"Sokoban-{_name}-v0",
        entry_point="pcg.environment:SokobanEnvironment",
        vector_entry_point="pcg.vector_environment:SokobanVectorEnvironment",
        kwargs={"representation": _name},
    )

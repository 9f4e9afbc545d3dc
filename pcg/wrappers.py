"""Other views of the observations of `pcg.environment`.

`CroppedObservation` and `OneHotObservation` can be combined, in this order; budgets and episodes stay as they are.
"""

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.utils import RecordConstructorArgs

from pcg.arrays import Float32Array
from pcg.environment import Observation, SokobanEnvironment
from pcg.episodes import EpisodeSettings
from pcg.observation import flat_observations, observation_size
from pcg.representation import N_TILES
from pcg.scalar_kernel import SCALAR_LIMIT

OUTSIDE = N_TILES
"""Tile of a cropped map where there is no cell."""

Wrapped = gymnasium.Env[Any, np.int64]


def _settings_of(env: Wrapped) -> EpisodeSettings:
    if not isinstance(env.unwrapped, SokobanEnvironment):
        raise TypeError(f"{env.unwrapped} is no SokobanEnvironment")
    return env.unwrapped.settings


class CroppedObservation(gymnasium.ObservationWrapper[Any, np.int64, Any], RecordConstructorArgs):
    """Shows a square of the map around the position; what is outside of the map is `OUTSIDE`, and frozen.

    Args:
        env: narrow or turtle; the others have no position.
        size: Side of the square, an odd number.
    """

    def __init__(self, env: Wrapped, size: int) -> None:
        RecordConstructorArgs.__init__(self, size=size)
        gymnasium.ObservationWrapper.__init__(self, env)
        parts = env.observation_space
        if not isinstance(parts, spaces.Dict) or "position" not in parts.spaces:
            raise ValueError("only observations with a position can be cropped; wide and flip have none")
        if parts["map"].shape != _settings_of(env).shape:
            raise ValueError("only whole maps of tiles can be cropped; crop first, then make flags of tiles")
        if size < 1 or size % 2 == 0:
            raise ValueError(f"size must be an odd number, found {size}")
        self._margin: int = size // 2
        highest = {"map": OUTSIDE, "frozen": 1, "goal": 1}
        cropped = {name: spaces.Box(0, high, (size, size), np.uint8) for name, high in highest.items()}
        self.observation_space = spaces.Dict({**parts.spaces, **cropped})

    def observation(self, observation: Observation) -> Observation:
        """The observation with square parts."""
        outside = {"map": OUTSIDE, "frozen": 1, "goal": 0}
        return {**observation, **{name: self._crop(observation, name, value) for name, value in outside.items()}}

    def _crop(self, observation: Observation, name: str, outside: int) -> np.ndarray[Any, Any]:
        row, column = observation["position"]
        side = 2 * self._margin + 1
        return np.pad(observation[name], self._margin, constant_values=outside)[
            row : row + side, column : column + side
        ]


class OneHotObservation(gymnasium.ObservationWrapper[Any, np.int64, Any], RecordConstructorArgs):
    """Shows the map as flags: (rows, columns, tiles), the last tile of a cropped map being `OUTSIDE`."""

    def __init__(self, env: Wrapped) -> None:
        RecordConstructorArgs.__init__(self)
        gymnasium.ObservationWrapper.__init__(self, env)
        parts = env.observation_space
        if not isinstance(parts, spaces.Dict) or not isinstance(parts["map"], spaces.Box):
            raise TypeError("observations need a map of tiles")
        self._tiles: np.ndarray[Any, Any] = np.arange(int(parts["map"].high.max()) + 1)
        flags = spaces.Box(0, 1, (*parts["map"].shape, len(self._tiles)), np.uint8)
        self.observation_space = spaces.Dict({**parts.spaces, "map": flags})

    def observation(self, observation: Observation) -> Observation:
        """The observation with flags in place of tiles."""
        return {**observation, "map": (observation["map"][..., None] == self._tiles).astype(np.uint8)}


class FlatObservation(gymnasium.ObservationWrapper[Any, np.int64, Any], RecordConstructorArgs):
    """Shows the one vector that the policies in `data/policies` are trained on; see `pcg.observation`."""

    def __init__(self, env: Wrapped) -> None:
        RecordConstructorArgs.__init__(self)
        gymnasium.ObservationWrapper.__init__(self, env)
        self._settings: EpisodeSettings = _settings_of(env)
        if env.observation_space != env.unwrapped.observation_space:
            raise ValueError("only the environment's own observations can be flattened, no cropped or one-hot ones")
        self.observation_space = spaces.Box(
            -SCALAR_LIMIT, SCALAR_LIMIT, (observation_size(self._settings),), np.float32
        )

    def observation(self, observation: Observation) -> Float32Array:
        """The observation as a vector."""
        batch_of_one = {name: part[None] for name, part in observation.items()}
        vector: Float32Array = flat_observations(batch_of_one, self._settings)[0]
        return vector

"""Human subgoals: fixed positions per object that a person demonstrated (`Hum` of [L], section IV-B)."""

from pathlib import Path

import numpy as np

from converter.scene import Scene
from converter.shape import FloatArray
from pcg.data_folder import data_folder
from pcg.errors import InputError
from planner.demonstration import read_demonstration, require_suitable
from planner.problem import Configuration, Problem
from planner.settings import Settings

FOLDER = "human"
"""Where `data` holds the demonstrations: one file a scene, called after it."""


def demonstration_path(scene: Scene, settings: Settings) -> Path:
    """Where the demonstration for a scene has to be."""
    folder = data_folder() / FOLDER if settings.demonstrations is None else Path(settings.demonstrations)
    return folder / f"{scene.name}.yaml"


class HumanSubgoals:
    """Demonstrated positions, the same in every configuration, of which as many as wanted are drawn.

    Raises:
        InputError: there is no demonstration for the scene, or it does not suit the scene.
    """

    def __init__(self, problem: Problem, settings: Settings) -> None:
        scene = problem.scene
        path = demonstration_path(scene, settings)
        if not path.is_file():
            raise InputError(scene.name, f"method Hum needs a demonstration; there is no file {path}")
        demonstration = read_demonstration(path)
        require_suitable(problem, demonstration, str(path))
        self._positions = [demonstration.positions(name) for name in scene.object_names]
        self.time_s = 0.0

    def candidates(self, configuration: Configuration, index: int, n: int, rng: np.random.Generator) -> FloatArray:
        """At most `n` of the positions (k, 2) [m] demonstrated for object `index`."""
        del configuration
        return rng.permutation(self._positions[index])[:n]

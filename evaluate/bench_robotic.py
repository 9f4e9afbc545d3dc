"""The authors' engine as a peer of the performance table: the RRT of the package `robotic`, where it is installed.

It reads the scene as the `.g` file that we write. Its margin is the scene's tolerance, its other parameters are its own,
but for the limit of iterations. What it prepares once for a scene does not count.
"""

import tempfile
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from converter.formats.rai_g_export import write_rai_g
from converter.scene import Scene
from converter.shape import FloatArray

NAME = "robotic"


def is_installed() -> bool:
    """Whether the package is there; it is no dependency."""
    return find_spec(NAME) is not None


def robotic_rrt(
    scene: Scene, goal: tuple[float, float], iterations: int, queries: int
) -> Callable[[int], FloatArray | None]:
    """The engine's RRT from the agent's start to `goal` [m], world, for a seed: the path (n, 2) [m] or None.

    It can be asked `queries` times, since each takes a finder of its own, which are set up beforehand.
    """
    import robotic  # noqa: PLC0415  # rarely installed

    configuration = robotic.Config()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.g"
        write_rai_g(path, scene)
        configuration.addFile(str(path))
    # Joints count from where the agent starts.
    start = scene.agent.position
    finders = []
    for _ in range(queries):
        finder = robotic.RRT_PathFinder()
        finder.setOptions(verbose=0, maxIters=iterations, collisionTolerance=scene.tolerance)
        finder.setProblem(configuration)
        finder.setStartGoal(np.zeros(2), np.array(goal) - start)
        finders.append(finder)

    def query(seed: int) -> FloatArray | None:
        robotic.rnd_seed(seed + 1)  # 0 would repeat 1
        found = finders.pop().solve(0)
        return np.asarray(found.x) + start if found.feasible else None

    return query

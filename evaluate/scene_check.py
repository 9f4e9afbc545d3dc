"""The physics preview with the planner's paths: where to drive in a scene, and what becomes of it."""

from collections.abc import Iterator

import numpy as np

from converter.plan import Plan
from converter.polyline import path_length
from converter.preview.checks import Problem as Fault
from converter.preview.checks import ProblemKind, check_scene
from converter.preview.driving import drive
from converter.preview.playback import play_back
from converter.preview.report import Approach, Push, SceneReport
from converter.scene import Body, Scene
from converter.shape import FloatArray
from evaluate.passage import goal_grid
from pcg.errors import InputError
from planner.contact_curve import ContactCurve
from planner.problem import Problem
from planner.push import touching_point
from planner.visibility import ShortestPathTree

GOAL = "goal"

GRASPS = 32
"""Points around an object to which the shortest ways are compared; every free stretch of its outline has one."""

_GOAL_GRID = 9

DIRECTIONS = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
"""In which objects are pushed."""


def check(
    scene: Scene, plan: Plan | None = None, *, drives: bool = True, push_distance: float | None = None
) -> SceneReport:
    """Everything that the preview can tell about a scene.

    Args:
        scene: The scene.
        plan: A plan to be played back.
        drives: Whether to drive to every object and into the goal.
        push_distance: How far [m] to drive against every object from four sides; None for not at all.

    Raises:
        InputError: the plan carries an object that the scene does not have.
    """
    static = check_scene(scene)
    if not static.valid:
        return SceneReport(scene.name, static.problems)
    try:
        surveyor = _Surveyor(scene) if drives or push_distance is not None else None
    except InputError as error:
        # The planner is exact where the engine has a slack.
        return SceneReport(scene.name, (Fault(ProblemKind.OVERLAP, (), None, str(error)),))
    return SceneReport(
        scene=scene.name,
        problems=(),
        approaches=tuple(surveyor.approaches()) if surveyor and drives else (),
        pushes=tuple(surveyor.pushes(push_distance)) if surveyor and push_distance is not None else (),
        playback=None if plan is None else play_back(scene, plan),
    )


class _Surveyor:
    """Finds the ways from the start of a scene, and drives along them."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.problem = Problem(scene)
        self.tree = ShortestPathTree(self.problem.agent_space(self.problem.initial), scene.agent.position)

    def approaches(self) -> Iterator[Approach]:
        for index, body in enumerate(self.scene.objects):
            yield self._approach(body.name, self._shortest(self._grasps(index, body)))
        yield self._approach(GOAL, self._shortest(self._goal_centre_first()))

    def pushes(self, distance: float) -> Iterator[Push]:
        for body in self.scene.objects:
            for direction in DIRECTIONS:
                towards = np.array(direction)
                start = body.position[:2] + touching_point(self.scene.agent, body, towards)
                way = self.tree.path_to(start)
                path = None if way is None else np.vstack([way, start + distance * towards])
                yield Push(body.name, direction, path, None if path is None else drive(self.scene, path))

    def _approach(self, target: str, path: FloatArray | None) -> Approach:
        return Approach(target, path, None if path is None else drive(self.scene, path))

    def _grasps(self, index: int, body: Body) -> FloatArray:
        """Places (n, 2) [m] of the agent that touch the object and can be reached."""
        curve = ContactCurve(body, self.scene.agent.radius)
        obstacles = self.problem.grasp_obstacles(self.problem.initial, index)
        # Which of the grasps are compared does not depend on anything but the scene.
        grasps = body.position[:2] + curve.sample_free(GRASPS, obstacles, np.random.default_rng(0))
        return grasps[self.tree.reaches(grasps)] if len(grasps) else grasps

    def _goal_centre_first(self) -> FloatArray:
        """The place (1, 2) [m] in the goal nearest to its centre that the agent can reach, on a grid; or none."""
        places = goal_grid(self.scene, _GOAL_GRID)
        return places[self.tree.reaches(places)][:1]

    def _shortest(self, places: FloatArray) -> FloatArray | None:
        paths = [path for path in map(self.tree.path_to, places) if path is not None]
        return min(paths, key=path_length, default=None)

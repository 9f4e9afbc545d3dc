"""Pick-and-place subproblems as published: switch configurations by a nonlinear program, motions by RRT-Connect.

The setting `motion` puts another motion planner in the place of RRT-Connect.
"""

from collections import Counter
from collections.abc import Callable, Iterator

import numpy as np

from converter.shape import FloatArray
from planner.configuration_space import ConfigurationSpace, contact_border
from planner.contact_curve import ContactCurve
from planner.kernel import BoolArray
from planner.motion import motion_planner
from planner.nlp import SwitchQuery
from planner.pick_place import PickPlace, Region
from planner.problem import Configuration, Problem
from planner.settings import Settings
from planner.shortcut import shortcut


class SampledPickPlace:
    """Subproblems of one configuration."""

    def __init__(
        self,
        problem: Problem,
        curves: list[ContactCurve],
        configuration: Configuration,
        settings: Settings,
        rng: np.random.Generator,
        counters: Counter[str],
        should_stop: Callable[[], bool],
    ) -> None:
        self._problem = problem
        self._curves = curves
        self._configuration = configuration
        self._settings = settings
        self._rng = rng
        self._counters = counters
        self._should_stop = should_stop
        self._plan_motion = motion_planner(settings.motion)
        self._agent_space = problem.agent_space(configuration)

    def reachable(self, index: int) -> bool:
        """Whether RRT-Connect finds its way to a grasp of object `index` within its budget."""
        reachable = self._path_to_grasp(index) is not None
        self._counters["reachable" if reachable else "unreachable"] += 1
        return reachable

    def placeable(self, index: int, subgoals: FloatArray) -> BoolArray:
        """All of `subgoals` (n, 2): whether a carry leads there is left to `pick_place`."""
        del index
        return np.ones(len(subgoals), dtype=bool)

    def contacts(self, index: int) -> FloatArray:
        """None: carries are sampled."""
        del index
        return np.empty((0, 2))

    def pick_place(self, index: int, region: Region) -> PickPlace | None:
        """Optimises switch configurations from several starts and seeks the motions between the first ones."""
        self._counters["subproblems_tried"] += 1
        start = self._configuration.objects[index]
        switches = self._switch_configurations(index, region)
        for _, (grasp, placement) in zip(range(self._settings.motion_attempts), switches, strict=False):
            offset = grasp - start
            carry_space = self._problem.carry_space(self._configuration, index, offset)
            carry = self._motion(carry_space, grasp, (placement + offset)[None])
            approach = (
                None if carry is None else self._motion(self._agent_space, self._configuration.agent, grasp[None])
            )
            if carry is not None and approach is not None:
                self._counters["subproblems_solved"] += 1
                return PickPlace(index, approach, carry, placement)
        return None

    def regrasp(self, index: int) -> PickPlace | None:
        """Drives to some grasp of object `index` and leaves the object where it is."""
        approach = self._path_to_grasp(index)
        return (
            None if approach is None else PickPlace(index, approach, approach[-1:], self._configuration.objects[index])
        )

    def _path_to_grasp(self, index: int) -> FloatArray | None:
        grasps = self._configuration.objects[index] + self._free_grasps(index)
        return self._motion(self._agent_space, self._configuration.agent, grasps, self._settings.reach_iterations)

    def _switch_configurations(self, index: int, region: Region) -> Iterator[tuple[FloatArray, FloatArray]]:
        """Grasp and placement (2,) [m] of each solution that the exact tests confirm."""
        start = self._configuration.objects[index]
        scene = self._problem.scene
        agent_space = self._problem.agent_space(self._configuration, held=index)
        object_space = self._problem.object_space(self._configuration, index)
        query = SwitchQuery(
            position=start,
            parts=contact_border(scene.agent.radius, scene.objects[index]),
            agent_obstacles=agent_space.obstacles,
            object_obstacles=object_space.obstacles,
            lower=region.lower,
            upper=region.upper,
        )
        for offset in self._free_grasps(index):
            if self._should_stop():
                return
            self._counters["nlp_calls"] += 1
            placement = self._rng.uniform(region.lower, region.upper)
            for grasp, placed in query.solve([np.concatenate([start + offset, placement])]):
                at_ends = np.array([grasp, grasp + placed - start])
                if agent_space.points_free(at_ends).all() and object_space.point_free(placed):
                    yield grasp, placed

    def _free_grasps(self, index: int) -> FloatArray:
        obstacles = self._problem.grasp_obstacles(self._configuration, index)
        return self._curves[index].sample_free(self._settings.grasp_starts, obstacles, self._rng)

    def _motion(
        self, space: ConfigurationSpace, start: FloatArray, goals: FloatArray, iterations: int | None = None
    ) -> FloatArray | None:
        self._counters["rrt_calls"] += 1
        budget = self._settings.motion_iterations if iterations is None else iterations
        result = self._plan_motion(space, start, goals, budget, self._rng, self._should_stop)
        self._counters["rrt_iterations"] += result.iterations
        if result.path is None:
            return None
        return shortcut(result.path, space, self._settings.shortcut_rounds, self._rng)

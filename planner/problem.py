"""A scene prepared for planning: configurations and the configuration spaces that belong to them.

Minkowski sums depend on shapes only, so each pair of shapes is summed once; a configuration's obstacles are the cached
sums moved to where its objects are.
"""

import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Self

import numpy as np

from converter.plan import TOUCH_SLACK
from converter.scene import Body, Scene
from converter.shape import FloatArray, frozen_array
from pcg.errors import InputError
from planner.configuration_space import (
    ConfigurationSpace,
    ObstacleSet,
    agent_obstacles,
    body_obstacles,
    contact_border,
    sight_obstacles,
)
from planner.kernel import points_free

MAX_PAIRS = 500_000
"""Pairs of an object and another body; preparing for so many takes about ten seconds."""


@dataclass(frozen=True, eq=False)
class Configuration:
    """Where the agent and all objects are.

    Attributes:
        agent: (2,) [m], world.
        objects: (n_objects, 2) [m], world, in the order of the scene.
    """

    agent: FloatArray
    objects: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "agent", frozen_array(self.agent, (2,)))
        object.__setattr__(self, "objects", frozen_array(self.objects, (None, 2)))

    def with_object(self, index: int, position: FloatArray) -> Self:
        """The configuration with one object elsewhere."""
        objects = self.objects.copy()
        objects[index] = position
        return replace(self, objects=objects)


class Problem:
    """A scene with its configuration-space obstacles; objects are addressed by index.

    Attributes:
        scene: The scene.
        n_objects: Number of movable objects.
        goal_index: The goal-object.
        initial: Where everything is at the start.
        agent_walls: Obstacles that the walls are to the agent.
        agent_objects: What each object is to the agent, relative to its own position.
        object_walls: Obstacles that the walls are to each object.
        object_objects: What object k is to object i at [i][k], relative to the position of k.
        sight_objects: How each object blocks lines of sight, relative to its own position.

    Raises:
        InputError: bodies overlap at the start, one is out of bounds, or there are too many of them.
    """

    def __init__(self, scene: Scene) -> None:
        _require_tractable(scene)
        self.scene = scene
        self.n_objects = len(scene.objects)
        self.goal_index = scene.object_names.index(scene.goal.object)
        self.initial = Configuration(scene.agent.position, np.array([body.position[:2] for body in scene.objects]))
        tolerance, objects = scene.tolerance, scene.objects
        for_agent = once_a_shape(partial(agent_obstacles, scene.agent, tolerance=tolerance))
        for_objects = [once_a_shape(partial(body_obstacles, moving, tolerance=tolerance)) for moving in objects]
        for_sight = once_a_shape(partial(sight_obstacles, tolerance=tolerance))
        _require_valid_start(scene, for_agent, for_objects)
        self.agent_walls = _fixed(scene.walls, for_agent)
        self.agent_objects = [for_agent(body) for body in objects]
        self.object_walls = [_fixed(scene.walls, for_object) for for_object in for_objects]
        self.object_objects = [[for_object(body) for body in objects] for for_object in for_objects]
        self._sight_walls = _fixed(scene.walls, for_sight)
        self.sight_objects = [for_sight(body) for body in objects]

    def starting_at(self, configuration: Configuration) -> Self:
        """The same problem from another configuration on, one that can be reached."""
        other = copy.copy(self)
        other.initial = configuration
        return other

    def at_goal(self, configuration: Configuration) -> bool:
        """Whether the goal-object's centre lies in the goal."""
        return self.scene.goal.contains(configuration.objects[self.goal_index])

    @property
    def goal_in_bounds(self) -> bool:
        """Whether any point of the goal lies where centres have to stay."""
        goal, (lower, upper) = self.scene.goal, self.scene.bounds
        nearest = np.clip(goal.position, lower, upper)
        return goal.contains(nearest)

    def touches(self, configuration: Configuration, index: int) -> bool:
        """Whether agent and object `index` are near enough for a grasp; whether they overlap is a matter of motion."""
        body, scene = self.scene.objects[index], self.scene
        near = contact_border(scene.agent.radius + scene.tolerance + TOUCH_SLACK, body)
        offset = configuration.agent - configuration.objects[index]
        return not points_free(offset[None], *near.arrays)[0]

    def distance_to_goal(self, configuration: Configuration) -> float:
        """How far the goal-object's centre is from the goal [m], as the crow flies."""
        return self.scene.goal.distance(configuration.objects[self.goal_index])

    def agent_space(self, configuration: Configuration, held: int | None = None) -> ConfigurationSpace:
        """Where the agent's centre may be; a `held` object is no obstacle."""
        return self._space(self.agent_walls, self.agent_objects, configuration, held)

    def grasp_obstacles(self, configuration: Configuration, index: int) -> ObstacleSet:
        """Obstacles of the agent's centre relative to that of object `index`, which is none itself."""
        return self.agent_space(configuration, held=index).obstacles.moved(-configuration.objects[index])

    def object_space(self, configuration: Configuration, index: int) -> ConfigurationSpace:
        """Where the centre of object `index` may be; the agent is no obstacle."""
        return self._space(self.object_walls[index], self.object_objects[index], configuration, index)

    def wall_space(self, index: int) -> ConfigurationSpace:
        """Where the centre of object `index` might be if it were the only object."""
        return ConfigurationSpace(self.object_walls[index], self.scene.bounds)

    def carry_space(self, configuration: Configuration, index: int, grasp: FloatArray) -> ConfigurationSpace:
        """Where the agent's centre may be while it holds object `index` with its own centre at `grasp` from its."""
        return self.carry_spaces(configuration, index)(grasp)

    def carry_spaces(self, configuration: Configuration, index: int) -> Callable[[FloatArray], ConfigurationSpace]:
        """`carry_space` as a function of the grasp; what does not depend on it is put together once."""
        agent, carried = self.agent_space(configuration, held=index), self.object_space(configuration, index)

        def at(grasp: FloatArray) -> ConfigurationSpace:
            lower = np.maximum(agent.bounds[0], carried.bounds[0] + grasp)
            upper = np.minimum(agent.bounds[1], carried.bounds[1] + grasp)
            return ConfigurationSpace(agent.obstacles.joined(carried.obstacles, grasp), np.array([lower, upper]))

        return at

    def sight_blockers(self, configuration: Configuration, *ignored: int) -> ObstacleSet:
        """Walls and all objects but the `ignored` ones, as they block lines of sight."""
        others = [
            blocker.moved(configuration.objects[k]) for k, blocker in enumerate(self.sight_objects) if k not in ignored
        ]
        return ObstacleSet.union([self._sight_walls, *others])

    def _space(
        self, obstacles: ObstacleSet, relative: list[ObstacleSet], configuration: Configuration, ignored: int | None
    ) -> ConfigurationSpace:
        """The space among fixed `obstacles` and the objects, which are `relative` to their positions."""
        for k in range(self.n_objects):
            if k != ignored:
                obstacles = obstacles.joined(relative[k], configuration.objects[k])
        return ConfigurationSpace(obstacles, self.scene.bounds)


RelativeObstacles = Callable[[Body], ObstacleSet]
"""The obstacles that a body is to some moving body, relative to the position of the former."""


def once_a_shape(obstacles: RelativeObstacles) -> RelativeObstacles:
    """The same function, which computes bodies that differ in their places only once."""
    known: dict[tuple[object, ...], ObstacleSet] = {}

    def remembered(body: Body) -> ObstacleSet:
        radii = (part.edge_radius for part in body.parts)
        shape = (body.bottom_top, *radii, *(core.tobytes() for core in body.cores))
        if shape not in known:
            known[shape] = obstacles(body)
        return known[shape]

    return remembered


def _fixed(walls: Sequence[Body], obstacles: RelativeObstacles) -> ObstacleSet:
    return ObstacleSet.union([obstacles(wall).moved(wall.position[:2]) for wall in walls]).with_free_corners()


def _require_tractable(scene: Scene) -> None:
    pairs = len(scene.objects) * (len(scene.objects) + len(scene.walls))
    if pairs > MAX_PAIRS:
        problem = f"{pairs} pairs of an object and another body are too many to plan with; at most {MAX_PAIRS} will do"
        raise InputError(scene.name, problem)


def _require_valid_start(scene: Scene, for_agent: RelativeObstacles, for_objects: Sequence[RelativeObstacles]) -> None:
    movers = [
        ("agent", scene.agent.position, for_agent, [*scene.walls, *scene.objects]),
        *(
            (f"object {body.name!r}", body.position[:2], for_object, [*scene.walls, *scene.objects[:i]])
            for i, (body, for_object) in enumerate(zip(scene.objects, for_objects, strict=True))
        ),
    ]
    for name, position, obstacles, others in movers:
        if (position < scene.bounds[0]).any() or (position > scene.bounds[1]).any():
            raise InputError(scene.name, f"{name} is out of bounds at {position.tolist()}")
        for other in others:
            space = ConfigurationSpace(obstacles(other).moved(other.position[:2]), scene.bounds)
            if not space.point_free(position):
                raise InputError(
                    scene.name,
                    f"{name} overlaps {other.name!r} at the start by more than the tolerance of {scene.tolerance:g} m",
                )

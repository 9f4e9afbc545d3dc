"""How hard a scene is: statistics of its geometry, and of a plan for it.

What walls and lines of sight allow is exact, and so is the number of objects that must move, up to the grid that
stands for the goal. The fewest pick-places are hard to prove, so those of the best plan that a counted search finds
stand for them: an upper bound, the same in every run.
"""

import itertools
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from converter.occlusion import occluded
from converter.plan import Plan
from converter.scene import OUTER_WALL_PREFIX, Body, Scene
from evaluate.passage import goal_grid, narrowest_passage, touching
from planner import settings_for, solve
from planner.configuration_space import ConfigurationSpace, ObstacleSet
from planner.contact_curve import ContactCurve
from planner.problem import Problem
from planner.visibility import ShortestPathTree

MAX_SUBSETS = 5000
"""Sets of objects that are tried when it is asked which must move."""

SEARCH = settings_for("fast", method="Rnd+FPR", time_limit=600.0, improve=600.0, max_expansions=300, improve_rounds=4)
"""The counted search for a plan with few pick-places; the time limits are guards that it does not reach."""

_AGENT = re.compile(r"([A-Za-z]+[0-9]*)-[0-9]")


@dataclass(frozen=True)
class SceneStatistics:
    """How hard a scene is.

    Attributes:
        objects: Movable objects.
        walls: Walls inside the room, without the outer ones.
        wall_density: Their area by that of the room; what overlaps counts twice.
        occluded: Whether a wall or another object hides the goal-object from the agent at the start.
        narrowest_passage_m: Width of the narrowest passage between walls on the widest way of the agent [m].
        must_move: The least number of objects, the goal-object included, that every plan moves; None if even moving
            all of them helps nothing.
        pick_places: Pick-places of the best plan that a counted search finds; None if it finds none.
        monotone: Whether that plan moves every object at most once; None without one.
    """

    objects: int
    walls: int
    wall_density: float
    occluded: bool
    narrowest_passage_m: float
    must_move: int | None
    pick_places: int | None
    monotone: bool | None


def statistics_of(scene: Scene) -> SceneStatistics:
    """The statistics of a scene; a fraction of a second for most.

    Raises:
        InputError: bodies overlap at the start.
    """
    plan = solve(scene, SEARCH, np.random.default_rng(0)).to_plan(scene, SEARCH, 0)
    geometry = geometry_statistics_of(scene)
    return replace(geometry, pick_places=plan.pick_places, monotone=is_monotone(plan)) if plan.solved else geometry


def geometry_statistics_of(scene: Scene) -> SceneStatistics:
    """The statistics that need no plan; `pick_places` and `monotone` are None.

    Raises:
        InputError: bodies overlap at the start.
    """
    inner = [wall for wall in scene.walls if not wall.name.startswith(OUTER_WALL_PREFIX)]
    return SceneStatistics(
        objects=len(scene.objects),
        walls=len(inner),
        wall_density=sum(map(_area, inner)) / float(np.ptp(scene.bounds, axis=0).prod()),
        occluded=occluded(scene),
        narrowest_passage_m=narrowest_passage(scene),
        must_move=must_move(scene),
        pick_places=None,
        monotone=None,
    )


def generator_of(scene_name: str) -> str | None:
    """The agent that generated the level of a scene, by the scene's name: `m3` for `m3-17`; None for other names."""
    match = _AGENT.match(scene_name)
    return match[1] if match else None


def is_monotone(plan: Plan) -> bool:
    """Whether a plan moves every object at most once."""
    return carries_once(segment.object for segment in plan.segments)


def carries_once(objects: Iterable[str | None]) -> bool:
    """Whether no object is carried twice; one for each segment, None where the agent moves alone."""
    carried = [name for name in objects if name is not None]
    return len(carried) == len(set(carried))


def must_move(scene: Scene) -> int | None:
    """The least number of objects that every plan moves.

    Objects that stay are walls. Whatever the plan, the goal-object must then fit through from its place to the goal
    even if nobody had to hold it, and the agent must get to where it touches the goal-object. The least set of other
    objects that must be left out for both is the answer, besides the goal-object itself.

    Returns:
        0 if the goal-object is in the goal already; None if no set suffices. With so many objects that `MAX_SUBSETS`
        sets do not decide, the number of which all smaller ones are refuted.

    Raises:
        InputError: bodies overlap at the start.
    """
    problem = Problem(scene)
    if problem.at_goal(problem.initial):
        return 0
    others = [i for i in range(problem.n_objects) if i != problem.goal_index]
    subsets = (moved for size in range(len(others) + 1) for moved in itertools.combinations(others, size))
    size = 0
    for moved in itertools.islice(subsets, MAX_SUBSETS):
        size = len(moved)
        if _suffices(problem, [i for i in others if i not in moved]):
            return 1 + size
    return None if size == len(others) else 1 + size


def _suffices(problem: Problem, fixed: list[int]) -> bool:
    """Whether goal-object and agent, each alone, get where they must while the objects `fixed` are walls."""
    goal, positions = problem.goal_index, problem.initial.objects
    object_fixed = [problem.object_objects[goal][i].moved(positions[i]) for i in fixed]
    object_space = _space(problem, [problem.object_walls[goal], *object_fixed])
    if not ShortestPathTree(object_space, positions[goal]).reaches(goal_grid(problem.scene)).any():
        return False
    agent_space = _space(problem, [problem.agent_walls, *(problem.agent_objects[i].moved(positions[i]) for i in fixed)])
    curve = ContactCurve(problem.scene.goal_object, problem.scene.agent.radius)
    places = touching(curve, agent_space.obstacles, positions[goal][np.newaxis])
    return bool(ShortestPathTree(agent_space, problem.initial.agent).reaches(places).any())


def _space(problem: Problem, obstacles: list[ObstacleSet]) -> ConfigurationSpace:
    return ConfigurationSpace(ObstacleSet.union(obstacles), problem.scene.bounds)


def _area(body: Body) -> float:
    """Area of a footprint [m^2]: of a core, of the strip along its edges, and of the discs' sectors at its corners."""
    total = 0.0
    for core, part in zip(body.cores, body.parts, strict=True):
        following = np.roll(core, -1, axis=0)
        inside = abs(float((core[:, 0] * following[:, 1] - core[:, 1] * following[:, 0]).sum())) / 2
        perimeter = float(np.hypot(*(following - core).T).sum())
        total += inside + perimeter * part.edge_radius + np.pi * part.edge_radius**2
    return total

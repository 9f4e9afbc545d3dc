"""Proofs that a scene has no plan, from necessary conditions that are exact and cheap.

Every plan touches some object first, some time the goal-object where it stands at the start, and at the end the
goal-object in the goal. Each can be asked of fewer obstacles than there are: of the walls, and of what cannot have
moved yet. To touch something the agent has to get onto the closed curve around it on which its distance is the largest
that counts as touching. The free stretches of this curve are exact, and one point of a stretch stands for all of it.

The visibility graph that leads there goes around rounded corners on tangents and so may miss slivers of free space. A
proof must err on the other side: its obstacles are smaller by as much as tangents stand off.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property, partial

import numpy as np

from converter.plan import TOUCH_SLACK, Status
from converter.scene import NUMERIC_SLACK, Body, Scene
from converter.shape import FloatArray, Part
from planner.configuration_space import ARC_EXCESS, ConfigurationSpace, ObstacleSet, agent_obstacles
from planner.contact_curve import ContactCurve
from planner.minkowski import minkowski_sum
from planner.problem import Problem, once_a_shape
from planner.result import PlanResult
from planner.visibility import ShortestPathTree

PATIENCE = 150
"""How often a search may ask whether to stop before a proof is looked for: some 0.1 s, counted so that a seed fixes the
result."""

_FAR = 100.0
"""Further [m] than any object reaches over the bounds."""

_SLACK = 2 * TOUCH_SLACK
"""More than the gap [m], beyond the tolerance, that the verification lets pass as touching."""


def proof_of_infeasibility(problem: Problem) -> str | None:
    """What shows that no plan leads from the initial configuration to the goal; None if nothing tried here does.

    That a proof is missing does not mean that there is a plan.
    """
    scene, places = problem.scene, problem.initial.objects
    objects, goal = scene.objects, scene.goal
    goal_object = objects[problem.goal_index]
    if not problem.goal_in_bounds:
        return "the goal is out of bounds"
    among_all = _Surroundings(problem, [*scene.walls, *(body.at(xy) for body, xy in zip(objects, places, strict=True))])
    among_walls = _Surroundings(problem, scene.walls)
    if not any(among_all.agent_touches(body, xy) for body, xy in zip(objects, places, strict=True)):
        return "the agent can touch no object"
    if not among_walls.agent_touches(goal_object, places[problem.goal_index]):
        return f"walls keep the agent from touching {goal.object!r}"
    if not among_walls.agent_touches(_swept(goal_object, goal.size), goal.position):
        return f"walls keep the agent from touching {goal.object!r} anywhere in the goal"
    return None


def with_proof(
    solve: Callable[[Callable[[], bool]], PlanResult],
    scene: Scene,
    should_stop: Callable[[], bool],
    *,
    ends_search: bool = True,
) -> PlanResult:
    """The result of `solve`; `infeasible` if it finds no plan and a proof says that there is none.

    Args:
        solve: Searches until what it is given says stop.
        scene: The puzzle.
        should_stop: What it would be given otherwise.
        ends_search: Whether the search is told to stop once there is a proof. A method that accepts plans which no
            verification passes would otherwise accept one or not, depending on how fast it is.
    """
    proof = _Proof(scene)

    def stops() -> bool:
        return should_stop() or (ends_search and proof.is_due() and proof.text is not None)

    result = solve(stops)
    if result.status is Status.SOLVED or proof.text is None:
        return result
    return replace(result, status=Status.INFEASIBLE, certificate=proof.text)


class _Proof:
    """A proof that is looked for once the search has taken some time: most need much less than the proof."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._asked = 0

    def is_due(self) -> bool:
        self._asked += 1
        return self._asked > PATIENCE

    @cached_property
    def text(self) -> str | None:
        return proof_of_infeasibility(Problem(self._scene))


class _Surroundings:
    """Where the agent can get among some bodies that stand still."""

    def __init__(self, problem: Problem, bodies: Sequence[Body]) -> None:
        scene = problem.scene
        self._start = problem.initial.agent
        self._bounds = scene.bounds
        self._reach = scene.agent.radius + scene.tolerance + _SLACK
        exact = once_a_shape(partial(agent_obstacles, scene.agent, tolerance=scene.tolerance))
        self._bodies = [(body, exact(body)) for body in bodies]
        edge_radius = max((part.edge_radius for body in bodies for part in body.parts), default=0.0)
        excess = ARC_EXCESS * (scene.agent.radius + edge_radius)
        smaller = once_a_shape(partial(agent_obstacles, scene.agent, tolerance=scene.tolerance + excess))
        obstacles = [smaller(body).moved(body.position[:2]) for body in bodies]
        space = ConfigurationSpace(ObstacleSet.union(obstacles).with_free_corners(), scene.bounds)
        self._tree = ShortestPathTree(space, self._start)

    def agent_touches(self, body: Body, place: FloatArray) -> bool:
        """Whether the agent may get to where it touches `body` with this at `place` (2,) [m]; True if in doubt.

        If `body` stands there as one of the bodies, it is none to the agent on the curve around it.
        """
        curve = ContactCurve(body, self._reach)
        if curve.encloses(self._start - place):
            return True
        others = [obstacles.moved(b.position[:2] - place) for b, obstacles in self._bodies if b.name != body.name]
        stretches = curve.free_stretches(ObstacleSet.union([*others, _beyond(self._bounds).moved(-place)]))
        return bool(self._tree.reaches(place + curve.at(stretches.mean(axis=1))).any())


def _beyond(bounds: FloatArray) -> ObstacleSet:
    """What is out of bounds, as four obstacles: a stretch of a curve must not leave the bounds and come back."""
    (x0, y0), (x1, y1) = bounds
    far = _FAR + np.abs(bounds).max()
    sides = [(-far, -far, x0, far), (x1, -far, far, far), (-far, -far, far, y0), (-far, y1, far, far)]
    boxes = [np.array([(ax, ay), (bx, ay), (bx, by), (ax, by)]) for ax, ay, bx, by in sides]
    return ObstacleSet.of(boxes, [-NUMERIC_SLACK] * len(boxes))


def _swept(body: Body, size: FloatArray) -> Body:
    """All that `body` covers while its centre moves through a rectangle of this size (2,) around it."""
    rectangle = Part.box(size).core
    parts = (
        Part(minkowski_sum(rectangle, core), part.edge_radius)
        for core, part in zip(body.cores, body.parts, strict=True)
    )
    return Body(body.name, body.position, body.height, tuple(parts))

"""The geometric half of a logic-geometric program: three nonlinear programs of increasing cost for one skeleton.

Toussaint and Lopes, Multi-bound tree search for logic-geometric programming in cooperative manipulation domains, ICRA
2017; the trajectory problem is a k-order Markov optimisation (Toussaint, arXiv 1407.0414).

A skeleton of K actions has K switches, at which an object is grasped or released, and K phases that end with them. A
configuration is described by the agent's position x alone: what it holds keeps its offset, so an object picked at x_i
and placed at x_j moves from p to p + x_j - x_i, and every other position follows from these sums. The bounds are:

- *pose*: the configuration of the last switch alone. Objects that were grasped or placed before are wherever that
  suits; collisions are costs.
- *sequence*: the configurations of all switches, x_1 ... x_K.
- *path*: n configurations a phase, K n in all; every n-th one is a switch.

Each demands less than the next one: the switches of a path satisfy the sequence, and the last of them the pose.

    touch at a pick          min over parts of s(x - p) - rho  =  TOUCH_GAP
    placement                p in the goal or on the floor
    no collision             s_k - rho_k >= MARGIN  for agent and held object against all that they do not touch
    limits                   x within the bounds of the scene

The cost is a sum of squares: accelerations and small terms for velocities and for staying near the start.

A program's graph depends on the skeleton and on the numbers of polygons and vertices; positions and shapes are
parameters. Building is apart from solving (`planner.lgp_solver`).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum

import casadi as ca

from planner.lgp_constraints import (
    MARGIN,
    TOUCH_GAP,
    accelerations,
    clearances,
    homing,
    inside,
    touch_gap,
    velocities,
)
from planner.lgp_scene import LgpStructure, SceneSymbols
from planner.lgp_weights import Weights
from planner.logic import Action, Skeleton, Surface


class Bound(StrEnum):
    """The relaxations of a skeleton, cheapest first."""

    POSE = "pose"
    SEQUENCE = "sequence"
    PATH = "path"


@dataclass(frozen=True, eq=False)
class Program:
    """One bound of one skeleton, symbolically.

    Attributes:
        x: Variables: agent positions [m], two rows each; in the pose followed by the free object positions.
        p: Parameters, as `planner.lgp_scene.pack` makes them.
        residuals: Their sum of squares is the cost.
        equalities: Scaled; 0 where satisfied.
        inequalities: Scaled; >= 0 where satisfied.
    """

    x: ca.MX
    p: ca.MX
    residuals: ca.MX
    equalities: ca.MX
    inequalities: ca.MX


@dataclass(frozen=True, eq=False)
class _Slice:
    """One configuration in time.

    Attributes:
        agent: (2,) position.
        objects: (2,) position of each object.
        movers: Objects whose own collisions count, such as the one that is held.
        attached: The object that the agent holds or is about to; it may touch it.
        switch: The action that takes place, if any.
    """

    agent: ca.MX
    objects: tuple[ca.MX, ...]
    movers: tuple[int, ...]
    attached: int | None
    switch: Action | None


def moved_before(skeleton: Skeleton) -> tuple[int, ...]:
    """The objects that the actions before the last one have grasped or placed, in order."""
    return tuple(sorted({action.index for action in skeleton[:-1]}))


def pose_program(structure: LgpStructure, moved: Sequence[int], action: Action, weights: Weights) -> Program:
    """The bound that looks at the last switch only.

    Args:
        structure: Of the scene.
        moved: Objects that earlier actions may have brought anywhere; among them that of a placement.
        action: The last action.
        weights: Factors and scales.
    """
    scene = SceneSymbols(structure)
    x = ca.MX.sym("x", 2 * (1 + len(moved)))
    objects = list(scene.objects)
    for k, index in enumerate(moved):
        objects[index] = x[2 * (k + 1) : 2 * (k + 2)]
    last = _Slice(x[:2], tuple(objects), tuple(moved), action.index, action)
    from_start = ca.vertcat(homing(x[:2], scene.start), *(homing(objects[k], scene.objects[k]) for k in moved))
    depths = ca.fmax(0, MARGIN - _collision_clearances(scene, [last]))
    costs = [weights.switch * from_start, weights.homing * from_start, weights.collision * depths]
    return _program(x, scene, [last], weights, costs, [])


def sequence_program(structure: LgpStructure, skeleton: Skeleton, weights: Weights) -> Program:
    """The bound that looks at all switches."""
    scene = SceneSymbols(structure)
    x = ca.MX.sym("x", 2 * len(skeleton))
    switches = ca.reshape(x, 2, len(skeleton))
    slices = list(_slices(scene, skeleton, switches, 1))
    costs = [weights.switch * velocities(switches, scene.start), weights.homing * homing(switches, scene.start)]
    return _program(x, scene, slices, weights, costs, [_collision_clearances(scene, slices) - MARGIN])


def path_program(structure: LgpStructure, skeleton: Skeleton, weights: Weights, phase_steps: int) -> Program:
    """The bound that looks at `phase_steps` configurations a phase."""
    scene = SceneSymbols(structure)
    n = len(skeleton) * phase_steps
    x = ca.MX.sym("x", 2 * n)
    path = ca.reshape(x, 2, n)
    slices = list(_slices(scene, skeleton, path, phase_steps))
    costs = [
        weights.acceleration * accelerations(path, scene.start),
        weights.velocity * velocities(path, scene.start),
        weights.homing * homing(path, scene.start),
    ]
    return _program(x, scene, slices, weights, costs, [_collision_clearances(scene, slices) - MARGIN])


def _slices(scene: SceneSymbols, skeleton: Skeleton, path: ca.MX, phase_steps: int) -> Iterator[_Slice]:
    """The configurations along `path` (2, K * phase_steps); objects rest or move with the agent."""
    objects, held, grasp = list(scene.objects), None, scene.start
    for k, action in enumerate(skeleton):
        for step in range(k * phase_steps, (k + 1) * phase_steps):
            agent = path[:, step]
            if held is not None:
                objects[held] = agent - grasp
            switch = action if step == (k + 1) * phase_steps - 1 else None
            attached = held if switch is None else action.index
            yield _Slice(agent, tuple(objects), () if held is None else (held,), attached, switch)
        held = action.index if action.is_pick else None
        grasp = path[:, (k + 1) * phase_steps - 1] - objects[action.index]


def _collision_clearances(scene: SceneSymbols, slices: Sequence[_Slice]) -> ca.MX:
    """Clearances of agent and movers in all `slices`, one block after the other."""
    n = len(scene.objects)
    found = [clearances(ca.horzcat(*(s.agent for s in slices)), *scene.agent_walls)]
    for k in range(n):
        apart = [s.agent - s.objects[k] for s in slices if s.attached != k]
        found.append(clearances(ca.horzcat(*apart), *scene.agent_objects[k]))
    for i in range(n):
        moving = [s for s in slices if i in s.movers]
        found.append(clearances(ca.horzcat(*(s.objects[i] for s in moving)), *scene.object_walls[i]))
        for k in range(n):
            # Of two movers the pair counts once.
            apart = [s.objects[i] - s.objects[k] for s in moving if k != i and not (k < i and k in s.movers)]
            found.append(clearances(ca.horzcat(*apart), *scene.object_objects[i][k]))
    return ca.vertcat(*found)


def _program(
    x: ca.MX,
    scene: SceneSymbols,
    slices: Sequence[_Slice],
    weights: Weights,
    costs: Sequence[ca.MX],
    collisions: Sequence[ca.MX],
) -> Program:
    """What the three bounds share: the demands of the switches, and the limits."""
    picks = [(s, s.switch) for s in slices if s.switch is not None and s.switch.is_pick]
    places = [(s, s.switch) for s in slices if s.switch is not None and not s.switch.is_pick]
    gaps = [touch_gap(s.agent - s.objects[a.index], *scene.parts[a.index]) - TOUCH_GAP for s, a in picks]
    placed = [inside(s.objects[a.index], *scene.surfaces[a.surface]) for s, a in places if a.surface is not None]
    limits = inside(ca.horzcat(*(s.agent for s in slices)), *scene.surfaces[Surface.FLOOR])
    return Program(
        x,
        scene.p,
        ca.vertcat(*costs),
        weights.touch * ca.vertcat(*gaps) if gaps else ca.MX(0, 1),
        ca.vertcat(
            *(weights.placement * margins for margins in (*placed, limits)),
            *(weights.collision * clearance for clearance in collisions),
        ),
    )

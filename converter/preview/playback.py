"""Plans played back in the physics engine: does anything move that should not?

The agent is kinematic: it follows the plan whatever happens. What it carries is attached to it by joints, and
everything else is free to move. A plan that collides nowhere moves nothing but the object that it carries, and leaves
that where the plan says.

The agent stops at every corner of its path and moves smoothly between them, because the engine lets the carried object
follow one step behind: it lags by acceleration times the square of the time step, a twentieth of a millimetre.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise

import numpy as np
import pymunk

from converter.plan import Plan
from converter.preview.simulation import MOVED, SPEED, Place, Simulation, reach
from converter.preview.world import Placed
from converter.replay import Step, replay
from converter.scene import AGENT, Scene
from converter.shape import FloatArray

TIME_STEP = 1 / 200
"""[s]."""

ACCELERATION = 2.0
"""Of the agent at most [m/s^2]."""


class PlaybackProblemKind(StrEnum):
    """What goes wrong when a plan is played back."""

    JUMP = "jump"
    """A segment does not start where the agent is; amount: length of the jump [m]."""
    NO_TOUCH = "no_touch"
    """The agent grasps an object that it does not touch; amount: the gap [m]."""
    PENETRATION = "penetration"
    """The agent, or what it carries, is driven into a body; amount: how deep [m]."""
    MOVED = "moved"
    """An object moves that is not carried; amount: by how much [m]."""
    SLIPPED = "slipped"
    """The carried object is held up; amount: how far from where the agent has it [m]."""
    GOAL_MISSED = "goal_missed"
    """The goal-object ends outside the goal; amount: by how much [m]."""


@dataclass(frozen=True)
class PlaybackProblem:
    """One thing that goes wrong.

    Attributes:
        kind: What it is.
        segment: Index of the segment; None for the plan as a whole.
        bodies: Names of the bodies concerned; the agent is `agent`.
        amount: By how much [m]; see `PlaybackProblemKind`.
        where: Where the first of the bodies is then [m], world.
        message: One line for people.
    """

    kind: PlaybackProblemKind
    segment: int | None
    bodies: tuple[str, ...]
    amount: float
    where: Place
    message: str


@dataclass(frozen=True)
class Playback:
    """What became of a plan.

    Attributes:
        problems: Empty if it plays back as planned.
        time_s: Time that the agent drove [s].
        moved: The most that an object moved which was not carried [m].
        slipped: The farthest that a carried object was from where the agent has it [m].
    """

    problems: tuple[PlaybackProblem, ...]
    time_s: float
    moved: float
    slipped: float

    @property
    def valid(self) -> bool:
        """Whether nothing went wrong."""
        return not self.problems


def play_back(scene: Scene, plan: Plan) -> Playback:
    """Plays the plan back and lists what goes wrong, by more than a millimetre besides the tolerance.

    Raises:
        InputError: the plan carries an object that the scene does not have.
    """
    player = _Player(scene)
    problems = [problem for i, step in enumerate(replay(scene, plan)) for problem in player.play(step, i)]
    problems += player.goal()
    return Playback(tuple(problems), player.simulation.time_s, player.moved, player.slipped)


class _Player:
    """State: the simulation, and the largest deviations so far [m]."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.moved = 0.0
        self.slipped = 0.0
        self.simulation = Simulation(scene, TIME_STEP)
        self.agent = self.simulation.world.agent
        self.agent.body.body_type = pymunk.Body.KINEMATIC
        self._most = self.simulation.world.allowed + MOVED

    def play(self, step: Step, i: int) -> Iterator[PlaybackProblem]:
        """Follows one segment."""
        path = step.segment.path
        jump = math.dist(self.agent.place, path[0])
        if jump > self._most:
            message = f"starts {jump:.6g} m away from the agent"
            yield self._problem(PlaybackProblemKind.JUMP, i, (AGENT,), jump, message)
        self.agent.body.position = float(path[0, 0]), float(path[0, 1])
        self.simulation.forget()
        held = None if step.carried is None else self.simulation.world.objects[step.carried]
        if held is not None and (gap := self._gap(held)) > self._most:
            message = f"the agent grasps {held.name}, which is {gap:.6g} m away"
            yield self._problem(PlaybackProblemKind.NO_TOUCH, i, (AGENT, held.name), gap, message)
        slipped = self._follow(path, held)
        yield from self._penetrations(i, held)
        yield from self._moved(i, held)
        if held is not None and slipped > MOVED:
            message = f"{held.name} is held up {slipped:.6g} m away from where the agent has it"
            yield self._problem(PlaybackProblemKind.SLIPPED, i, (held.name,), slipped, message)

    def goal(self) -> Iterator[PlaybackProblem]:
        """Whether the goal-object is in the goal."""
        goal = self.scene.goal
        placed = self.simulation.world.objects[self.scene.object_names.index(goal.object)]
        beyond = goal.distance(np.array(placed.place))
        if beyond > MOVED:
            message = f"{goal.object} ends {beyond:.6g} m outside the goal"
            yield self._problem(PlaybackProblemKind.GOAL_MISSED, None, (goal.object,), beyond, message)

    def _follow(self, path: FloatArray, held: Placed | None) -> float:
        """Drives along the path; the farthest that the held object, if any, was from where the agent has it [m]."""
        space, body = self.simulation.world.space, self.agent.body
        joints = [] if held is None else _joints(self.agent.body, held.body)
        space.add(*joints)
        offset, angle = (0j, 0.0) if held is None else (_complex(held.body) - _complex(body), held.body.angle)
        slipped = 0.0
        for velocity in _velocities(path):
            body.velocity = velocity
            self.simulation.step()
            if held is not None:
                slip = abs(_complex(held.body) - _complex(body) - offset)
                slipped = max(slipped, slip + abs(held.body.angle - angle) * reach(held))
        body.velocity = 0.0, 0.0
        # One step in which the joints bring the held object to where it belongs.
        self.simulation.step()
        space.remove(*joints)
        self.slipped = max(self.slipped, slipped)
        return slipped

    def _penetrations(self, i: int, held: Placed | None) -> Iterator[PlaybackProblem]:
        movers = {AGENT} if held is None else {AGENT, held.name}
        for touch in self.simulation.touches:
            one_moves = len(movers & set(touch.bodies)) == 1
            if one_moves and touch.depth > self._most:
                message = f"{touch.bodies[0]} penetrates {touch.bodies[1]} by {touch.depth:.6g} m"
                kind = PlaybackProblemKind.PENETRATION
                yield PlaybackProblem(kind, i, touch.bodies, touch.depth, touch.where, f"segment {i}: {message}")

    def _moved(self, i: int, held: Placed | None) -> Iterator[PlaybackProblem]:
        others = [moved for moved in self.simulation.moved(0.0) if held is None or moved.object != held.name]
        self.moved = max(self.moved, *(moved.distance for moved in others), 0.0)
        for moved in self.simulation.moved():
            if moved in others:
                message = f"{moved.object} moves by {moved.distance:.6g} m and {moved.turned:.3g} rad"
                kind = PlaybackProblemKind.MOVED
                yield PlaybackProblem(kind, i, (moved.object,), moved.distance, moved.end, f"segment {i}: {message}")

    def _gap(self, held: Placed) -> float:
        """Distance of agent and object [m]; infinite if they do not meet in height."""
        if not self.agent.meets_in_height(held):
            return math.inf
        held.refresh()
        distances = [shape.point_query(self.agent.place).distance for shape in held.shapes]
        return max(0.0, min(distances) - self.scene.agent.radius)

    def _problem(
        self, kind: PlaybackProblemKind, i: int | None, bodies: tuple[str, ...], amount: float, message: str
    ) -> PlaybackProblem:
        placed = next(placed for placed in self.simulation.world.movable if placed.name == bodies[0])
        return PlaybackProblem(
            kind, i, bodies, amount, placed.place, message if i is None else f"segment {i}: {message}"
        )


def _joints(agent: pymunk.Body, held: pymunk.Body) -> list[pymunk.Constraint]:
    """What makes two bodies move as one."""
    joints = [pymunk.PivotJoint(agent, held, held.position), pymunk.GearJoint(agent, held, held.angle, 1.0)]
    for joint in joints:
        joint.collide_bodies = False
        joint.error_bias = 0.0  # errors are corrected within one step
    return joints


def _velocities(path: FloatArray) -> Iterator[Place]:
    """Velocities [m/s], one for each step of time, that lead exactly along the path."""
    for start, end in pairwise(path):
        leg = end - start
        length = float(np.hypot(*leg))
        # s = 3 t^2 - 2 t^3 has the greatest slope 1.5 and the greatest curvature 6.
        duration = max(1.5 * length / SPEED, math.sqrt(6 * length / ACCELERATION))
        steps = max(1, math.ceil(duration / TIME_STEP))
        t = np.linspace(0, 1, steps + 1)
        shares = np.diff(t * t * (3 - 2 * t)) / TIME_STEP
        yield from ((float(x), float(y)) for x, y in shares[:, None] * leg)


def _complex(body: pymunk.Body) -> complex:
    return complex(body.position.x, body.position.y)

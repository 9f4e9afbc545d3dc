"""Replaying plans in MuJoCo: a check of plan and exported model by an engine that shares no code with either.

- `replay_kinematic` sets agent and objects to where the plan says they are, densely along its path, and reads the
  engine's contacts. For the `published` geometry, whose corridors leave the agent no clearance.
- `replay_dynamic` drives the agent with the model's servos and grasps with its welds; everything obeys physics. For
  the `clear` geometry.

MuJoCo is not a dependency of manipuzzle: `pip install mujoco`.
"""

import importlib
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from converter.formats.mjcf import AGENT_JOINTS, FLOOR, GRASP_PREFIX, body_names, mjcf_text
from converter.plan import Plan
from converter.scene import AGENT, Scene
from converter.shape import FloatArray
from converter.trajectory import NOTHING, SpeedProfile, TimedPlan
from pcg.errors import InputError

ENGINE_SLACK = 1e-3
"""Penetration beyond the scene's tolerance that is put down to the engine's soft contacts [m]."""

SPACING = 0.005
"""Distance of the places where contacts are read in a kinematic replay [m]."""

DYNAMIC_PROFILE = SpeedProfile(speed=1.0, acceleration=4.0, grasp_time=0.1)
"""How a dynamic replay drives by default."""

LIFT = 5e-4
"""How far a dynamic replay lifts what it carries off the floor [m]."""

SETTLING_TIME = 0.2
"""How long the world is stepped before and after a dynamic replay [s]."""


@dataclass(frozen=True)
class MujocoReplay:
    """What the engine saw.

    Attributes:
        penetration: The deepest of all contacts [m]; 0 if nothing penetrates.
        bodies: Names of the two bodies in that contact, as in the model.
        segment: Index of the plan's segment in which it happened; None if nothing penetrates.
        disturbance: Largest distance [m] by which an object that is not held left its place.
        tracking_error: Largest distance [m] of the agent from its trajectory.
        goal_reached: Whether the centre of the goal-object ends in the goal.
        goal_distance: Distance [m] of that centre from the goal; 0 inside.
        allowed: Penetration [m] that counts as none: the scene's tolerance plus `ENGINE_SLACK`.
    """

    penetration: float
    bodies: tuple[str, str] | None
    segment: int | None
    disturbance: float
    tracking_error: float
    goal_reached: bool
    goal_distance: float
    allowed: float

    @property
    def valid(self) -> bool:
        """Whether nothing penetrates deeper than allowed and the goal-object ends in the goal."""
        return self.penetration <= self.allowed and self.goal_reached


def replay_kinematic(scene: Scene, plan: Plan, spacing: float = SPACING) -> MujocoReplay:
    """Sets the bodies to their places every `spacing` [m] along the plan's path, and at its way-points.

    Raises:
        InputError: MuJoCo is not installed or cannot load the scene, or the plan is not solved or not for this scene.
    """
    world = _World(scene)
    motion = TimedPlan(scene, plan, SpeedProfile(speed=1.0, acceleration=math.inf))
    trajectory = motion.rows(spacing)
    for k, segment in enumerate(trajectory.segment):
        world.place(trajectory.agent[k], trajectory.objects[k])
        world.read_contacts(int(segment))
    return world.result(trajectory.objects[-1], 0.0, 0.0)


def replay_dynamic(scene: Scene, plan: Plan, profile: SpeedProfile = DYNAMIC_PROFILE) -> MujocoReplay:
    """Drives the plan with the model's servos and welds, under gravity and friction.

    Raises:
        InputError: MuJoCo is not installed or cannot load the scene, or the plan is not solved or not for this scene.
    """
    world = _World(scene)
    motion = TimedPlan(scene, plan, profile)
    steps = math.ceil((motion.duration + 2 * SETTLING_TIME) / world.time_step)
    trajectory = motion.sample(np.asarray(np.arange(steps) * world.time_step - SETTLING_TIME, dtype=np.float64))
    tracking_error = disturbance = 0.0
    rest = world.object_places
    held = NOTHING
    for k, segment in enumerate(trajectory.segment):
        if trajectory.held[k] != held:
            # What was released stays where it was put; what is grasped is compared again after its release.
            rest = world.object_places
            held = int(trajectory.held[k])
            world.grasp(held, trajectory.objects[k] - trajectory.agent[k])
        tracking_error = max(tracking_error, math.dist(world.agent_place, trajectory.agent[k]))
        world.drive(trajectory.agent[k], trajectory.velocity[k])
        world.read_contacts(int(segment))
        moved = np.hypot(*(world.object_places - rest).T)
        if held != NOTHING:
            moved[held] = 0.0
        disturbance = max(disturbance, float(moved.max()))
    return world.result(world.object_places, disturbance, tracking_error)


class _World:
    """A scene in MuJoCo, and the deepest contact that was read so far."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._engine = _mujoco()
        names = body_names(scene).objects
        try:
            self._model = self._engine.MjModel.from_xml_string(mjcf_text(scene))
        except ValueError as error:
            raise InputError(scene.name, f"MuJoCo refuses the scene: {' '.join(str(error).split())}") from None
        self._data = self._engine.MjData(self._model)
        self._start = scene.agent.position
        # The agent's two joints and the first two numbers of each free joint are positions in the plane.
        self._agent = np.array([self._model.joint(name).qposadr[0] for name in AGENT_JOINTS])
        self._objects = np.array([self._model.joint(name).qposadr[0] + np.arange(2) for name in names])
        self._welds = [self._model.equality(GRASP_PREFIX + name).id for name in names]
        self._bodies = [self._model.body(name).id for name in names]
        self._agent_body = self._model.body(AGENT).id
        self._penetration = 0.0
        self._deepest: tuple[tuple[str, str], int] | None = None

    @property
    def time_step(self) -> float:
        """[s]."""
        return float(self._model.opt.timestep)

    @property
    def agent_place(self) -> FloatArray:
        """(2,) [m], world."""
        return np.asarray(self._start + self._data.qpos[self._agent])

    @property
    def object_places(self) -> FloatArray:
        """(n_objects, 2) [m], world."""
        return np.array(self._data.qpos[self._objects])

    def place(self, agent: FloatArray, objects: FloatArray) -> None:
        """Puts agent (2,) and objects (n_objects, 2) [m] to places and finds their contacts, without dynamics."""
        self._data.qpos[self._agent] = agent - self._start
        self._data.qpos[self._objects] = objects
        self._engine.mj_kinematics(self._model, self._data)
        self._engine.mj_comPos(self._model, self._data)
        self._engine.mj_collision(self._model, self._data)

    def drive(self, agent: FloatArray, velocity: FloatArray) -> None:
        """Sets what the servos want, a place (2,) [m] and a velocity (2,) [m/s], and steps once."""
        self._data.ctrl[:] = [*(agent - self._start), *velocity]
        self._engine.mj_step(self._model, self._data)

    def grasp(self, held: int, offsets: FloatArray) -> None:
        """Welds the object with index `held` to the agent, and releases the others.

        The weld draws the object to where the plan holds it: `offsets` (n_objects, 2) [m] from the agent, unturned and
        lifted. What contacts did to it before, fractions of a millimetre, does not add up over several grasps.
        """
        self._data.eq_active[self._welds] = 0
        if held == NOTHING:
            return
        weld, body = self._welds[held], self._bodies[held]
        heights = self._model.body_pos[[body, self._agent_body], 2]
        # The agent never turns, so its frame is the world's but for the place.
        data = self._model.eq_data[weld]
        data[0:3] = 0.0
        data[3:6] = [*offsets[held], heights[0] - heights[1] + LIFT]
        data[6:10] = self._model.body_quat[body]
        self._data.eq_active[weld] = 1

    def read_contacts(self, segment: int) -> None:
        """Remembers the deepest contact so far, and that it was in this segment of the plan."""
        if self._data.ncon == 0:
            return
        distances = self._data.contact.dist
        k = int(distances.argmin())
        if -distances[k] > self._penetration:
            self._penetration = float(-distances[k])
            first, second = (self._name(geom) for geom in self._data.contact.geom[k])
            self._deepest = (first, second), segment

    def _name(self, geom: int) -> str:
        body = self._model.body(self._model.geom_bodyid[geom]).name
        return FLOOR if body == "world" else str(body)

    def result(self, objects: FloatArray, disturbance: float, tracking_error: float) -> MujocoReplay:
        """What was seen, with the objects (n_objects, 2) [m] where they are at the end."""
        goal = self._scene.goal
        place = objects[self._scene.object_names.index(goal.object)]
        bodies, segment = (None, None) if self._deepest is None else self._deepest
        return MujocoReplay(
            penetration=self._penetration,
            bodies=bodies,
            segment=segment,
            disturbance=disturbance,
            tracking_error=tracking_error,
            goal_reached=goal.contains(place),
            goal_distance=goal.distance(place),
            allowed=self._scene.tolerance + ENGINE_SLACK,
        )


def _mujoco() -> Any:
    # By its name, because the package is optional and without types.
    try:
        return importlib.import_module("mujoco")
    except ImportError:
        raise InputError("mujoco", "not installed; it is needed for this replay only: pip install mujoco") from None

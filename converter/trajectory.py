"""Plans in time: how fast a path is driven, and where agent and objects are at any moment.

Every straight piece of a path is driven with the same profile. With an acceleration the agent starts and stops at each
way-point (a trapezoid of speed over time, or a triangle where the piece is too short for full speed), so that a real
machine can follow the corners exactly. Without one it drives at constant speed and turns at once.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from converter.plan import Plan
from converter.replay import Step, replay, start_positions
from converter.scene import Scene
from converter.shape import FloatArray
from pcg.errors import InputError

MAX_POSITIONS = 20_000_000
"""Most positions of agent and objects, over all rows, that a trajectory may have."""

LARGEST = 1e6
"""Largest speed, acceleration and time of a profile, and one over the smallest speed and acceleration."""

NOTHING = -1
"""Stands for an object's index where none is held."""


@dataclass(frozen=True)
class SpeedProfile:
    """How a path is driven.

    Attributes:
        speed: Full speed [m/s].
        acceleration: From rest to full speed and back [m/s^2]; infinite for constant speed.
        grasp_time: How long the agent rests at every grasp, and at every release, still holding the object [s].
    """

    speed: float = 0.5
    acceleration: float = 1.0
    grasp_time: float = 0.0

    def __post_init__(self) -> None:
        if not 1 / LARGEST <= self.speed <= LARGEST:
            raise InputError("speed", f"{self.speed} m/s must be from {1 / LARGEST:g} to {LARGEST:g}")
        if not (1 / LARGEST <= self.acceleration <= LARGEST or self.acceleration == math.inf):
            problem = f"{self.acceleration} m/s^2 must be from {1 / LARGEST:g} to {LARGEST:g}, or infinite"
            raise InputError("acceleration", problem)
        if not 0 <= self.grasp_time <= LARGEST:
            raise InputError("grasp_time", f"{self.grasp_time} s must be from 0 to {LARGEST:g}")

    def durations(self, lengths: FloatArray) -> FloatArray:
        """Times [s] to drive straight pieces of these lengths (n,) [m]."""
        ramps = self.speed / self.acceleration
        short = 2 * np.sqrt(lengths / self.acceleration)
        return np.where(lengths < self.speed * ramps, short, lengths / self.speed + np.where(lengths > 0, ramps, 0.0))

    def progress(self, times: FloatArray, lengths: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Distances driven (n,) [m] and speeds (n,) [m/s] at `times` (n,) [s] since the begin of pieces of `lengths`.

        After the end of a piece the agent rests there.
        """
        durations = self.durations(lengths)
        times = np.clip(times, 0.0, durations)
        if math.isinf(self.acceleration):
            return times * self.speed, np.where(times < durations, self.speed, 0.0)
        ramps = np.minimum(self.speed / self.acceleration, durations / 2)
        rest = durations - times
        # Seen from the nearer end of the piece a ramp comes first, then full speed.
        near = np.minimum(times, rest)
        covered = np.where(
            near < ramps, self.acceleration * near**2 / 2, self.acceleration * ramps * (near - ramps / 2)
        )
        speeds = self.acceleration * np.minimum(near, ramps)
        return np.where(times <= rest, covered, lengths - covered), speeds


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A plan at n moments.

    Attributes:
        times: (n,) [s], rising from 0.
        agent: (n, 2) [m], world.
        velocity: (n, 2) [m/s]: of the agent from this moment on.
        objects: (n, n_objects, 2) [m], world, in the order of the scene's objects.
        held: (n,) index of the object that is held from this moment on; `NOTHING` in a move and at the end.
        segment: (n,) index of the plan's segment.
        names: Names of the objects.
    """

    times: FloatArray
    agent: FloatArray
    velocity: FloatArray
    objects: FloatArray
    held: npt.NDArray[np.int64]
    segment: npt.NDArray[np.int64]
    names: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class _Piece:
    """A straight motion, or a rest if `length` is 0, for `duration` [s] in the plan's segment `segment`."""

    segment: int
    start: FloatArray
    direction: FloatArray
    length: float
    duration: float


class TimedPlan:
    """A solved plan as a function of time.

    Args:
        scene: The scene in which the plan was made.
        plan: The plan; it is believed, as `converter.replay` does.
        profile: How its path is driven.

    Raises:
        InputError: the plan has no solution, or carries an object that the scene does not have.
    """

    def __init__(self, scene: Scene, plan: Plan, profile: SpeedProfile | None = None) -> None:
        if not plan.solved:
            raise InputError(f"plan for {plan.scene!r}", f"status: {plan.status}; only a solved plan has a motion")
        self.profile = profile or SpeedProfile()
        self._scene = scene
        self._steps = replay(scene, plan)
        self._pieces = [
            piece
            for i, step in enumerate(self._steps)
            for piece in _pieces(i, step, self.profile)
            if piece.duration > 0
        ]
        self._ends = np.cumsum([piece.duration for piece in self._pieces])

    @property
    def duration(self) -> float:
        """Time from begin to end [s]."""
        return float(self._ends[-1]) if self._pieces else 0.0

    @cached_property
    def way_times(self) -> FloatArray:
        """(k,) [s]: begin, every way-point, every begin and end of a rest, and the end."""
        return np.concatenate([[0.0], self._ends])

    def rows(self, step: float) -> Trajectory:
        """The trajectory at all multiples of `step` [s] and at all `way_times`.

        Straight lines between its rows never leave the plan's path.

        Raises:
            InputError: `step` is not positive, or so small that there would be more than `MAX_POSITIONS`.
        """
        if not step > 0:
            raise InputError("step", f"{step} s must be positive")
        if (self.duration / step + len(self._pieces)) * (1 + len(self._scene.objects)) > MAX_POSITIONS:
            raise InputError("step", f"{step} s is too fine for {self.duration:.6g} s: over {MAX_POSITIONS} positions")
        regular = np.arange(math.ceil(self.duration / step)) * step
        # A multiple that falls on a way-point but for rounding errors would make a second row for one moment.
        nearest = np.searchsorted(self.way_times, regular)
        gaps = [np.abs(self.way_times[np.clip(nearest - k, 0, len(self._pieces))] - regular) for k in (0, 1)]
        return self.sample(np.union1d(regular[np.minimum(*gaps) > 1e-9 * max(self.duration, 1.0)], self.way_times))

    def sample(self, times: FloatArray) -> Trajectory:
        """The trajectory at `times` (n,) [s], rising; before the begin and after the end everything rests."""
        names = tuple(self._scene.object_names)
        if not self._pieces:
            return self._resting(times, names)
        at = np.minimum(np.searchsorted(self._ends, times, side="right"), len(self._pieces) - 1)
        starts, directions = (np.array([getattr(p, name) for p in self._pieces])[at] for name in ("start", "direction"))
        lengths = np.array([piece.length for piece in self._pieces])[at]
        distances, speeds = self.profile.progress(times - self.way_times[at], lengths)
        agent = starts + distances[:, np.newaxis] * directions
        segment = np.array([piece.segment for piece in self._pieces])[at]
        held = np.array([NOTHING if s.carried is None else s.carried for s in self._steps])[segment]
        over = times >= self.duration
        objects = np.array([step.positions for step in self._steps])[segment]
        carrying = np.flatnonzero(held != NOTHING)
        offsets = np.array([step.offset for step in self._steps])[segment]
        objects[carrying, held[carrying]] = agent[carrying] + offsets[carrying]
        objects[over] = self._steps[-1].end_positions
        return Trajectory(
            times=times,
            agent=agent,
            velocity=np.where(over, 0.0, speeds)[:, np.newaxis] * directions,
            objects=objects,
            held=np.where(over, NOTHING, held),
            segment=segment,
            names=names,
        )

    def _resting(self, times: FloatArray, names: tuple[str, ...]) -> Trajectory:
        n = len(times)
        end = self._steps[-1].end_positions if self._steps else start_positions(self._scene)
        agent = self._steps[-1].segment.path[-1] if self._steps else self._scene.agent.position
        return Trajectory(
            times=times,
            agent=np.tile(agent, (n, 1)),
            velocity=np.zeros((n, 2)),
            objects=np.tile(end, (n, 1, 1)),
            held=np.full(n, NOTHING),
            segment=np.full(n, max(len(self._steps) - 1, 0)),
            names=names,
        )


def _pieces(index: int, step: Step, profile: SpeedProfile) -> list[_Piece]:
    path = step.segment.path
    edges = np.diff(path, axis=0)
    lengths = np.hypot(*edges.T)
    durations = profile.durations(lengths)
    drives = [
        _Piece(index, start, edge / length, float(length), float(duration))
        for start, edge, length, duration in zip(path[:-1], edges, lengths, durations, strict=True)
        if length > 0
    ]
    if step.carried is None:
        return drives
    grasp, release = (_Piece(index, path[end], np.zeros(2), 0.0, profile.grasp_time) for end in (0, -1))
    return [grasp, *drives, release]

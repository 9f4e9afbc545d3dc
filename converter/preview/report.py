"""What the preview found out about a scene."""

from dataclasses import asdict, dataclass
from typing import Any

from converter.preview.checks import Problem
from converter.preview.driving import Drive
from converter.preview.playback import Playback
from converter.shape import FloatArray


@dataclass(frozen=True, eq=False)
class Approach:
    """A drive from the start to an object, until the agent touches it, or into the goal.

    Attributes:
        target: Name of the object, or `goal`.
        path: (n, 2) [m], world: the way that a planner found; None if there is none.
        drive: What became of it; None without a path.
    """

    target: str
    path: FloatArray | None
    drive: Drive | None


@dataclass(frozen=True, eq=False)
class Push:
    """A drive from the start to one side of an object and then straight against it.

    Attributes:
        object: Name of the object.
        direction: Unit vector, world.
        path: (n, 2) [m], world; None if no way leads to that side.
        drive: What became of it; None without a path.
    """

    object: str
    direction: tuple[float, float]
    path: FloatArray | None
    drive: Drive | None


@dataclass(frozen=True, eq=False)
class SceneReport:
    """What the preview found.

    Attributes:
        scene: Name of the scene.
        problems: What is wrong with the scene at rest.
        approaches: To every object and to the goal; empty unless the scene is valid.
        pushes: As asked for; empty unless the scene is valid.
        playback: Of the plan, if there is one.
    """

    scene: str
    problems: tuple[Problem, ...]
    approaches: tuple[Approach, ...] = ()
    pushes: tuple[Push, ...] = ()
    playback: Playback | None = None

    @property
    def valid(self) -> bool:
        """Whether the scene can be set up and begun."""
        return not self.problems

    @property
    def all_well(self) -> bool:
        """Whether the scene is valid, the engine follows every path there is, and the plan plays back.

        That no path leads to an object is no flaw: others may be in the way, to be carried away first.
        """
        followed = all(approach.drive is None or approach.drive.reached for approach in self.approaches)
        return self.valid and followed and (self.playback is None or self.playback.valid)

    def document(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "scene": self.scene,
            "valid": self.valid,
            "problems": [asdict(problem) for problem in self.problems],
            "reachable": [_approach(approach) for approach in self.approaches],
            "pushes": [_push(push) for push in self.pushes],
            "playback": None if self.playback is None else {"valid": self.playback.valid, **asdict(self.playback)},
        }


def _approach(approach: Approach) -> dict[str, Any]:
    return {"target": approach.target, "path": _points(approach.path), "drive": _drive(approach.drive)}


def _push(push: Push) -> dict[str, Any]:
    moved = [] if push.drive is None else [moved for moved in push.drive.moved if moved.object == push.object]
    return {
        "object": push.object,
        "direction": list(push.direction),
        "path": _points(push.path),
        "distance_m": moved[0].distance if moved else None if push.drive is None else 0.0,
        "drive": _drive(push.drive),
    }


def _drive(drive: Drive | None) -> dict[str, Any] | None:
    return None if drive is None else asdict(drive)


def _points(path: FloatArray | None) -> list[list[float]] | None:
    return None if path is None else path.tolist()

"""Options of level conversion. The defaults are the sizes of the authors' generated scenes [L].

[L] Levit, Ortiz-Haro, Toussaint: Solving Sequential Manipulation Puzzles by Finding Easier Subproblems, ICRA 2024.
"""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from converter.formats.body_document import MAX_LENGTH, MIN_LENGTH
from converter.preset import CLEAR, Preset, preset_named
from pcg.errors import InputError

_LENGTHS = (
    "cell",
    "wall_height",
    "object_size",
    "object_height",
    "goal_size",
    "agent_radius",
    "agent_height",
)


@dataclass(frozen=True)
class ConversionSettings:
    """How a level becomes a scene; lengths in metres.

    Attributes:
        preset: Geometry preset, `clear` or `published`.
        cell: Side of a cell.
        wall_height: Height of blocks and outer walls.
        object_size: Side of the boxes that crates become; they have to fit their cells.
        object_height: Height of these boxes; None makes them cubes.
        goal_size: Side of the goal square.
        agent_radius: Radius of the agent; None takes that of the preset.
        agent_height: Height of the agent.
        merge_walls: Whether adjacent wall cells become larger bodies, as few as possible; what they fill stays the
            same exactly.
        size_jitter: Share, 0 to less than 1, by which each side of each object is made longer or shorter at random.
        yaw_jitter: Angle [rad], 0 to pi, by which each object is turned at most, either way, at random.
        seed: Of the random sizes and angles. Each level has draws of its own, whatever it is called and converted with.
        goal_crate: Which crate becomes the goal-object, counted from 1 in reading order; None takes the crate that the
            level names, or else the one that the solver brings to the goal.
        drop_targets: Whether the targets but the first are removed before the solver is asked.
        drop_crates: Whether the crates but the goal crate are removed, and with them the targets but the first.
    """

    preset: str = CLEAR.name
    cell: float = 0.4
    wall_height: float = 0.4
    object_size: float = 0.2
    object_height: float | None = None
    goal_size: float = 0.35
    agent_radius: float | None = None
    agent_height: float = 0.2
    merge_walls: bool = False
    size_jitter: float = 0.0
    yaw_jitter: float = 0.0
    seed: int = 0
    goal_crate: int | None = None
    drop_targets: bool = False
    drop_crates: bool = False

    def __post_init__(self) -> None:
        preset = preset_named(self.preset)
        for name in _LENGTHS:
            value = getattr(self, name)
            if value is not None and not MIN_LENGTH <= value <= MAX_LENGTH:
                raise InputError(name, f"{value} m must be between {MIN_LENGTH:g} and {MAX_LENGTH:g}")
        if not 0 <= self.size_jitter < 1:
            raise InputError("size_jitter", f"{self.size_jitter} must be at least 0 and less than 1")
        if not 0 <= self.yaw_jitter <= np.pi:
            raise InputError("yaw_jitter", f"{self.yaw_jitter} rad must be between 0 and pi")
        if self.seed < 0:
            raise InputError("seed", f"{self.seed} must not be negative")
        if self.goal_crate is not None and self.goal_crate < 1:
            raise InputError("goal_crate", f"{self.goal_crate} is not the number of a crate; the first one is 1")
        self._require_room(preset)

    @property
    def jitters(self) -> bool:
        """Whether objects differ in size or angle."""
        return self.size_jitter > 0 or self.yaw_jitter > 0

    def as_recorded(self, preset: Preset) -> dict[str, Any]:
        """Every setting with the value that was used."""
        defaults = {"object_height": self.object_size, "agent_radius": preset.agent_radius}
        values = asdict(self)
        return {**values, **{name: value for name, value in defaults.items() if values[name] is None}}

    def _require_room(self, preset: Preset) -> None:
        if not 2 * preset.block_edge_radius < self.cell:
            raise InputError("cell", f"{self.cell} m must be more than two edge radii of {preset.block_edge_radius}")
        radius = preset.object_edge_radius
        if not 2 * radius < self.object_size * (1 - self.size_jitter) or self.object_size > self.cell:
            problem = f"must fit a cell of {self.cell} m and exceed two edge radii of {radius} m"
            raise InputError("object_size", f"{self.object_size} m {problem}")
        # Objects that leave the grid keep to the part of a cell that no outer wall covers, so that none overlaps another
        # body. Of all angles, a box is widest at 45 degrees.
        angle = min(self.yaw_jitter, np.pi / 4)
        core = self.object_size * (1 + self.size_jitter) - 2 * radius
        widest = core * (np.cos(angle) + np.sin(angle)) + 2 * radius
        room = self.cell - 2 * preset.outer_wall_overhang
        if self.jitters and widest > room:
            raise InputError(
                "object_size",
                f"boxes of {self.object_size} m with this jitter may be {widest:.3g} m wide; beside the outer walls of preset "
                f"{preset.name} a cell of {self.cell} m leaves {room:.3g} m",
            )

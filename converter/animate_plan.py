"""Frames of a plan in motion: the agent drives and carries at constant speed, and rests where it picks and places."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import repeat
from math import inf

import numpy as np

from converter.drawing import Drawing, Shape
from converter.plan import Plan
from converter.polyline import path_length
from converter.raster import Image, paint, paint_over
from converter.render_scene import agent_shape, body_shape, object_color, object_shapes, room_drawing
from converter.replay import Step, points_along, replay, start_positions
from converter.scene import Scene
from converter.shape import FloatArray
from converter.theme import PAPER, Theme
from pcg.errors import InputError

REST_S = 0.3
"""Rest at the end of every segment, where the agent picks or places [s]."""

FIRST_REST_S = 0.6
LAST_REST_S = 1.5
"""Rests before the first and after the last motion [s]."""

MAX_FRAMES = 3000

HELD_OUTLINE = 2.0
"""Outline of what the agent holds, as a multiple of other outlines."""


@dataclass(frozen=True)
class _Timing:
    fps: int
    speed: float

    def frames(self, seconds: float) -> int:
        return max(round(seconds * self.fps), 1)

    def travel_frames(self, length: float) -> int:
        """Frames that the agent needs for `length` [m], at least one."""
        return self.frames(length / self.speed)


def plan_frames(
    scene: Scene, plan: Plan, *, fps: int = 20, speed: float = 1.0, width_px: int = 480, theme: Theme = PAPER
) -> Iterator[Image]:
    """The frames of the plan's motion, from the start of the scene to the end of the last segment.

    Args:
        scene: The scene.
        plan: Its plan; one without segments shows the scene at rest.
        fps: Frames a second.
        speed: Of the agent [m/s].
        width_px: Width of each frame.
        theme: Colours and line widths.

    Raises:
        InputError: the plan carries an object that the scene does not have, `fps` or `speed` is not positive, or the
            animation would have more than `MAX_FRAMES` frames or too large ones.
    """
    if not (fps > 0 and 0 < speed < inf):
        raise InputError("animation", f"{fps} frames a second at {speed} m/s; both must be positive")
    timing = _Timing(fps, speed)
    steps = replay(scene, plan)
    count = sum(timing.travel_frames(step.segment.length) + timing.frames(REST_S) for step in steps)
    if count > MAX_FRAMES:
        raise InputError(
            "animation",
            f"{count} frames for {plan.path_length:.3g} m at {speed:g} m/s; at most {MAX_FRAMES} are allowed",
        )
    room = room_drawing(scene, theme)
    return _frames(scene, steps, timing, room=room, empty=paint(room, width_px), theme=theme)


def _frames(
    scene: Scene, steps: list[Step], timing: _Timing, *, room: Drawing, empty: Image, theme: Theme
) -> Iterator[Image]:
    still = _still(scene, start_positions(scene), scene.agent.position, room, theme)
    yield from repeat(paint_over(empty, still), timing.frames(FIRST_REST_S))
    for step in steps:
        objects = object_shapes(scene, step.positions, room.unit, theme)
        resting = tuple(shape for i, shape in enumerate(objects) if i != step.carried)
        ground = paint_over(empty, replace(room, items=resting))
        for position in _sampled(step.segment.path, timing.travel_frames(step.segment.length)):
            frame = paint_over(ground, replace(room, items=_moving(scene, step, position, room.unit, theme)))
            yield frame
        yield from repeat(frame, timing.frames(REST_S))
    if steps:
        still = _still(scene, steps[-1].end_positions, steps[-1].segment.path[-1], room, theme)
    yield from repeat(paint_over(empty, still), timing.frames(LAST_REST_S))


def _still(scene: Scene, positions: FloatArray, agent: FloatArray, room: Drawing, theme: Theme) -> Drawing:
    """Objects and agent with nothing held."""
    objects = object_shapes(scene, positions, room.unit, theme)
    return replace(room, items=(*objects, agent_shape(scene, agent, room.unit, theme)))


def _moving(scene: Scene, step: Step, position: FloatArray, unit: float, theme: Theme) -> tuple[Shape, ...]:
    """The agent at `position` and, below it, what it holds."""
    agent = agent_shape(scene, position, unit, theme)
    if step.carried is None:
        return (agent,)
    body = scene.objects[step.carried]
    held = body_shape(body, object_color(scene, body, theme), unit, theme, position + step.offset)
    return tuple(replace(shape, outline_width=HELD_OUTLINE * shape.outline_width) for shape in (held, agent))


def _sampled(path: FloatArray, count: int) -> FloatArray:
    """(count, 2) [m]: equally spaced points of `path`, its end the last of them and its start left out."""
    length = path_length(path)
    return points_along(path, np.linspace(0.0, length, count + 1)[1:])

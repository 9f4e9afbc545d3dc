"""Storyboards: the key frames of a plan in one picture (as Fig. 1 of Levit et al.).

A frame shows the scene as the agent grasps an object, with the way that it carries it; the last one shows the end.
Grey dots mark all subgoals: the places where objects are put down, a ring the one that comes next.
"""

from dataclasses import replace

import numpy as np

from converter.drawing import Drawing, Shape, disc
from converter.plan import Plan
from converter.render_plan import carry_lines
from converter.render_scene import agent_shape, object_color, object_shapes, room_drawing
from converter.replay import Step, replay
from converter.scene import Scene
from converter.shape import FloatArray
from converter.sheet import Card, sheet_drawing
from converter.theme import PAPER, Theme
from pcg.errors import InputError

DOT_RADIUS = 9.0
RING_WIDTH = 3.0
"""Radius of a subgoal's dot and width of the ring around the next one, in units of a frame."""

ONE_ROW = 5
"""Frames that stand in one row."""

MAX_FRAMES = 200


def storyboard_drawing(scene: Scene, plan: Plan, *, theme: Theme = PAPER) -> Drawing:
    """A frame for each grasp, and one for the end.

    Raises:
        InputError: the plan has no carries or more than `MAX_FRAMES`, or carries an object that the scene lacks.
    """
    steps = replay(scene, plan)
    carries = [step for step in steps if step.carried is not None]
    if not 0 < len(carries) < MAX_FRAMES:
        raise InputError(
            f"plan for {plan.scene!r}", f"{len(carries)} pick-places; a storyboard shows 1 to {MAX_FRAMES - 1}"
        )
    goals = np.array([step.end_positions[step.carried] for step in carries])
    cards = [
        Card(f"{i + 1}: carries {step.segment.object}", _grasp_frame(scene, step, goals, i, theme))
        for i, step in enumerate(carries)
    ]
    last = steps[-1]
    end = _frame(scene, last.end_positions, last.segment.path[-1], goals, theme)
    frames = [*cards, Card("end", end)]
    return sheet_drawing(frames, columns=len(frames) if len(frames) <= ONE_ROW else None, theme=theme)


def _grasp_frame(scene: Scene, step: Step, goals: FloatArray, index: int, theme: Theme) -> Drawing:
    frame = _frame(scene, step.positions, step.segment.path[0], goals, theme)
    assert step.carried is not None  # noqa: S101  # only carries come here
    color = object_color(scene, scene.objects[step.carried], theme)
    unit = frame.unit
    lines = carry_lines(step.segment.path + step.offset, color, unit, theme)
    ring = Shape(
        (disc(goals[index], DOT_RADIUS * unit),), theme.subgoal, outline=theme.outline, outline_width=RING_WIDTH * unit
    )
    return replace(frame, items=(*frame.items, *lines, ring))


def _frame(scene: Scene, positions: FloatArray, agent: FloatArray, goals: FloatArray, theme: Theme) -> Drawing:
    """The scene with its objects at `positions` (n_objects, 2) [m], and all subgoals `goals` (n, 2) [m]."""
    room = room_drawing(scene, theme)
    unit = room.unit
    movable = [*object_shapes(scene, positions, unit, theme), agent_shape(scene, agent, unit, theme)]
    dots = [
        Shape((disc(goal, DOT_RADIUS * unit),), theme.subgoal, outline=theme.badge, outline_width=unit)
        for goal in goals
    ]
    return replace(room, items=(*room.items, *dots, *movable))

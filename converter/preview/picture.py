"""A summary picture of what the preview found: one scene, the ways driven in it, what was touched and pushed."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from converter.drawing import Drawing, Item, Label, Line, Shape, disc, footprint
from converter.preview.report import Approach, Push, SceneReport
from converter.render_scene import body_shape, object_color, scene_drawing
from converter.scene import Scene
from converter.shape import FloatArray
from converter.theme import PAPER, Color, Theme, mixed

END_RADIUS = 5.0
"""Of the dot at the end of a drive, in units of the picture."""

TOUCH_RADIUS = 3.0
"""Of the dot where two bodies touched."""

CROSS = 9.0
"""Half the side of the cross over what no way leads to."""

CAPTION_LENGTH = 72
"""Letters that fit below the picture."""

CAPTION_HEIGHT = 2.2
"""Of the strip below the picture, in text heights."""


def report_drawing(scene: Scene, report: SceneReport, *, theme: Theme = PAPER) -> Drawing:
    """The scene with all that the preview found.

    Bodies with a problem are marked; lines are the ways to each object (in its colour) and to the goal, with a dot at
    the end, green where the disc arrived; a cross is on what no way leads to. Translucent bodies are pushed objects
    where they end. Small dots are contacts.
    """
    start = scene_drawing(scene, theme=theme)
    unit = start.unit
    strip = CAPTION_HEIGHT * theme.text_height * unit
    middle = np.array([(start.lower[0] + start.upper[0]) / 2, start.lower[1] - strip / 2])
    items = [
        *_troubled(scene, report, unit, theme),
        *(item for push in report.pushes for item in _push(scene, push, unit, theme)),
        *(item for approach in report.approaches for item in _approach(scene, approach, unit, theme)),
        *_mishaps(report, unit, theme),
        Label(_caption(report), middle, theme.text_height * unit, theme.outline),
    ]
    return replace(start, lower=start.lower - np.array([0.0, strip]), items=(*start.items, *items))


def summary(report: SceneReport) -> str:
    """What was found, in a few words."""
    if not report.valid:
        return "; ".join(problem.message for problem in report.problems)
    words = ["valid"]
    if report.approaches:
        reached = [approach.drive for approach in report.approaches if approach.drive and approach.drive.reached]
        words.append(f"{len(reached)} of {len(report.approaches)} targets reached")
    if report.pushes:
        possible = [
            push for push in report.pushes if push.drive and any(m.object == push.object for m in push.drive.moved)
        ]
        words.append(f"{len(possible)} of {len(report.pushes)} pushes move their object")
    if report.playback is not None:
        problems = "; ".join(problem.message for problem in report.playback.problems)
        words.append(problems or "the plan plays back")
    return ", ".join(words)


def _caption(report: SceneReport) -> str:
    text = f"{report.scene}: {summary(report)}"
    return text if len(text) <= CAPTION_LENGTH else text[: CAPTION_LENGTH - 1] + "…"


def _troubled(scene: Scene, report: SceneReport, unit: float, theme: Theme) -> Iterator[Item]:
    names = {name for problem in report.problems for name in problem.bodies}
    width = 2 * theme.outline_width * unit
    for body in (*scene.walls, *scene.objects):
        if body.name in names:
            yield Shape(footprint(body), theme.bad, theme.ghost_opacity, outline=theme.bad, outline_width=width)
    if names - {body.name for body in (*scene.walls, *scene.objects)}:
        agent = (disc(scene.agent.position, scene.agent.radius),)
        yield Shape(agent, theme.bad, theme.ghost_opacity, outline=theme.bad, outline_width=width)


def _approach(scene: Scene, approach: Approach, unit: float, theme: Theme) -> Iterator[Item]:
    body = next((body for body in scene.objects if body.name == approach.target), None)
    place = scene.goal.position if body is None else body.position[:2]
    if approach.path is None or approach.drive is None:
        yield from _cross(place, unit, theme)
        return
    color = theme.goal_dark if body is None else mixed(object_color(scene, body, theme), theme.outline, 0.35)
    yield Line(approach.path, theme.move_width * unit, color)
    for touch in approach.drive.touches:
        yield _dot(np.array(touch.where), TOUCH_RADIUS * unit, theme.neutral, theme)
    verdict = theme.good if approach.drive.reached else theme.bad
    yield _dot(np.array(approach.drive.end), END_RADIUS * unit, verdict, theme)


def _push(scene: Scene, push: Push, unit: float, theme: Theme) -> Iterator[Item]:
    for moved in () if push.drive is None else push.drive.moved:
        body = scene.object(moved.object)
        color = object_color(scene, body, theme)
        pushed = replace(body.at(np.array(moved.end)), yaw=body.yaw + moved.turned)
        ghost = body_shape(pushed, color, unit, theme)
        dark = mixed(color, theme.outline, 0.55)
        yield replace(ghost, fill_opacity=theme.ghost_opacity, outline=dark, outline_width=ghost.outline_width / 2)
        yield Line(np.array([moved.start, moved.end]), theme.move_width * unit, dark)


def _mishaps(report: SceneReport, unit: float, theme: Theme) -> Iterator[Item]:
    for problem in () if report.playback is None else report.playback.problems:
        yield _dot(np.array(problem.where), END_RADIUS * unit, theme.bad, theme)


def _cross(place: FloatArray, unit: float, theme: Theme) -> Iterator[Item]:
    arms = [np.array([place - arm, place + arm]) for arm in CROSS * unit * np.array([[1.0, 1.0], [1.0, -1.0]])]
    width = 2 * theme.move_width * unit
    yield from (Line(arm, 2 * width, theme.badge) for arm in arms)
    yield from (Line(arm, width, theme.bad) for arm in arms)


def _dot(place: FloatArray, radius: float, color: Color, theme: Theme) -> Shape:
    return Shape((disc(place, radius),), color, outline=theme.badge, outline_width=radius / 4)

"""What the command `render` draws: levels, scenes and plans, each with its picture, its name and a verdict."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Literal, NamedTuple, Protocol

from converter.drawing import Drawing
from converter.plan import Plan
from converter.raster import MAX_PIXELS
from converter.render_level import level_drawing
from converter.render_plan import plan_drawing
from converter.render_scene import scene_drawing
from converter.scene import Scene
from converter.storyboard import storyboard_drawing
from converter.theme import Theme
from evaluate.inputs import is_scene, read_playable_levels, read_scene_file
from evaluate.names import safe_name
from evaluate.plan_source import names_plan, read_named_plan
from pcg.errors import InputError
from pcg.level import Level
from pcg.solver import SolverStatus, solve
from planner.verify import verify

TILE_PX = 40
"""Side of a level's tile."""

SCENE_PX = 600
"""Width of a picture of a scene or plan."""


class Verdict(NamedTuple):
    """What a contact sheet says about a picture, and whether that is good."""

    text: str
    good: bool


class Draw(Protocol):
    """A function that makes a drawing."""

    def __call__(self, *, theme: Theme) -> Drawing:
        """The drawing in the colours of `theme`."""


class Motion(NamedTuple):
    """A plan and its scene."""

    scene: Scene
    plan: Plan


@dataclass(frozen=True, eq=False)
class Subject:
    """Something to draw. Its functions can be sent to other processes.

    Attributes:
        kind: What it is.
        name: Stem of its file.
        draw: Makes its picture.
        judge: Finds out whether it is solvable, valid or verified; takes some milliseconds.
        width_px: Width of its picture, if none is asked for; None for as wide as a sheet.
        motion: What can be animated, if it is a plan.
    """

    kind: Literal["level", "scene", "plan"]
    name: str
    draw: Draw
    judge: Callable[[], Verdict]
    width_px: int | None = SCENE_PX
    motion: Motion | None = None


def read_subjects(path: Path, given: Scene | None) -> list[Subject]:
    """What a file or the folder of a level set holds.

    Args:
        path: Scene, plan or levels, by its suffix; or a trial of a study.
        given: Scene of a plan whose file holds none.

    Raises:
        InputError: naming the file, the place in it, and the reason.
    """
    if names_plan(path):
        found = read_named_plan(path)
        return [plan_subject(found.name, found.scene(given), found.plan)]
    if is_scene(path):
        return [scene_subject(read_scene_file(path))]
    return [level_subject(level) for level in read_playable_levels(path)]


def level_subject(level: Level) -> Subject:
    """A level as tiles, smaller ones where the picture would be too large."""
    rows, columns = (side + 2 for side in level.shape)
    width_px = columns * min(TILE_PX, math.isqrt(MAX_PIXELS // (rows * columns)))
    return Subject(
        "level", safe_name(level.name), partial(level_drawing, level), partial(_judge_level, level), width_px
    )


def scene_subject(scene: Scene) -> Subject:
    """A scene at its start."""
    return Subject("scene", safe_name(scene.name), partial(scene_drawing, scene), partial(_judge_scene, scene))


def plan_subject(name: str, scene: Scene, plan: Plan) -> Subject:
    """A plan; its picture shows the whole motion."""
    draw, judge = partial(plan_drawing, scene, plan), partial(_judge_plan, scene, plan)
    return Subject("plan", safe_name(name), draw, judge, motion=Motion(scene, plan))


def as_storyboard(subject: Subject) -> Subject:
    """The key frames of a plan.

    Raises:
        InputError: it is no plan.
    """
    if subject.motion is None:
        raise InputError(subject.name, f"a {subject.kind} has no motion; --storyboard shows plans")
    draw = partial(storyboard_drawing, *subject.motion)
    return Subject(subject.kind, f"{subject.name}-storyboard", draw, subject.judge, None, subject.motion)


def _judge_level(level: Level) -> Verdict:
    solution = solve(level)
    if solution.solved:
        return Verdict(f"solvable, {solution.pushes} pushes", good=True)
    unsolvable = solution.status is SolverStatus.UNSOLVABLE
    return Verdict("not solvable" if unsolvable else "solver gave up", good=False)


def _judge_scene(scene: Scene) -> Verdict:
    from converter.preview import check_scene  # noqa: PLC0415  # it loads a physics engine, which only sheets need

    found = check_scene(scene)
    return Verdict("valid" if found.valid else found.problems[0].message, good=found.valid)


def _judge_plan(scene: Scene, plan: Plan) -> Verdict:
    if not plan.solved:
        return Verdict(plan.status.value, good=False)
    if violations := verify(scene, plan):
        return Verdict(violations[0].message, good=False)
    picks = f"{plan.pick_places} pick{'' if plan.pick_places == 1 else 's'}"
    return Verdict(f"verified, {picks}, {plan.path_length:.1f} m", good=True)

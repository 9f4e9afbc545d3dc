"""Pictures of subgoals before and after the filter, side by side, coloured by score (as Fig. 3 of Levit et al.)."""

import numpy as np
import numpy.typing as npt

from converter.drawing import Drawing, Inset, Item, Label, Shape, disc
from converter.render_scene import scene_drawing
from converter.scene import Scene
from converter.shape import FloatArray
from converter.theme import PAPER, Color, Theme, mixed

DOT_RADIUS = 5.0
DRAWN_RADIUS = 8.0
"""Radii of the dots of positions, and of the rings around those that were drawn, in units of the picture."""

MARGIN = 34.0
"""Height of the lines above and below the room, in units of the picture."""


def subgoals_drawing(
    scene: Scene,
    candidates: FloatArray,
    scores: FloatArray,
    passed: npt.NDArray[np.int64],
    drawn: npt.NDArray[np.int64],
    *,
    theme: Theme = PAPER,
) -> Drawing:
    """All candidates on the left; on the right those that passed the filter, with rings around the ones drawn.

    Args:
        scene: The scene at its start.
        candidates: (k, 2) [m], world.
        scores: (k,) of the candidates.
        passed: Indices of the candidates that passed the filter.
        drawn: Indices of the candidates that were drawn.
        theme: Colours and line widths.
    """
    everything = np.arange(len(candidates))
    before = f"before the filter: {len(candidates)}"
    after = f"after the filter: {len(passed)}, drawn: {len(drawn)}"
    left = _panel(scene, before, candidates, scores, everything, everything[:0], theme)
    right = _panel(scene, after, candidates, scores, passed, drawn, theme)
    width, height = left.upper - left.lower
    insets = (Inset(left, np.zeros(2), width), Inset(right, np.array([width, 0.0]), width))
    return Drawing(np.zeros(2), np.array([2 * width, height]), theme.page, insets)


def score_color(score: float, scores: FloatArray, theme: Theme = PAPER) -> Color:
    """The colour of a score among all `scores` (n,)."""
    low, high = float(scores.min()), float(scores.max())
    return mixed(theme.low_score, theme.high_score, (score - low) / (high - low) if high > low else 1.0)


def _panel(
    scene: Scene,
    title: str,
    candidates: FloatArray,
    scores: FloatArray,
    shown: npt.NDArray[np.int64],
    ringed: npt.NDArray[np.int64],
    theme: Theme,
) -> Drawing:
    room = scene_drawing(scene, theme=theme)
    unit = room.unit
    margin = np.array([0.0, MARGIN * unit])
    middle = (room.lower[0] + room.upper[0]) / 2
    heading = Label(title, np.array([middle, room.upper[1] + margin[1] / 2]), theme.text_height * unit, theme.outline)
    rings = [
        Shape((disc(candidates[i], DRAWN_RADIUS * unit),), theme.badge, outline=theme.outline, outline_width=unit)
        for i in ringed
    ]
    # The best ones on top, where dots overlap.
    dots = [
        _dot(candidates[i], scores[i], scores, unit, theme) for i in shown[np.argsort(scores[shown], kind="stable")]
    ]
    legend = _legend(scores, np.array([middle, room.lower[1] - margin[1] / 2]), unit, theme)
    return Drawing(
        room.lower - margin, room.upper + margin, room.background, (*room.items, heading, *rings, *dots, *legend)
    )


def _dot(position: FloatArray, score: float, scores: FloatArray, unit: float, theme: Theme) -> Shape:
    color = score_color(float(score), scores, theme)
    return Shape((disc(position, DOT_RADIUS * unit),), color, outline=theme.outline, outline_width=0.7 * unit)


def _legend(scores: FloatArray, center: FloatArray, unit: float, theme: Theme) -> list[Item]:
    """What the colours stand for: a dot and a number for each score that occurs."""
    values = np.unique(scores)
    step = 55.0 * unit
    left = center[0] - step * (len(values) - 2) / 2
    heading = np.array([left - step, center[1]])
    items: list[Item] = [Label("score", heading, theme.text_height * unit, theme.outline)] if len(values) else []
    for i, value in enumerate(values):
        dot, number = np.array([[-14.0, 0.0], [6.0, 0.0]]) * unit + [left + i * step, center[1]]
        items.append(_dot(dot, value, scores, unit, theme))
        items.append(Label(f"{value:g}", number, theme.text_height * unit, theme.outline))
    return items

"""Colours of pictures."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from converter.render_scene import object_color
from converter.scene import Scene
from converter.theme import COLORBLIND, PAPER, THEMES, Color, Theme, theme_named
from pcg.errors import InputError

VISION = {
    "usual": np.eye(3),
    "protanopia": np.array([[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]),
    "deuteranopia": np.array([[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]),
    "tritanopia": np.array([[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]),
}  # fmt: skip
"""How linear RGB is seen (Machado, Oliveira, Fernandes 2009, severity 1)."""

TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
WHITE = TO_XYZ.sum(axis=1)

TELLABLE = 20.0
"""Difference in CIELAB at which areas of colour are told apart at a glance."""


def lab(color: Color, vision: str) -> np.ndarray:
    """(3,): a colour in CIELAB, as seen with `vision`."""
    rgb = np.array(color)
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    ratio = TO_XYZ @ np.clip(VISION[vision] @ linear, 0, 1) / WHITE
    f = np.where(ratio > 216 / 24389, np.cbrt(ratio), (24389 / 27 * ratio + 16) / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def closest(theme: Theme, vision: str) -> float:
    """Least difference between the colours of what a scene shows."""
    colors = [theme.floor, theme.wall, theme.agent, theme.goal, theme.goal_object, theme.obstacles[1]]
    return min(float(np.linalg.norm(lab(a, vision) - lab(b, vision))) for a, b in combinations(colors, 2))


@pytest.mark.parametrize("vision", VISION)
def test_the_safe_theme_is_told_apart_by_everybody(vision: str):
    """Floor, walls, agent, goal, goal-object and an obstacle differ for each kind of colour vision."""
    assert closest(COLORBLIND, vision) > TELLABLE


@pytest.mark.parametrize("vision", VISION)
def test_good_and_bad_differ_for_everybody(vision: str):
    """Marks of verdicts too."""
    assert np.linalg.norm(lab(COLORBLIND.good, vision) - lab(COLORBLIND.bad, vision)) > TELLABLE


def test_the_paper_theme_is_not_safe():
    """The measure is one that can fail: brown walls and the red goal are close for some."""
    assert closest(PAPER, "protanopia") < TELLABLE < closest(PAPER, "usual")


def test_own_colours_yield_to_the_safe_theme(small_room: Scene):
    """A colour that a scene gives an object would undo what the theme is for."""
    body = replace(small_room.goal_object, color=(1.0, 0.0, 0.0))
    assert object_color(small_room, body, PAPER) == (1.0, 0.0, 0.0)
    assert object_color(small_room, body, COLORBLIND) == COLORBLIND.goal_object


def test_unknown_themes_are_refused():
    """With the names that are allowed."""
    assert [theme_named(name) for name in THEMES] == list(THEMES.values())
    with pytest.raises(InputError, match="theme: found 'dark', allowed are paper, colorblind"):
        theme_named("dark")

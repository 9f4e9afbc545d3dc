"""Colours and line widths of every picture."""

from dataclasses import dataclass

from pcg.errors import InputError

Color = tuple[float, float, float]
"""Red, green, blue in 0..1 (sRGB)."""


@dataclass(frozen=True)
class Theme:
    """How pictures look. Colours are red, green, blue in 0..1.

    Widths and text heights are in six-hundredths of the picture's longer side, so that a picture keeps its look at
    every size: in one of 600 pixels they are pixels.

    Attributes:
        page: Around the room.
        floor: Of the room.
        floor_line: Borders of a level's cells.
        wall: Faces of walls.
        wall_light: Lit edges of a level's walls.
        wall_dark: Shaded edges and outlines of walls.
        agent: The disc.
        goal: The goal rectangle; a level's targets.
        goal_dark: Its outline.
        goal_object: The object that has to reach the goal, unless it brings its own colour.
        obstacles: The other objects in order, used again from the start when there are more.
        crate: A level's crates other than its goal crate.
        outline: Around agent and objects; also text.
        move: Path of the agent alone.
        subgoal: Dots where objects are to be placed.
        badge: Behind numbers.
        outline_width: Of every outline.
        move_width: Of the agent's path alone.
        carry_width: Of the agent's path while it carries.
        text_height: Of numbers.
        ghost_opacity: Of the fill of what is not there now: placements, the agent at the end.
        good: Marks what is solved or valid.
        bad: Marks what is not.
        neutral: Marks what is neither, and lines without a meaning of their own.
        low_score: Of the candidates with the lowest score.
        high_score: Of those with the highest; it differs in brightness, so both are told apart in grey too.
        own_colors: Whether objects keep the colours that their scene gives them.
    """

    page: Color = (1.0, 1.0, 1.0)
    floor: Color = (0.955, 0.945, 0.925)
    floor_line: Color = (0.90, 0.885, 0.86)
    wall: Color = (0.70, 0.52, 0.45)
    wall_light: Color = (0.79, 0.63, 0.56)
    wall_dark: Color = (0.50, 0.35, 0.29)
    agent: Color = (0.97, 0.74, 0.31)
    goal: Color = (0.94, 0.38, 0.35)
    goal_dark: Color = (0.72, 0.20, 0.19)
    goal_object: Color = (0.18, 0.36, 0.87)
    obstacles: tuple[Color, ...] = ((1.0, 1.0, 1.0), (0.95, 0.52, 0.78), (0.55, 0.78, 0.62), (0.66, 0.58, 0.84))
    crate: Color = (0.98, 0.93, 0.84)
    outline: Color = (0.20, 0.20, 0.23)
    move: Color = (0.33, 0.33, 0.37)
    subgoal: Color = (0.55, 0.55, 0.58)
    badge: Color = (1.0, 1.0, 1.0)
    outline_width: float = 1.5
    move_width: float = 1.8
    carry_width: float = 4.5
    text_height: float = 15.0
    ghost_opacity: float = 0.28
    good: Color = (0.16, 0.62, 0.27)
    bad: Color = (0.82, 0.20, 0.18)
    neutral: Color = (0.62, 0.62, 0.66)
    low_score: Color = (1.0, 0.93, 0.62)
    high_score: Color = (0.49, 0.05, 0.47)
    own_colors: bool = True


PAPER = Theme()
"""Colours after the pictures in Levit et al. (ICRA 2024): brown walls, yellow agent, blue goal-object, red goal."""


COLORBLIND = Theme(
    floor=(0.96, 0.96, 0.96),
    floor_line=(0.87, 0.87, 0.87),
    wall=(0.42, 0.42, 0.42),
    wall_light=(0.53, 0.53, 0.53),
    wall_dark=(0.24, 0.24, 0.24),
    agent=(0.94, 0.89, 0.26),
    goal=(0.84, 0.37, 0.0),
    goal_dark=(0.48, 0.20, 0.0),
    goal_object=(0.0, 0.45, 0.70),
    obstacles=((1.0, 1.0, 1.0), (0.34, 0.71, 0.91), (0.80, 0.47, 0.65), (0.0, 0.62, 0.45)),
    outline=(0.0, 0.0, 0.0),
    good=(0.0, 0.45, 0.70),
    bad=(0.84, 0.37, 0.0),
    own_colors=False,
)
"""Colours of Okabe and Ito (2008), which people with any kind of colour vision tell apart; walls are grey."""

THEMES = {"paper": PAPER, "colorblind": COLORBLIND}


def theme_named(name: str) -> Theme:
    """The theme called `name`.

    Raises:
        InputError: there is none.
    """
    if name not in THEMES:
        raise InputError("theme", f"found {name!r}, allowed are {', '.join(THEMES)}")
    return THEMES[name]


def mixed(color: Color, other: Color, share: float) -> Color:
    """`color` with a `share` of `other`, 0..1."""
    red, green, blue = ((1 - share) * a + share * b for a, b in zip(color, other, strict=True))
    return red, green, blue

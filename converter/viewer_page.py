"""The viewer: a page that plays plans in a browser, and its parts for embedding in other pages.

A page holds everything it needs and asks the network for nothing; its Content-Security-Policy forbids that, and any
script but its own. Plans reach the player as JSON, which it draws as SVG, so names of scenes and methods are text and
never markup.

To embed a player in another page, put `player_assets()` into it once, `embedded_json([plan_payload(scene, plan)])` into
a `<script type="application/json">`, and call in the browser

    ManipuzzlePlayer.mount(element, payloads)

with the parsed JSON: one payload, or a list whose plans are played side by side by one clock. It returns the player,
with `play() pause() toggle() seek(seconds) step(1 | -1) setSpeed(factor) showPath(on) showSubgoals(on) destroy()` and
`time duration playing speed`.
"""

import base64
import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import jinja2
import numpy as np

from converter.animate_plan import FIRST_REST_S, HELD_OUTLINE, LAST_REST_S, REST_S
from converter.drawing import Shape
from converter.plan import Plan
from converter.render_plan import Placement, carries_of, placements
from converter.render_scene import agent_shape, body_shape, object_color, room_drawing
from converter.replay import replay
from converter.scene import Body, Scene
from converter.shape import FloatArray, rounded
from converter.svg import Frame, hex_color, path_data
from converter.theme import PAPER, Theme
from pcg.files import write_text

DIGITS = 5
"""Decimals of positions [m] in the page."""

_FRAME = Frame(digits=DIGITS)
"""Of paths in the page: metres, y down."""


@dataclass(frozen=True)
class PlayerAssets:
    """What a page with players needs once.

    Attributes:
        style: The text of a `<style>` element.
        script: The text of a `<script>` element; it defines `ManipuzzlePlayer`.
    """

    style: str
    script: str


@cache
def player_assets() -> PlayerAssets:
    """Style and script of the player."""
    folder = files("converter") / "viewer"
    style, script = (folder.joinpath(name).read_text(encoding="utf-8") for name in ("player.css", "player.js"))
    return PlayerAssets(style, script)


def plan_payload(scene: Scene, plan: Plan, *, theme: Theme = PAPER) -> dict[str, Any]:
    """The plain values that the player needs to play `plan`, for `json.dumps`.

    Raises:
        InputError: the plan carries an object that the scene does not have.
    """
    room = room_drawing(scene, theme)
    (left, low), (right, high) = room.lower, room.upper
    steps = replay(scene, plan)
    agent = agent_shape(scene, np.zeros(2), room.unit, theme)
    return {
        "scene": scene.name,
        "method": plan.method,
        "seed": plan.seed,
        "status": plan.status.value,
        "time_s": plan.time_s,
        "path_length_m": plan.path_length,
        "pick_places": plan.pick_places,
        "view": _rounded(np.array([left, -high, right - left, high - low])),
        "unit": room.unit,
        "colors": {name: hex_color(getattr(theme, name)) for name in ("page", "outline", "move", "badge", "subgoal")},
        "widths": {"move": theme.move_width, "carry": theme.carry_width, "text": theme.text_height},
        "held_outline": HELD_OUTLINE,
        "rests_s": {"first": FIRST_REST_S, "step": REST_S, "last": LAST_REST_S},
        "room": [_shape(item) for item in room.items if isinstance(item, Shape)],
        "objects": [_object(scene, body, room.unit, theme) for body in scene.objects],
        "agent": {"start": _rounded(scene.agent.position), **_shape(agent)},
        "segments": [{"carried": step.carried, "path": _rounded(step.segment.path)} for step in steps],
        "placements": [_placement(scene, place) for place in placements(carries_of(scene, steps))],
    }


def _object(scene: Scene, body: Body, unit: float, theme: Theme) -> dict[str, Any]:
    shape = body_shape(body, object_color(scene, body, theme), unit, theme, np.zeros(2))
    return {"name": body.name, "start": _rounded(body.position[:2]), **_shape(shape)}


def _placement(scene: Scene, place: Placement) -> dict[str, Any]:
    return {
        "object": scene.object_names.index(place.body.name),
        "position": _rounded(place.position),
        "numbers": list(place.numbers),
    }


def embedded_json(value: Any) -> str:
    """`value` as JSON that may stand inside a `<script>` element: nothing in it can end the element."""
    text = json.dumps(value, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")


def viewer_page(title: str, payloads: Sequence[dict[str, Any]]) -> str:
    """A page that plays the plans of `payloads` side by side, as the text of an HTML file."""
    assets = player_assets()
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("converter", "viewer"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
    )
    return environment.get_template("page.html.j2").render(
        title=title,
        assets=assets,
        style_hash=content_hash(assets.style),
        script_hash=content_hash(assets.script),
        data=embedded_json(list(payloads)),
    )


def write_viewer(path: Path, title: str, payloads: Sequence[dict[str, Any]]) -> None:
    """Writes the page of `viewer_page`.

    Raises:
        InputError: the file cannot be written.
    """
    write_text(path, viewer_page(title, payloads))


def _shape(shape: Shape) -> dict[str, Any]:
    """Outline and fill are apart, because a shape may have several parts whose outlines would cross others."""
    return {
        "d": path_data(shape.parts, _FRAME),
        "around": path_data(shape.parts, _FRAME, shape.outline_width),
        "held": path_data(shape.parts, _FRAME, HELD_OUTLINE * shape.outline_width),
        "fill": hex_color(shape.fill),
        "outline": hex_color(shape.outline),
    }


def _rounded(values: FloatArray) -> Any:
    return rounded(values, DIGITS).tolist()


def content_hash(text: str) -> str:
    """What a Content-Security-Policy calls the text of an element."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()

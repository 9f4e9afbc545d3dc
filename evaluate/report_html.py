"""The report as one HTML page that holds everything and asks the network for nothing.

Names of scenes and methods may hold anything: the template escapes them, and the page's script writes them as text. Its
Content-Security-Policy lets no script run but the page's own.

Pictures and plans are stored compressed and are unpacked when they are shown, so a page with a thousand scenes opens at
once; budgets keep it small enough to be sent by mail.
"""

import base64
import json
import zlib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import jinja2

from converter.render_scene import scene_drawing
from converter.svg import svg_text
from converter.viewer_page import content_hash, embedded_json, plan_payload, player_assets
from evaluate.plot_style import inline_svg
from evaluate.report import GalleryScene, Report
from evaluate.table import Table
from pcg.files import write_text

PICTURE_BUDGET, PLAN_BUDGET = 4_000_000, 8_000_000
"""Bytes of the page for pictures of scenes and for plans; scenes that come later do without."""

MAX_SCENES = 3_000
"""Scenes in the gallery."""

CELL_BUDGET = 12_000
"""Cells of one table; longer tables are cut in the page and whole in their files."""

PICTURE_WIDTH = 160

SECTIONS = (
    ("methods", "Methods", ("methods", "comparisons"), ("solved-within",)),
    ("scenes", "Scenes", ("times", "plans", "facts"), ("times",)),
    ("success", "Success by kinds of scenes", ("success-",), ("success",)),
)
"""Anchor and title of each section, and the beginnings of the names of its tables and plots."""


@dataclass(frozen=True)
class _Plot:
    name: str
    title: str
    note: str
    svg: str


@dataclass(frozen=True)
class _Section:
    id: str
    title: str
    tables: tuple[Table, ...] = ()
    plots: tuple[_Plot, ...] = ()


def write_page(path: Path, report: Report, scenes: Iterable[GalleryScene]) -> None:
    """Writes the page.

    Raises:
        InputError: the file cannot be written, or a stored plan is damaged.
    """
    write_text(path, page(report, scenes))


def page(report: Report, scenes: Iterable[GalleryScene]) -> str:
    """The text of the page."""
    stored = _Stored()
    tiles = [stored.tile(scene) for scene, _ in zip(scenes, range(MAX_SCENES), strict=False)]
    sections = [*_sections(report), _Section("gallery", "Gallery")]
    script = _text("report.js")
    player = player_assets()
    return (
        _environment()
        .get_template("page.html.j2")
        .render(
            report=report,
            sections=sections,
            row_limit=_row_limit,
            left_out=_left_out(len(report.scenes), len(tiles), stored),
            scenes=embedded_json({"methods": report.methods, "scenes": tiles}),
            player=player,
            style=_text("report.css"),
            script=script,
            script_hashes=[content_hash(player.script), content_hash(script)],
        )
    )


class _Stored:
    """Pictures and plans within their budgets."""

    def __init__(self) -> None:
        self._pictures, self._plans = PICTURE_BUDGET, PLAN_BUDGET
        self.without_plan = 0

    def tile(self, scene: GalleryScene) -> dict[str, Any]:
        """The plain values of a scene in the gallery."""
        picture = _compressed(svg_text(scene_drawing(scene.scene), PICTURE_WIDTH))
        self._pictures -= len(picture)
        return {
            "name": scene.name,
            "runs": scene.runs,
            "occluded": scene.occluded,
            "picture": picture if self._pictures >= 0 else "",
            "plan": self._plan(scene),
            "caption": _caption(scene),
        }

    def _plan(self, scene: GalleryScene) -> str:
        if scene.plan is None:
            return ""
        packed = _compressed(json.dumps(plan_payload(scene.scene, scene.plan), allow_nan=False, separators=(",", ":")))
        if len(packed) > self._plans:
            self.without_plan += 1
            return ""
        self._plans -= len(packed)
        return packed


def _caption(scene: GalleryScene) -> str:
    if scene.plan is None:
        return ""
    plan = scene.plan
    times = "pick-place" if plan.pick_places == 1 else "pick-places"
    return f"Best plan of the study: {plan.method}, seed {plan.seed}, {plan.pick_places} {times}, {plan.path_length:.1f} m."


def _left_out(scenes: int, shown: int, stored: _Stored) -> str:
    parts = []
    if shown < scenes:
        parts.append(f"The gallery shows the first {shown} of {scenes} scenes.")
    if stored.without_plan:
        parts.append(f"{stored.without_plan} plans are left out to keep this page small.")
    return " ".join(parts)


def _sections(report: Report) -> list[_Section]:
    found = []
    for anchor, title, tables, plots in SECTIONS:
        section = _Section(
            anchor,
            title,
            tuple(table for table in report.tables if table.name.startswith(tables)),
            tuple(
                _Plot(plot.name, plot.title, plot.note, inline_svg(plot.figure, plot.name))
                for plot in report.plots
                if plot.name in plots
            ),
        )
        if section.tables or section.plots:
            found.append(section)
    return found


def _row_limit(table: Table) -> int:
    return max(CELL_BUDGET // len(table.columns), 1)


def _compressed(text: str) -> str:
    return base64.b64encode(zlib.compress(text.encode(), 9)).decode()


@cache
def _environment() -> jinja2.Environment:
    return jinja2.Environment(
        loader=jinja2.PackageLoader("evaluate", "report_page"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
    )


@cache
def _text(name: str) -> str:
    return (files("evaluate") / "report_page" / name).read_text(encoding="utf-8")

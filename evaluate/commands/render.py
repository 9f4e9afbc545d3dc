"""`manipuzzle render`: pictures, animations and pages of levels, scenes and plans."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from converter.scene import Scene
from converter.theme import THEMES
from evaluate.commands.options import Json, Out, SceneOfPlans, Theme, application
from evaluate.inputs import (
    PLAN_SUFFIXES,
    SCENE_SUFFIXES,
    expanded,
    is_level_set,
    read_scene_file,
    require_choice,
    require_writable,
)
from evaluate.names import require_distinct, safe_name
from evaluate.output import counted, print_json, print_line, print_table, progress
from evaluate.picture_files import FORMATS, PAGE, STILL, Picture, Style, write_pictures
from evaluate.subjects import Subject, as_storyboard, read_subjects
from pcg.errors import InputError

app = application()

SHEET = "sheet"
"""Stem of the file of a contact sheet."""


@app.command()
def run(
    inputs: Annotated[
        list[Path],
        typer.Argument(
            metavar="LEVEL|SCENE|PLAN",
            help="XSB files, level sets, scenes, plans, folders of scenes and plans, trials DIR#KEY of studies.",
        ),
    ],
    *,
    out: Out,
    format_: Annotated[
        str, typer.Option("--format", metavar="NAME", help="png or svg; of plans also gif, mp4, or html: a player.")
    ] = "png",
    sheet: Annotated[bool, typer.Option("--sheet", help="One contact sheet with names and verdicts.")] = False,
    storyboard: Annotated[bool, typer.Option("--storyboard", help="The key frames of plans: each grasp.")] = False,
    theme: Theme = "paper",
    width: Annotated[
        int | None, typer.Option(metavar="PIXELS", min=16, help="Width of pictures and frames.", show_default=False)
    ] = None,
    speed: Annotated[
        float, typer.Option(metavar="M/S", min=0.01, max=1000, help="Speed of the agent in animations.")
    ] = 1.0,
    scene: SceneOfPlans = None,
    json: Json = False,
) -> bool:
    """Draw levels, scenes and plans to DIR/{name}.{format}, or with --sheet all of them to DIR/sheet.{format}.

    html makes a page that plays plans, those of one scene side by side, without a network.

    Example:  manipuzzle render out/plans/*.json --out out/pictures --format gif
    """
    style = Style(theme=theme, width_px=width, speed=speed)
    request = Request(format_, scene, style, sheet=sheet, storyboard=storyboard)
    _require_possible(request)
    given = None if scene is None else read_scene_file(scene)
    subjects = [subject for path in drawn_files(inputs) for subject in _subjects(path, request, given)]
    pictures = _pictures(subjects, out, request)
    require_distinct([picture.file.stem for picture in pictures], "inputs")
    require_writable(out)
    with progress() as bar:
        for _ in bar.track(write_pictures(pictures), description="pictures", total=len(pictures)):
            pass
    if json:
        print_json({"pictures": [{"name": picture.file.stem, "file": str(picture.file)} for picture in pictures]})
    else:
        print_table(["name", "file"], [(picture.file.stem, str(picture.file)) for picture in pictures])
        print_line(f"{counted(len(pictures), 'file')} written to {out}")
    return True


@dataclass(frozen=True)
class Request:
    """Options of the command.

    Attributes:
        format: One of `FORMATS`.
        scene: Scene file of plans that hold none.
        style: Theme, width and speed.
        sheet: All inputs on one contact sheet.
        storyboard: Key frames of plans.
    """

    format: str
    scene: Path | None
    style: Style
    sheet: bool = False
    storyboard: bool = False


def _require_possible(request: Request) -> None:
    require_choice("--format", request.format, FORMATS)
    require_choice("--theme", request.style.theme, list(THEMES))
    if request.sheet and request.storyboard:
        raise InputError("--sheet", "a sheet shows whole plans; leave out --sheet or --storyboard")
    for option, wanted in (("--sheet", request.sheet), ("--storyboard", request.storyboard)):
        if wanted and request.format not in STILL:
            raise InputError(option, f"makes a picture; --format must be {' or '.join(STILL)}, found {request.format}")


def drawn_files(paths: Iterable[Path]) -> Iterator[Path]:
    """The inputs, each level set as it is, and of other folders the scenes and plans in them.

    Raises:
        InputError: a folder holds none.
    """
    for path in paths:
        yield from (path,) if is_level_set(path) else expanded([path], (*SCENE_SUFFIXES, *PLAN_SUFFIXES))


def _subjects(path: Path, request: Request, given: Scene | None) -> Iterable[Subject]:
    for subject in read_subjects(path, given):
        if request.format not in STILL and subject.motion is None:
            raise InputError(str(path), f"{request.format} shows plans in motion; draw {subject.kind}s as png or svg")
        yield as_storyboard(subject) if request.storyboard else subject


def _pictures(subjects: Sequence[Subject], out: Path, request: Request) -> list[Picture]:
    """The files to write: one for each input, for each scene of a page, or for all."""
    if request.sheet:
        groups = {SHEET: list(subjects)}
    elif request.format == PAGE:
        groups = _pages(subjects)
    else:
        require_distinct([subject.name for subject in subjects], "inputs")
        groups = {subject.name: [subject] for subject in subjects}
    return [
        Picture(out / f"{name}.{request.format}", tuple(group), request.style, is_sheet=request.sheet)
        for name, group in groups.items()
    ]


def _pages(subjects: Sequence[Subject]) -> dict[str, list[Subject]]:
    """Plans of one scene share a page, called after the scene, or after the plan if it is the only one."""
    by_scene: dict[tuple[str, str], list[Subject]] = {}
    for subject in subjects:
        if subject.motion is not None:
            scene = subject.motion.scene
            by_scene.setdefault((scene.name, scene.geometry_hash), []).append(subject)
    pages: dict[str, list[Subject]] = {}
    for (scene_name, _), group in by_scene.items():
        name = group[0].name if len(group) == 1 else safe_name(scene_name)
        require_distinct([*pages, name], "pages")
        pages[name] = group
    return pages

"""Writing the pictures of the command `render`, in several processes where that is faster."""

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from converter.animate_plan import plan_frames
from converter.drawing import Drawing
from converter.image_file import write_gif, write_png
from converter.raster import Image, paint
from converter.sheet import Card, sheet_drawing, sheet_width_px
from converter.svg import write_svg
from converter.theme import theme_named
from converter.video import write_mp4
from converter.viewer_page import plan_payload, write_viewer
from evaluate.inputs import require_choice
from evaluate.subjects import Motion, Subject
from evaluate.workers import Failure, Job, WorkerStartError, run_tasks
from pcg.errors import InputError

GIF_FPS = 20
MP4_FPS = 30
FRAME_PX = 480
"""Width of the frames of animations."""

STILL, MOVING, PAGE = ("png", "svg"), ("gif", "mp4"), "html"
FORMATS = (*STILL, *MOVING, PAGE)

WORTH_A_PROCESS = 20
"""Pictures that take a process as long as its start; an animation counts as many."""

MAX_SECONDS = 3600.0
"""Longest that a picture may take in a process of its own."""


@dataclass(frozen=True)
class Style:
    """How pictures are made.

    Attributes:
        theme: Name of the theme.
        width_px: Width of pictures and frames; None for that which suits them.
        speed: Of the agent in animations [m/s].
    """

    theme: str = "paper"
    width_px: int | None = None
    speed: float = 1.0


@dataclass(frozen=True, eq=False)
class Picture:
    """A file to be written.

    Attributes:
        file: Its path; the suffix is its format.
        subjects: What it shows; several only in pages and sheets.
        style: How it is made.
        is_sheet: Whether it is a contact sheet.
    """

    file: Path
    subjects: tuple[Subject, ...]
    style: Style
    is_sheet: bool = False

    @property
    def format(self) -> str:
        """One of `FORMATS`."""
        return self.file.suffix.removeprefix(".")


def require_still(format_: str) -> None:
    """Refuses formats that are not for still pictures.

    Raises:
        InputError: naming the allowed ones.
    """
    require_choice("--format", format_, STILL)


def write_drawing(file: Path, drawing: Drawing, width_px: int, title: str) -> None:
    """Writes a drawing as PNG or, with its title, as SVG; as the suffix of `file` says.

    Raises:
        InputError: the picture would be too large, or the file cannot be written.
    """
    if file.suffix == ".svg":
        write_svg(file, drawing, width_px, title=title)
    else:
        write_png(file, paint(drawing, width_px))


def write_picture(picture: Picture) -> None:
    """Writes one file.

    Raises:
        InputError: the picture would be too large or the animation too long, or the file cannot be written.
    """
    _WRITERS[picture.format](picture)


def draw_to_file(subject: Subject, file: Path) -> None:
    """Writes the picture, animation or page of `subject`, as the suffix of `file` says.

    Raises:
        InputError: as `write_picture`.
    """
    write_picture(Picture(file, (subject,), Style()))


def write_pictures(pictures: Sequence[Picture]) -> Iterator[Picture]:
    """Writes the files, and yields each when it is there.

    Raises:
        InputError: as `write_picture`, for the first one that fails.
    """
    workers = _workers(pictures)
    if workers == 1:
        for picture in pictures:
            write_picture(picture)
            yield picture
        return
    job: Job[Picture, str | None] = Job(_attempt, _failed, lambda _: MAX_SECONDS)
    try:
        for picture, problem in run_tasks(job, iter(pictures), workers):
            if problem is not None:
                raise InputError("", problem)
            yield picture
    except WorkerStartError as error:
        raise InputError("render", str(error)) from None


def _workers(pictures: Sequence[Picture]) -> int:
    """As many processes as there are cores, if there is work for them."""
    work = sum(WORTH_A_PROCESS if picture.format in MOVING else 1 for picture in pictures)
    return max(1, min(len(os.sched_getaffinity(0)), work // WORTH_A_PROCESS, len(pictures)))


def _attempt(picture: Picture) -> str | None:
    """The problem, if there is one, as text: exceptions lose their form on the way between processes."""
    try:
        write_picture(picture)
    except InputError as error:
        return str(error)
    return None


def _failed(picture: Picture, failure: Failure) -> str:
    return f"{picture.file}: {failure.message}"


def _drawing(picture: Picture) -> tuple[Drawing, int]:
    """A still picture and its width [px]."""
    theme = theme_named(picture.style.theme)
    if picture.is_sheet:
        drawing = _sheet(picture)
        width_px = None
    else:
        (subject,) = picture.subjects
        drawing = subject.draw(theme=theme)
        width_px = subject.width_px
    return drawing, picture.style.width_px or width_px or sheet_width_px(drawing)


def _sheet(picture: Picture) -> Drawing:
    theme = theme_named(picture.style.theme)
    cards, good = [], 0
    for subject in picture.subjects:
        verdict = subject.judge()
        good += verdict.good
        cards.append(Card(subject.name, subject.draw(theme=theme), *verdict))
    return sheet_drawing(cards, heading=_heading(picture.subjects, good), theme=theme)


def _heading(subjects: Sequence[Subject], good: int) -> str:
    kinds = {subject.kind for subject in subjects}
    kind = kinds.pop() if len(kinds) == 1 else "picture"
    praise = {"level": "solvable", "scene": "valid", "plan": "verified"}.get(kind, "good")
    return f"{len(subjects)} {kind}{'' if len(subjects) == 1 else 's'}, {good} {praise}"


def _still(picture: Picture) -> None:
    subject = picture.subjects[0]
    title = "contact sheet" if picture.is_sheet else f"{subject.kind} {subject.name}"
    write_drawing(picture.file, *_drawing(picture), title)


def _motion_of(subject: Subject) -> Motion:
    if subject.motion is None:
        raise ValueError(f"a {subject.kind} does not move")
    return subject.motion


def _gif(picture: Picture) -> None:
    write_gif(picture.file, _frames(picture, GIF_FPS), GIF_FPS)


def _mp4(picture: Picture) -> None:
    write_mp4(picture.file, _frames(picture, MP4_FPS), MP4_FPS)


def _frames(picture: Picture, fps: int) -> Iterator[Image]:
    style = picture.style
    width_px, theme = style.width_px or FRAME_PX, theme_named(style.theme)
    return plan_frames(*_motion_of(picture.subjects[0]), fps=fps, speed=style.speed, width_px=width_px, theme=theme)


def _html(picture: Picture) -> None:
    motions = [_motion_of(subject) for subject in picture.subjects]
    theme = theme_named(picture.style.theme)
    write_viewer(picture.file, motions[0].scene.name, [plan_payload(*motion, theme=theme) for motion in motions])


_WRITERS: dict[str, Callable[[Picture], None]] = {"png": _still, "svg": _still, "gif": _gif, "mp4": _mp4, "html": _html}

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import PIL.Image
import pytest

from converter.animate_plan import plan_frames
from converter.image_file import write_gif, write_png
from converter.plan import Plan
from converter.raster import Image, paint
from converter.render_scene import scene_drawing
from converter.scene import Scene
from pcg.errors import InputError


def moving_square(count: int) -> list[Image]:
    """Frames in which a red square moves right by one pixel each."""
    frames = np.full((count, 24, 40, 3), 240, dtype=np.uint8)
    for i, frame in enumerate(frames):
        frame[8:16, i : i + 8] = (220, 40, 30)
    return list(frames)


def gif_frames(path: Path) -> tuple[list[Image], list[int]]:
    """The frames of a file as images, and their durations [ms]."""
    with PIL.Image.open(path) as file:
        images, durations = [], []
        for i in range(file.n_frames):
            file.seek(i)
            images.append(np.asarray(file.convert("RGB")))
            durations.append(file.info["duration"])
        return images, durations


def test_png_keeps_every_pixel(tmp_path: Path, small_room: Scene):
    """What is read back is what was written, red as red."""
    image = paint(scene_drawing(small_room), 200)
    write_png(tmp_path / "scene.png", image)
    assert np.array_equal(cv2.imread(str(tmp_path / "scene.png"))[..., ::-1], image)


def test_png_bytes_are_the_same_each_time(tmp_path: Path, small_room: Scene):
    """The same scene gives the same file, byte for byte."""
    for name in ("a.png", "b.png"):
        write_png(tmp_path / name, paint(scene_drawing(small_room), 200))
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_files_get_missing_folders_and_leave_nothing_else(tmp_path: Path):
    """Folders are made, names need not be ASCII, and no temporary file stays."""
    write_png(tmp_path / "neu" / "Größe.png", np.zeros((2, 2, 3), dtype=np.uint8))
    write_gif(tmp_path / "neu" / "Größe.gif", moving_square(2), fps=10)
    assert sorted(path.name for path in (tmp_path / "neu").iterdir()) == ["Größe.gif", "Größe.png"]


@pytest.mark.parametrize("write", [write_png, lambda path, image: write_gif(path, [image], 10)])
def test_unwritable_place_is_an_error_for_the_user(tmp_path: Path, write: Callable[[Path, Image], None]):
    """A file where a folder is needed is named."""
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        write(tmp_path / "file" / "image", np.zeros((2, 2, 3), dtype=np.uint8))


def test_gif_has_every_frame(tmp_path: Path):
    """Number, size, colours and durations of the frames are those that were given; it repeats for ever."""
    frames = moving_square(12)
    write_gif(tmp_path / "a.gif", iter(frames), fps=20)
    images, durations = gif_frames(tmp_path / "a.gif")
    assert np.array_equal(images, frames)
    assert durations == [50] * 12
    with PIL.Image.open(tmp_path / "a.gif") as file:
        assert file.info["loop"] == 0


def test_gif_keeps_the_whole_time(tmp_path: Path):
    """With 30 frames a second, which the format cannot express, the whole still takes its second."""
    write_gif(tmp_path / "a.gif", moving_square(30), fps=30)
    _, durations = gif_frames(tmp_path / "a.gif")
    assert set(durations) == {30, 40}
    assert sum(durations) == 1000


def test_gif_merges_equal_frames(tmp_path: Path):
    """A rest is one frame that is shown for longer."""
    still, moved = moving_square(2)
    write_gif(tmp_path / "a.gif", [still] * 10 + [moved] * 5, fps=10)
    images, durations = gif_frames(tmp_path / "a.gif")
    assert np.array_equal(images, [still, moved])
    assert durations == [1000, 500]


def test_gif_of_a_plan_is_small_and_true(tmp_path: Path, small_room: Scene, small_plan: Plan):
    """A plan's animation stays below a megabyte, shows each frame nearly as painted, and is the same each time."""
    frames = list(plan_frames(small_room, small_plan, fps=10))
    for name in ("a.gif", "b.gif"):
        write_gif(tmp_path / name, frames, fps=10)
    data = (tmp_path / "a.gif").read_bytes()
    assert data == (tmp_path / "b.gif").read_bytes()
    assert len(data) < 1_000_000
    images, durations = gif_frames(tmp_path / "a.gif")
    assert images[0].shape == frames[0].shape
    assert sum(durations) == 100 * len(frames)
    for image, frame in ((images[0], frames[0]), (images[-1], frames[-1])):
        assert np.abs(image.astype(int) - frame).mean() < 0.5


@pytest.mark.parametrize("fps", [0, -1, 51])
def test_gif_refuses_rates_that_viewers_ignore(tmp_path: Path, fps: int):
    """Frame rates that GIF cannot hold are an error that says what is allowed."""
    with pytest.raises(InputError, match=f"fps: {fps} frames a second; a GIF allows 1 to 50"):
        write_gif(tmp_path / "a.gif", moving_square(2), fps)


def test_gif_needs_a_frame(tmp_path: Path):
    """An animation of nothing is a programmer's mistake, and leaves no file."""
    with pytest.raises(ValueError, match="at least one frame"):
        write_gif(tmp_path / "a.gif", [], fps=10)
    assert list(tmp_path.iterdir()) == []

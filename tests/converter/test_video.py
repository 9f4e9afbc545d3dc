"""Videos, decoded by OpenCV, whose decoder is FFmpeg's."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from converter.animate_plan import plan_frames
from converter.h264 import KEY_FRAME_S, H264Encoder
from converter.plan import Plan
from converter.raster import Image
from converter.scene import Scene
from converter.video import write_mp4
from pcg.errors import InputError


def decoded(path: Path) -> list[Image]:
    """The frames of a file, red-green-blue."""
    video = cv2.VideoCapture(str(path))
    frames = []
    while (found := video.read())[0]:
        frames.append(np.asarray(found[1], dtype=np.uint8)[..., ::-1])
    return frames


def random_frames(count: int, height: int, width: int) -> list[Image]:
    """Frames of grey noise in which some parts stay, some are flat, some striped."""
    rng = np.random.default_rng(0)
    frame = np.full((height, width, 3), 128, dtype=np.uint8)
    frames = []
    for _ in range(count):
        row, column = rng.integers(0, height - 8), rng.integers(0, width - 8)
        patch = frame[row : row + 24, column : column + 40]
        kind = rng.integers(4)
        noise = rng.integers(0, 256, patch.shape[:2])
        grey = [noise, np.full_like(noise, noise[0, 0]), noise[:1] + 0 * noise, noise[:, :1] + 0 * noise][kind]
        patch[:] = grey[..., np.newaxis]
        frames.append(frame.copy())
    return frames


@pytest.mark.parametrize(("height", "width"), [(64, 96), (50, 38), (17, 33)])
def test_frames_come_back(tmp_path: Path, height: int, width: int):
    """Grey pictures of any size come back to the rounding of the colours, whatever stays, moves or is flat."""
    frames = random_frames(40, height, width)
    write_mp4(tmp_path / "a.mp4", iter(frames), fps=25)
    found = decoded(tmp_path / "a.mp4")
    assert len(found) == 40
    assert found[0].shape == (height + height % 2, width + width % 2, 3)
    errors = [np.abs(a[:height, :width].astype(int) - b).max() for a, b in zip(found, frames, strict=True)]
    assert max(errors) <= 2


def test_a_plan_is_small_and_true(tmp_path: Path, small_room: Scene, small_plan: Plan):
    """A plan's video stays below a megabyte and shows each frame nearly as painted; it is the same each time."""
    frames = list(plan_frames(small_room, small_plan, fps=15, width_px=160))
    for name in ("a.mp4", "b.mp4"):
        write_mp4(tmp_path / name, frames, fps=15)
    data = (tmp_path / "a.mp4").read_bytes()
    assert data == (tmp_path / "b.mp4").read_bytes()
    assert len(data) < 1_000_000
    found = decoded(tmp_path / "a.mp4")
    assert len(found) == len(frames)
    assert max(np.abs(a.astype(int) - b).mean() for a, b in zip(found, frames, strict=True)) < 2


def test_players_learn_rate_and_size(tmp_path: Path):
    """What a player reads from the file's index is right, and the index stands before the pictures."""
    write_mp4(tmp_path / "a.mp4", random_frames(30, 48, 64), fps=30)
    video = cv2.VideoCapture(str(tmp_path / "a.mp4"))
    found = [video.get(key) for key in (cv2.CAP_PROP_FPS, cv2.CAP_PROP_FRAME_COUNT, cv2.CAP_PROP_FRAME_WIDTH)]
    assert found == [30, 30, 64]
    code = int(video.get(cv2.CAP_PROP_FOURCC)).to_bytes(4, "little")
    assert code in {b"avc1", b"h264"}
    data = (tmp_path / "a.mp4").read_bytes()
    assert data.index(b"moov") < data.index(b"mdat")


def test_players_can_start_in_the_middle():
    """Every ten seconds there is a frame that needs no other one."""
    encoder = H264Encoder(32, 32, fps=2)
    frames = random_frames(45, 32, 32)
    keys = [i for i, frame in enumerate(frames) if encoder.encode(frame)[1]]
    assert keys == [0, int(2 * KEY_FRAME_S), int(4 * KEY_FRAME_S)]


def test_what_stands_still_costs_nothing():
    """A frame equal to the one before is a few bytes."""
    encoder = H264Encoder(320, 320, fps=30)
    frame = random_frames(3, 320, 320)[-1]
    first, second = encoder.encode(frame)[0], encoder.encode(frame)[0]
    assert len(second) < 20 < len(first)


def test_no_unit_looks_like_two():
    """Three bytes 0, 0, 0..2, which begin a unit, never occur inside of one."""
    encoder = H264Encoder(64, 64, fps=30)
    frame = np.zeros((64, 64, 3), dtype=np.uint8)
    units = [encoder.sps, encoder.pps, *(encoder.encode(f)[0] for f in (frame, frame, random_frames(9, 64, 64)[-1]))]
    assert all(bytes([0, 0, last]) not in unit for unit in units for last in range(3))


@pytest.mark.parametrize("fps", [0, -1, 121])
def test_impossible_rates_are_refused(tmp_path: Path, fps: int):
    """With what is allowed."""
    with pytest.raises(InputError, match=f"fps: {fps} frames a second; a video allows 1 to 120"):
        write_mp4(tmp_path / "a.mp4", random_frames(2, 32, 32), fps)


def test_frames_too_large_for_the_format_are_refused():
    """Before anything is encoded."""
    with pytest.raises(InputError, match=r"too large for H\.264"):
        H264Encoder(8000, 8000, fps=30)


def test_a_video_needs_a_frame(tmp_path: Path):
    """An animation of nothing is a programmer's mistake, and leaves no file."""
    with pytest.raises(ValueError, match="at least one frame"):
        write_mp4(tmp_path / "a.mp4", [], fps=10)
    assert list(tmp_path.iterdir()) == []

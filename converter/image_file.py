"""Writing images: PNG, and animated GIF."""

from collections.abc import Iterable
from itertools import chain
from pathlib import Path

import cv2
import numpy as np
import PIL.Image

from converter.raster import Image
from pcg.errors import InputError
from pcg.files import replacing

FPS_RANGE = (1, 50)
"""Frames a second that viewers of GIF files play as they are told."""


PNG_COMPRESSION = 6
"""Files are hardly larger than with 9, and written in half the time."""


def write_png(path: Path, image: Image) -> None:
    """Writes an image; equal images give equal bytes.

    Raises:
        InputError: the file cannot be written.
    """
    _, encoded = cv2.imencode(".png", image[..., ::-1], [cv2.IMWRITE_PNG_COMPRESSION, PNG_COMPRESSION])
    with replacing(path) as temporary:
        temporary.write_bytes(encoded.tobytes())


def write_gif(path: Path, frames: Iterable[Image], fps: int) -> None:
    """Writes an animation that repeats for ever; equal frames in a row become one that is shown for longer.

    All frames share the 256 colours that suit the first one best.

    Args:
        path: The file.
        frames: Images of one size, at least one; they are taken one by one.
        fps: Frames a second, 1 to 50. The file counts time in hundredths of a second, so that with 30 frames a
            second a frame is shown for 30 or 40 ms, and the whole for the right time.

    Raises:
        InputError: `fps` is out of range, or the file cannot be written.
        ValueError: there are no frames.
    """
    if not FPS_RANGE[0] <= fps <= FPS_RANGE[1]:
        raise InputError("fps", f"{fps} frames a second; a GIF allows {FPS_RANGE[0]} to {FPS_RANGE[1]}")
    rest = iter(frames)
    first = next(rest, None)
    if first is None:
        raise ValueError("an animation needs at least one frame")
    palette = PIL.Image.fromarray(first).quantize(dither=PIL.Image.Dither.NONE)
    indexed = [_indexed(frame, palette) for frame in chain([first], rest)]
    durations_ms = np.diff(np.rint(np.arange(len(indexed) + 1) * 100 / fps)).astype(int) * 10
    with replacing(path) as temporary:
        indexed[0].save(
            temporary,
            format="GIF",
            save_all=True,
            append_images=indexed[1:],
            duration=durations_ms.tolist(),
            loop=0,
        )


def _indexed(frame: Image, palette: PIL.Image.Image) -> PIL.Image.Image:
    return PIL.Image.fromarray(frame).quantize(palette=palette, dither=PIL.Image.Dither.NONE)

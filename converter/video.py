"""Writing videos: H.264 in an MP4 file (ISO/IEC 14496-12 and -15), which plays everywhere."""

import struct
from collections.abc import Iterable, Sequence
from itertools import chain
from pathlib import Path

from converter.h264 import CONSTRAINT_FLAGS, PROFILE_IDC, H264Encoder
from converter.raster import Image
from pcg.errors import InputError
from pcg.files import replacing

FPS_RANGE = (1, 120)

_UNITY = struct.pack(">9I", 0x10000, 0, 0, 0, 0x10000, 0, 0, 0, 0x40000000)
"""The transformation that leaves pictures as they are."""

_UNDETERMINED = 0x55C4
"""Language of a track without one."""


def write_mp4(path: Path, frames: Iterable[Image], fps: int) -> None:
    """Writes a video; equal frames give equal bytes.

    Args:
        path: The file.
        frames: Images of one size, at least one; they are taken one by one.
        fps: Frames a second.

    Raises:
        InputError: `fps` is out of range, the frames are too large, or the file cannot be written.
        ValueError: there are no frames.
    """
    if not FPS_RANGE[0] <= fps <= FPS_RANGE[1]:
        raise InputError("fps", f"{fps} frames a second; a video allows {FPS_RANGE[0]} to {FPS_RANGE[1]}")
    rest = iter(frames)
    first = next(rest, None)
    if first is None:
        raise ValueError("a video needs at least one frame")
    encoder = H264Encoder(first.shape[1], first.shape[0], fps)
    samples, keys = [], []
    for number, frame in enumerate(chain([first], rest), start=1):
        unit, is_key = encoder.encode(frame)
        samples.append(struct.pack(">I", len(unit)) + unit)
        if is_key:
            keys.append(number)
    with replacing(path) as temporary:
        temporary.write_bytes(_file(encoder, samples, keys, fps))


def _file(encoder: H264Encoder, samples: Sequence[bytes], keys: Sequence[int], fps: int) -> bytes:
    """The index stands before the pictures, so that a browser can play before it has read all."""
    head = _box(b"ftyp", b"isom", struct.pack(">I", 0x200), b"isomiso2avc1mp41")
    sizes = [len(sample) for sample in samples]
    data = _box(b"mdat", *samples)
    offset = len(head) + len(_index(encoder, sizes, keys, fps, 0)) + 8
    return head + _index(encoder, sizes, keys, fps, offset) + data


def _index(encoder: H264Encoder, sizes: Sequence[int], keys: Sequence[int], fps: int, offset: int) -> bytes:
    """The box `moov`; times count frames."""
    count = len(sizes)
    movie = struct.pack(">4I", 0, 0, fps, count) + struct.pack(">IH10x", 0x10000, 0x100) + _UNITY + bytes(24)
    track = struct.pack(">5I8x4H", 0, 0, 1, 0, count, 0, 0, 0, 0) + _UNITY
    track += struct.pack(">II", encoder.width << 16, encoder.height << 16)
    media = _box(
        b"mdia",
        _full_box(b"mdhd", struct.pack(">4IHH", 0, 0, fps, count, _UNDETERMINED, 0)),
        _full_box(b"hdlr", bytes(4) + b"vide" + bytes(12) + b"video\0"),
        _box(
            b"minf",
            _full_box(b"vmhd", bytes(8), flags=1),
            _box(b"dinf", _full_box(b"dref", struct.pack(">I", 1), _full_box(b"url ", flags=1))),
            _sample_table(encoder, sizes, keys, offset),
        ),
    )
    return _box(
        b"moov",
        _full_box(b"mvhd", movie + struct.pack(">I", 2)),
        _box(b"trak", _full_box(b"tkhd", track, flags=3), media),
    )


def _sample_table(encoder: H264Encoder, sizes: Sequence[int], keys: Sequence[int], offset: int) -> bytes:
    """All samples in one chunk at `offset`."""
    count = len(sizes)
    return _box(
        b"stbl",
        _full_box(b"stsd", struct.pack(">I", 1), _sample_entry(encoder)),
        _full_box(b"stts", struct.pack(">3I", 1, count, 1)),
        _full_box(b"stss", struct.pack(f">{1 + len(keys)}I", len(keys), *keys)),
        _full_box(b"stsc", struct.pack(">4I", 1, 1, count, 1)),
        _full_box(b"stsz", struct.pack(f">{2 + count}I", 0, count, *sizes)),
        _full_box(b"stco", struct.pack(">2I", 1, offset)),
    )


def _sample_entry(encoder: H264Encoder) -> bytes:
    configuration = (
        bytes([1, PROFILE_IDC, CONSTRAINT_FLAGS, encoder.level_idc, 0xFF, 0xE1])
        + struct.pack(">H", len(encoder.sps))
        + encoder.sps
        + struct.pack(">BH", 1, len(encoder.pps))
        + encoder.pps
    )
    return _box(
        b"avc1",
        bytes(6) + struct.pack(">H16x", 1),
        struct.pack(">HH", encoder.width, encoder.height),
        struct.pack(">IIIH", 0x480000, 0x480000, 0, 1),
        bytes(32) + struct.pack(">Hh", 24, -1),
        _box(b"avcC", configuration),
        _box(b"colr", b"nclx" + struct.pack(">3HB", 1, 1, 6, 0)),
    )


def _full_box(kind: bytes, *contents: bytes, flags: int = 0) -> bytes:
    return _box(kind, struct.pack(">I", flags), *contents)


def _box(kind: bytes, *contents: bytes) -> bytes:
    size = 8 + sum(len(content) for content in contents)
    return b"".join((struct.pack(">I", size), kind, *contents))

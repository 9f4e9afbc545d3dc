"""Lossless H.264 video of pictures that mostly stand still (ITU-T Rec. H.264, Constrained Baseline profile).

H.264 is what every player, browser and slide program shows, and the encoders that OpenCV brings along make other formats.
Pictures of plans are drawn: from frame to frame only what moves changes, and most of a picture is flat or has straight
edges. So three ways to code a macroblock (16 x 16 pixels) are enough:

- skipped: as in the frame before (`P_Skip`);
- predicted: every row is the one above the macroblock, or every column the one left of it (`I_16x16` without residual);
- plain: its samples as they are (`I_PCM`).

None of them loses anything, so no transform and no rate control are needed, and equal frames give equal bytes. Chroma has
half the resolution (4:2:0, as the profile wants). Names of syntax elements are those of the standard.
"""

import re
from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from converter.raster import Image
from pcg.arrays import BoolArray
from pcg.errors import InputError

Plane = npt.NDArray[np.uint8]

MACROBLOCK = 16

KEY_FRAME_S = 10.0
"""Time between frames at which a player can start [s]."""

LEVELS = ((30, 1_620, 40_500), (31, 3_600, 108_000), (40, 8_192, 245_760), (51, 36_864, 983_040))
"""`level_idc`, and the most macroblocks of a frame and of a second (Table A-1)."""

PROFILE_IDC = 66
CONSTRAINT_FLAGS = 0b1100_0000
I_PCM = 25
P_SLICE_OFFSET = 5
"""What is added to the types of intra macroblocks in P slices (Table 7-13)."""

_NAL_SLICE, _NAL_IDR, _NAL_SPS, _NAL_PPS = 0x41, 0x65, 0x67, 0x68
_I_SLICE, _P_SLICE = 7, 5
_FRAME_NUM_BITS = 16
_START = re.compile(rb"\0\0(?=[\0-\x03])")


class _Planes(NamedTuple):
    """Luma (16 m, 16 n) and chroma (8 m, 8 n) samples."""

    y: Plane
    cb: Plane
    cr: Plane


class _Bits:
    """A string of bits that grows at its end."""

    def __init__(self) -> None:
        self._bytes = bytearray()
        self._value = 0
        self._count = 0

    def u(self, value: int, count: int) -> None:
        """`value` in `count` bits."""
        self._value = self._value << count | value
        self._count += count
        while self._count >= 8:
            self._count -= 8
            self._bytes.append(self._value >> self._count & 0xFF)
        self._value &= (1 << self._count) - 1

    def ue(self, value: int) -> None:
        """Exp-Golomb code of a number >= 0."""
        self.u(value + 1, 2 * (value + 1).bit_length() - 1)

    def raw(self, data: bytes) -> None:
        """Whole bytes, after zero bits up to the next byte."""
        if self._count:
            self.u(0, 8 - self._count)
        self._bytes += data

    def payload(self) -> bytes:
        """All bits, closed by a one and zeros up to a whole byte."""
        self.u(1, 1)
        self.raw(b"")
        return bytes(self._bytes)


class H264Encoder:
    """Encodes frames of one size, one after the other.

    Attributes:
        width: Of the frames [px], even.
        height: Of the frames [px], even.
        level_idc: Ten times the level.
        sps: Sequence parameter set, as a NAL unit.
        pps: Picture parameter set, as a NAL unit.
    """

    def __init__(self, width: int, height: int, fps: int) -> None:
        """Frames of odd size get another column or row.

        Raises:
            InputError: the frames are larger than the highest level allows.
        """
        self.width, self.height = width + width % 2, height + height % 2
        columns, rows = -(-width // MACROBLOCK), -(-height // MACROBLOCK)
        self.level_idc = _level(columns * rows, fps)
        self.sps = _nal(_NAL_SPS, _sequence_parameters(self, columns, rows, fps))
        self.pps = _nal(_NAL_PPS, _picture_parameters())
        self._padding = ((0, rows * MACROBLOCK - height), (0, columns * MACROBLOCK - width))
        self._key_interval = max(round(KEY_FRAME_S * fps), 1)
        self._number = 0
        self._before: _Planes | None = None

    def encode(self, image: Image) -> tuple[bytes, bool]:
        """The next frame (h, w, 3) as a NAL unit, and whether a player can start at it."""
        planes = _planes(np.pad(image, (*self._padding, (0, 0)), mode="edge"))
        frame_num = self._number % self._key_interval
        is_key = frame_num == 0
        changed = _changed(planes, None if is_key else self._before)
        bits = _slice_header(frame_num, key_index=self._number // self._key_interval if is_key else None)
        _slice_data(bits, planes, changed, is_key=is_key)
        self._number += 1
        self._before = planes
        return _nal(_NAL_IDR if is_key else _NAL_SLICE, bits.payload()), is_key


def _level(macroblocks: int, fps: int) -> int:
    for level_idc, of_frame, of_second in LEVELS:
        if macroblocks <= of_frame and macroblocks * fps <= of_second:
            return level_idc
    raise InputError(
        "video", f"frames of {macroblocks * MACROBLOCK**2} pixels at {fps} a second are too large for H.264"
    )


def _planes(image: Image) -> _Planes:
    """Luma and chroma in studio range, by the matrix of BT.601."""
    stacked = np.asarray(cv2.cvtColor(image, cv2.COLOR_RGB2YUV_I420), dtype=np.uint8)
    rows, columns = image.shape[:2]
    y, cb, cr = np.split(stacked.ravel(), [rows * columns, rows * columns * 5 // 4])
    half = (rows // 2, columns // 2)
    return _Planes(y.reshape(rows, columns), cb.reshape(half), cr.reshape(half))


def _changed(planes: _Planes, before: _Planes | None) -> BoolArray:
    """(m, n): the macroblocks that differ from the frame before, all of them without one."""
    rows, columns = planes.y.shape[0] // MACROBLOCK, planes.y.shape[1] // MACROBLOCK
    if before is None:
        return np.ones((rows, columns), dtype=np.bool_)
    y, cb, cr = (_any_in_blocks(new != old, rows) for new, old in zip(planes, before, strict=True))
    return y | cb | cr


def _any_in_blocks(plane: BoolArray, rows: int) -> BoolArray:
    """(rows, n): whether a square block of `plane`, of which a column has `rows`, has anything set."""
    side = plane.shape[0] // rows
    eights = plane.view(np.uint64).reshape(rows, side, -1, side // 8)
    found: BoolArray = (np.bitwise_or.reduce(eights, axis=1) != 0).any(axis=-1)
    return found


def _predictable(plane: Plane, rows: int) -> tuple[BoolArray, BoolArray]:
    """Two (rows, n): blocks whose rows all equal the one above, and whose columns all equal the one to the left."""
    differs = np.ones((2, *plane.shape), dtype=np.bool_)
    differs[0, 1:] = plane[1:] != plane[:-1]
    differs[1, :, 1:] = plane[:, 1:] != plane[:, :-1]
    return ~_any_in_blocks(differs[0], rows), ~_any_in_blocks(differs[1], rows)


def _slice_data(bits: _Bits, planes: _Planes, changed: BoolArray, *, is_key: bool) -> None:
    """The macroblocks in reading order (7.3.4)."""
    luma, cb, cr = (_predictable(plane, len(changed)) for plane in planes)
    down, right = cb[0] & cr[0], cb[1] & cr[1]
    plain = changed & ~((luma[0] | luma[1]) & (down | right))
    offset = 0 if is_key else P_SLICE_OFFSET
    last = -1
    for index in np.flatnonzero(changed).tolist():
        row, column = divmod(index, changed.shape[1])
        if not is_key:
            bits.ue(index - last - 1)  # mb_skip_run
        last = index
        if plain[row, column]:
            bits.ue(offset + I_PCM)
            bits.raw(_samples(planes, row, column))
        else:
            bits.ue(offset + (1 if luma[0][row, column] else 2))  # I_16x16, vertical or horizontal
            bits.ue(2 if down[row, column] else 1)  # intra_chroma_pred_mode: vertical or horizontal
            bits.ue(0)  # mb_qp_delta
            _no_coefficients(bits, plain, row, column)
    if not is_key and last < changed.size - 1:
        bits.ue(changed.size - 1 - last)


def _samples(planes: _Planes, row: int, column: int) -> bytes:
    parts = []
    for plane, side in zip(planes, (MACROBLOCK, MACROBLOCK // 2, MACROBLOCK // 2), strict=True):
        parts.append(plane[row * side : (row + 1) * side, column * side : (column + 1) * side].tobytes())
    return b"".join(parts)


def _no_coefficients(bits: _Bits, plain: BoolArray, row: int, column: int) -> None:
    """`coeff_token` of a block without coefficients; its code depends on those of the neighbours (9.2.1).

    A plain macroblock counts as 16 coefficients, any other as none.
    """
    neighbours = [16 * bool(plain[row, column - 1])] if column else []
    neighbours += [16 * bool(plain[row - 1, column])] if row else []
    if neighbours and sum(neighbours) / len(neighbours) >= 8:
        bits.u(0b000011, 6)
    else:
        bits.u(1, 1)


def _slice_header(frame_num: int, key_index: int | None) -> _Bits:
    bits = _Bits()
    bits.ue(0)  # first_mb_in_slice
    bits.ue(_P_SLICE if key_index is None else _I_SLICE)  # slice_type
    bits.ue(0)  # pic_parameter_set_id
    bits.u(frame_num, _FRAME_NUM_BITS)
    if key_index is None:
        bits.u(0, 1)  # num_ref_idx_active_override_flag
        bits.u(0, 1)  # ref_pic_list_modification_flag_l0
        bits.u(0, 1)  # adaptive_ref_pic_marking_mode_flag
    else:
        bits.ue(key_index % 2)  # idr_pic_id: consecutive ones differ
        bits.u(0, 2)  # no_output_of_prior_pics_flag, long_term_reference_flag
    bits.ue(0)  # slice_qp_delta
    bits.ue(1)  # disable_deblocking_filter_idc
    return bits


def _sequence_parameters(video: H264Encoder, columns: int, rows: int, fps: int) -> bytes:
    bits = _Bits()
    bits.raw(bytes([PROFILE_IDC, CONSTRAINT_FLAGS, video.level_idc]))
    bits.ue(0)  # seq_parameter_set_id
    bits.ue(_FRAME_NUM_BITS - 4)  # log2_max_frame_num_minus4
    bits.ue(2)  # pic_order_cnt_type: frames are shown in their order
    bits.ue(1)  # max_num_ref_frames
    bits.u(0, 1)  # gaps_in_frame_num_value_allowed_flag
    bits.ue(columns - 1)  # pic_width_in_mbs_minus1
    bits.ue(rows - 1)  # pic_height_in_map_units_minus1
    bits.u(0b11, 2)  # frame_mbs_only_flag, direct_8x8_inference_flag
    bits.u(1, 1)  # frame_cropping_flag; the offsets count pairs of pixels
    for offset in (0, columns * MACROBLOCK - video.width, 0, rows * MACROBLOCK - video.height):
        bits.ue(offset // 2)  # left, right, top, bottom
    bits.u(1, 1)  # vui_parameters_present_flag
    bits.u(0b00, 2)  # aspect_ratio_info_present_flag, overscan_info_present_flag
    bits.u(1, 1)  # video_signal_type_present_flag
    bits.u(5 << 1, 4)  # video_format unspecified, video_full_range_flag 0
    bits.u(1, 1)  # colour_description_present_flag
    for code in (1, 1, 6):  # primaries and transfer of BT.709, matrix of BT.601
        bits.u(code, 8)
    bits.u(0, 1)  # chroma_loc_info_present_flag
    bits.u(1, 1)  # timing_info_present_flag
    bits.u(1, 32)  # num_units_in_tick
    bits.u(2 * fps, 32)  # time_scale, of fields
    bits.u(1, 1)  # fixed_frame_rate_flag
    bits.u(0b0000, 4)  # no HRD parameters, pic_struct_present_flag, bitstream_restriction_flag
    return bits.payload()


def _picture_parameters() -> bytes:
    bits = _Bits()
    bits.ue(0)  # pic_parameter_set_id
    bits.ue(0)  # seq_parameter_set_id
    bits.u(0b00, 2)  # entropy_coding_mode_flag (CAVLC), bottom_field_pic_order_in_frame_present_flag
    for _ in range(3):
        bits.ue(0)  # num_slice_groups_minus1, num_ref_idx_l0_ and _l1_default_active_minus1
    bits.u(0b000, 3)  # weighted_pred_flag, weighted_bipred_idc
    for _ in range(3):
        bits.ue(0)  # pic_init_qp_minus26, pic_init_qs_minus26, chroma_qp_index_offset
    bits.u(1, 1)  # deblocking_filter_control_present_flag
    bits.u(0b00, 2)  # constrained_intra_pred_flag, redundant_pic_cnt_present_flag
    return bits.payload()


def _nal(header: int, payload: bytes) -> bytes:
    """A NAL unit: nothing in it looks like the start of another one (7.4.1)."""
    return bytes([header]) + _START.sub(b"\0\0\x03", payload)

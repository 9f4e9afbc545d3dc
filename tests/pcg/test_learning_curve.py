from pathlib import Path

import pytest

from pcg.errors import InputError
from pcg.learning_curve import CurveRow, draw_curves, read_curve, smoothed


def row(steps: int) -> CurveRow:
    """A row at this step."""
    means = dict.fromkeys(("success", "valid", "pushes", "occluded", "dependency", "gained", "length"), 0.5)
    return CurveRow(steps=steps, cpu_s=1.5, episodes=3, **means)


def test_rows_are_read_back(tmp_path: Path):
    """What was written is read; a last line that was cut off does not count, nor does a missing file fail."""
    path = tmp_path / "curve.jsonl"
    assert read_curve(path) == []
    path.write_text(f"{row(1).model_dump_json()}\n{row(2).model_dump_json()}\n" + row(3).model_dump_json()[:20])
    assert read_curve(path) == [row(1), row(2)]


def test_broken_lines_are_named(tmp_path: Path):
    """The error says which line is no row."""
    path = tmp_path / "curve.jsonl"
    path.write_text(f"{row(1).model_dump_json()}\nnonsense\n")
    with pytest.raises(InputError, match=r"line 2: not a row"):
        read_curve(path)


def test_smoothing_is_a_moving_mean():
    """Each value becomes the mean of itself and those before it."""
    assert smoothed([0, 2, 4, 6], 2) == [0, 1, 3, 5]
    assert smoothed([0, 2, 4, 6], 10) == [0, 1, 2, 3]


@pytest.mark.parametrize("name", ["curve.png", "curve.svg"])
def test_curves_are_drawn(tmp_path: Path, name: str):
    """The picture is there, also for a run of one row and one of none."""
    draw_curves(tmp_path / name, {"narrow": [row(k) for k in range(30)], "turtle": [row(1)], "wide": []})
    assert (tmp_path / name).stat().st_size > 5000

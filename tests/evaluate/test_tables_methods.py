"""Tables over all scenes."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evaluate.tables_methods import MAX_COMPARED, comparison_table, methods_table, percent
from evaluate.trial_frame import read_trials


def test_methods(two_methods: Path):
    """Solved is what was verified; what a method accepted by itself stands beside it; PAR2 counts 20 s a failure."""
    table = methods_table(read_trials(two_methods), np.random.default_rng(0))
    first, second = (dict(zip(table.columns, row, strict=True)) for row in table.rows)
    assert (first["solved"].text, first["accepted"].text, second["accepted"].text) == ("3/5", "1", "")
    assert first["solved [%]"].text == "60.0% (23 to 88)"
    assert first["mean [s]"].value == pytest.approx(4.1 / 3)
    assert second["PAR2 [s]"].value == pytest.approx((4 + 20 + 0.5 + 0.7) / 4)
    assert first["median [s]"].value == 3.0


def test_equal_generators_give_equal_tables(two_methods: Path):
    """Intervals come from the generator alone."""
    frame = read_trials(two_methods)
    first, second = (methods_table(frame, np.random.default_rng(7)) for _ in range(2))
    assert first == second


def test_comparison(two_methods: Path):
    """A wins both runs in `wall` and loses both in `corner`; `open` has no pair."""
    table = comparison_table(read_trials(two_methods), np.random.default_rng(0))
    assert table is not None
    assert [entry.text for entry in table.rows[0][:6]] == ["A vs. Btl", "4", "2", "0", "2", "1 / 0 / 1"]
    assert table.rows[0][6].value == pytest.approx(((1 + 3 - 4 - 20) / 2 + (40 - 1.2) / 2) / 2)


def test_many_methods_are_not_all_compared(make_study: Callable[..., Path], make_run: Callable[..., Any]):
    """Pairs of more methods than anybody reads are left out, and the note says so."""
    names = [f"m{i:02}" for i in range(MAX_COMPARED + 1)]
    table = comparison_table(
        read_trials(make_study(make_run("wall", name, 0, 1.0) for name in names)), np.random.default_rng(0)
    )
    assert table is not None
    assert len(table.rows) == math.comb(MAX_COMPARED, 2)
    assert table.note.endswith(f" Of {len(names)} methods the first {MAX_COMPARED} are compared.")


@pytest.mark.parametrize(
    ("share", "text"), [(0.0, "0%"), (1.0, "100%"), (0.9997, "99.9%"), (0.0001, "0.1%"), (0.736, "73.6%")]
)
def test_percent_never_claims_all_or_none(share: float, text: str):
    """359.9 of 360 are not 100 %."""
    assert percent(share) == text

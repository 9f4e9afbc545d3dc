"""Trials as a data frame."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

from evaluate.store import FILE_NAME, TrialStore
from evaluate.trial_frame import names_in, planning_times, read_trials, write_parquet
from pcg.errors import InputError


def test_times_are_paired_by_seed(two_methods: Path):
    """A row is a seed, a column a scene; unsolved runs are infinite, runs that were not made NaN."""
    frame = read_trials(two_methods)
    times = planning_times(frame)
    assert names_in(frame, "scene") == ["wall", "corner", "open"]
    np.testing.assert_array_equal(times["A"], [[1.0, np.inf, 0.1], [3.0, np.inf, np.nan]])
    np.testing.assert_array_equal(times["Btl"], [[4.0, 0.5, np.nan], [np.inf, 0.7, np.nan]])


def test_methods_of_one_name_are_told_apart(make_study: Callable[..., Path], make_run: Callable[..., Any]):
    """Two settings under one name give two methods, called after the settings in which they differ."""
    runs = [make_run("wall", "A", 0, 1.0, settings=settings) for settings in "xy"]
    folder = make_study(runs)
    assert names_in(read_trials(folder), "method") == ["A [name=x]", "A [name=y]"]


def test_settings_of_earlier_studies_do_not_matter(make_study: Callable[..., Path], make_run: Callable[..., Any]):
    """Where the study that last ran has one method of a name, it bears that name, whatever else the folder holds."""
    folder = make_study([make_run("wall", "A", 0, 1.0, settings=settings) for settings in "xy"])
    with TrialStore(folder) as store:
        study = store.study()
        assert study is not None
        store.set_study(replace(study, methods=study.methods[1:]))
    frame = read_trials(folder)
    assert (len(frame), names_in(frame, "method")) == (1, ["A"])


def test_parquet_holds_every_row_and_column_but_the_plans(two_methods: Path, tmp_path: Path):
    """The exported numbers are those of the database."""
    path = tmp_path / "out" / "trials.parquet"
    assert write_parquet(two_methods, path) == 9
    frame = pl.read_parquet(path)
    with TrialStore(two_methods) as store:
        rows = list(store.rows())
    assert "plan" not in frame.columns
    assert len(frame.columns) == len(rows[0].__dataclass_fields__) - 1
    assert frame["time_s"].to_list() == [row.time_s for row in rows]
    assert frame["verified"].to_list() == [row.verified for row in rows]


def test_a_folder_without_study_is_refused(tmp_path: Path):
    """One line says what is missing, or what is wrong with the file."""
    with pytest.raises(InputError, match=FILE_NAME):
        read_trials(tmp_path)
    (tmp_path / FILE_NAME).write_bytes(b"no database" * 200)
    with pytest.raises(InputError, match="database"):
        read_trials(tmp_path)


def test_a_study_without_trials_is_refused(tmp_path: Path):
    """Nothing to report is said so."""
    with TrialStore(tmp_path):
        pass
    with pytest.raises(InputError, match="no trials yet"):
        read_trials(tmp_path)

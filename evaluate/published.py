"""Published results, to stand beside those of a study.

Two CSV files of `data/published` hold those of the paper; other papers' can be given in the format of the first:

    scene,method,mean_s,std_s,solved_percent,mean_s_without_subgoal_computation
    wall,Rnd+FPR,190.1,130.60,100,

Lines that begin with `#` say where the numbers come from. A combination that is missing, or has no percentage, was not
run. The tables of a study are written in this format too, so two studies can be compared.
"""

import csv
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pcg.data_folder import data_folder
from pcg.errors import InputError
from pcg.files import read_text

TIME_COLUMNS = ("scene", "method", "mean_s", "std_s", "solved_percent", "mean_s_without_subgoal_computation")
SUCCESS_COLUMNS = ("group", "method", "scenes", "solved_percent")
MAX_BYTES = 1_000_000


@dataclass(frozen=True)
class PublishedTime:
    """What was published of a method on a scene.

    Attributes:
        mean: Mean time of the solved runs [s]; None if none was solved.
        deviation: Their standard deviation [s].
        percent: Share of runs solved, 0..100.
        mean_without_subgoals: Mean time without computing the subgoals [s].
    """

    mean: float | None
    deviation: float | None
    percent: float
    mean_without_subgoals: float | None


def scene_key(name: str) -> str:
    """What scenes are matched by, however a paper writes their names: `four-blocks` for `4 blocks`."""
    words = re.split(r"[\s_-]+", name.strip().lower())
    return "-".join(_NUMERALS.get(word, word) for word in words)


_NUMERALS = {"2": "two", "3": "three", "4": "four", "5": "five"}


def table_one() -> Path:
    """The paper's Table I.

    Raises:
        InputError: the data is not installed.
    """
    return data_folder() / "published" / "table1.csv"


def read_times(path: Path) -> dict[tuple[str, str], PublishedTime]:
    """Published times by `scene_key` and method.

    Raises:
        InputError: naming file, line and reason.
    """
    times = {}
    for where, row in _rows(path, TIME_COLUMNS):
        percent = _number(where, row, "solved_percent")
        if percent is None:
            continue
        if percent > 100:
            raise InputError(where, f"solved_percent: found {row['solved_percent']!r}, allowed is 0 to 100")
        times[scene_key(row["scene"]), row["method"]] = PublishedTime(
            _number(where, row, "mean_s"),
            _number(where, row, "std_s"),
            percent,
            _number(where, row, "mean_s_without_subgoal_computation"),
        )
    return times


def success_by_occlusion() -> dict[tuple[str, str], float]:
    """The paper's share solved, 0..1, by group of scenes (`all`, `not occluded`, `occluded`) and method.

    Raises:
        InputError: the data is not installed or damaged.
    """
    rows = _rows(data_folder() / "published" / "success.csv", SUCCESS_COLUMNS)
    return {(row["group"], row["method"]): (_number(where, row, "solved_percent") or 0.0) / 100 for where, row in rows}


def _rows(path: Path, columns: tuple[str, ...]) -> Iterator[tuple[str, dict[str, str]]]:
    """Where a row stands, and its values by column."""
    numbered = enumerate(read_text(path, MAX_BYTES).splitlines(), start=1)
    lines = [(number, line) for number, line in numbered if line.strip() and not line.startswith("#")]
    if not lines or tuple(_values(lines[0][1], str(path))) != columns:
        raise InputError(str(path), f"the first line has to be {','.join(columns)}")
    for number, line in lines[1:]:
        where = f"{path}: line {number}"
        values = _values(line, where)
        if len(values) != len(columns):
            raise InputError(where, f"found {len(values)} values, allowed are {len(columns)}")
        yield where, dict(zip(columns, values, strict=True))


def _values(line: str, where: str) -> list[str]:
    try:
        return next(csv.reader([line]))
    except csv.Error as error:
        raise InputError(where, f"not a line of a CSV file: {error}") from None


def _number(where: str, row: dict[str, str], column: str) -> float | None:
    text = row[column].strip()
    if not text:
        return None
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0 <= value < math.inf:
        raise InputError(where, f"{column}: found {text!r}, allowed is a number >= 0 or nothing")
    return value

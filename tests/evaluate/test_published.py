"""Published results."""

from pathlib import Path

import pytest

from evaluate.published import PublishedTime, read_times, scene_key, table_one
from pcg.errors import InputError

HEAD = "scene,method,mean_s,std_s,solved_percent,mean_s_without_subgoal_computation\n"


def test_table_one():
    """Some cells of the paper's Table I; MBTS solves three scenes of the puzzles, Hum was not run everywhere."""
    times = read_times(table_one())
    assert times["wall", "Btl+FPR"] == PublishedTime(59.7, 25.21, 90.0, 32.6)
    assert times["maze", "MBTS"] == PublishedTime(None, None, 0.0, None)
    assert ("cube-free", "Hum+R") not in times
    assert sum(method == "MBTS" and time.percent == 100 for (_, method), time in times.items()) == 4
    assert len({scene for scene, _ in times}) == 21


def test_names_of_scenes():
    """A paper's spelling and a file's are the same scene."""
    assert [scene_key(name) for name in ("4 blocks", "O-Room", "a3-92", " Maze-Easy ")] == [
        "four-blocks",
        "o-room",
        "a3-92",
        "maze-easy",
    ]


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "the first line has to be"),
        ("a,b\n1,2\n", "the first line has to be"),
        (HEAD + "wall,A,1,2\n", "line 2: found 4 values"),
        (HEAD + "wall,A,x,,100,\n", "line 2: mean_s: found 'x'"),
        (HEAD + "# comment\nwall,A,1,,200,\n", "line 3: solved_percent: found '200'"),
        (HEAD + "wall,A,nan,,100,\n", "line 2: mean_s: found 'nan'"),
    ],
)
def test_bad_files_are_refused(tmp_path: Path, text: str, problem: str):
    """One line names file, line and field."""
    path = tmp_path / "published.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=problem):
        read_times(path)

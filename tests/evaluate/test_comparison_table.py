from dataclasses import replace

import pytest

from evaluate.comparison_table import COLUMNS, markdown, rows, summary_rows
from pcg.compare import Measurement

FIRST = Measurement(
    source="a",
    task="t",
    seed=0,
    cpu_s=2.0,
    attempts=100,
    steps=1000,
    met=12,
    levels=10,
    mean_pushes=6.0,
    dependency=0.1,
    hamming=0.3,
    goal_entropy=3.0,
)
NOTHING = replace(
    FIRST, source="b", met=0, levels=0, mean_pushes=None, dependency=None, hamming=None, goal_entropy=None
)


def test_a_row_by_hand():
    """Levels by CPU second with its deviation over the seeds; counts are added up before they are divided."""
    second = replace(FIRST, seed=1, cpu_s=4.0, attempts=300, levels=40, met=48, mean_pushes=8.0)
    (row,) = rows([FIRST, second], "t")
    values = dict(zip(COLUMNS, row, strict=True))
    assert values["levels per CPU s"] == "7.50 ± 3.54"
    assert values["CPU s per level"] == "0.120"
    assert values["requests met by attempt"] == "15.00%"
    assert values["levels per 1,000 steps"] == "25.0"
    assert values["mean pushes"] == "7.00"


def test_a_source_without_levels_has_a_row():
    """Zeros where there is something to count, dashes where there is nothing to average."""
    (row,) = rows([NOTHING], "t")
    assert row == ["b", "0 ± 0", "-", "0.00%", "0", "0", "-", "-", "-", "-"]


def test_the_summary_counts_tasks():
    """Shares are averaged over the tasks, a tie is won by both, a task without levels by nobody."""
    runs = [FIRST, replace(FIRST, task="u", met=2), NOTHING, replace(FIRST, source="b", task="u")]
    nobody = [replace(m, task="v", met=0, levels=0) for m in (FIRST, NOTHING)]
    assert list(summary_rows([*runs, *nobody])) == [
        ["a", "4.67%", "2 of 3", "2 of 3"],
        ["b", "4.00%", "1 of 3", "1 of 3"],
    ]


@pytest.mark.parametrize("task", ["t", "u"])
def test_one_table_a_task(task: str):
    """Every task has a heading and a row for each of its sources."""
    text = markdown([FIRST, NOTHING, replace(FIRST, task="u")])
    section = text.partition(f"## {task}\n")[2].partition("##")[0]
    assert section.count("| a |") == 1
    assert section.count("| b |") == (task == "t")

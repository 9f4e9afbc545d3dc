"""Tables of a study."""

from evaluate.summary import time_text
from evaluate.tables import Cell, Result, by_method, by_scene_and_method, markdown

RESULTS = [
    Result("wall", "Rnd+FPR", solved=True, time_s=1.0),
    Result("wall", "Rnd+FPR", solved=True, time_s=3.0),
    Result("wall", "Rnd+R", solved=True, time_s=0.5),
    Result("wall", "Rnd+R", solved=False, time_s=60.0),
    Result("maze", "Rnd+R", solved=False, time_s=60.0),
]


def test_cells_count_solved_runs_only():
    """Mean and deviation are over solved runs, the rate over all."""
    cell = by_scene_and_method(RESULTS)["wall", "Rnd+R"]
    assert (cell.trials, cell.solved, cell.rate, cell.mean_time, cell.time_deviation) == (2, 1, 0.5, 0.5, 0.0)


def test_totals_add_up():
    """The total of a method holds all of its trials."""
    totals = by_method(by_scene_and_method(RESULTS))
    assert {method: (cell.solved, cell.trials) for method, cell in totals.items()} == {
        "Rnd+FPR": (2, 2),
        "Rnd+R": (1, 3),
    }


def test_markdown_table():
    """Deviation beside the mean, the percentage only below 100, a dash for nothing solved, nothing if not run."""
    text = markdown("smoke", "A note.", ["wall", "maze"], ["Rnd+FPR", "Rnd+R"], by_scene_and_method(RESULTS))
    assert text.splitlines() == [
        "# smoke",
        "",
        "A note.",
        "",
        "| scene | Rnd+FPR | Rnd+R |",
        "| --- | ---: | ---: |",
        "| wall | **2.00 (1.41)** | 0.500 (0) 50% |",
        "| maze |  | - |",
        "| solved | 2/2 (34 to 100 %) | 1/3 (6 to 79 %) |",
    ]


def test_nearly_all_is_not_all():
    """A rate below 100 % is never printed as 100 %."""
    cell = Cell(trials=10_000, times=[1.0] * 9_999)
    assert time_text(cell.summary) == "1.00 (0) 99.9%"


def test_names_cannot_break_the_table():
    """A vertical bar in a name is escaped."""
    assert "| a\\|b |" in markdown("t", "n", ["a|b"], [], {})

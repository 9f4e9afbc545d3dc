"""All tables of a study."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from evaluate.scene_groups import groupings
from evaluate.tables import overview, tables_of
from evaluate.trial_frame import read_trials
from tests.evaluate.test_tables_success import FACTS


def test_every_table_names_its_settings(two_methods: Path):
    """Without settings, limits and seeds a result could not be compared; what scenes are like depends on none."""
    facts = dict.fromkeys(["wall", "corner", "open"], FACTS)
    tables = {table.name: table for table in tables_of(read_trials(two_methods), facts, groupings(facts), None)}
    assert list(tables) == ["methods", "comparisons", "success-occlusion", "times", "plans", "facts"]
    said = {name: table.note.endswith(" Settings `fast`, time limit 10 s, 2 seeds.") for name, table in tables.items()}
    assert said == {name: name != "facts" for name in tables}


def test_the_overview_in_markdown(two_methods: Path):
    """Times by scene, then the methods over all scenes, under the name of the study."""
    lines = overview("smoke", read_trials(two_methods)).splitlines()
    assert [line for line in lines if line.startswith("# ")] == [
        "# smoke: planning times by scene and method",
        "# smoke: methods over all scenes",
    ]
    assert "| wall | **2.00 (1.41)** | 4.00 \\[1.00\\] 50% |" in lines
    assert any(line.startswith("| A | 3/5 | 60.0% (23 to 88) |") for line in lines)


def test_names_cannot_break_the_table(make_study: Callable[..., Path], make_run: Callable[..., Any]):
    """A vertical bar in a name is escaped."""
    assert "| a\\|b |" in overview("t", read_trials(make_study([make_run("a|b", "A", 0, 1.0)])))

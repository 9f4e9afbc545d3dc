from dataclasses import replace

import numpy as np

from pcg.level import Level
from pcg.report import LevelReport, LevelsSummary, report_levels, summarise
from pcg.symmetry import symmetries

EASY = Level(np.array([[2, 3, 0, 4], [1, 0, 3, 0]]), "easy")
HIDDEN = Level(np.array([[2, 3, 3, 0, 4]]), "hidden")


def test_reports_by_hand():
    """Every field of a solvable level and of an unsolvable one, whose goal crate is the first."""
    assert list(report_levels([EASY, HIDDEN])) == [
        LevelReport(
            name="easy",
            solvable=True,
            pushes=2,
            moves=2,
            solution="RR",
            crates=2,
            targets=1,
            walls=1,
            regions=1,
            occluded=False,
            duplicate_of=None,
        ),
        LevelReport(
            name="hidden",
            solvable=False,
            pushes=None,
            moves=None,
            solution=None,
            crates=2,
            targets=1,
            walls=0,
            regions=1,
            occluded=False,
            duplicate_of=None,
        ),
    ]


def test_the_named_goal_crate_counts():
    """Solvability and occlusion are those of the crate that the level names."""
    (report,) = report_levels([replace(HIDDEN, goal_crate=(0, 2))])
    assert (report.solvable, report.occluded) == (False, True)


def test_duplicates_name_the_first_of_them():
    """Turned, mirrored and repeated levels point to the first one, also when their goal crates differ."""
    turned = replace(symmetries(EASY)[3], name="turned")
    again = replace(EASY, name="again", goal_crate=(1, 2))
    reports = list(report_levels([EASY, turned, HIDDEN, again]))
    assert [report.duplicate_of for report in reports] == [None, "easy", None, "easy"]


def test_the_limit_is_reported_as_unknown():
    """A level that the solver could not decide is neither solvable nor not."""
    (report,) = report_levels([EASY], max_states=1)
    assert report.solvable is None


def test_summary_counts():
    """Unknown is not solvable; every count is over all reports."""
    hidden = replace(HIDDEN, goal_crate=(0, 2))
    reports = [*report_levels([EASY, hidden, replace(EASY, name="again")]), *report_levels([EASY], max_states=1)]
    assert summarise(reports) == LevelsSummary(levels=4, solvable=2, occluded=1, duplicates=1)
    assert summarise([]) == LevelsSummary(0, 0, 0, 0)

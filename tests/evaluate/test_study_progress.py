"""The progress of a study."""

from dataclasses import replace

import pytest

from converter.scene import Scene
from evaluate.method import Method
from evaluate.output import progress
from evaluate.record import failed_row
from evaluate.study import Study
from evaluate.study_progress import FIELD, StudyProgress
from evaluate.trial import Trial
from evaluate.trial_row import TrialRow
from evaluate.workers import Failure
from planner import Settings


@pytest.fixture
def study(small_room: Scene) -> Study:
    """Two scenes with ten seeds."""
    return Study("s", (small_room, replace(small_room, name="maze")), (Method("m", Settings()),), range(10))


def row(study: Study, scene: int, *, solved: bool, time_s: float) -> TrialRow:
    """The row of a trial."""
    trial = Trial(study.scenes[scene], study.methods[0], 0)
    return replace(failed_row(trial, Failure("error", "", time_s)), verified=solved)


def test_what_is_shown(study: Study):
    """Rate, solved and the worst scene: the one with the fewest solved, and of equals the slowest."""
    now = [100.0]
    with progress(FIELD) as bar:
        shown = StudyProgress(bar, study, lambda: now[0])
        assert shown.text() == ""
        shown.on_trial(row(study, 0, solved=True, time_s=1.0))
        shown.on_trial(row(study, 1, solved=True, time_s=2.0))
        now[0] = 101.0
        assert shown.text() == "2/s, solved 2/2, worst maze 1/1 in 2 s"
        shown.on_trial(row(study, 0, solved=False, time_s=2.0))
        now[0] = 400.0
        assert shown.text() == "0.6/min, solved 2/3, worst small-room 1/2 in 1.5 s"


def test_trials_of_earlier_calls_are_no_progress(study: Study):
    """They are taken off the total, so that the time that remains is that of the others."""
    now = [0.0]
    with progress(FIELD) as bar:
        shown = StudyProgress(bar, study, lambda: now[0])
        for _ in range(15):
            now[0] += 1
            shown.on_trial(None)
        now[0] += 1
        shown.on_trial(row(study, 0, solved=True, time_s=1.0))
        (task,) = bar.tasks
        assert (task.total, task.completed) == (5, 1)


def test_errors_are_told_by_method(study: Study):
    """How many there were, and what the first one said; trials that end otherwise are none."""
    with progress(FIELD) as bar:
        shown = StudyProgress(bar, study)
        shown.on_trial(replace(row(study, 0, solved=True, time_s=1.0), status="solved"))
        assert shown.errors() == []
        for message in ("no module 'mine'", "another"):
            shown.on_trial(replace(row(study, 0, solved=False, time_s=1.0), message=message))
        assert shown.errors() == ["m: 2 trials ended with an error, the first: no module 'mine'"]

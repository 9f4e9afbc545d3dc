"""Studies."""

import itertools
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from converter.formats import write_scene
from converter.scene import Scene
from evaluate.store import TrialRow, TrialStore
from evaluate.study import Study, StudySummary, read_study, run_study, study_table
from evaluate.tables import Cell
from evaluate.workers import Limits
from pcg.errors import InputError
from planner import Settings

SPEC = """
name: test
scenes: [scenes/*.yaml]
methods: [Rnd+FPR, Rnd+R]
seeds: 2
"""

Runner = Callable[..., StudySummary]


@pytest.fixture
def spec(tmp_path: Path, small_room: Scene) -> Path:
    """A specification with two scenes beside it."""
    for name in ("one", "two"):
        write_scene(tmp_path / "scenes" / f"{name}.yaml", replace(small_room, name=name))
    path = tmp_path / "spec.yaml"
    path.write_text(SPEC)
    return path


@pytest.fixture
def study(small_room: Scene) -> Study:
    """One scene, one method, five seeds."""
    return Study("test", (small_room,), ("Rnd+FPR",), tuple(range(5)), Settings(), Limits(seconds=2.0))


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Runner:
    """Runs a study with a stand-in for the planner, always in the same folder."""
    # Worker processes import the stand-ins from where this process would.
    monkeypatch.syspath_prepend(Path(__file__).parent)

    def runner(study: Study, planner: str, **options: object) -> StudySummary:
        import stub_planners  # noqa: PLC0415 - found only now

        with TrialStore(tmp_path / "out") as store:
            return run_study(study, store, 1, run=getattr(stub_planners, planner), **options)

    yield runner
    sys.modules.pop("stub_planners", None)


def rows_in(folder: Path) -> list[TrialRow]:
    """All rows of a finished study."""
    with TrialStore(folder) as store:
        return list(store.rows())


def test_a_specification_becomes_a_study(spec: Path):
    """Scenes are found beside the file, a number of seeds counts from 0, and defaults are those of `solve`."""
    study = read_study(spec)
    assert [scene.name for scene in study.scenes] == ["one", "two"]
    assert (study.methods, study.seeds) == (("Rnd+FPR", "Rnd+R"), (0, 1))
    assert study.settings == Settings()
    assert study.limits == Limits(seconds=120.0)
    assert study.size == len(list(study.trials())) == 8


def test_improvement_has_its_own_time(spec: Path):
    """It comes on top of the time limit, also where trials are killed."""
    spec.write_text(f"{SPEC}time_limit: 10\nimprove: 5\n")
    study = read_study(spec)
    assert study.settings == Settings(time_limit=10, improve=5)
    assert study.limits == Limits(seconds=30.0)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("seeds: 2", "seeds: [3, -1]", r"seeds\[1\]: .*greater than or equal to 0"),
        ("seeds: 2", "seeds: 0", "seeds: .*at least 1 item"),
        ("seeds: 2", "seeds: 99999999999", "seeds: .*at most 1000000 items"),
        ("seeds: 2", "seeds: [1, 1]", "seeds: .*an entry is given twice"),
        ("seeds: 2", "", "seeds: Field required"),
        ("Rnd+R]", "Rnd+X]", "methods: .*unknown method 'Rnd[+]X', allowed are Rnd[+]FPR"),
        ("scenes/*.yaml", "elsewhere/*.yaml", "scenes: nothing matches 'elsewhere/[*].yaml'"),
        ("scenes/*.yaml", "scenes/*.yaml, scenes/one.yaml", "scenes: two inputs would be written as 'one'"),
        ("seeds: 2", "seeds: 2\nworkers: 3", "workers: Extra inputs"),
        ("seeds: 2", "seeds: 2\nhard_limit: 0.5", "hard_limit: .*greater than or equal to 1"),
        ("seeds: 2", "seeds: 2\nimprove: -1", "improve: .*greater than or equal to 0"),
        ("name: test", "name: [", "line"),
    ],
)
def test_bad_specifications(spec: Path, old: str, new: str, message: str):
    """Each mistake is one line that names the file and the field."""
    spec.write_text(SPEC.replace(old, new))
    with pytest.raises(InputError, match=message) as error:
        read_study(spec)
    assert str(error.value).startswith(str(spec))
    assert "\n" not in str(error.value)


def test_the_smoke_study_can_be_read():
    """The study that comes with the product names scenes and methods that exist."""
    study = read_study(Path(__file__).parents[2] / "data" / "studies" / "smoke.yaml")
    assert study.size == 18


def test_every_trial_has_one_row_whatever_happens(study: Study, run: Runner, tmp_path: Path):
    """Overruns, crashes, exceptions and clean failures are rows; the rest of the study is not touched."""
    summary = run(replace(study, limits=Limits(seconds=1.5)), "troubled")
    assert (summary.trials, summary.run, summary.skipped, summary.solved) == (5, 5, 0, 1)
    found = {row.seed: (row.status, row.verified, row.message) for row in rows_in(tmp_path / "out")}
    assert found == {
        0: ("timeout", None, "stopped at the hard limit of 1.5 s"),
        1: ("error", None, "the worker process ended with exit status 3"),
        2: ("error", None, "RuntimeError: a bug of two lines"),
        3: ("exhausted", None, None),
        4: ("solved", True, None),
    }


def test_finished_trials_are_not_repeated(study: Study, run: Runner):
    """A second run only counts; a grown study runs what is new; the summary covers all."""
    run(study, "quick")
    again = run(study, "forbidden")
    assert (again.run, again.skipped, again.solved) == (0, 5, 5)
    grown = run(replace(study, seeds=tuple(range(7))), "quick")
    assert (grown.run, grown.skipped, grown.solved) == (2, 5, 7)


def test_other_settings_are_other_trials(study: Study, run: Runner, small_room: Scene):
    """Changed settings or geometry run anew, and the table shows only what belongs to the study."""
    run(study, "quick")
    for changed in (
        replace(study, settings=Settings(candidates=50)),
        replace(study, scenes=(replace(small_room, tolerance=0.0),)),
    ):
        summary = run(changed, "quick")
        assert (summary.run, summary.skipped, summary.solved) == (5, 0, 5)
    assert run(study, "forbidden").cells["small-room", "Rnd+FPR"].trials == 5


def test_an_interrupt_keeps_finished_rows(study: Study, run: Runner, tmp_path: Path):
    """What was finished before Ctrl-C stays, and the next run continues there."""
    seen = []

    def interrupt(row: TrialRow | None) -> None:
        seen.append(row)
        if len(seen) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(study, "quick", on_trial=interrupt)
    assert len(rows_in(tmp_path / "out")) == 2
    summary = run(study, "quick")
    assert (summary.run, summary.skipped) == (3, 2)


def test_large_studies_are_not_listed(small_room: Scene):
    """The first trials of a hundred million are there at once: one seed over all methods, then the next."""
    study = Study("big", (small_room,), ("Rnd+FPR", "Rnd+R"), range(50_000_000), Settings(), Limits())
    first = [(trial.seed, trial.settings.method) for trial in itertools.islice(study.trials(), 3)]
    assert first == [(0, "Rnd+FPR"), (0, "Rnd+R"), (1, "Rnd+FPR")]
    assert study.size == 100_000_000


def test_the_table_names_its_preset(study: Study):
    """A table without settings could not be compared."""
    text = study_table(study, {("small-room", "Rnd+FPR"): Cell(5, [0.5, 0.5])})
    assert "of 5 seeds" in text
    assert "Settings `fast`, time limit 60 s" in text
    assert "| small-room | 0.500 ± 0 (40 %) |" in text

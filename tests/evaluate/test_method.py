"""Methods: ours, and other people's functions."""

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from converter.plan import Segment, Status
from converter.scene import Scene
from evaluate.method import ImportedPlanner, Method, OwnPlanner, method_named
from evaluate.record import run_recorded
from evaluate.references import HEURISTICS, PLANNERS, SUBGOALS, Reference
from evaluate.trial import Trial, prepare
from pcg.errors import InputError
from planner import Settings

MODULE = '''
from types import SimpleNamespace

import numpy as np

from converter.plan import Segment, Status
from planner import PlanResult

calls = []

def solve(scene, settings, rng, option=0):
    calls.append((scene.name, settings.time_limit, int(rng.integers(1000)), option))
    return PlanResult(Status.SOLVED, 1e9, (Segment("move", None, scene.agent.position[None]),))

def wrong(scene, settings, rng):
    return "a plan"

def with_numpy(scene, settings, rng):
    return PlanResult("exhausted", 0.0, counters={"nodes": np.int64(3), "score": np.float32(0.5)})

def endless(scene, settings, rng):
    return PlanResult(Status.EXHAUSTED, 0.0, counters={"score": float("nan")})

def half(scene, settings, rng):
    return PlanResult(Status.EXHAUSTED, 0.0, certificate="half of a character: \\udc80")

class Here:
    """Proposes where the object is."""
    def __init__(self, problem, settings):
        self.time_s = 0.0
    def candidates(self, configuration, index, n, rng):
        calls.append("candidates")
        return np.array([[-1.0, 1.5]])

def height(problem, configuration):
    calls.append("score")
    return float(configuration.objects[problem.goal_index][1])

nested = SimpleNamespace(inner=SimpleNamespace(solve=solve))
'''


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A folder with somebody else's module, which is not on the search path before."""
    monkeypatch.setattr(sys, "path", list(sys.path))
    name = f"somebody_{tmp_path.name}".replace("-", "_")
    (tmp_path / f"{name}.py").write_text(MODULE)
    yield f"{tmp_path}:{name}"
    sys.modules.pop(name, None)


def reference(folder: str, function: str, group: str = PLANNERS) -> Reference:
    """A function of somebody else's module."""
    place, _, module = folder.partition(":")
    return Reference(f"{module}:{function}", group, place)


def test_an_imported_planner_is_timed_and_verified(folder: str, small_room: Scene):
    """It gets scene, settings, the seed's generator and its options; its own word on its time does not count."""
    function = reference(folder, "solve")
    method = Method("theirs", Settings(time_limit=3), ImportedPlanner(function, {"option": 5}))
    prepare([method])
    outcome = Trial(small_room, method, 11).run()
    calls = sys.modules[function.text.split(":")[0]].calls  # type: ignore[attr-defined]  # see MODULE
    drawn = int(np.random.default_rng(np.random.SeedSequence(11)).integers(1000))
    assert calls == [("small-room", 3, drawn, 5)]
    assert (outcome.plan.method, outcome.plan.status, outcome.verified) == ("theirs", Status.SOLVED, False)
    assert outcome.plan.time_s < 60
    assert method.document["planner"] == function.text


def test_an_imported_planner_must_return_a_result(folder: str, small_room: Scene):
    """Anything else is an error that says what was found."""
    method = Method("theirs", Settings(), ImportedPlanner(reference(folder, "wrong")))
    with pytest.raises(TypeError, match=r"wrong returned '.*', allowed is a planner\.PlanResult"):
        method.plan(small_room, 0)


def test_numbers_of_numpy_are_numbers(folder: str, small_room: Scene):
    """Counters come from arrays as often as not, and the text of a status stands for it; the row can be written."""
    method = Method("theirs", Settings(), ImportedPlanner(reference(folder, "with_numpy")))
    row = run_recorded(Trial(small_room, method, 0))
    assert (row.status, row.counters) == ("exhausted", '{"nodes": 3, "score": 0.5}')


@pytest.mark.parametrize(
    ("function", "problem"),
    [("endless", r"counters\.score: .*found nan"), ("half", "certificate: text must be Unicode")],
)
def test_an_imported_planner_must_say_what_a_plan_can_hold(folder: str, small_room: Scene, function: str, problem: str):
    """What would make the database or its report unusable is an error of the trial."""
    method = Method("theirs", Settings(), ImportedPlanner(reference(folder, function)))
    with pytest.raises(InputError, match=f"plan of theirs: {problem}"):
        method.plan(small_room, 0)


def test_our_search_with_their_subgoals_and_heuristic(folder: str, small_room: Scene):
    """Both are asked, and the plan is as good as any."""
    subgoals, heuristic = reference(folder, "Here", SUBGOALS), reference(folder, "height", HEURISTICS)
    planner = OwnPlanner(subgoals, heuristic)
    method = Method("mixed", Settings(method="Rnd+FPR", max_expansions=3), planner)
    Trial(small_room, method, 0).run()
    calls = sys.modules[subgoals.text.split(":")[0]].calls  # type: ignore[attr-defined]  # see MODULE
    assert "score" in calls
    assert planner.document() == {"subgoals": subgoals.text, "heuristic": heuristic.text}
    assert planner.document().items() <= method.document.items()


def test_references_reach_into_objects(folder: str):
    """A function may be an attribute of an attribute, and is the same wherever its folder is."""
    nested = reference(folder, "nested.inner.solve")
    assert nested.load() is reference(folder, "solve").load()
    assert nested == Reference(nested.text, nested.group, "elsewhere")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("no_such_module:f", "no_such_module:f: cannot be imported: ModuleNotFoundError"),
        ("json:f", "json:f: cannot be imported: AttributeError"),
        ("json:decoder", "json:decoder: found a module, allowed is something that can be called"),
        ("nobody", "nobody: neither module:function nor an entry point of manipuzzle.planners"),
    ],
)
def test_bad_references(text: str, message: str):
    """Each is one line that names the reference."""
    with pytest.raises(InputError, match=message):
        Reference(text, PLANNERS).load()


def test_entry_points_are_found_by_name(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    """An installed package may offer a function under a name."""
    info = tmp_path / "theirs-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: theirs\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[manipuzzle.planners]\ntheirs = json:loads\n")
    monkeypatch.syspath_prepend(tmp_path)
    assert Reference("theirs", PLANNERS).load()("3") == 3


def test_identity_is_in_the_settings_of_all(folder: str):
    """Names do not count; settings, options and references do."""
    solve = reference(folder, "solve")
    methods = [
        Method("a", Settings()),
        Method("a", Settings(candidates=3)),
        Method("a", Settings(), ImportedPlanner(solve)),
        Method("a", Settings(), ImportedPlanner(solve, {"option": 1})),
        Method("a", Settings(), OwnPlanner(subgoals=solve)),
        Method("a", Settings(), OwnPlanner(heuristic=solve)),
    ]
    assert len({method.hash for method in methods}) == len(methods)
    assert Method("b", Settings()).hash == methods[0].hash


def test_methods_that_need_something(small_room: Scene):
    """Hum suits scenes with a demonstration, Push those with a level; the others suit all."""
    suited = {
        name for name in ("Rnd+R", "MBTS", "Hum+R", "Push")
        if (method := method_named(name, Settings())).planner.suits(small_room, method.settings)
    }  # fmt: skip
    assert suited == {"Rnd+R", "MBTS"}
    assert Segment("move", None, small_room.agent.position[None]).length == 0

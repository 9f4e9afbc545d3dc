"""Algorithm 1: its order of work with solvers that are scripted, and whole searches, each verified independently."""

import json
from collections import Counter
from collections.abc import Callable
from itertools import count
from pathlib import Path

import numpy as np
import pytest

from converter.formats import read_scene
from converter.plan import Plan, Status, plan_document
from converter.scene import Body, Scene
from converter.shape import FloatArray
from pcg.errors import InputError
from planner import search
from planner.frontier import Node
from planner.kernel import BoolArray
from planner.pick_place import PickPlace, Region
from planner.problem import Configuration, Problem
from planner.result import PlanResult, Progress
from planner.search import Search, solve
from planner.settings import Settings, settings_for
from planner.verify import verify
from tests.planner.scenes import body, room, wall

REPOSITORY = Path(__file__).resolve().parents[2]
PUZZLES = REPOSITORY / "data" / "puzzles"
GENERATED = REPOSITORY.parent / "shared" / "scenes" / "pcg"
LETTERS = ["Rnd+FPR", "Rnd+FP", "Rnd+FR", "Rnd+R"]


def verified(scene: Scene, settings: Settings, seed: int) -> Plan:
    """A plan of the forward search that the independent verifier accepts."""
    plan = solve(scene, settings, np.random.default_rng(seed)).to_plan(scene, settings, seed)
    assert plan.status is Status.SOLVED
    assert verify(scene, plan) == []
    return plan


class Scripted:
    """A solver of subproblems in which every carry works at once, and those into the goal as often as it is told."""

    def __init__(
        self, configuration: Configuration, *, into_goal: bool, placements: Callable[[int], FloatArray]
    ) -> None:
        self._configuration = configuration
        self._into_goal = into_goal
        self._placements = placements
        self._calls = count()

    def reachable(self, index: int) -> bool:
        """Only the goal-object can be reached."""
        return index == 0

    def placeable(self, index: int, subgoals: FloatArray) -> BoolArray:
        """All of them."""
        del index
        return np.ones(len(subgoals), dtype=bool)

    def contacts(self, index: int) -> FloatArray:
        """None are known."""
        del index
        return np.empty((0, 2))

    def pick_place(self, index: int, region: Region) -> PickPlace | None:
        """The first call is about the goal, the later ones are about subgoals."""
        call = next(self._calls)
        if call == 0 and not self._into_goal:
            return None
        return self._step(index, region.centre if call == 0 else self._placements(call))

    def regrasp(self, index: int) -> PickPlace | None:
        """Stays where it is."""
        here = self._configuration.agent[np.newaxis]
        return PickPlace(index, here, here, self._configuration.objects[index])

    def _step(self, index: int, placement: FloatArray) -> PickPlace:
        agent = self._configuration.agent
        return PickPlace(index, agent[np.newaxis], np.array([agent, agent + 0.01]), placement)


def scripted(
    monkeypatch: pytest.MonkeyPatch,
    settings: Settings,
    *,
    into_goal: Callable[[int], bool] = lambda _: False,
    placements: Callable[[int], FloatArray] = lambda call: np.array([-1.0 - 0.2 * call, 0.0]),
    **arguments: Callable[..., object],
) -> tuple[Search, PlanResult]:
    """A search whose n-th expansion can reach the goal if `into_goal` says so, and otherwise makes `placements`."""
    expansions = count(1)

    def solver_for(configuration: Configuration) -> Scripted:
        return Scripted(configuration, into_goal=into_goal(next(expansions)), placements=placements)

    monkeypatch.setattr(search, "subproblem_solvers", lambda *_: solver_for)
    scene = room(objects=(body("obj", -1, -1), body("other", 1, -1)), half=4)
    run = Search(Problem(scene), settings, np.random.default_rng(0), **arguments)  # type: ignore[arg-type]  # callbacks
    return run, run.run()


def test_the_original_problem_is_tried_first(monkeypatch: pytest.MonkeyPatch):
    """If it is solved at once there is one expansion and nothing else is asked."""
    run, result = scripted(monkeypatch, Settings(), into_goal=lambda _: True)
    assert result.status is Status.SOLVED
    assert (result.counters["expansions"], result.counters["nodes"]) == (1, 1)
    assert [subgoal.object for subgoal in result.subgoals] == ["obj"]
    assert run.solution is not None
    assert run.problem.at_goal(run.solution.configuration)


def test_each_expansion_makes_a_child_for_each_subgoal_and_the_trivial_one(monkeypatch: pytest.MonkeyPatch):
    """Five placements and a regrasp of the only object that can be reached."""
    run, _ = scripted(monkeypatch, Settings(method="Rnd+FP", max_expansions=1))
    children = [node for node in run.nodes if node.parent is run.nodes[0]]
    assert len(children) == run.settings.subgoals_per_object + 1
    assert [node.step.is_regrasp for node in children if node.step is not None] == [False] * 5 + [True]


def test_the_plan_is_the_way_to_the_solution(monkeypatch: pytest.MonkeyPatch):
    """The steps of the ancestors come before the last one."""
    run, result = scripted(monkeypatch, Settings(), into_goal=lambda expansion: expansion == 4)
    assert result.status is Status.SOLVED
    assert run.solution is not None
    assert run.solution.parent in run.nodes
    placed = [step.placement.tolist() for step in run.solution.steps() if not step.is_regrasp]
    assert [subgoal.position.tolist() for subgoal in result.subgoals] == placed


def expansion_order(run: Search) -> list[Node]:
    """Nodes by when they were expanded, told by when their children came."""
    parents = [node.parent for node in run.nodes if node.parent is not None]
    return list(dict.fromkeys(parents))


def test_prioritised_selection_expands_the_best_first(monkeypatch: pytest.MonkeyPatch):
    """With P a child near the goal goes before its elder siblings, without P the eldest goes first."""
    near_goal = {3: np.array([1.25, 1.25])}

    def placements(call: int) -> FloatArray:
        return near_goal.get(call, np.array([-1.0 - 0.2 * call, 0.0]))

    prioritised, _ = scripted(monkeypatch, Settings(method="Rnd+FP", max_expansions=3), placements=placements)
    first_in, _ = scripted(monkeypatch, Settings(method="Rnd+R", max_expansions=3), placements=placements)
    assert expansion_order(prioritised)[1] is max(prioritised.nodes[1:7], key=lambda node: node.score)
    assert expansion_order(prioritised)[1].configuration.objects[0].tolist() == [1.25, 1.25]
    assert expansion_order(first_in)[1] is first_in.nodes[1]


@pytest.mark.parametrize("method", LETTERS)
def test_rejection_bounds_equal_configurations(monkeypatch: pytest.MonkeyPatch, method: str):
    """With R at most two configurations have equal object positions, however often they come up; without R more do."""
    spots = [np.array([-1.0 - 0.2 * k, 0.0]) for k in range(3)]
    run, result = scripted(
        monkeypatch,
        Settings(method=method, max_expansions=20, equal_configurations=2),
        placements=lambda call: spots[call % 3],
    )
    cells = Counter(np.floor(node.configuration.objects / 0.1).tobytes() for node in run.nodes)
    if "R" in method.partition("+")[2]:
        assert max(cells.values()) == 2
        assert result.counters["rejected"] > 0
        assert result.status is Status.EXHAUSTED
    else:
        assert max(cells.values()) > 2
        assert "rejected" not in result.counters
        assert result.status is Status.TIMEOUT


@pytest.mark.parametrize("longest", [0.0, 4.0, 6.0])
def test_no_way_is_longer_than_allowed(longest: float):
    """Every configuration in the tree leaves enough of the length to get to the goal as the crow flies."""
    scene = room(wall(0, 0.5, 0.2, 3), objects=(body("obj", -1, 0),), agent=(-1.5, 0), goal=(1, 0))
    problem = Problem(scene)
    run = Search(problem, Settings(max_expansions=10), np.random.default_rng(0), max_length=longest)
    run.run()
    lengths = [node.length + problem.distance_to_goal(node.configuration) for node in run.nodes]
    assert all(length <= longest for length in lengths)
    assert (len(run.nodes) == 0) == (longest == 0.0)


def test_nothing_is_expanded_more_than_twice(monkeypatch: pytest.MonkeyPatch):
    """Few placements with rejection: each configuration is expanded twice, then the search is exhausted and says why."""
    run, result = scripted(monkeypatch, Settings(), placements=lambda call: np.array([-1.0 - 0.2 * (call % 2), 0.0]))
    assert result.status is Status.EXHAUSTED
    assert {node.expansions for node in run.nodes} == {2}
    assert result.counters["expansions"] == 2 * len(run.nodes)
    assert result.certificate == f"all {len(run.nodes)} configurations were expanded 2 times"


def test_a_subgoal_in_the_goal_solves_the_problem(monkeypatch: pytest.MonkeyPatch):
    """An object that a subgoal has brought to the goal is not carried there a second time."""
    run, result = scripted(monkeypatch, Settings(), placements=lambda _: np.array([1.5, 1.4]))
    assert result.status is Status.SOLVED
    assert [subgoal.position.tolist() for subgoal in result.subgoals] == [[1.5, 1.4]]
    assert run.solution is run.nodes[1]


@pytest.mark.parametrize("limit", [1, 2, 5])
def test_the_number_of_expansions_is_bounded(monkeypatch: pytest.MonkeyPatch, limit: int):
    """All expansions that are allowed are complete ones; then the search gives up."""
    run, result = scripted(monkeypatch, Settings(method="Rnd+FP", max_expansions=limit))
    assert (result.status, result.counters["expansions"]) == (Status.TIMEOUT, limit)
    assert len(run.nodes) == 1 + 6 * limit


def test_a_search_that_is_cut_short_is_not_exhausted(monkeypatch: pytest.MonkeyPatch):
    """If the stop comes during the last expansion, something may have been left: the status is timeout."""
    asked = count()
    _, whole = scripted(
        monkeypatch,
        Settings(expansions=1),
        placements=lambda _: np.array([-1.0, 0.0]),
        should_stop=lambda: next(asked) < 0,
    )
    assert whole.status is Status.EXHAUSTED
    last = next(asked) - 2
    asked = count()
    _, cut = scripted(
        monkeypatch,
        Settings(expansions=1),
        placements=lambda _: np.array([-1.0, 0.0]),
        should_stop=lambda: next(asked) >= last,
    )
    assert (cut.status, cut.certificate) == (Status.TIMEOUT, None)
    assert cut.counters["expansions"] == whole.counters["expansions"]


def test_stopping_at_once(monkeypatch: pytest.MonkeyPatch):
    """Nothing is expanded, nothing is planned."""
    _, result = scripted(monkeypatch, Settings(), into_goal=lambda _: True, should_stop=lambda: True)
    assert (result.status, result.segments, result.certificate) == (Status.TIMEOUT, (), None)
    assert result.counters.get("expansions", 0) == 0


def test_progress_is_reported_after_each_expansion(monkeypatch: pytest.MonkeyPatch):
    """Expansions and nodes grow, the best score never falls."""
    reports: list[Progress] = []
    scripted(monkeypatch, Settings(method="Rnd+FP", max_expansions=3), on_progress=reports.append)
    assert [report.expansions for report in reports] == [1, 2, 3]
    assert [report.nodes for report in reports] == [7, 13, 19]
    scores = [report.best_score for report in reports]
    assert scores == sorted(scores)


def behind_another_object() -> Scene:
    """The way to the goal is a gap in which the other object stands."""
    divider = [wall(0.5, sign * 1.3, 0.2, 1.8) for sign in (1, -1)]
    objects = body("obj", -1, 0), body("other", 0.5, 0)
    return room(*divider, *outer_walls(), objects=objects, agent=(-1, -1), goal=(1.5, 0.0), tolerance=1e-4)


def outer_walls() -> list[Body]:
    """Four walls around a room of side 4 m, inner faces at 2 m."""
    sides = [wall(0, sign * 2.1, 4.4, 0.2) for sign in (1, -1)]
    return [*sides, *(wall(sign * 2.1, 0, 0.2, 4) for sign in (1, -1))]


@pytest.mark.parametrize("method", LETTERS)
@pytest.mark.parametrize("seed", range(2))
def test_obstacles_are_moved_out_of_the_way(method: str, seed: int):
    """Every method clears the gap first, so the plan has two carries at least."""
    plan = verified(behind_another_object(), Settings(method=method), seed)
    assert plan.pick_places >= 2
    assert plan.subgoals[-1].object == "obj"
    assert "other" in {subgoal.object for subgoal in plan.subgoals}


def test_a_goal_in_sight_takes_one_carry():
    """In an empty room the goal-object is carried to the goal in a straight line."""
    plan = verified(room(), Settings(), 0)
    assert (plan.pick_places, plan.counters["expansions"]) == (1, 1)
    assert len(plan.segments[1].path) == 2


def test_a_problem_that_is_solved_needs_no_motion():
    """With the goal-object at the goal the plan is empty, and the verifier agrees."""
    plan = verified(room(objects=(body("obj", 1.4, 1.6),)), Settings(), 0)
    assert (plan.segments, plan.subgoals) == ((), ())


def test_overlapping_starts_are_refused():
    """Bad scenes are errors, not failures to plan."""
    with pytest.raises(InputError, match="agent overlaps 'obj' at the start"):
        solve(room(objects=(body("obj", 0.2, 0),)), Settings(), np.random.default_rng(0))


@pytest.mark.parametrize("preset", ["fast", "faithful"])
def test_nothing_to_reach(preset: str):
    """With every object behind walls the search ends after both expansions, with the reason."""
    pen = [wall(0, 0.6, 1.8, 0.2), wall(0, -0.6, 1.8, 0.2), wall(0.9, 0, 0.2, 1.4), wall(-0.9, 0, 0.2, 1.4)]
    scene = room(*pen, objects=(body("obj", -1.5, -1.5),))
    result = solve(scene, settings_for(preset, reach_iterations=200), np.random.default_rng(0))
    assert (result.status, result.certificate) == (Status.EXHAUSTED, "no object could be reached")
    assert (result.segments, result.counters["expansions"]) == ((), 2)


@pytest.mark.parametrize("preset", ["fast", "faithful"])
def test_stopping_ends_a_search(preset: str):
    """After some questions the answer is to stop; the result is a timeout without a plan."""
    walled_goal = [wall(1.5, 1.1, 1, 0.2), wall(1.1, 1.5, 0.2, 1)]
    scene = room(*walled_goal, objects=(body("obj", -1, 0),), agent=(-1, -1))
    asked = count()
    result = solve(scene, settings_for(preset), np.random.default_rng(0), should_stop=lambda: next(asked) > 30)
    assert (result.status, result.segments) == (Status.TIMEOUT, ())


def test_the_time_limit_is_a_guard():
    """A limit that is over at once ends the search."""
    result = solve(room(), Settings(time_limit=1e-9), np.random.default_rng(0))
    assert result.status is Status.TIMEOUT


def untimed(plan: Plan) -> str:
    """The plan's file without its times."""
    document = plan_document(plan)
    del document["time_s"]
    document["counters"] = {key: value for key, value in document["counters"].items() if not key.endswith("_s")}
    return json.dumps(document)


@pytest.mark.parametrize(
    ("puzzle", "preset", "method"),
    [
        ("wall", "fast", "Rnd+FPR"),
        ("two-blocks", "fast", "Rnd+R"),
        ("two-blocks", "fast", "Btl+FPR"),
        ("corner", "faithful", "Rnd+FPR"),
    ],
)
def test_same_seed_gives_the_same_plan(puzzle: str, preset: str, method: str):
    """Byte for byte apart from times, whatever ran in between; another seed gives another plan."""
    scene, settings = read_scene(PUZZLES / f"{puzzle}.yaml"), settings_for(preset, method=method)
    first = untimed(verified(scene, settings, 1))
    other = untimed(verified(scene, settings, 2))
    again = untimed(verified(scene, settings, 1))
    assert first == again
    assert first.replace('"seed": 1', '"seed": 2') != other


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    "puzzle", ["cube-free", "corner", "two-blocks", "wall-easy", "maze-easy", "o-room", "wall", "four-blocks"]
)
def test_puzzles_are_solved(puzzle: str, seed: int):
    """The fast preset solves the puzzles, and the independent verifier accepts the plans."""
    verified(read_scene(PUZZLES / f"{puzzle}.yaml"), settings_for("fast"), seed)


@pytest.mark.slow
def test_maze_is_solved():
    """The hardest puzzle takes a dozen regrasps of centimetres, within two minutes."""
    verified(read_scene(PUZZLES / "maze.yaml"), settings_for("fast", time_limit=120), 0)


@pytest.mark.parametrize("puzzle", ["cube-free", "corner", "wall-easy"])
def test_the_faithful_preset_solves_the_easy_puzzles(puzzle: str):
    """RRT-Connect and nonlinear programs find valid plans too."""
    verified(read_scene(PUZZLES / f"{puzzle}.yaml"), settings_for("faithful"), 0)


@pytest.mark.skipif(not GENERATED.is_dir(), reason="the published scenes are not beside the checkout")
@pytest.mark.parametrize("name", ["a11-6", "a15-20", "a19-20", "a23-6", "a3-92", "a35-2"])
def test_generated_scenes_are_solved(name: str):
    """One-cell corridors without clearance: the fast preset solves all published generated scenes."""
    verified(read_scene(GENERATED / f"{name}.g"), settings_for("fast"), 0)

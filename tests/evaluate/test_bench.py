"""The performance table: its document, its arithmetic, and peers that answer the same questions. Nothing is timed."""

import json
from itertools import count, pairwise

import numpy as np
import pytest
from typer.testing import CliRunner

from converter.shape import FloatArray
from evaluate.bench import TURN, BenchRow, Contest, measure
from evaluate.bench_contests import GOALS, QUICK, SWITCH_PUZZLES, Effort, contests, read_puzzle, switch_contest
from evaluate.bench_peers import STEP, ShapelyObstacles, ompl_with_sampled_checks
from evaluate.cli import app
from planner.problem import Problem

KEYS = {"name", "median_s", "p95_s", "n", "peer", "peer_median_s", "ratio", "figures"}


def test_the_document_lists_every_contest():
    """Each row has all keys; what has no peer has null for its figures, the others a ratio that fits them."""
    result = CliRunner().invoke(app, ["bench", "--quick", "--json"])
    assert result.exit_code == 0
    document = json.loads(result.stdout)
    assert set(document) == {"rows"}
    rows = document["rows"]
    assert [row["name"] for row in rows] == [contest.name for contest in contests(QUICK)]
    assert len({row["name"] for row in rows}) == len(rows)
    for row in rows:
        assert set(row) == KEYS
        assert 0 < row["median_s"] <= row["p95_s"]
        assert row["n"] == 2
        if row["peer"] is None:
            assert row["peer_median_s"] is row["ratio"] is None
        else:
            assert row["ratio"] == pytest.approx(row["peer_median_s"] / row["median_s"])
    assert {row["peer"] is None for row in rows} == {True, False}


def test_the_table_names_units():
    """For people, times have units and the time limit of the puzzles is told."""
    result = CliRunner().invoke(app, ["bench", "--quick"])
    assert result.exit_code == 0
    assert "motion, wall: compiled RRT-Connect" in result.stdout
    assert " us " in result.stdout
    assert " ms " in result.stdout
    assert "within 0.5 s" in result.stdout


def test_by_default_every_puzzle_is_solved():
    """All nine puzzles take part, and there are at least twenty seeds where that costs little."""
    names = [contest.name for contest in contests(Effort(levels=1))]
    assert sum(name.startswith("puzzle, ") for name in names) == 9
    assert len(set(names)) == len(names)
    assert min(Effort().queries, Effort().solves) >= 20


def test_medians_and_turns():
    """Both take turns of some seeds after one turn that does not count; times are divided by the repeats."""
    calls: list[tuple[str, int]] = []
    now = [0.0]

    def work(name: str, seconds: float, seed: int) -> None:
        calls.append((name, seed))
        now[0] += seconds * (1 + seed)

    seeds = TURN + 3
    contest = Contest(
        "ours", lambda seed: work("a", 1.0, seed), seeds, "theirs", lambda seed: work("b", 10.0, seed), 3, repeats=2
    )
    row = measure(contest, clock=lambda: now[0])
    turns = [("a", 0), ("b", 0), *(("a", k) for k in range(TURN)), *(("b", k) for k in range(3))]
    assert calls == [*turns, *(("a", k) for k in range(TURN, seeds))]
    ours = (1 + np.arange(seeds)) / 2
    assert row == BenchRow(
        "ours", np.median(ours), np.percentile(ours, 95), seeds, "theirs", 10.0, 10 / np.median(ours)
    )


def test_without_a_peer():
    """There is nothing to compare with; a preparation takes the place of the first turn."""
    seeds, prepared, ticks = [], [], count()
    contest = Contest("alone", seeds.append, 3, prepare=lambda: prepared.append(len(seeds)))
    row = measure(contest, clock=lambda: float(next(ticks)))
    assert (seeds, prepared) == ([0, 1, 2], [0])
    assert row == BenchRow("alone", 1.0, 1.0, 3, None, None, None)


@pytest.mark.parametrize("name", GOALS)
def test_shapely_answers_the_same_question(name: str):
    """Of many random segments shapely finds as many free as the exact test, but for a few that graze an arc."""
    problem = Problem(read_puzzle(name))
    space = problem.agent_space(problem.initial)
    starts, ends = np.random.default_rng(0).uniform(*space.bounds, (2, 2000, 2))
    free = int(np.count_nonzero(space.segments_free(starts, ends)))
    assert abs(ShapelyObstacles(space.obstacles).segments_free(starts, ends) - free) <= 4
    assert 100 < free < 1900


def sampled(path: FloatArray, step: float) -> FloatArray:
    """Points along a path, at most `step` apart."""
    pieces = [np.linspace(a, b, 2 + int(np.hypot(*(b - a)) / step)) for a, b in pairwise(path)]
    return np.vstack(pieces)


@pytest.mark.parametrize("name", GOALS)
def test_ompl_answers_the_same_question(name: str):
    """With points checked every 5 mm OMPL finds a path whose points are free."""
    problem = Problem(read_puzzle(name))
    space, goal = problem.agent_space(problem.initial), np.array(GOALS[name])
    path = ompl_with_sampled_checks()(space, problem.initial.agent, goal[None], 100_000, np.random.default_rng(0)).path
    assert path is not None
    np.testing.assert_array_equal(path[[0, -1]], [problem.initial.agent, goal])
    assert np.mean(space.points_free(sampled(path, STEP))) > 0.99


@pytest.mark.parametrize("name", SWITCH_PUZZLES)
def test_contact_curve_and_program_answer_the_same_question(name: str):
    """In these puzzles both find grasps with placements in the goal, and those of the program hold."""
    problem = Problem(read_puzzle(name))
    contest = switch_contest(name, problem, 1)
    assert contest.peer_work is not None
    releases, solutions = contest.work(0), contest.peer_work(0)
    assert isinstance(releases, np.ndarray)
    assert isinstance(solutions, list)
    assert len(releases) > 0
    held, start = problem.goal_index, problem.initial.objects[problem.goal_index]
    agent_space = problem.agent_space(problem.initial, held=held)
    for grasp, placement in solutions:
        assert agent_space.points_free(np.array([grasp, grasp + placement - start])).all()
    assert solutions

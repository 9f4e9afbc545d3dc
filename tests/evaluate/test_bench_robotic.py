"""The engine `robotic` as a peer: asked about the same scene in its own coordinates; real where it is installed."""

import importlib.machinery
import sys
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

from evaluate.bench_contests import GOALS, motion_contests, read_puzzle
from evaluate.bench_robotic import NAME, is_installed, robotic_rrt
from planner.problem import Problem


class Finder:
    """A finder that drives straight, once."""

    def __init__(self) -> None:
        self.solved = 0

    def setOptions(self, **options: float) -> None:  # noqa: N802  # the engine's name
        """Takes the options."""
        self.options = options

    def setProblem(self, configuration: "Configuration") -> None:  # noqa: N802  # as above
        """Takes the scene."""
        self.configuration = configuration

    def setStartGoal(self, start: np.ndarray, goal: np.ndarray) -> None:  # noqa: N802  # as above
        """Takes the query, in joint coordinates."""
        self.ends = np.array([start, goal])

    def solve(self, verbose: int) -> SimpleNamespace:
        """The straight motion, the first time it is asked."""
        assert verbose == 0
        self.solved += 1
        return SimpleNamespace(feasible=self.solved == 1, x=self.ends)


class Configuration:
    """A configuration that remembers what it has read."""

    def addFile(self, path: str) -> None:  # noqa: N802  # as above
        """Reads the scene."""
        with open(path, encoding="utf-8") as file:  # noqa: PTH123  # the engine takes plain names
            self.text = file.read()


@pytest.fixture
def engine(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """A stand-in for the engine."""
    module = ModuleType(NAME)
    module.__spec__ = importlib.machinery.ModuleSpec(NAME, None)
    finders: list[Finder] = []

    def new_finder() -> Finder:
        finders.append(Finder())
        return finders[-1]

    vars(module).update(Config=Configuration, RRT_PathFinder=new_finder, rnd_seed=lambda _: None, finders=finders)
    monkeypatch.setitem(sys.modules, NAME, module)
    return module


def test_queries_are_in_the_coordinates_of_the_joint(engine: ModuleType):
    """The agent of O-Room starts at (1.7, 0), where its joint is 0; paths come back in world coordinates."""
    scene = read_puzzle("o-room")
    query = robotic_rrt(scene, GOALS["o-room"], iterations=77, queries=2)
    for seed in range(2):
        np.testing.assert_allclose(query(seed), [scene.agent.position, GOALS["o-room"]])
    for finder in engine.finders:
        np.testing.assert_allclose(finder.ends, [[0.0, 0.0], GOALS["o-room"] - scene.agent.position])
        assert finder.options == {"verbose": 0, "maxIters": 77, "collisionTolerance": scene.tolerance}
        assert "limits:[-3.75 -2.05 0.35 2.05]" in finder.configuration.text


def test_it_competes_only_where_it_is_installed(engine: ModuleType, monkeypatch: pytest.MonkeyPatch):
    """Its contest needs a finder for every seed and one to warm up."""
    problem = Problem(read_puzzle("wall"))
    assert is_installed()
    with_engine = [contest.peer for contest in motion_contests("wall", problem, seeds=3)]
    assert with_engine[-1] == "robotic's RRT"
    assert len(engine.finders) == 4
    monkeypatch.setattr("evaluate.bench_robotic.find_spec", lambda _: None)
    assert [contest.peer for contest in motion_contests("wall", problem, seeds=3)] == with_engine[:-1]


@pytest.mark.skipif(not is_installed(), reason="the engine is not installed")
@pytest.mark.parametrize("name", GOALS)
def test_it_finds_ways_that_are_free(name: str):
    """The engine's own collision tests and ours agree about the way-points of its path."""
    scene = read_puzzle(name)
    path = robotic_rrt(scene, GOALS[name], iterations=100_000, queries=1)(0)
    assert path is not None
    problem = Problem(scene)
    assert problem.agent_space(problem.initial).points_free(path).all()

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pytest

from pcg.agents import read_agents
from pcg.compare import Task, band_tasks, compare, measure, standard_tasks, two_rooms
from pcg.level import Level
from pcg.random_source import RandomSource
from pcg.request import Proposal, Request
from pcg.solver import solve

TASK = Task("any", Request())


def level_with_target(column: int) -> Level:
    """One row: player, goal crate, and another crate out of the way; the target further right."""
    wall = np.zeros((3, 8), dtype=np.bool_)
    return Level.of(wall, players=[(1, 0)], crates=[(1, 1), (0, 0)], targets=[(1, column)], goal_crate=(1, 1))


@dataclass(frozen=True)
class Scripted:
    """Proposes the same four things again and again: failure, a level, the same level, another one."""

    representation: None = None
    weights_hash: None = None

    def proposals(self, request: Request, seed: int) -> Iterator[Proposal]:
        """Ten attempts and a hundred steps in four proposals."""
        del request, seed
        a, b = level_with_target(4), level_with_target(6)
        while True:
            yield Proposal(None, None, 5, {"easy": 5}, 50)
            for level in (a, a, b):
                yield Proposal(level, solve(level), 1, {}, 10)
            yield Proposal(None, None, 2, {"easy": 2}, 20)


def test_everything_is_counted():
    """Attempts, steps, requests met and distinct levels of a scripted source, until the clock stops it."""
    ticks = iter([0.0, *(float(n) for n in range(6)), 5.0])
    m = measure("s", Scripted(), TASK, 0, cpu_limit=5.0, max_levels=10, clock=lambda: next(ticks))
    assert (m.attempts, m.steps, m.met, m.levels, m.cpu_s) == (10, 100, 3, 2, 5.0)
    assert m.levels_per_cpu_s == pytest.approx(0.4)
    assert (m.mean_pushes, m.dependency, m.goal_entropy) == (4.0, 0.0, 0.0)
    assert m.hamming == pytest.approx(2 / 24)


def test_enough_levels_end_a_run():
    """The run stops at the number of distinct levels, not of proposals."""
    m = measure("s", Scripted(), TASK, 0, cpu_limit=1e9, max_levels=2)
    assert (m.levels, m.met) == (2, 3)


def test_nothing_found_has_no_means():
    """A source without success has a row too."""
    m = measure("r", RandomSource(), Task("hard", Request(pushes=(900, 1000))), 0, cpu_limit=0.05, max_levels=1)
    assert (m.levels, m.mean_pushes, m.dependency, m.hamming, m.goal_entropy) == (0, None, None, None, None)
    assert m.attempts > 0
    assert m.levels_per_cpu_s == 0


def test_all_sources_work_on_all_tasks_with_all_seeds():
    """One measurement each; the same seed gives the same levels."""
    sources = {"a": RandomSource(), "b": RandomSource()}
    runs = list(compare(sources, [TASK], [4, 5], cpu_limit=60, max_levels=3))
    assert [(m.source, m.task, m.seed) for m in runs] == [(s, "any", n) for n in (4, 5) for s in ("a", "b")]
    by_seed = {(m.source, m.seed): (m.attempts, m.mean_pushes, m.hamming) for m in runs}
    assert by_seed["a", 4] == by_seed["b", 4] != by_seed["a", 5]


def test_the_standard_tasks_make_sense():
    """Different names; each can be met by the baseline in principle; the two rooms are one region."""
    tasks = standard_tasks()
    assert len({task.name for task in tasks}) == len(tasks)
    assert any(task.request.frozen == two_rooms() for task in tasks)
    (rooms,) = (task.request for task in tasks if task.request.frozen is not None)
    assert next(RandomSource().proposals(rooms, 0)).attempts > 0


def test_agents_with_one_request_share_a_task():
    """36 agents have twelve pairs of bands."""
    tasks = band_tasks(agent.request for agent in read_agents().values())
    assert len({task.name for task in tasks}) == len(tasks) == 12
    assert tasks[0].name == "3 to 6 pushes, 7-10 walls"

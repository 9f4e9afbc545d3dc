"""Candidates, the filter and the draw."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from converter.scene import Body
from converter.shape import FloatArray, Part
from planner.heuristics import scores_if
from planner.kernel import BoolArray
from planner.problem import Configuration, Problem
from planner.settings import METHODS, Settings, settings_for
from planner.subgoals import GENERATORS, Proposal, filter_best, propose_subgoals
from planner.subgoals_random import RandomSubgoals
from tests.planner.scenes import body, room, vectors, wall

PROBLEM = Problem(room(wall(0, 0.8, 0.4, 1.6), objects=(body("obj", -1, 1), body("other", 1, -1)), agent=(0, -1)))
WITH_FILTER, WITHOUT = Settings(method="Rnd+FPR"), Settings(method="Rnd+R")


class Fixed:
    """A generator of the same candidates everywhere."""

    def __init__(self, positions: FloatArray) -> None:
        self.positions = positions
        self.time_s = 0.0

    def candidates(self, configuration: Configuration, index: int, n: int, rng: np.random.Generator) -> FloatArray:
        """The first `n` of the positions."""
        del configuration, index, rng
        return self.positions[:n] if isinstance(self.positions, np.ndarray) else self.positions


def everywhere(positions: FloatArray) -> BoolArray:
    """Every position may be reached."""
    return np.ones(len(positions), dtype=bool)


def propose(settings: Settings, positions: FloatArray, seed: int = 0, index: int = 0) -> Proposal:
    """A proposal for one object at the start."""
    rng = np.random.default_rng(seed)
    return propose_subgoals(PROBLEM, Fixed(positions), PROBLEM.initial, index, everywhere, settings, rng)


@given(
    st.lists(st.sampled_from([0.0, 2.0, 5.0, 15.0]), min_size=1, max_size=30), st.integers(1, 40), st.integers(0, 99)
)
def test_the_filter_keeps_the_best(values: list[float], keep: int, seed: int):
    """As many as asked for, no index twice, and none that is left out is better than one that is kept."""
    scores = np.array(values)
    kept = filter_best(scores, keep, np.random.default_rng(seed))
    assert len(kept) == min(keep, len(scores))
    assert len(set(kept.tolist())) == len(kept)
    left_out = np.delete(scores, kept)
    assert len(left_out) == 0 or scores[kept].min() >= left_out.max()


def test_ties_are_broken_at_random():
    """Of equals each is kept about as often."""
    scores = np.array([1.0, 0.0, 1.0, 1.0, 1.0])
    rng = np.random.default_rng(0)
    counts = Counter(int(i) for _ in range(400) for i in filter_best(scores, 2, rng))
    assert set(counts) == {0, 2, 3, 4}
    assert min(counts.values()) > 140


def test_proposals_come_from_the_best_candidates():
    """With F the drawn ones are among the best by the hypothetical score, without F among all."""
    positions = np.random.default_rng(1).uniform(-1.9, 1.9, (50, 2))
    proposal = propose(WITH_FILTER, positions)
    expected = scores_if(PROBLEM, PROBLEM.initial, 0, positions)
    np.testing.assert_array_equal(proposal.scores, expected)
    assert len(proposal.passed) == round(WITH_FILTER.keep_share * 50)
    assert set(proposal.drawn.tolist()) <= set(proposal.passed.tolist())
    assert expected[proposal.passed].min() >= np.delete(expected, proposal.passed).max()
    np.testing.assert_array_equal(proposal.subgoals, positions[proposal.drawn])
    free = propose(WITHOUT, positions)
    assert sorted(free.passed) == list(range(50))


@pytest.mark.parametrize("settings", [WITH_FILTER, WITHOUT])
def test_as_many_subgoals_with_the_filter_as_without(settings: Settings):
    """The filter does not change how many are drawn, and over many draws each that passed has its turn."""
    positions = np.random.default_rng(1).uniform(-1.9, 1.9, (50, 2))
    drawn: Counter[int] = Counter()
    for seed in range(100):
        proposal = propose(settings, positions, seed)
        assert len(proposal.subgoals) == settings.subgoals_per_object
        drawn.update(proposal.drawn.tolist())
    assert len(drawn) >= 10


def test_positions_that_no_carry_leads_to_are_left_out():
    """Only candidates that the solver calls placeable are scored and drawn."""
    positions = np.random.default_rng(1).uniform(-1.9, 1.9, (50, 2))
    rng = np.random.default_rng(0)
    proposal = propose_subgoals(
        PROBLEM, Fixed(positions), PROBLEM.initial, 0, lambda p: np.asarray(p[:, 0] > 0), WITHOUT, rng
    )
    np.testing.assert_array_equal(proposal.candidates, positions[positions[:, 0] > 0])


@pytest.mark.parametrize("settings", [WITH_FILTER, WITHOUT])
@pytest.mark.parametrize("index", [0, 1])
def test_no_candidates_no_subgoals(settings: Settings, index: int):
    """Where an object can go nowhere only the trivial subgoal is left."""
    assert propose(settings, np.empty((0, 2)), index=index).subgoals.shape == (0, 2)


def test_a_single_candidate_passes_the_filter():
    """The best share of one is that one."""
    np.testing.assert_array_equal(propose(WITH_FILTER, vectors([1, 1])).subgoals, vectors([1, 1]))


def test_every_method_of_the_forward_search_has_a_generator():
    """Methods with letters name their generator first."""
    assert {method.split("+")[0] for method in METHODS if "+" in method} == set(GENERATORS)


@pytest.mark.parametrize("index", [0, 1])
def test_random_candidates_are_free_and_everywhere(index: int):
    """As many as asked for, free of walls and the other object, in all quarters of the room, fixed by the seed."""
    generator = RandomSubgoals(PROBLEM, settings_for("faithful"))
    found, again = (generator.candidates(PROBLEM.initial, index, 200, np.random.default_rng(3)) for _ in range(2))
    np.testing.assert_array_equal(found, again)
    assert found.shape == (200, 2)
    assert PROBLEM.object_space(PROBLEM.initial, index).points_free(found).all()
    quarters = Counter(map(tuple, (found > 0).tolist()))
    assert len(quarters) == 4
    assert min(quarters.values()) > 20
    assert np.abs(found).max() <= 2


def test_near_candidates_come_at_every_scale():
    """Of five squares around the object, each half as wide as the one before, each has its share."""
    here = PROBLEM.initial.objects[0]
    generator = RandomSubgoals(PROBLEM, Settings(near_share=1.0))
    found = generator.candidates(PROBLEM.initial, 0, 3000, np.random.default_rng(0))
    distances = np.abs(found - here).max(axis=1)
    assert distances.max() <= 1
    assert np.abs(np.corrcoef((found - here).T)[0, 1]) < 0.2
    for scale in range(1, 6):
        assert (distances <= 2 / 2**scale).mean() > (5.5 - scale) / 5


def test_an_object_that_fits_nowhere_else_has_no_candidates():
    """Under a ceiling with a hole of its size a tall object can go nowhere, so the generator gives up."""
    tall = Body("obj", np.array([0.0, 0.0, 0.2]), 0.4, (Part.box((0.2, 0.2)),))
    sides = [(-1.1, 0, 2, 4.2), (1.1, 0, 2, 4.2), (0, 1.1, 0.2, 2), (0, -1.1, 0.2, 2)]
    ceiling = [body(f"ceiling {i}", x, y, Part.box((sx, sy)), z=0.3) for i, (x, y, sx, sy) in enumerate(sides)]
    problem = Problem(room(*ceiling, objects=(tall,), agent=(1.0, 1.0)))
    assert problem.object_space(problem.initial, 0).point_free(np.zeros(2))
    found = RandomSubgoals(problem, WITHOUT).candidates(problem.initial, 0, 100, np.random.default_rng(0))
    assert found.shape == (0, 2)


@pytest.mark.parametrize("settings", [WITH_FILTER, WITHOUT])
def test_as_many_are_drawn_with_a_filter_as_without(settings: Settings):
    """Few candidates do not make the filter draw fewer subgoals."""
    positions = np.random.default_rng(2).uniform(-1.9, 1.9, (8, 2))
    assert len(propose(settings, positions).drawn) == settings.subgoals_per_object


@pytest.mark.parametrize("given", ["nowhere", None, np.zeros(2), np.zeros((2, 3)), [[0.0, np.nan]], [[0.0, "x"]]])
def test_generators_from_outside_give_positions(given: object):
    """Anything else is said to be wrong where it comes from."""
    with pytest.raises(TypeError, match=r"subgoal generator returned .*, allowed are \(k, 2\) finite numbers"):
        propose(WITHOUT, given)  # type: ignore[arg-type]  # what somebody else's generator may do


def test_generators_from_outside_may_give_lists():
    """Lists of pairs, and none."""
    assert propose(WITHOUT, [[0.0, 1.0]]).candidates.tolist() == [[0.0, 1.0]]  # type: ignore[arg-type]  # as above
    assert propose(WITHOUT, []).candidates.shape == (0, 2)  # type: ignore[arg-type]  # as above

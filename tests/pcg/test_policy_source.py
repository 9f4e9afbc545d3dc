from itertools import islice

import numpy as np
import pytest

from pcg.agents import policy_path, read_agents
from pcg.errors import InputError
from pcg.examine import examined
from pcg.policy import load_policy
from pcg.policy_source import PolicySource, UntrainedPolicy, policies_of, source_of
from pcg.request import Request
from pcg.symmetry import tiles_hash

OPEN = Request(wall_density=(0.0, 0.4), pushes=(1, 1000))


@pytest.mark.parametrize("representation", ["narrow", "turtle", "wide"])
def test_levels_of_policies_are_tested_again(representation: str):
    """Each level meets the request, each failure has one reason, each attempt has steps."""
    source = PolicySource(load_policy(policy_path(representation)))
    proposals = list(islice(source.proposals(OPEN, 0), 128))
    assert any(proposal.level is not None for proposal in proposals)
    for proposal in proposals:
        assert proposal.attempts == 1
        assert proposal.steps > 0
        if proposal.level is None:
            assert sum(proposal.rejected.values()) == 1
        else:
            assert not proposal.rejected
            assert isinstance(examined(proposal.level, OPEN), tuple)
    assert source.representation == representation


def test_the_seed_decides():
    """The same seed gives the same attempts, another one others."""

    def levels(seed: int) -> list[str]:
        proposals = islice(source_of(read_agents()["m0"]).proposals(OPEN, seed), 96)
        return [tiles_hash(proposal.level) for proposal in proposals if proposal.level is not None]

    assert levels(1) == levels(1) != levels(2)


def test_an_untrained_policy_takes_all_actions_alike():
    """Frequencies of many actions are near to equal, and depend on the generator alone."""
    policy = load_policy(policy_path("turtle"))
    untrained = UntrainedPolicy(policy.settings, policy.weights_hash, policy.session)
    observed = np.zeros((7000, 1), dtype=np.float32)
    actions = untrained.sample(observed, np.random.default_rng(0))
    counts = np.bincount(actions)
    assert counts.min() > 0.8 * 7000 / len(counts)
    assert (actions == untrained.sample(observed, np.random.default_rng(0))).all()


def test_policies_by_representation():
    """One for all agents that share it."""
    policies = policies_of(read_agents().values())
    assert {name: policy.representation for name, policy in policies.items()} == {n: n for n in policies}
    assert set(policies) == {"narrow", "turtle", "wide"}


def test_another_size_is_refused():
    """A policy makes levels of the size that it was trained for."""
    source = source_of(read_agents()["m0"])
    with pytest.raises(InputError, match="policy narrow: asked for 5 x 10 cells"):
        next(source.proposals(Request(rows=5), 0))

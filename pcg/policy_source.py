"""Levels by policies, trained or not."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from pcg.agents import Agent, policy_path
from pcg.arrays import Float32Array, IntArray
from pcg.examine import examined
from pcg.policy import Policy, load_policy, policy_levels
from pcg.request import Proposal, Rejection, Request


@dataclass(frozen=True)
class PolicySource:
    """Runs a policy; an attempt is an episode.

    Levels are taken as the policy left them, without any repair, and tested by `examined`: the policy's own account of
    what it met does not count.
    """

    policy: Policy

    @property
    def representation(self) -> str:
        """How the policy edits levels."""
        return self.policy.representation

    @property
    def weights_hash(self) -> str:
        """SHA-256 of the policy's file."""
        return self.policy.weights_hash

    def proposals(self, request: Request, seed: int) -> Iterator[Proposal]:
        """One proposal an episode; see `LevelSource`.

        Raises:
            InputError: the policy cannot make levels of this kind.
        """
        targets = _targets(request)
        for attempt in policy_levels(self.policy, request, np.random.default_rng(np.random.SeedSequence(seed))):
            outcome = attempt.rejection if attempt.level is None else examined(attempt.level, request)
            if isinstance(outcome, tuple):
                yield Proposal(*outcome, 1, {}, attempt.steps, targets)
            else:
                reason = outcome or Rejection.UNFINISHED
                yield Proposal(None, None, 1, {reason.value: 1}, attempt.steps, targets)


@dataclass(frozen=True)
class UntrainedPolicy(Policy):
    """A policy that takes all actions alike, as networks do before their first update."""

    def sample(self, observed: Float32Array, rng: np.random.Generator) -> IntArray:
        """(n,) actions; see `Policy.sample`."""
        (logits,) = self.session.get_outputs()
        return rng.integers(logits.shape[1], size=len(observed))


def policies_of(agents: Iterable[Agent]) -> dict[str, Policy]:
    """The policies of agents by representation.

    Raises:
        InputError: a policy is missing or cannot be read.
    """
    return {name: load_policy(policy_path(name)) for name in dict.fromkeys(agent.representation for agent in agents)}


def source_of(agent: Agent) -> PolicySource:
    """The source of an agent's levels.

    Raises:
        InputError: its policy is missing or cannot be read.
    """
    return PolicySource(load_policy(policy_path(agent.representation)))


def _targets(request: Request) -> dict[str, float]:
    """What is asked for, by name; open bands and wishes without preference are left out."""
    asked = {
        "min_wall_density": request.wall_density[0],
        "max_wall_density": request.wall_density[1],
        "min_pushes": request.pushes[0],
        "max_pushes": request.pushes[1],
        "occluded": request.occluded,
        "dependency": request.dependency,
    }
    return {name: float(value) for name, value in asked.items() if value is not None}

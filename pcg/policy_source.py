"""Levels by trained policies."""

from pcg.agents import Agent, policy_path
from pcg.errors import InputError
from pcg.request import LevelSource


def source_of(agent: Agent) -> LevelSource:
    """The source of an agent's levels.

    Raises:
        InputError: its policy is missing or cannot be read.
    """
    path = policy_path(agent.representation)
    raise InputError(str(path), "no such policy")

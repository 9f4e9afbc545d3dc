"""What the performance table times of the generator: steps of the environments.

Two regimes: *solvable starts*, fresh levels that random actions then spoil, with an empty cache of verdicts, the regime
in which maps have to be solved all the time; and *random starts*, as a training begins. Times are for one step of one
environment, with its observation, in one process.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import islice

import numpy as np

from evaluate.bench import Contest
from pcg.episodes import Beginning, Episodes, EpisodeSettings
from pcg.level import TileArray
from pcg.observation import observation_parts
from pcg.random_source import RandomSource
from pcg.representation import REPRESENTATIONS
from pcg.request import Request
from pcg.task import request_beginning

BATCHES = {"solvable starts": 64, "random starts": 512}
"""Environments that are stepped together."""

STEPS = 100
"""Steps of the batch in one measurement."""

LEVELS = 1000
"""Solvable levels that episodes begin with, one after the other."""


def environment_contests(seeds: int) -> Iterator[Contest]:
    """Steps of each representation in both regimes.

    Args:
        seeds: How often each is timed.
    """
    proposals = (proposal.level for proposal in RandomSource().proposals(Request(), 0))
    levels = np.array([level.tiles for level in islice((level for level in proposals if level), LEVELS)])
    for name in REPRESENTATIONS:
        for regime, starts in (("solvable starts", levels), ("random starts", None)):
            work = _stepping(EpisodeSettings(name), BATCHES[regime], starts)
            repeats = STEPS * BATCHES[regime]
            yield Contest(f"environment step, {name}: {regime}", work, seeds, repeats=repeats)


def _stepping(settings: EpisodeSettings, n: int, starts: TileArray | None) -> Callable[[int], object]:
    """Steps a new batch with uniform actions; ended episodes begin anew."""

    def step(seed: int) -> object:
        rng = np.random.default_rng(seed)
        episodes = Episodes(settings, n)
        offset = int(rng.integers(LEVELS))

        def beginning(count: int) -> Beginning:
            nonlocal offset
            begun = request_beginning(rng, count, Request(), settings)
            if starts is None:
                return begun
            offset += count
            return replace(begun, maps=starts[np.arange(offset - count, offset) % len(starts)])

        episodes.begin(rng, np.arange(n), beginning(n))
        for actions in rng.integers(episodes.representation.n_actions, size=(STEPS, n)):
            done = episodes.step(actions)
            observation_parts(episodes)
            if len(ended := np.flatnonzero(done.terminated | done.truncated)):
                episodes.begin(rng, ended, beginning(len(ended)))
        return episodes.judge.hit_rate

    return step

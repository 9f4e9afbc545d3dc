"""What the performance table times of the generator: steps of the environments.

Two regimes: *solvable starts*, fresh levels that uniform actions then spoil, with an empty cache of verdicts, the regime
in which maps have to be solved all the time; and *random starts*, as a training begins. Environments are stepped in
batches, and one by one, as Gymnasium does it. Times are for one step of one environment, with its observation, in one
process. Beside them: the share of solver verdicts that came from the cache, and the share of steps that changed the map.
"""

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from itertools import islice

import numpy as np

from evaluate.bench import Contest
from pcg.environment import SokobanEnvironment
from pcg.episodes import Beginning, Episodes, EpisodeSettings
from pcg.level import TileArray
from pcg.observation import observation_parts
from pcg.random_source import RandomSource
from pcg.representation import REPRESENTATIONS
from pcg.request import Request
from pcg.task import request_beginning

BATCHES = {"solvable starts": 64, "random starts": 512}
"""Environments that are stepped together."""

STEPS, SINGLE_STEPS = 100, 1000
"""Steps in one measurement, of a batch and of one environment."""

LEVELS = 1000
"""Solvable levels that episodes begin with, one after the other."""


@dataclass(frozen=True)
class _Stepped:
    """What a measurement says beside its time.

    Attributes:
        cache_hits: Share of solver verdicts that came from the cache.
        maps_changed: Share of steps that changed the map.
    """

    cache_hits: float
    maps_changed: float


def environment_contests(seeds: int) -> Iterator[Contest]:
    """Steps of each representation in both regimes, in batches and alone.

    Args:
        seeds: How often each is timed.
    """
    proposals = (proposal.level for proposal in RandomSource().proposals(Request(), 0))
    levels = np.array([level.tiles for level in islice((level for level in proposals if level), LEVELS)])
    for name in REPRESENTATIONS:
        for regime, starts in (("solvable starts", levels), ("random starts", None)):
            batch = BATCHES[regime]
            batched, alone = _batch_stepping(EpisodeSettings(name), batch, starts), _stepping(name, starts)
            title = f"environment step, {name}: {regime}"
            yield _contest(f"{title}, batches of {batch}", batched, seeds, STEPS * batch)
            yield _contest(f"{title}, one by one", alone, seeds, SINGLE_STEPS)


def _contest(name: str, step: Callable[[int], _Stepped], seeds: int, repeats: int) -> Contest:
    return Contest(name, step, seeds, repeats=repeats, figures=lambda: asdict(step(0)))


def _batch_stepping(settings: EpisodeSettings, n: int, starts: TileArray | None) -> Callable[[int], _Stepped]:
    """Steps a new batch with uniform actions; ended episodes begin anew."""

    def step(seed: int) -> _Stepped:
        rng = np.random.default_rng(seed)
        episodes = Episodes(settings, n)
        offset, changed = int(rng.integers(LEVELS)), 0

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
            changed += int(done.changed.sum())
            if len(ended := np.flatnonzero(done.terminated | done.truncated)):
                episodes.begin(rng, ended, beginning(len(ended)))
        return _Stepped(episodes.judge.hit_rate, changed / (STEPS * n))

    return step


def _stepping(name: str, starts: TileArray | None) -> Callable[[int], _Stepped]:
    """Steps a new environment with uniform actions; an ended episode begins anew."""

    def step(seed: int) -> _Stepped:
        env = SokobanEnvironment(name, request=Request())
        rng = np.random.default_rng(seed)
        offset, changed = int(rng.integers(LEVELS)), 0

        def begin() -> None:
            nonlocal offset
            offset += 1
            env.reset(options={} if starts is None else {"start": starts[offset % len(starts)]})

        env.reset(seed=seed)
        begin()
        changes = 0
        for action in rng.integers(env.episodes.representation.n_actions, size=SINGLE_STEPS):
            *_, terminated, truncated, information = env.step(action)
            changed += information["changes"] - changes
            changes = information["changes"]
            if terminated or truncated:
                begin()
                changes = 0
        return _Stepped(env.episodes.judge.hit_rate, changed / SINGLE_STEPS)

    return step

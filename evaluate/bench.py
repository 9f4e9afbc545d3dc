"""Performance: times of the parts that matter, each beside a peer timed in the same run.

A *contest* does one thing in our way and, where there is one, in the way of a peer, once for each seed. The two take
turns of `TURN` seeds, so that a busy machine slows down both, yet neither finds its caches filled by the other every
time. What is done beforehand does not count: libraries are loaded and functions compiled. Medians over the seeds are
compared. Absolute times are those of the machine; ratios carry over to others.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

TURN = 10
"""Seeds before it is the other's turn."""

Work = Callable[[int], object]
"""Does something once with a seed."""


@dataclass(frozen=True)
class Contest:
    """What to time.

    Attributes:
        name: What is done, and how we do it.
        work: Does it our way.
        seeds: How often it is timed.
        peer: How the peer does it; None without a peer.
        peer_work: Does it the peer's way.
        peer_seeds: How often the peer is timed, at most `seeds`; None for as often.
        repeats: How often `work` and `peer_work` do the thing in one call; times are divided by it.
        prepare: What is done before the first turn; None for doing both once.
        figures: Shares that belong to the thing, by name, found after the last turn; None without any.
    """

    name: str
    work: Work
    seeds: int
    peer: str | None = None
    peer_work: Work | None = None
    peer_seeds: int | None = None
    repeats: int = 1
    prepare: Callable[[], object] | None = None
    figures: Callable[[], Mapping[str, float]] | None = None


@dataclass(frozen=True)
class BenchRow:
    """What came of a contest.

    Attributes:
        name: Of the contest.
        median_s: Median time [s].
        p95_s: 95th percentile [s].
        n: Number of seeds.
        peer: How the peer does it; None without a peer.
        peer_median_s: Median time of the peer [s].
        ratio: How many times longer the peer takes: `peer_median_s / median_s`.
        figures: The contest's shares, by name.
    """

    name: str
    median_s: float
    p95_s: float
    n: int
    peer: str | None
    peer_median_s: float | None
    ratio: float | None
    figures: Mapping[str, float] = field(default_factory=dict)


def measure(contest: Contest, clock: Callable[[], float] = time.perf_counter) -> BenchRow:
    """Times a contest; `clock` gives seconds."""
    sides = [(contest.work, contest.seeds)]
    if contest.peer_work is not None:
        sides.append((contest.peer_work, contest.seeds if contest.peer_seeds is None else contest.peer_seeds))
    if contest.prepare is not None:
        contest.prepare()
    else:
        for work, _ in sides:
            work(0)
    times: list[list[float]] = [[] for _ in sides]
    for first in range(0, contest.seeds, TURN):
        for taken, (work, seeds) in zip(times, sides, strict=True):
            for seed in range(first, min(first + TURN, seeds)):
                started = clock()
                work(seed)
                taken.append((clock() - started) / contest.repeats)
    medians = [float(np.median(taken)) for taken in times]
    peer_median = medians[1] if len(medians) > 1 else None
    return BenchRow(
        name=contest.name,
        median_s=medians[0],
        p95_s=float(np.percentile(times[0], 95)),
        n=contest.seeds,
        peer=contest.peer,
        peer_median_s=peer_median,
        ratio=None if peer_median is None else peer_median / medians[0],
        figures={} if contest.figures is None else contest.figures(),
    )

"""Generating levels: a source proposes, duplicates are dropped, what was thrown away is counted.

The source is the random baseline or a trained policy; see `pcg.request.LevelSource`. Levels are called
`{agent}-{seed}-{index}`.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

from pcg.errors import InputError
from pcg.level_set import GeneratedLevel
from pcg.random_source import RandomSource
from pcg.request import LevelSource, Rejection, Request
from pcg.symmetry import content_hash

RANDOM_AGENT = "random"

MAX_ATTEMPTS = 100_000
"""Attempts by level, by default."""


def generated_levels(
    source: LevelSource, request: Request, seed: int, agent: str = RANDOM_AGENT, max_attempts: int = MAX_ATTEMPTS
) -> Iterator[GeneratedLevel]:
    """Levels without end, distinct up to symmetry.

    Level i depends on source, request and seed alone, not on how many levels are taken.

    Args:
        source: Proposes levels.
        request: What they have to be.
        seed: At least 0.
        agent: Name of the generator; the levels' names begin with it.
        max_attempts: The source is given up when it needs as many for one level.

    Raises:
        ValueError: the seed is negative.
        InputError: no level was found in `max_attempts` attempts, or the request contradicts itself.
    """
    taken: set[str] = set()
    rejected: Counter[str] = Counter()
    steps = 0
    for proposal in source.proposals(request, seed):
        rejected.update(proposal.rejected)
        steps += proposal.steps
        if proposal.level is not None and proposal.solution is not None:
            digest = content_hash(proposal.level)
            if digest not in taken:
                yield GeneratedLevel(
                    level=replace(proposal.level, name=f"{agent}-{seed}-{len(taken)}"),
                    solution=proposal.solution,
                    agent=agent,
                    seed=seed,
                    representation=source.representation,
                    weights_hash=source.weights_hash,
                    control_targets=proposal.targets,
                    rejected=dict(rejected),
                    steps=steps,
                )
                taken.add(digest)
                rejected, steps = Counter(), 0
                continue
            rejected[Rejection.DUPLICATE.value] += 1
        if rejected.total() >= max_attempts:
            raise InputError("generator", _given_up(rejected))


def random_levels(
    seed: int, request: Request | None = None, max_attempts: int = MAX_ATTEMPTS
) -> Iterator[GeneratedLevel]:
    """Random levels without end; see `generated_levels`."""
    return generated_levels(RandomSource(), request or Request(), seed, max_attempts=max_attempts)


def _given_up(rejected: Counter[str]) -> str:
    reasons = ", ".join(f"{number} {reason}" for reason, number in rejected.most_common())
    return f"no level in {rejected.total()} attempts ({reasons}); ask for less, such as fewer pushes"

"""Comparing sources of levels: what they yield, how fast, how different the levels are, how often requests are met.

A *task* asks for levels of one kind. Every source works on every task with several seeds, for a budget of CPU time or
until it has made enough distinct levels. CPU time counts from the first attempt to the last, the solver included; whatever
is compiled or loaded once is not. All sources are tested by the same `examined`, with the same solver.

A *step* is an edit of one tile: for a policy a step of its environment, whether it changes the tile or not; for the random
baseline a wall or a thing that it places.
"""

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pcg.dependency import has_dependency
from pcg.diversity import goal_cell_entropy, mean_hamming_distance
from pcg.frozen import OPEN, FrozenTiles
from pcg.level import Level, Tile
from pcg.request import MAX_PUSHES, LevelSource, Request
from pcg.symmetry import content_hash

PUBLISHED_DENSITY = (0.07, 0.26)
"""Of the published scenes."""


@dataclass(frozen=True)
class Task:
    """A kind of levels.

    Attributes:
        name: What is asked for.
        request: The same, for a source.
    """

    name: str
    request: Request


@dataclass(frozen=True)
class Measurement:
    """What a source did on a task with a seed.

    Attributes:
        source: Name of the source.
        task: Name of the task.
        seed: Of the run.
        cpu_s: CPU time [s].
        attempts: Attempts, the last ones included.
        steps: Edits of tiles in all of them.
        met: Attempts whose level is what was asked for.
        levels: Of these, those distinct up to symmetry.
        mean_pushes: Mean least number of pushes of the distinct levels; None without any, and so are the others.
        dependency: Share with a dependency.
        hamming: Mean share of cells in which two of them differ; None for fewer than two.
        goal_entropy: Entropy of the goal crates' cells in bits.
    """

    source: str
    task: str
    seed: int
    cpu_s: float
    attempts: int
    steps: int
    met: int
    levels: int
    mean_pushes: float | None
    dependency: float | None
    hamming: float | None
    goal_entropy: float | None

    @property
    def levels_per_cpu_s(self) -> float:
        """Distinct levels by CPU time [1/s]."""
        return self.levels / self.cpu_s if self.cpu_s > 0 else 0.0


def measure(
    name: str,
    source: LevelSource,
    task: Task,
    seed: int,
    *,
    cpu_limit: float,
    max_levels: int,
    clock: Callable[[], float] = time.process_time,
) -> Measurement:
    """Lets a source work on a task until the CPU time [s] is spent or there are `max_levels` distinct levels."""
    found: dict[str, tuple[Level, int]] = {}
    attempts = steps = met = 0
    proposals = source.proposals(task.request, seed)
    began = clock()
    while len(found) < max_levels and clock() - began < cpu_limit:
        proposal = next(proposals)
        attempts += proposal.attempts
        steps += proposal.steps
        if proposal.level is not None and proposal.solution is not None:
            met += 1
            found.setdefault(content_hash(proposal.level), (proposal.level, proposal.solution.pushes or 0))
    cpu_s = clock() - began
    levels = [level for level, _ in found.values()]
    return Measurement(
        source=name,
        task=task.name,
        seed=seed,
        cpu_s=cpu_s,
        attempts=attempts,
        steps=steps,
        met=met,
        levels=len(levels),
        mean_pushes=float(np.mean([pushes for _, pushes in found.values()])) if levels else None,
        dependency=float(np.mean([has_dependency(level) is True for level in levels])) if levels else None,
        hamming=mean_hamming_distance(levels),
        goal_entropy=goal_cell_entropy(levels),
    )


def compare(
    sources: dict[str, LevelSource], tasks: Sequence[Task], seeds: Sequence[int], *, cpu_limit: float, max_levels: int
) -> Iterator[Measurement]:
    """Every source on every task with every seed, one after the other; see `measure`."""
    for source in sources.values():
        # Compiles and loads what is needed.
        measure("", source, tasks[0], 0, cpu_limit=0.1, max_levels=1)
    for task in tasks:
        for seed in seeds:
            for name, source in sources.items():
                yield measure(name, source, task, seed, cpu_limit=cpu_limit, max_levels=max_levels)


def standard_tasks() -> list[Task]:
    """The tasks of the published comparison: any level, bands, and what rejection finds hard."""
    any_level = Request(wall_density=PUBLISHED_DENSITY, pushes=(3, MAX_PUSHES))

    def task(name: str, **changes: object) -> Task:
        fields = {**vars(any_level), **changes}
        return Task(name, Request(**fields))

    return [
        task("any level"),
        task("3 to 6 pushes, 15-19 walls", pushes=(3, 6), wall_density=(0.15, 0.19)),
        task("12 to 19 pushes, 7-10 walls", pushes=(12, 19), wall_density=(0.07, 0.10)),
        task("12 to 19 pushes, 20-26 walls", pushes=(12, 19), wall_density=(0.20, 0.26)),
        task("at least 16 pushes", pushes=(16, MAX_PUSHES)),
        task("at least 16 pushes, 7-10 walls", pushes=(16, MAX_PUSHES), wall_density=(0.07, 0.10)),
        task("at least 20 pushes", pushes=(20, MAX_PUSHES)),
        task("at least 20 pushes, 7-10 walls", pushes=(20, MAX_PUSHES), wall_density=(0.07, 0.10)),
        task("at least 24 pushes", pushes=(24, MAX_PUSHES)),
        task("dependency", dependency=True),
        task("dependency, at least 12 pushes", dependency=True, pushes=(12, MAX_PUSHES)),
        task("dependency, at least 16 pushes", dependency=True, pushes=(16, MAX_PUSHES)),
        task("dependency, at least 20 pushes", dependency=True, pushes=(20, MAX_PUSHES)),
        task("dependency, 7-10 walls", dependency=True, wall_density=(0.07, 0.10)),
        task("occluded, 7-10 walls", occluded=True, wall_density=(0.07, 0.10)),
        task("two rooms given, at least 16 pushes", frozen=two_rooms(), pushes=(16, MAX_PUSHES)),
    ]


def band_tasks(requests: Iterable[Request]) -> list[Task]:
    """A task for each request of agents, called after its bands; agents with the same request share one."""
    return [Task(_bands(request), request) for request in dict.fromkeys(requests)]


def _bands(request: Request) -> str:
    fewest, most = (round(density * request.cells) for density in request.wall_density)
    return f"{request.pushes[0]} to {request.pushes[1]} pushes, {fewest}-{most} walls"


def two_rooms(side: int = 10) -> FrozenTiles:
    """A wall across the middle with a door of two cells, the player above it, the target below: the rest is open."""
    tiles = np.full((side, side), OPEN, dtype=np.uint8)
    middle = side // 2
    tiles[middle] = Tile.WALL
    tiles[middle, 2:4] = Tile.FLOOR
    tiles[1, side - 2] = Tile.PLAYER
    tiles[side - 2, side - 2] = Tile.TARGET
    return FrozenTiles(tiles)

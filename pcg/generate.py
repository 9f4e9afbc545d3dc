"""The random baseline: walls, player, crates and targets at random, kept if the exact solver accepts the level.

Every learned generator has to beat this one. For each level a wall density is drawn once, and kept over all attempts, so
that rejection does not prefer open levels. An attempt adds walls in random order, leaving out each that would divide
the free cells, until their number is reached; then it places everything else on distinct free cells. It is thrown away
if it is too easy, unsolvable, or one of the eight symmetries of an earlier level.
"""

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from enum import StrEnum
from itertools import count as count_from
from itertools import islice

import numpy as np

from pcg.errors import InputError
from pcg.grid import BoolArray, cells_of, reachable
from pcg.level import Level
from pcg.level_set import GeneratedLevel, LevelSet
from pcg.solver import Solution, SolverStatus, solve
from pcg.symmetry import content_hash

RANDOM_AGENT = "random"


class Rejection(StrEnum):
    """Why an attempt was thrown away."""

    WALLS = "walls"
    """So many walls do not fit without dividing the free cells, or without filling those that are needed."""
    UNSOLVABLE = "unsolvable"
    UNDECIDED = "undecided"
    """The solver reached its limit of states."""
    EASY = "easy"
    """Fewer pushes than asked for solve it."""
    DUPLICATE = "duplicate"
    """Symmetric to an earlier level of the run."""


@dataclass(frozen=True)
class GeneratorSettings:
    """What random levels look like.

    Attributes:
        rows: Inner rows.
        columns: Inner columns.
        crates: Crates, at least as many as targets.
        targets: Targets, at least one.
        wall_density: Range of the walls by inner cells; each level draws its own uniformly. The published scenes have
            0.07 to 0.26.
        min_pushes: Pushes that a level needs at least. The published scenes need 3 to 19.
        max_attempts: Attempts by level.
        max_states: Limit of the solver, None for its default.
    """

    rows: int = 10
    columns: int = 10
    crates: int = 2
    targets: int = 1
    wall_density: tuple[float, float] = (0.05, 0.3)
    min_pushes: int = 3
    max_attempts: int = 10_000
    max_states: int | None = None

    def __post_init__(self) -> None:
        if min(self.rows, self.columns, self.targets, self.max_attempts) < 1:
            raise ValueError("rows, columns, targets and max_attempts must be at least 1")
        if self.crates < self.targets:
            raise ValueError(f"{self.crates} crates cannot cover {self.targets} targets")
        if not 0 <= self.wall_density[0] <= self.wall_density[1] <= 1:
            raise ValueError(f"wall_density {self.wall_density} must be a range within 0 and 1")
        if self.things > self.rows * self.columns:
            raise ValueError(f"{self.rows} x {self.columns} cells cannot hold {self.things} things")

    @property
    def things(self) -> int:
        """Cells taken by the player, the crates and the targets."""
        return 1 + self.crates + self.targets


def random_levels(seed: int, settings: GeneratorSettings | None = None) -> Iterator[GeneratedLevel]:
    """Random levels without end, called `random-{seed}-{index}`, each with its own generator.

    Level i depends on seed and settings alone, not on how many levels are taken.

    Raises:
        ValueError: the seed is negative.
        InputError: no level was found in `max_attempts` attempts.
    """
    settings = settings or GeneratorSettings()
    taken: set[str] = set()
    for index in count_from():
        rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(index,)))
        generated = _generated(rng, settings, taken, seed, f"{RANDOM_AGENT}-{seed}-{index}")
        taken.add(content_hash(generated.level))
        yield generated


def generate_random(
    count: int,
    seed: int,
    settings: GeneratorSettings | None = None,
    progress: Callable[[int], None] | None = None,
) -> LevelSet:
    """The first `count` of `random_levels`; `progress` is called with the number of finished levels.

    Raises:
        ValueError: the seed is negative.
        InputError: no level was found in `max_attempts` attempts.
    """
    levels = []
    for generated in islice(random_levels(seed, settings), count):
        levels.append(generated)
        if progress is not None:
            progress(len(levels))
    return LevelSet(tuple(levels))


def _generated(
    rng: np.random.Generator, settings: GeneratorSettings, taken: set[str], seed: int, name: str
) -> GeneratedLevel:
    density = rng.uniform(*settings.wall_density)
    walls = round(density * settings.rows * settings.columns)
    rejected: Counter[str] = Counter()
    for _ in range(settings.max_attempts):
        outcome = _attempt(rng, settings, walls, taken)
        if isinstance(outcome, Rejection):
            rejected[outcome.value] += 1
            continue
        level, solution = outcome
        return GeneratedLevel(
            level=replace(level, name=name, goal_crate=solution.goal_crate),
            solution=solution,
            agent=RANDOM_AGENT,
            seed=seed,
            control_targets={"wall_density": density},
            rejected=dict(rejected),
        )
    reasons = ", ".join(f"{number} {reason}" for reason, number in rejected.most_common())
    raise InputError(
        "generator", f"no level in {settings.max_attempts} attempts ({reasons}); ask for less, such as fewer pushes"
    )


def _attempt(
    rng: np.random.Generator, settings: GeneratorSettings, walls: int, taken: set[str]
) -> tuple[Level, Solution] | Rejection:
    is_wall = _random_walls(rng, settings, walls)
    if is_wall is None:
        return Rejection.WALLS
    level = _furnished(rng, settings, is_wall)
    solution = solve(level, max_states=settings.max_states)
    if solution.pushes is None:
        return Rejection.UNDECIDED if solution.status is SolverStatus.LIMIT else Rejection.UNSOLVABLE
    if solution.pushes < settings.min_pushes:
        return Rejection.EASY
    return Rejection.DUPLICATE if content_hash(level) in taken else (level, solution)


def _random_walls(rng: np.random.Generator, settings: GeneratorSettings, walls: int) -> BoolArray | None:
    """(rows, columns) mask with that many walls and one region of free cells, None if they did not fit."""
    shape = settings.rows, settings.columns
    is_wall: BoolArray = np.zeros(shape, dtype=np.bool_)
    if is_wall.size - walls < settings.things:
        return None
    for cell in rng.permutation(is_wall.size).tolist():
        if walls == 0:
            break
        is_wall.flat[cell] = True
        if _is_connected(~is_wall):
            walls -= 1
        else:
            is_wall.flat[cell] = False
    return is_wall if walls == 0 else None


def _is_connected(passable: BoolArray) -> bool:
    start = np.unravel_index(int(passable.argmax()), passable.shape)
    return bool((reachable(passable, [(int(start[0]), int(start[1]))]) == passable).all())


def _furnished(rng: np.random.Generator, settings: GeneratorSettings, is_wall: BoolArray) -> Level:
    free = cells_of(~is_wall)
    player, *others = (free[i] for i in rng.permutation(len(free))[: settings.things])
    crates, targets = others[: settings.crates], others[settings.crates :]
    return Level.of(is_wall, players=[player], crates=crates, targets=targets)

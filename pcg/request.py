"""What is asked of a generator, what it proposes, and why proposals are thrown away."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Protocol

from pcg.frozen import FrozenTiles
from pcg.level import Level
from pcg.solver import MAX_CELLS, Solution

MAX_PUSHES = 10_000
"""Largest number of pushes; stands for the upper end of a push band that has none."""


@dataclass(frozen=True)
class Request:
    """What a level has to be.

    Attributes:
        rows: Inner rows; with the columns at most `pcg.solver.MAX_CELLS` cells.
        columns: Inner columns.
        crates: Crates, at least as many as targets.
        targets: Targets, at least one.
        wall_density: Band of the walls by inner cells, inclusive. The published scenes have 0.07 to 0.26.
        pushes: Band of the least number of pushes, inclusive. The published scenes need 3 to 19.
        occluded: Whether the goal crate is to be hidden from the player (`metrics.occluded`); None for either.
        dependency: Whether another crate has to move before the goal crate can reach its target; None for either.
        frozen: Tiles that every level keeps, of the same shape; None without.
    """

    rows: int = 10
    columns: int = 10
    crates: int = 2
    targets: int = 1
    wall_density: tuple[float, float] = (0.05, 0.3)
    pushes: tuple[int, int] = (3, MAX_PUSHES)
    occluded: bool | None = None
    dependency: bool | None = None
    frozen: FrozenTiles | None = None

    def __post_init__(self) -> None:
        if min(self.rows, self.columns, self.targets) < 1:
            raise ValueError("rows, columns and targets must be at least 1")
        if self.cells > MAX_CELLS:
            raise ValueError(f"{self.rows} x {self.columns} cells are too many; at most {MAX_CELLS} are solved")
        if self.crates < self.targets:
            raise ValueError(f"{self.crates} crates cannot cover {self.targets} targets")
        if not 0 <= self.wall_density[0] <= self.wall_density[1] <= 1:
            raise ValueError(f"wall_density {self.wall_density} must be a range within 0 and 1")
        if not 0 <= self.pushes[0] <= self.pushes[1] <= MAX_PUSHES:
            raise ValueError(f"pushes {self.pushes} must be a range within 0 and {MAX_PUSHES}")
        if self.things > self.cells:
            raise ValueError(f"{self.rows} x {self.columns} cells cannot hold {self.things} things")
        if self.frozen is not None and self.frozen.shape != (self.rows, self.columns):
            raise ValueError(f"frozen tiles are {self.frozen.shape}, the level is {(self.rows, self.columns)}")

    @property
    def cells(self) -> int:
        """Inner cells."""
        return self.rows * self.columns

    @property
    def things(self) -> int:
        """Cells taken by the player, the crates and the targets."""
        return 1 + self.crates + self.targets


class Rejection(StrEnum):
    """Why an attempt was thrown away."""

    UNFINISHED = "unfinished"
    """The numbers of players, crates or targets are wrong, or the free cells are divided."""
    WALLS = "walls"
    """The wall density is out of its band, or so many walls do not fit."""
    FROZEN = "frozen"
    """A frozen tile was changed."""
    UNSOLVABLE = "unsolvable"
    UNDECIDED = "undecided"
    """The solver reached its limit of states."""
    EASY = "easy"
    """Fewer pushes than asked for solve it."""
    HARD = "hard"
    """More pushes than asked for are needed."""
    SIGHT = "sight"
    """The goal crate is hidden although it should be seen, or seen although it should be hidden."""
    DEPENDENCY = "dependency"
    """Whether another crate has to move first is not as asked for."""
    DUPLICATE = "duplicate"
    """Symmetric to an earlier level of the run."""


@dataclass(frozen=True)
class Proposal:
    """What a source made since its last proposal.

    Attributes:
        level: A level that meets the request, with its goal crate; None if all attempts so far were thrown away.
        solution: The solver's result for it; None without a level.
        attempts: Attempts, with the one that gave the level.
        rejected: Those thrown away, by reason.
        steps: Edits of tiles in all of these attempts.
        targets: What was asked for this level, by name.
    """

    level: Level | None
    solution: Solution | None
    attempts: int
    rejected: Mapping[str, int]
    steps: int
    targets: Mapping[str, float] = field(default_factory=dict)


class LevelSource(Protocol):
    """Something that makes levels: the random baseline or a policy."""

    @property
    def representation(self) -> str | None:
        """Of a policy, how it edits levels (narrow, turtle, wide, flip)."""

    @property
    def weights_hash(self) -> str | None:
        """Of a policy, the hash of its weights."""

    def proposals(self, request: Request, seed: int) -> Iterator[Proposal]:
        """Proposals without end; which they are depends on source, request and seed alone.

        Levels may repeat themselves.
        """

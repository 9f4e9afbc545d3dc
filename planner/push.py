"""Method Push: the push solution of the level that a scene was converted from, lifted to motions.

A push is a carry by one cell: the agent drives behind the crate until it touches it and carries it straight ahead;
consecutive pushes in one direction are one carry. In geometry preset `clear` one-cell corridors are wider than the
agent, so every push solution lifts: the plan is a certificate that the scene can be solved. As a baseline it is an
unfair one, for it knows the level; no other method uses it.

Where the straight carry collides, as beside the outer walls of preset `published`, any other grasp that brings the
crate to the same place will do.
"""

import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from pydantic import BaseModel, Field

from converter.plan import Status
from converter.scene import NUMERIC_SLACK, Agent, Body, Scene
from converter.shape import FloatArray
from pcg.errors import InputError
from pcg.grid import DIRECTIONS, Cell
from pcg.level import Level
from pcg.solver import Solution, SolverStatus
from pcg.solver import solve as solve_level
from pcg.validation import validated
from pcg.xsb import parse_levels
from planner.assemble import segments_of, subgoals_of
from planner.configuration_space import agent_obstacles
from planner.kernel import points_free
from planner.pick_place import PickPlace, Region
from planner.problem import Problem
from planner.result import PlanResult, Progress
from planner.settings import Settings
from planner.subproblems import subproblem_solvers
from planner.visibility import ShortestPathTree

_ENDS = {
    SolverStatus.SOLVED: (Status.SOLVED, None),
    SolverStatus.UNSOLVABLE: (Status.EXHAUSTED, "no sequence of pushes solves the source level"),
    SolverStatus.LIMIT: (Status.TIMEOUT, "the push solver reached its limit of states"),
}
"""Status and certificate of a plan by how the search for pushes ended."""


class _Sizes(BaseModel):
    cell: float = Field(gt=0, allow_inf_nan=False)


class _Source(BaseModel):
    xsb: str
    settings: _Sizes


@dataclass(frozen=True, eq=False)
class SourceLevel:
    """The level that a scene was converted from.

    Attributes:
        level: What the scene asks for: the goal is the only target, and the goal-object the crate for it.
        cell: Side of a cell [m].
    """

    level: Level
    cell: float

    @classmethod
    def of(cls, scene: Scene) -> "SourceLevel":
        """What `source` of the scene records.

        Raises:
            InputError: it records no level, or the scene is not what that level becomes.
        """
        if "xsb" not in scene.source:
            raise InputError(scene.name, "method Push needs a scene converted from a level, with source.xsb")
        recorded = validated(_Source, dict(scene.source), f"{scene.name}: source")
        level, *more = parse_levels(recorded.xsb, f"{scene.name}: source.xsb")
        player, target, goal_crate, *crates = (
            _cell_at(position, level.shape, recorded.settings.cell)
            for position in (
                scene.agent.position,
                scene.goal.position,
                scene.goal_object.position[:2],
                *(body.position[:2] for body in scene.objects),
            )
        )
        if more or (player, sorted(crates)) != (level.player, level.crates) or target not in level.targets:
            raise InputError(scene.name, "source.xsb is not the level of this scene: things stand elsewhere")
        asked = Level.of(
            level.is_wall, players=[player], crates=crates, targets=[target], name=level.name, goal_crate=goal_crate
        )
        return cls(asked, recorded.settings.cell)


@dataclass(frozen=True)
class _Run:
    """Consecutive pushes of one crate in one direction.

    Attributes:
        crate: Cell of the crate before.
        step: Rows and columns of one push.
        length: Number of pushes.
    """

    crate: Cell
    step: Cell
    length: int


def solve(
    scene: Scene,
    settings: Settings,
    rng: np.random.Generator,
    *,
    should_stop: Callable[[], bool] = lambda: False,
    on_progress: Callable[[Progress], object] = lambda _: None,
) -> PlanResult:
    """Lifts the solution with the fewest pushes that brings the goal crate to the goal, as `planner.methods.solve` says.

    Raises:
        InputError: bodies of the scene overlap at the start, or its source level is missing or another one.
    """
    started = time.perf_counter()
    source, problem = SourceLevel.of(scene), Problem(scene)
    solution = solve_level(source.level)
    status, certificate = _ENDS[solution.status]
    lift = _Lift(problem, source, settings, rng)
    for run in _runs(source.level, solution):
        if should_stop() or time.perf_counter() - started > settings.time_limit:
            status = Status.TIMEOUT
            break
        if not lift.carry(run):
            # Pushes may fail where other carries would not.
            status, certificate = Status.EXHAUSTED, f"carry {len(lift.steps) + 1} of the push solution collides"
            break
        on_progress(Progress(len(lift.steps), len(lift.steps) + 1, 0.0, time.perf_counter() - started))
    steps = lift.steps if status is Status.SOLVED else []
    return PlanResult(
        status=status,
        time_s=time.perf_counter() - started,
        segments=segments_of(scene, steps),
        subgoals=subgoals_of(scene, steps),
        certificate=certificate,
        counters={"level_states": solution.states, "pushes": solution.pushes or 0},
    )


class _Lift:
    """State: the configuration, and the steps that have led to it."""

    def __init__(self, problem: Problem, source: SourceLevel, settings: Settings, rng: np.random.Generator) -> None:
        self.steps: list[PickPlace] = []
        self._problem = problem
        self._source = source
        self._configuration = problem.initial
        self._any_grasp = subproblem_solvers(problem, settings, rng, Counter(), lambda: False)

    def carry(self, run: _Run) -> bool:
        """Adds the carry that makes the pushes of `run`; False if there is none."""
        crates = [_cell_at(p, self._source.level.shape, self._source.cell) for p in self._configuration.objects]
        index = crates.index(run.crate)
        row, column = run.step
        by = run.length * self._source.cell * np.array([column, -row], dtype=float)
        step = self._straight(index, by)
        if step is None:
            region = Region.around(self._configuration.objects[index] + by, 0.0)
            step = self._any_grasp(self._configuration).pick_place(index, region)
        if step is None:
            return False
        self.steps.append(step)
        self._configuration = step.applied_to(self._configuration)
        return True

    def _straight(self, index: int, by: FloatArray) -> PickPlace | None:
        """The carry of object `index` by the vector `by` (2,) [m] with the agent behind it."""
        problem, configuration = self._problem, self._configuration
        grasp = touching_point(problem.scene.agent, problem.scene.objects[index], by / np.hypot(*by))
        start = configuration.objects[index] + grasp
        if not problem.carry_space(configuration, index, grasp).path_free(np.array([start, start + by])):
            return None
        approach = ShortestPathTree(problem.agent_space(configuration), configuration.agent).path_to(start)
        if approach is None:
            return None
        return PickPlace(index, approach, np.array([start, start + by]), configuration.objects[index] + by)


def touching_point(agent: Agent, body: Body, direction: FloatArray) -> FloatArray:
    """The agent centre (2,) [m], relative to `body`, at which it touches the body to push it in `direction`, a unit vector.

    That is where the ray from the body's centre against the direction leaves the places at which the agent overlaps it,
    found by bisection; all of a convex body is before the tangent at its hindmost point.
    """
    overlap = agent_obstacles(agent, body, tolerance=0.0)
    inside, outside = (
        0.0,
        agent.radius
        + max(
            float((core @ -direction).max()) + part.edge_radius
            for core, part in zip(body.cores, body.parts, strict=True)
        ),
    )
    while outside - inside > NUMERIC_SLACK:
        middle = (inside + outside) / 2
        if points_free(-direction[None] * middle, *overlap.arrays)[0]:
            outside = middle
        else:
            inside = middle
    return -direction * outside


def _runs(level: Level, solution: Solution) -> Iterator[_Run]:
    row, column = level.player
    for letter, equal in groupby(solution.lurd or ""):
        down, right = DIRECTIONS[letter.lower()]
        length = len(list(equal))
        if letter.isupper():
            yield _Run((row + down, column + right), (down, right), length)
        row, column = row + down * length, column + right * length


def _cell_at(position: FloatArray, shape: Cell, cell: float) -> Cell:
    """The cell that contains `position` (2,) [m], world, in a level of `shape` with cells of side `cell` [m]."""
    rows, columns = shape
    right, up = np.floor(position / cell + np.array([columns / 2, rows / 2])).astype(int)
    return rows - 1 - int(up), int(right)

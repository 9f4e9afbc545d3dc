"""What the performance table times: motions, grasps, collision tests, levels, and solving.

- *motion*: one query from the start of a puzzle, without shortening the path that comes of it;
- *switch configurations*: pairs of a grasp and a placement in the goal. The contact curve gives grasps, each of which
  is tried with each of some placements; the nonlinear program starts from as many such grasps, one placement with each;
- *segment*: whether one straight motion is free;
- *puzzle*: from scene to plan. It is cut short at a time limit, which then counts as its time;
- *level*: the exact Sokoban solver on random levels, and solving the scenes that they are converted to;
- *environment step*: one edit of a level, see `bench_generator`.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import islice

import numpy as np

from converter.convert import ConversionSettings, convert_level
from converter.preset import CLEAR
from converter.scene import Scene
from converter.shape import FloatArray
from evaluate.bench import Contest
from evaluate.bench_generator import environment_contests
from evaluate.bench_peers import ShapelyObstacles, ompl_with_sampled_checks
from evaluate.bench_robotic import is_installed, robotic_rrt
from evaluate.inputs import read_scene_file
from evaluate.trial import warm_up
from pcg import solver
from pcg.data_folder import data_folder
from pcg.generate import random_levels
from planner import PlanResult, settings_for, solve
from planner.configuration_space import contact_border
from planner.contact_curve import ContactCurve
from planner.motion import MotionPlanner, MotionResult, motion_planner
from planner.nlp import SwitchQuery
from planner.pick_place import Region
from planner.problem import Problem

PUZZLES = (
    "cube-free",
    "corner",
    "wall-easy",
    "wall",
    "o-room",
    "maze-easy",
    "two-blocks",
    "four-blocks",
    "maze",
)
GOALS = {"wall": (0.0, -1.6), "o-room": (-1.6, 1.6), "maze-easy": (-1.7, 1.7)}
"""Where the agent is to drive in the motion queries [m]: behind the walls of these puzzles."""

SWITCH_PUZZLES = ("cube-free", "wall", "maze-easy")
"""Puzzles in which some grasps of the goal-object at the start allow to release it in the goal."""

STARTS = 12
"""Grasps, or starts of the nonlinear program, for one pair of switch configurations."""

PLACEMENTS = 8
"""Placements tried with each grasp."""

ENVIRONMENT_SEEDS = 10
"""Seeds of the contests of environments, which take longer than the others."""

ITERATIONS = 100_000
"""Iterations of a motion query, enough to find a path."""


@dataclass(frozen=True)
class Effort:
    """How much is timed.

    Attributes:
        puzzles: Names of puzzles to solve.
        motion_puzzles: Names of puzzles for motions and segments.
        switch_puzzles: Names of puzzles for switch configurations.
        queries: Seeds of the contests that do not solve anything.
        segments: Segments tested for each seed.
        solves: Seeds of our solver in each puzzle.
        peer_solves: Seeds of its peer.
        time_limit: Time limit of both [s].
        levels: Random levels.
    """

    puzzles: Sequence[str] = PUZZLES
    motion_puzzles: Sequence[str] = tuple(GOALS)
    switch_puzzles: Sequence[str] = SWITCH_PUZZLES
    queries: int = 40
    segments: int = 10_000
    solves: int = 20
    peer_solves: int = 5
    time_limit: float = 2.0
    levels: int = 40


QUICK = Effort(
    puzzles=("cube-free",),
    motion_puzzles=("wall",),
    switch_puzzles=("wall",),
    queries=2,
    segments=100,
    solves=2,
    peer_solves=1,
    time_limit=0.5,
    levels=2,
)
"""A few seconds, to see that everything works; the figures mean little."""


def contests(effort: Effort) -> Iterator[Contest]:
    """Every contest, in the order of the table."""
    for name in effort.motion_puzzles:
        yield from motion_contests(name, Problem(read_puzzle(name)), effort.queries)
    for name in effort.switch_puzzles:
        yield switch_contest(name, Problem(read_puzzle(name)), effort.queries)
    for name in effort.motion_puzzles:
        yield segment_contest(name, Problem(read_puzzle(name)), effort)
    for name in effort.puzzles:
        yield puzzle_contest(read_puzzle(name), effort)
    yield from level_contests(effort)
    yield from environment_contests(min(effort.queries, ENVIRONMENT_SEEDS))


def read_puzzle(name: str) -> Scene:
    """One of the puzzles that come with the product."""
    return read_scene_file(data_folder() / "puzzles" / f"{name}.yaml")


def motion_contests(name: str, problem: Problem, seeds: int) -> Iterator[Contest]:
    """Ways to answer one motion query."""
    space, start, goals = problem.agent_space(problem.initial), problem.initial.agent, np.array([GOALS[name]])

    def query(plan: MotionPlanner) -> Callable[[int], MotionResult]:
        return lambda seed: plan(space, start, goals, ITERATIONS, np.random.default_rng(seed))

    sampled = "OMPL RRT-Connect, points every 5 mm", query(ompl_with_sampled_checks())
    exact = "OMPL RRT-Connect, exact tests", query(motion_planner("ompl"))
    rrt = "compiled RRT-Connect", query(motion_planner("rrt"))
    shortest = "shortest path", query(motion_planner("visibility"))
    for (ours, work), (peer, peer_work) in [(rrt, sampled), (shortest, exact), (exact, sampled)]:
        yield Contest(f"motion, {name}: {ours}", work, seeds, peer, peer_work)
    if is_installed():
        # One query more than seeds: the first is to warm up.
        engine = robotic_rrt(problem.scene, GOALS[name], ITERATIONS, seeds + 1)
        yield Contest(f"motion, {name}, beside the engine: {rrt[0]}", rrt[1], seeds, "robotic's RRT", engine)


def switch_contest(name: str, problem: Problem, seeds: int) -> Contest:
    """Ways to find grasps of the goal-object together with placements in the goal."""
    index, configuration, scene = problem.goal_index, problem.initial, problem.scene
    body, position = scene.objects[index], configuration.objects[index]
    agent_space = problem.agent_space(configuration, held=index)
    object_space = problem.object_space(configuration, index)
    region = Region.of_goal(scene.goal)
    curve, relative = ContactCurve(body, scene.agent.radius), agent_space.obstacles.moved(-position)
    nlp = SwitchQuery(
        position=position,
        parts=contact_border(scene.agent.radius, body),
        agent_obstacles=agent_space.obstacles,
        object_obstacles=object_space.obstacles,
        lower=region.lower,
        upper=region.upper,
    )

    def on_curve(seed: int) -> FloatArray:
        rng = np.random.default_rng(seed)
        grasps = curve.sample_free(STARTS, relative, rng)
        placements = region.sample(PLACEMENTS, rng)
        placements = placements[object_space.points_free(placements)]
        releases = (placements[:, None] + grasps).reshape(-1, 2)
        return releases[agent_space.points_free(releases)]

    def by_program(seed: int) -> list[tuple[FloatArray, FloatArray]]:
        rng = np.random.default_rng(seed)
        grasps = position + curve.sample_free(STARTS, relative, rng)
        return nlp.solve([*np.hstack([grasps, rng.uniform(region.lower, region.upper, grasps.shape)])])

    peer = f"CasADi program, {STARTS} starts"
    return Contest(f"switch configurations, {name}: contact curve", on_curve, seeds, peer, by_program)


def segment_contest(name: str, problem: Problem, effort: Effort) -> Contest:
    """Ways to decide whether a straight motion of the agent is free."""
    space = problem.agent_space(problem.initial)
    shapely = ShapelyObstacles(space.obstacles)

    def segments(seed: int) -> tuple[FloatArray, FloatArray]:
        lower, upper = space.bounds
        ends = np.random.default_rng(seed).uniform(lower, upper, (2, effort.segments, 2))
        return ends[0], ends[1]

    drawn = [segments(seed) for seed in range(effort.queries)]
    return Contest(
        f"segment, {name}: exact test",
        lambda seed: space.segments_free(*drawn[seed]),
        effort.queries,
        "shapely, prepared polygons",
        lambda seed: shapely.segments_free(*drawn[seed]),
        repeats=effort.segments,
    )


def puzzle_contest(scene: Scene, effort: Effort) -> Contest:
    """The two settings presets on one puzzle."""
    fast, faithful = (settings_for(preset, time_limit=effort.time_limit) for preset in ("fast", "faithful"))

    def solving(preset: str, seed: int) -> PlanResult:
        settings = {"fast": fast, "faithful": faithful}[preset]
        return solve(scene, settings, np.random.default_rng(np.random.SeedSequence(seed)))

    return Contest(
        f"puzzle, {scene.name}: {fast.method} fast",
        partial(solving, "fast"),
        effort.solves,
        f"{faithful.method} faithful",
        partial(solving, "faithful"),
        peer_seeds=effort.peer_solves,
        prepare=lambda: warm_up(fast, faithful),
    )


def level_contests(effort: Effort) -> Iterator[Contest]:
    """Random levels, and the scenes that they are converted to."""
    levels = [generated.level for generated in islice(random_levels(0), effort.levels)]
    scenes = [convert_level(level, ConversionSettings(preset=CLEAR.name)) for level in levels]
    fast = settings_for("fast", time_limit=effort.time_limit)
    yield Contest("level, random: push solver", lambda seed: solver.solve(levels[seed]), effort.levels)
    yield Contest(
        f"level, random, {CLEAR.name}: {fast.method} fast",
        lambda seed: solve(scenes[seed], fast, np.random.default_rng(np.random.SeedSequence(seed))),
        effort.levels,
        prepare=lambda: warm_up(fast),
    )

"""Every parameter of the search in one place, with the value chosen and why."""

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal, get_args

from pcg.errors import InputError
from planner.mbts_settings import MbtsSettings
from planner.motion import MOTION_PLANNERS

METHODS = ("Rnd+FPR", "Rnd+FP", "Rnd+FR", "Rnd+R", "Btl+FPR", "Hum+R", "MBTS", "MBTS-rrt", "Push")
"""Names of the methods.

Of the forward search: subgoal generator (random, bottleneck, human), then F filter, P prioritised selection, R
rejection. Of multi-bound tree search: trajectories by optimisation as published, or by RRT-Connect. Push lifts the
solution of the level that the scene was converted from.
"""

SOLVE_BY = ("pick-place", "MBTS", "MBTS-rrt")
"""Ways to attempt the original problem within the forward search."""

PresetName = Literal["fast", "faithful"]

_CHOICES = {
    "method": METHODS,
    "preset": get_args(PresetName),
    "motion": MOTION_PLANNERS,
    "solve_by": SOLVE_BY,
}

_COUNTS = (
    "candidates",
    "subgoals_per_object",
    "grasp_starts",
    "placement_samples",
    "reach_iterations",
    "motion_iterations",
    "motion_attempts",
    "equal_configurations",
    "expansions",
    "restart_after",
    "max_expansions",
    "mbts_max_depth",
    "mbts_phase_steps",
    "mbts_max_iterations",
)

_AMOUNTS = (
    "subgoal_size",
    "shortcut_rounds",
    "improve_rounds",
    "mbts_max_violation",
    "mbts_noise",
    "mbts_action_cost",
    "mbts_acceleration_weight",
    "mbts_velocity_weight",
    "mbts_homing_weight",
    "mbts_switch_weight",
    "mbts_touch_scale",
    "mbts_placement_scale",
    "mbts_collision_scale",
)

_RANGES: tuple[tuple[tuple[str, ...], Callable[[float], bool], str], ...] = (
    (_COUNTS, lambda value: value >= 1, "at least 1"),
    (_AMOUNTS, lambda value: value >= 0, "at least 0"),
    (("rejection_cell", "novelty_cell"), lambda value: value > 0, "> 0"),
    (("near_share", "contact_share", "explore_share"), lambda value: 0 <= value <= 1, "from 0 to 1"),
    (("keep_share",), lambda value: 0 < value <= 1, "> 0 and at most 1"),
)
"""Names of settings, what their values have to fulfil, and how a message says it."""


@dataclass(frozen=True)
class Settings(MbtsSettings):
    """Parameters of Algorithm 1 and of what it calls, and of multi-bound tree search.

    Counts, not seconds, bound the work, so that a seed fixes the plan; `time_limit` is only a guard.

    Attributes:
        method: One of `METHODS`.
        preset: `faithful` (RRT-Connect and nonlinear programs, as published) or `fast` (exact geometry).
        time_limit: Wall time after which the search gives up [s].
        candidates: Free positions drawn for an object before the filter.
        near_share: Share of the proposals of Rnd that draw their candidates near the object instead of in the whole
            room. Maze needs them; elsewhere half of all costs nothing measurable but in four-blocks.
        contact_share: Share of the proposals of Rnd that draw their candidates from the places where contact stops a carry:
            a walk of many short carries, as in Maze, makes most way by these.
        keep_share: Share of the candidates that passes the filter.
        subgoals_per_object: Positions drawn from those that passed; the trivial subgoal comes on top.
        subgoal_size: Sides of the square around a subgoal in which the object may be placed [m]; the subgoals of the
            published scene files are 0.1 m tables in the puzzles and 0.2 m tables in the generated scenes.
        grasp_starts: Starts on the contact curve for one switch-configuration problem: grasps tried, ends of free
            stretches among them.
        placement_samples: Placements tried in a region, its centre first.
        solve_by: How the original problem is attempted from a configuration, one of `SOLVE_BY`; see
            `planner.original_problem`.
        motion: Motion planner of the faithful preset and of MBTS-rrt, one of `planner.motion.MOTION_PLANNERS`: by
            default the compiled RRT-Connect, the same algorithm as OMPL's and a hundred times faster.
        reach_iterations: Iterations of RRT-Connect for the question whether an object can be reached.
        motion_iterations: Iterations of RRT-Connect for a motion between switch configurations.
        motion_attempts: Switch configurations of one subproblem for which motions are sought.
        shortcut_rounds: Random shortcuts tried on a path of RRT-Connect.
        equal_configurations: Equal configurations that rejection lets pass, two as in [L].
        rejection_by_access: Whether rejection counts only those configurations as equal between which the agent can
            drive, and lets more pass the fewer grasps it can drive to; see `planner.rejection`.
        rejection_cell: Edge of the cells in which rejection compares object positions [m].
        novelty_cell: Edge of the cells in which prioritised selection counts expansions to break ties [m].
        explore_share: Share of the selections that disregard the score; see `planner.frontier`. Measured on the two slowest
            of 360 random levels, 16 seeds each: with 0, 28 s (3 of 12 unsolved in 60 s) and 4.1 s in median, with 0.2,
            0.5 and 1.7 s; Maze takes 0.6 and 0.8 s.
        expansions: How often one configuration may be expanded.
        restart_after: Expansions after which the search starts anew; see `planner.restarts`.
        max_expansions: Expansions in all after which the search gives up.
        improve: Wall time for improving a plan once it is found [s]; 0 keeps the first plan.
        improve_rounds: Rounds of local search and restarts after which improvement ends.
        demonstrations: Folder with the files `{scene}.yaml` of method Hum; None for those that come with the product.
    """

    method: str = "Rnd+FPR"
    preset: PresetName = "fast"
    time_limit: float = 60.0
    candidates: int = 100
    near_share: float = 0.5
    contact_share: float = 0.5
    keep_share: float = 0.2
    subgoals_per_object: int = 5
    subgoal_size: float = 0.1
    grasp_starts: int = 6
    placement_samples: int = 8
    solve_by: str = "pick-place"
    motion: str = "rrt"
    reach_iterations: int = 20_000
    motion_iterations: int = 20_000
    motion_attempts: int = 2
    shortcut_rounds: int = 30
    equal_configurations: int = 2
    rejection_by_access: bool = True
    rejection_cell: float = 0.1
    novelty_cell: float = 0.2
    explore_share: float = 0.2
    expansions: int = 2
    restart_after: int = 1000
    max_expansions: int = 100_000
    improve: float = 0.0
    improve_rounds: int = 100_000
    demonstrations: str | None = None

    def __post_init__(self) -> None:
        for name, choices in _CHOICES.items():
            if (found := getattr(self, name)) not in choices:
                raise InputError(name, f"found {found!r}, allowed are {', '.join(choices)}")
        if not 0 < self.time_limit < math.inf:
            raise InputError("time limit", f"found {self.time_limit}, must be a finite number of seconds > 0")
        if not 0 <= self.improve < math.inf:
            raise InputError("improve", f"found {self.improve}, must be a finite number of seconds >= 0")
        for names, fits, allowed in _RANGES:
            for name in names:
                if not fits(found := getattr(self, name)):
                    raise InputError(name, f"found {found}, must be {allowed}")

    @property
    def generator(self) -> str:
        """Name of the subgoal generator."""
        return self.method.split("+")[0]

    @property
    def letters(self) -> str:
        """Which of filter (F), prioritised selection (P) and rejection (R) are on."""
        return self.method.partition("+")[2]

    def as_document(self) -> dict[str, Any]:
        """Plain values, for plan files and trial records."""
        return asdict(self)


PRESETS = {
    "fast": Settings(),
    # Measured with Rnd+FPR on the five scenes that take longest (4 blocks, O-Room, Wall, a23-6, a3-92), 4 runs of 20 s
    # each, one value changed at a time. Solved, and mean time of a run on a machine with other work:
    # subgoals_per_object 10: 18 of 20; 30: 20, 2.7 s; 60: 20, 4.2 s. Most draws fail, because candidates are drawn
    #   without asking where a carry can lead.
    # keep_share 0.2: 18 of 20; 0.5: 19; 0.9: 20. In Wall 56 % of the room see the goal, and none of that can be reached
    #   at first.
    # motion_iterations 1500: 19 of 20; 3000: 20, 2.7 s; 10,000: 20, 4.7 s. What there is to find is found early.
    # motion_attempts 1: 20 of 20, 1.5 s; 2: 20, 2.7 s; 4: 20, 1.9 s.
    # grasp_starts 6: 20 of 20, 1.3 s; 12: 20, 2.7 s; 24: 20, 1.9 s: no difference that shows.
    "faithful": Settings(
        preset="faithful",
        keep_share=0.9,
        subgoals_per_object=30,
        motion_iterations=3000,
        motion_attempts=1,
        grasp_starts=12,
        near_share=0.0,
        contact_share=0.0,
        explore_share=0.0,
        restart_after=100_000,
        rejection_by_access=False,
    ),
}
"""Settings by the name of their preset."""


def settings_for(preset: str, **changes: Any) -> Settings:
    """The settings of a preset with some values changed.

    Raises:
        InputError: there is no such preset, or a value is not allowed.
    """
    if preset not in PRESETS:
        raise InputError("settings", f"found {preset!r}, allowed are {', '.join(PRESETS)}")
    return replace(PRESETS[preset], **changes)

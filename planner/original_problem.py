"""`solve` of Algorithm 1: the original problem from one configuration on, without subgoals.

[L] calls MBTS here. Three ways are at hand, chosen by the setting `solve_by`:

- `pick-place`: one pick-and-place of the goal-object into the goal, the shortest skeleton of MBTS, answered like any
  other subproblem;
- `MBTS`: all skeletons of up to `mbts_max_depth` actions, trajectories by optimisation. Those that cut a corner
  or miss the goal, which MBTS alone accepts, are refused;
- `MBTS-rrt`: the same skeletons, motions by RRT-Connect between the switch configurations.
"""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from converter.plan import Segment
from planner.pick_place import PickPlace, PickPlaceSolver, Region
from planner.problem import Configuration, Problem
from planner.settings import Settings

OriginalSolver = Callable[[Configuration, PickPlaceSolver], list[PickPlace]]
"""Pick-places from a configuration to a solution; empty if none was found."""


def original_solver(
    problem: Problem,
    settings: Settings,
    rng: np.random.Generator,
    counters: Counter[str],
    should_stop: Callable[[], bool],
) -> OriginalSolver:
    """The solver that `settings.solve_by` names."""
    if settings.solve_by == "pick-place":
        return partial(_by_pick_place, problem)
    return partial(_by_mbts, problem, replace(settings, method=settings.solve_by), rng, counters, should_stop)


def _by_pick_place(problem: Problem, configuration: Configuration, subproblems: PickPlaceSolver) -> list[PickPlace]:
    del configuration
    step = subproblems.pick_place(problem.goal_index, Region.of_goal(problem.scene.goal))
    return [] if step is None else [step]


def _by_mbts(
    problem: Problem,
    settings: Settings,
    rng: np.random.Generator,
    counters: Counter[str],
    should_stop: Callable[[], bool],
    configuration: Configuration,
    subproblems: PickPlaceSolver,
) -> list[PickPlace]:
    del subproblems
    # CasADi takes a third of a second to import, which the fast preset need not pay.
    from planner.mbts import MultiBoundTreeSearch  # noqa: PLC0415  # see above

    tree_search = MultiBoundTreeSearch(problem.starting_at(configuration), settings, rng, should_stop)
    result = tree_search.run()
    counters["mbts_calls"] += 1
    counters["nlp_calls"] += tree_search.counters["nlp_calls"]
    counters["rrt_calls"] += tree_search.counters["rrt_calls"]
    return _exact_steps(problem, configuration, result.segments)


def _exact_steps(problem: Problem, configuration: Configuration, segments: Sequence[Segment]) -> list[PickPlace]:
    """The pick-places of moves and carries in turn; none if one of them is not free or the goal is missed."""
    names, steps = problem.scene.object_names, []
    for move, carry in zip(segments[::2], segments[1::2], strict=True):
        index = names.index(str(carry.object))
        start = configuration.objects[index]
        grasped = Configuration(carry.path[0], configuration.objects)
        free = (
            problem.touches(grasped, index)
            and problem.agent_space(configuration).path_free(move.path)
            and problem.carry_space(configuration, index, carry.path[0] - start).path_free(carry.path)
        )
        if not free:
            return []
        placement = start + carry.path[-1] - carry.path[0]
        steps.append(PickPlace(index, move.path, carry.path, placement))
        configuration = steps[-1].applied_to(configuration)
    return steps if problem.at_goal(configuration) else []

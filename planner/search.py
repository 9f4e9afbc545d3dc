"""Forward search over pick-and-place subproblems: Algorithm 1 of [L].

[L] Levit, Ortiz-Haro, Toussaint: Solving Sequential Manipulation Puzzles by Finding Easier Subproblems. ICRA 2024,
arXiv 2405.02053.

    L <- {initial configuration}
    while L is not empty:
        C <- select_node(L)
        if solve(C): return the plan
        for each object o with reachable(C, o):
            for each z in propose_subgoals(C, o):
                C' <- sub_solve(C, o, z)
                if there is a C' and not rej(L, C'): add C' to L

`solve` tries the original problem from C, `sub_solve` brings o to z by one pick-and-place. Among the subgoals is the
trivial one, z = where o is: the agent takes it from another side. C goes back to the end of L until it has been expanded
as often as the settings say. Budgets, restarts (`planner.restarts`) and a bound on the plan's length are our additions.
"""

import time
from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from converter.plan import Status
from converter.scene import Scene
from converter.shape import FloatArray
from planner.assemble import segments_of, subgoals_of
from planner.frontier import Frontier, Node
from planner.heuristics import Heuristic, checked, score, scores_by, scores_if
from planner.original_problem import original_solver
from planner.pick_place import PickPlace, PickPlaceSolver, Region
from planner.problem import Configuration, Problem
from planner.rejection import Rejection
from planner.restarts import with_restarts
from planner.result import PlanResult, Progress
from planner.settings import Settings
from planner.subgoals import GENERATORS, GeneratorFactory, propose_subgoals
from planner.subproblems import subproblem_solvers

TRIVIAL = None
"""The subgoal of an object that stays where it is."""


def solve(
    scene: Scene,
    settings: Settings,
    rng: np.random.Generator,
    *,
    should_stop: Callable[[], bool] = lambda: False,
    on_progress: Callable[[Progress], object] = lambda _: None,
    generator: GeneratorFactory | None = None,
    heuristic: Heuristic | None = None,
) -> PlanResult:
    """Searches for a plan that brings the goal-object to the goal.

    Args:
        scene: The puzzle.
        settings: Method and budgets.
        rng: Source of all randomness.
        should_stop: Asked between subproblems; True ends the search with status `timeout`.
        on_progress: Told after every expansion that did not end the search.
        generator: Makes the subgoal generator; None for that of the method.
        heuristic: Scores configurations for filter and selection; None for that of [L].

    Raises:
        InputError: bodies of the scene overlap at the start, or method Hum has no demonstration for the scene.
    """
    problem = Problem(scene)

    def search(budgets: Settings) -> PlanResult:
        return Search(problem, budgets, rng, should_stop, on_progress, generator=generator, heuristic=heuristic).run()

    return with_restarts(search, settings)


class Search:
    """One run of Algorithm 1.

    Args:
        problem: The problem.
        settings: Method and budgets.
        rng: Source of all randomness.
        should_stop: Asked between subproblems; True ends the search with status `timeout`.
        on_progress: Told after every expansion that did not end the search.
        max_pick_places: The most pick-places that a plan may have.
        max_length: Configurations are left out from which a plan would be longer [m].
        generator: Makes the subgoal generator; None for that of the method.
        heuristic: Scores configurations for filter and selection; None for that of [L].

    Attributes:
        nodes: Afterwards the search tree.
        solution: Afterwards the configuration with the goal-object at the goal, reached from one of `nodes`; None if
            the search did not find it.
    """

    def __init__(
        self,
        problem: Problem,
        settings: Settings,
        rng: np.random.Generator,
        should_stop: Callable[[], bool] = lambda: False,
        on_progress: Callable[[Progress], object] = lambda _: None,
        max_pick_places: float = np.inf,
        max_length: float = np.inf,
        *,
        generator: GeneratorFactory | None = None,
        heuristic: Heuristic | None = None,
    ) -> None:
        self.problem = problem
        self.settings = settings
        self.rng = rng
        self.nodes: list[Node] = []
        self.solution: Node | None = None
        self.counters: Counter[str] = Counter()
        self._best_score = -np.inf
        self._frontier = Frontier(settings, rng, problem.goal_index)
        self._rejection = Rejection(problem, settings)
        self._generator = (generator or GENERATORS[settings.generator])(problem, settings)
        # Other generators say themselves where candidates come from.
        self._in_contact = generator is None and settings.generator == "Rnd"
        self._score = score if heuristic is None else checked(heuristic)
        self._scores_of = scores_if if heuristic is None else scores_by(self._score)
        self._solver_for = subproblem_solvers(problem, settings, rng, self.counters, self._out_of_budget)
        self._solve = original_solver(problem, settings, rng, self.counters, self._out_of_budget)
        self._started = time.perf_counter()
        self._should_stop = should_stop
        self._on_progress = on_progress
        self._max_length = max_length
        self._max_pick_places = max_pick_places

    def run(self) -> PlanResult:
        """Expands configurations until one solves the problem, none is left or the budget is spent."""
        problem = self.problem
        self._add(problem.initial)
        while self._frontier:
            if self._out_of_budget() or self.counters["expansions"] >= self.settings.max_expansions:
                return self._result(Status.TIMEOUT)
            node = self._frontier.select_node()
            if problem.at_goal(node.configuration):
                return self._solved(node)
            self.counters["expansions"] += 1
            subproblems = self._solver_for(node.configuration)
            if steps := self._solve(node.configuration, subproblems):
                return self._solved(node.followed_by(steps))
            for index in range(problem.n_objects):
                if subproblems.reachable(index):
                    for subgoal in self._propose_subgoals(subproblems, node, index):
                        if step := self._sub_solve(subproblems, index, subgoal):
                            self._add(step.applied_to(node.configuration), node, step)
            self._frontier.add(node)
            self._on_progress(self._progress())
        # Where the last expansion was cut short, something may have been left.
        return self._result(Status.TIMEOUT if self._out_of_budget() else Status.EXHAUSTED)

    def _propose_subgoals(self, subproblems: PickPlaceSolver, node: Node, index: int) -> list[FloatArray | None]:
        """Where object `index` is to go next, (2,) [m] each, and at last nowhere: the trivial subgoal."""
        if node.pick_places + 2 > self._max_pick_places:
            # After one more, the goal-object would still have to be brought to the goal.
            return [TRIVIAL]
        proposal = propose_subgoals(
            self.problem,
            self._generator,
            node.configuration,
            index,
            partial(subproblems.placeable, index),
            self.settings,
            self.rng,
            self._scores_of,
            partial(subproblems.contacts, index) if self._in_contact else None,
        )
        return [*proposal.subgoals, TRIVIAL]

    def _sub_solve(self, subproblems: PickPlaceSolver, index: int, subgoal: FloatArray | None) -> PickPlace | None:
        """Brings object `index` near `subgoal` (2,) [m], or grasps it anew; None if no way was found."""
        if subgoal is TRIVIAL:
            return subproblems.regrasp(index)
        if self._out_of_budget():
            return None
        return subproblems.pick_place(index, Region.around(subgoal, self.settings.subgoal_size))

    def _add(self, configuration: Configuration, parent: Node | None = None, step: PickPlace | None = None) -> None:
        """Enters a configuration into the tree unless `rej` refuses it."""
        node = Node(configuration, parent, step)
        if node.length + self.problem.distance_to_goal(configuration) > self._max_length:
            return
        if not self._rejection.accepts(configuration, step.index if step else self.problem.goal_index):
            self.counters["rejected"] += 1
            return
        node.score = self._score(self.problem, configuration)
        self.nodes.append(node)
        self._best_score = max(self._best_score, node.score)
        self._frontier.add(node)

    def _progress(self) -> Progress:
        time_s = time.perf_counter() - self._started
        return Progress(self.counters["expansions"], len(self.nodes), self._best_score, time_s)

    def _out_of_budget(self) -> bool:
        return self._should_stop() or time.perf_counter() - self._started > self.settings.time_limit

    def _solved(self, solution: Node) -> PlanResult:
        self.solution = solution
        return self._result(Status.SOLVED, solution.steps())

    def _result(self, status: Status, steps: Sequence[PickPlace] = ()) -> PlanResult:
        self.counters["nodes"] = len(self.nodes)
        return PlanResult(
            status=status,
            time_s=time.perf_counter() - self._started,
            segments=segments_of(self.problem.scene, steps),
            subgoals=subgoals_of(self.problem.scene, steps),
            certificate=self._certificate(status),
            counters={**self.counters, "subgoal_time_s": self._generator.time_s},
        )

    def _certificate(self, status: Status) -> str | None:
        if status is not Status.EXHAUSTED:
            return None
        if len(self.nodes) == 1 and self.counters["reachable"] == 0:
            return "no object could be reached"
        return f"all {len(self.nodes)} configurations were expanded {self.settings.expansions} times"

"""Multi-bound tree search over action skeletons (MBTS).

Toussaint and Lopes, Multi-bound tree search for logic-geometric programming in cooperative manipulation domains, ICRA
2017; the baseline of [L] and, there, what `solve` in Algorithm 1 stands for.

The tree of action sequences is expanded breadth first, one node a step. When a child satisfies the goal symbolically,
it and its ancestors are queued for the pose bound. Then at most one pose, one sequence and one path problem are solved
a step, each time the cheapest by the cost of the bound before it. A node that passes a bound and satisfies the goal is
queued for the next bound; an infeasible node takes its subtree out of all queues. A node that passes the path bound is
a solution.

A bound is feasible if the scaled violations of its constraints sum up to less than a threshold, so a solution may
penetrate obstacles by centimetres, and between the configurations of its path collisions are not looked at. Whether it
solves the scene is for `planner.verify` to say. There is one optimisation a node and bound, and none starts anew: where
the way from the start to an object leads around a wall, the path bound fails.
"""

import heapq
import time
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import count

import numpy as np

from converter.plan import Segment, Status, Subgoal
from converter.scene import Scene
from converter.shape import FloatArray
from planner.lgp import Bound, Weights
from planner.lgp_motion import phases, segments_of, subgoals_of, waypoints
from planner.lgp_scene import LgpStructure, pack
from planner.lgp_solver import BoundSolution, BoundStructure, bound_solver
from planner.logic import Action, Domain, Skeleton, SymbolicState
from planner.mbts_rrt import motions_between
from planner.problem import Problem
from planner.result import PlanResult
from planner.settings import Settings


def solve(
    scene: Scene,
    settings: Settings,
    rng: np.random.Generator,
    *,
    should_stop: Callable[[], bool] = lambda: False,
) -> PlanResult:
    """Searches for a skeleton whose path bound is feasible.

    Args:
        scene: The puzzle.
        settings: Method (`MBTS` or `MBTS-rrt`) and budgets.
        rng: Source of all randomness.
        should_stop: Asked between optimisations; True ends the search with status `timeout`.

    Raises:
        InputError: bodies of the scene overlap at the start.
    """
    return MultiBoundTreeSearch(Problem(scene), settings, rng, should_stop).run()


@dataclass(eq=False)
class TreeNode:
    """An action sequence.

    Attributes:
        state: What is held and what lies where after it.
        parent: The sequence without its last action; None for the root.
        action: The last action.
        costs: Cost of each bound that has been computed.
        solutions: Optimum of each of them.
        infeasible: Whether one of them was infeasible.
        queued: Whether the pose bound has been asked for.
    """

    state: SymbolicState
    parent: "TreeNode | None" = None
    action: Action | None = None
    costs: dict[Bound, float] = field(default_factory=dict)
    solutions: dict[Bound, FloatArray] = field(default_factory=dict)
    infeasible: bool = False
    queued: bool = False

    @property
    def path(self) -> list["TreeNode"]:
        """The nodes from below the root to this one."""
        return [] if self.parent is None else [*self.parent.path, self]

    @property
    def skeleton(self) -> Skeleton:
        """The actions from the root to here."""
        return tuple(node.action for node in self.path if node.action is not None)

    @property
    def pruned(self) -> bool:
        """Whether this node or an ancestor is infeasible."""
        return self.infeasible or (self.parent is not None and self.parent.pruned)


class Queue:
    """Nodes that wait for a bound, cheapest first; among equals the oldest."""

    def __init__(self) -> None:
        self._heap: list[tuple[float, int, TreeNode]] = []
        self._order = count()

    def push(self, node: TreeNode, cost: float) -> None:
        """Enters a node."""
        heapq.heappush(self._heap, (cost, next(self._order), node))

    def pop(self) -> TreeNode | None:
        """Takes the cheapest node out that has not been pruned."""
        while self._heap:
            node = heapq.heappop(self._heap)[-1]
            if not node.pruned:
                return node
        return None

    def __len__(self) -> int:
        return sum(not node.pruned for _, _, node in self._heap)


class MultiBoundTreeSearch:
    """One run of MBTS; afterwards `root` is the tree's root and `queues` hold what was left to do."""

    def __init__(
        self,
        problem: Problem,
        settings: Settings,
        rng: np.random.Generator,
        should_stop: Callable[[], bool] = lambda: False,
    ) -> None:
        self.problem = problem
        self.settings = settings
        self.rng = rng
        self.counters: Counter[str] = Counter()
        self.domain = Domain(problem.n_objects, problem.goal_index)
        self.root = TreeNode(self.domain.initial)
        self.fringe: deque[TreeNode] = deque([self.root])
        self.queues = {bound: Queue() for bound in Bound}
        self._structure = LgpStructure.of(problem)
        self._parameters = pack(problem)
        self._should_stop = should_stop
        self._started = time.perf_counter()

    def run(self) -> PlanResult:
        """Steps until a path bound is feasible, nothing is left to do or the budget is spent."""
        if self.problem.at_goal(self.problem.initial):
            return self._result(Status.SOLVED)
        while self.fringe or any(self.queues.values()):
            if self._out_of_budget():
                return self._result(Status.TIMEOUT)
            solution = self.step()
            if solution is not None:
                return self._solved(*solution)
        return self._result(Status.EXHAUSTED)

    def step(self) -> tuple[TreeNode, list[FloatArray]] | None:
        """Expands one node and solves at most one problem of each bound; the node and its motions if one is solved."""
        self.counters["steps"] += 1
        self._expand_next()
        self._solve_next_pose()
        self._solve_next_sequence()
        return self._solve_next_path()

    def _expand_next(self) -> None:
        while self.fringe and self.fringe[0].pruned:
            self.fringe.popleft()
        if not self.fringe:
            return
        node = self.fringe.popleft()
        self.counters["expansions"] += 1
        for action in self.domain.actions(node.state):
            child = TreeNode(self.domain.successor(node.state, action), node, action)
            self.counters["nodes"] += 1
            if self.domain.is_solved(child.state):
                self._queue_poses(child)
            elif len(child.path) < self.settings.mbts_max_depth:
                self.fringe.append(child)

    def _queue_poses(self, terminal: TreeNode) -> None:
        """Asks for the pose bound of every node from the root to `terminal`; the root itself poses no problem."""
        for node in terminal.path:
            if not node.queued:
                node.queued = True
                self.queues[Bound.POSE].push(node, self._symbolic_cost(node))

    def _solve_next_pose(self) -> None:
        node = self._pop(Bound.POSE)
        if node is None:
            return
        moved = sorted({action.index for action in node.skeleton[:-1]})
        start = np.concatenate([self.problem.initial.agent, self.problem.initial.objects[moved].ravel()])
        solution = self._optimise(Bound.POSE, node, start)
        if self._accepts(Bound.POSE, node, solution) and self.domain.is_solved(node.state):
            self.queues[Bound.SEQUENCE].push(node, node.costs[Bound.POSE])

    def _solve_next_sequence(self) -> None:
        node = self._pop(Bound.SEQUENCE)
        if node is None:
            return
        solution = self._optimise(Bound.SEQUENCE, node, np.tile(self.problem.initial.agent, len(node.skeleton)))
        if self._accepts(Bound.SEQUENCE, node, solution):
            self.queues[Bound.PATH].push(node, node.costs[Bound.SEQUENCE])

    def _solve_next_path(self) -> tuple[TreeNode, list[FloatArray]] | None:
        node = self._pop(Bound.PATH)
        if node is None:
            return None
        motions = _PATH_BOUNDS[self.settings.method](self, node)
        if motions is None:
            node.infeasible = True
            self.counters["path_infeasible"] += 1
            return None
        self.counters["path_feasible"] += 1
        return node, motions

    def path_by_optimisation(self, node: TreeNode) -> list[FloatArray] | None:
        """The motions of the phases from the optimised trajectory, started on lines through the sequence's switches."""
        n = self.settings.mbts_phase_steps
        start = waypoints(self.problem.initial.agent, node.solutions[Bound.SEQUENCE], n)
        solution = self._optimise(Bound.PATH, node, start.ravel())
        if solution.violation >= self.settings.mbts_max_violation:
            return None
        return phases(self.problem.initial.agent, solution.x.reshape(-1, 2), len(node.skeleton))

    def path_by_rrt(self, node: TreeNode) -> list[FloatArray] | None:
        """The motions of the phases by RRT-Connect between the sequence's switches, exactly checked."""
        return motions_between(
            self.problem,
            node.skeleton,
            node.solutions[Bound.SEQUENCE],
            self.settings,
            self.rng,
            self.counters,
            self._out_of_budget,
        )

    def _optimise(self, bound: Bound, node: TreeNode, start: FloatArray) -> BoundSolution:
        settings = self.settings
        solver = bound_solver(
            BoundStructure(
                bound, self._structure, node.skeleton, Weights(), settings.mbts_phase_steps, settings.mbts_max_iterations
            )
        )
        noise = self.rng.normal(0.0, settings.mbts_noise, len(start))
        solution = solver.solve(start + noise, self._parameters)
        self.counters["nlp_calls"] += 1
        self.counters["nlp_iterations"] += solution.iterations
        return solution

    def _accepts(self, bound: Bound, node: TreeNode, solution: BoundSolution) -> bool:
        """Records a bound; infeasible nodes drop out of all queues, and their subtrees with them."""
        node.infeasible = solution.violation >= self.settings.mbts_max_violation
        node.costs[bound] = solution.cost + self._symbolic_cost(node)
        node.solutions[bound] = solution.x.reshape(-1, 2)
        self.counters[f"{bound}_{'infeasible' if node.infeasible else 'feasible'}"] += 1
        return not node.infeasible

    def _symbolic_cost(self, node: TreeNode) -> float:
        return self.settings.mbts_action_cost * len(node.path)

    def _pop(self, bound: Bound) -> TreeNode | None:
        return None if self._out_of_budget() else self.queues[bound].pop()

    def _out_of_budget(self) -> bool:
        return (
            self._should_stop()
            or self.counters["expansions"] >= self.settings.max_expansions
            or time.perf_counter() - self._started > self.settings.time_limit
        )

    def _solved(self, node: TreeNode, motions: list[FloatArray]) -> PlanResult:
        switches = np.array([motion[-1] for motion in motions])
        self.counters["accepted"] = 1
        return self._result(
            Status.SOLVED,
            segments_of(self.problem, node.skeleton, motions),
            subgoals_of(self.problem, node.skeleton, switches),
        )

    def _result(
        self, status: Status, segments: tuple[Segment, ...] = (), subgoals: tuple[Subgoal, ...] = ()
    ) -> PlanResult:
        certificate = None
        if status is Status.EXHAUSTED:
            certificate = f"all skeletons of up to {self.settings.mbts_max_depth} actions were tried"
        return PlanResult(
            status, time.perf_counter() - self._started, segments, subgoals, certificate, dict(self.counters)
        )


_PATH_BOUNDS: dict[str, Callable[[MultiBoundTreeSearch, TreeNode], list[FloatArray] | None]] = {
    "MBTS": MultiBoundTreeSearch.path_by_optimisation,
    "MBTS-rrt": MultiBoundTreeSearch.path_by_rrt,
}
"""How the path bound is decided, by the name of the method."""

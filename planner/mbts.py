"""Multi-bound tree search over action skeletons (MBTS).

Toussaint and Lopes, Multi-bound tree search for logic-geometric programming in cooperative manipulation domains, ICRA
2017; the baseline of [L] and, there, what `solve` in Algorithm 1 stands for.

The tree of action sequences is expanded breadth first, one node a step. When a child satisfies the goal symbolically,
it and its ancestors are queued for the pose bound. Then at most one pose, one sequence and one path problem are solved
a step, each time the cheapest by the cost of the bound before it. A node that passes a bound and satisfies the goal is
queued for the next bound; an infeasible node takes its subtree out of all queues. A node that passes the path bound is
a solution.

A bound is feasible if the scaled violations of its constraints sum up to less than a threshold, so a solution may
penetrate obstacles by centimetres; and collisions are looked at in the configurations of a path only, so between two of
them it may cut a corner or jump through a wall. Whether it solves the scene is for `planner.verify` to say. There is
one optimisation a node and bound, and none starts anew: what lies behind a wall is often not found.

With method `MBTS-rrt` RRT-Connect decides the path bound instead of the optimiser (`planner.mbts_rrt`), exactly.
"""

import time
from collections import Counter, deque
from collections.abc import Callable

import numpy as np

from converter.plan import Segment, Status, Subgoal
from converter.scene import Scene
from converter.shape import FloatArray
from planner.lgp import Bound, moved_before
from planner.lgp_motion import phases, segments_of, subgoals_of, waypoints
from planner.lgp_scene import LgpStructure, pack
from planner.lgp_solver import BoundSolution, BoundSolver, path_solver, pose_solver, sequence_solver
from planner.logic import Domain
from planner.mbts_rrt import motions_between
from planner.mbts_tree import Queue, TreeNode
from planner.problem import Problem
from planner.result import PlanResult, Progress
from planner.settings import Settings


def solve(
    scene: Scene,
    settings: Settings,
    rng: np.random.Generator,
    *,
    should_stop: Callable[[], bool] = lambda: False,
    on_progress: Callable[[Progress], object] = lambda _: None,
) -> PlanResult:
    """Searches for a skeleton whose path bound is feasible, as `planner.methods.solve` says.

    `best_score` of the progress counts the bounds passed by the node that has come furthest.
    """
    return MultiBoundTreeSearch(Problem(scene), settings, rng, should_stop, on_progress).run()


class MultiBoundTreeSearch:
    """One run of MBTS; afterwards `root` is the tree's root and `queues` hold what was left to do."""

    def __init__(
        self,
        problem: Problem,
        settings: Settings,
        rng: np.random.Generator,
        should_stop: Callable[[], bool] = lambda: False,
        on_progress: Callable[[Progress], object] = lambda _: None,
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
        self._on_progress = on_progress
        self._started = time.perf_counter()

    def run(self) -> PlanResult:
        """Steps until a path bound is feasible, nothing is left to do or the budget is spent."""
        if self.problem.at_goal(self.problem.initial):
            return self._result(Status.SOLVED)
        while (self.fringe or any(self.queues.values())) and not self._out_of_budget():
            solution = self.step()
            if solution is not None:
                return self._solved(*solution)
            self._on_progress(self._progress())
        # What the end of the budget cut short counts as infeasible, so empty queues alone say nothing.
        return self._result(Status.TIMEOUT if self._out_of_budget() else Status.EXHAUSTED)

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
        skeleton, settings = node.skeleton, self.settings
        moved = moved_before(skeleton)
        solver = pose_solver(self._structure, moved, skeleton[-1], settings.mbts_weights, settings.mbts_max_iterations)
        start = np.concatenate([self.problem.initial.agent, self.problem.initial.objects[list(moved)].ravel()])
        solution = self._optimise(solver, start)
        if self._accepts(Bound.POSE, node, solution) and self.domain.is_solved(node.state):
            self.queues[Bound.SEQUENCE].push(node, node.costs[Bound.POSE])

    def _solve_next_sequence(self) -> None:
        node = self._pop(Bound.SEQUENCE)
        if node is None:
            return
        skeleton, settings = node.skeleton, self.settings
        solver = sequence_solver(self._structure, skeleton, settings.mbts_weights, settings.mbts_max_iterations)
        solution = self._optimise(solver, np.tile(self.problem.initial.agent, len(skeleton)))
        if self._accepts(Bound.SEQUENCE, node, solution):
            self.queues[Bound.PATH].push(node, node.costs[Bound.SEQUENCE])

    def _solve_next_path(self) -> tuple[TreeNode, list[FloatArray]] | None:
        node = self._pop(Bound.PATH)
        if node is None:
            return None
        motions = _PATH_BOUNDS[self.settings.method](self, node)
        return None if motions is None else (node, motions)

    def path_by_optimisation(self, node: TreeNode) -> list[FloatArray] | None:
        """The motions of the phases from the optimised trajectory, started on lines through the sequence's switches."""
        skeleton, settings, n = node.skeleton, self.settings, self.settings.mbts_phase_steps
        solver = path_solver(self._structure, skeleton, settings.mbts_weights, n, settings.mbts_max_iterations)
        start = waypoints(self.problem.initial.agent, node.solutions[Bound.SEQUENCE], n)
        solution = self._optimise(solver, start.ravel())
        if not self._accepts(Bound.PATH, node, solution):
            return None
        return phases(self.problem.initial.agent, node.solutions[Bound.PATH], len(skeleton))

    def path_by_rrt(self, node: TreeNode) -> list[FloatArray] | None:
        """The motions of the phases by RRT-Connect between the sequence's switches, exactly checked."""
        motions = motions_between(
            self.problem,
            node.skeleton,
            node.solutions[Bound.SEQUENCE],
            self.settings,
            self.rng,
            self.counters,
            self._out_of_budget,
        )
        self._record(Bound.PATH, node, feasible=motions is not None)
        return motions

    def _optimise(self, solver: BoundSolver, start: FloatArray) -> BoundSolution:
        noise = self.rng.normal(0.0, self.settings.mbts_noise, len(start))
        solution = solver.solve(start + noise, self._parameters)
        self.counters["nlp_calls"] += 1
        self.counters["nlp_iterations"] += solution.iterations
        return solution

    def _accepts(self, bound: Bound, node: TreeNode, solution: BoundSolution) -> bool:
        """Whether `solution` is feasible; enters it into the node."""
        node.costs[bound] = solution.cost + self._symbolic_cost(node)
        node.solutions[bound] = solution.x.reshape(-1, 2)
        return self._record(bound, node, feasible=solution.violation < self.settings.mbts_max_violation)

    def _record(self, bound: Bound, node: TreeNode, *, feasible: bool) -> bool:
        """Counts the outcome; an infeasible node drops out of all queues, and its subtree with it."""
        node.infeasible = not feasible
        self.counters[f"{bound}_{'feasible' if feasible else 'infeasible'}"] += 1
        return feasible

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

    def _progress(self) -> Progress:
        passed = sum(self.counters[f"{bound}_feasible"] > 0 for bound in Bound)
        elapsed = time.perf_counter() - self._started
        return Progress(self.counters["expansions"], self.counters["nodes"], float(passed), elapsed)

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

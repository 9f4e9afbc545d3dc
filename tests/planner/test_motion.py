"""The back ends of motion queries: one interface, and they never contradict each other."""

from collections import Counter

import numpy as np
import pytest

from converter.shape import FloatArray
from planner.configuration_space import ConfigurationSpace, ObstacleSet
from planner.motion import MOTION_PLANNERS, OMPL_PLANNERS, motion_planner
from planner.pick_place import Region
from planner.problem import Problem
from planner.settings import settings_for
from planner.subproblems import subproblem_solvers
from planner.visibility import ShortestPathTree
from tests.planner.plain_geometry import length
from tests.planner.scenes import body, room, vectors, violations, wall

BOUNDS = vectors([-2, -2], [2, 2])
CORNERS = vectors([-1, -1], [1, -1], [1, 1], [-1, 1])
RADIUS = 0.2
CLEARANCE = 5e-3
BARRIER = vectors([-0.1, -2], [0.1, -2], [0.1, 1.5], [-0.1, 1.5])
CLOSED = vectors([-0.1, -2], [0.1, -2], [0.1, 2], [-0.1, 2])
LEFT, RIGHT = vectors([-1, -1], [1, -1])
ONE_EACH = pytest.mark.parametrize("name", ["ompl", "rrt", "visibility"])
SAMPLING = pytest.mark.parametrize("name", ["ompl", "rrt"])


def space_with(*cores: FloatArray, rho: float = RADIUS) -> ConfigurationSpace:
    """A square of 4 m with these obstacles."""
    return ConfigurationSpace(ObstacleSet.of(cores, [rho] * len(cores)), BOUNDS)


def random_cores(rng: np.random.Generator) -> list[FloatArray]:
    """Cubes on a grid whose gaps are as wide as the disc, and two turned boxes."""
    cells = np.argwhere(rng.random((5, 5)) < 0.4)
    cores = [0.8 * cell - 1.6 + 0.2 * CORNERS for cell in cells]
    for angle in rng.uniform(0, np.pi, 2):
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        cores.append(rng.uniform(-2, 2, 2) + CORNERS * rng.uniform(0.02, 0.4, 2) @ turn)
    return cores


def test_every_name_has_a_back_end():
    """The default of OMPL is RRT-Connect; unknown names are a mistake that is told which names there are."""
    assert all(callable(motion_planner(name)) for name in MOTION_PLANNERS)
    assert OMPL_PLANNERS[0] == "RRTConnect"
    for name in ("", "ompl:", "ompl:PRM", "rrt:RRT"):
        with pytest.raises(KeyError, match="there are ompl, rrt, visibility, ompl:RRTConnect"):
            motion_planner(name)


@pytest.mark.parametrize("name", [name for name in MOTION_PLANNERS if "KPIECE" not in name])
def test_every_back_end_finds_a_way(name: str):
    """Around a wall the path is free and joins the ends."""
    space = space_with(BARRIER, rho=0.1)
    result = motion_planner(name)(space, LEFT, RIGHT[None], 4000, np.random.default_rng(3))
    assert result.path is not None
    np.testing.assert_array_equal(result.path[[0, -1]], [LEFT, RIGHT])
    assert space.path_free(result.path)
    assert result.iterations <= 4000


@pytest.mark.parametrize("name", MOTION_PLANNERS)
def test_no_back_end_finds_a_way_where_there_is_none(name: str):
    """A wall from border to border, and ends that are not free; the iterations are bounded."""
    plan, rng = motion_planner(name), np.random.default_rng(0)
    space = space_with(CLOSED)
    result = plan(space, LEFT, RIGHT[None], 300, rng)
    assert result.path is None
    assert result.iterations <= 300
    blocked, outside = vectors([0, 0], [-2.1, 0])
    for start, goals in [
        (blocked, RIGHT[None]),
        (outside, RIGHT[None]),
        (LEFT, np.array([blocked, outside])),
        (LEFT, np.empty((0, 2))),
    ]:
        refused = plan(space, start, goals, 300, rng)
        assert (refused.path, refused.iterations) == (None, 0)


@pytest.mark.parametrize("name", MOTION_PLANNERS)
def test_the_seed_decides(name: str):
    """The same generator gives the same path, whatever ran before."""
    plan, space = motion_planner(name), space_with(BARRIER, rho=0.1)
    first, _, again = (plan(space, LEFT, RIGHT[None], 400, np.random.default_rng(seed)) for seed in (5, 6, 5))
    assert first.iterations == again.iterations
    assert (first.path is None) == (again.path is None)
    if first.path is not None:
        np.testing.assert_array_equal(first.path, again.path)


@SAMPLING
@pytest.mark.parametrize("seed", range(5))
def test_sampled_paths_are_free_and_join_the_ends(name: str, seed: int):
    """The path begins and ends exactly where asked, the exact test of its pieces confirms it; other seeds, other paths."""
    space = space_with(BARRIER, rho=0.1)
    result, other = (
        motion_planner(name)(space, LEFT, RIGHT[None], 5000, np.random.default_rng(s)) for s in (seed, seed + 1)
    )
    assert result.path is not None
    assert other.path is not None
    np.testing.assert_array_equal(result.path[[0, -1]], [LEFT, RIGHT])
    assert space.path_free(result.path)
    assert 0 < result.iterations <= 5000
    assert result.path.shape != other.path.shape or (result.path != other.path).any()


@SAMPLING
@pytest.mark.parametrize("iterations", [0, 1, 50, 600])
def test_iterations_are_bounded(name: str, iterations: int):
    """Where there is no way, the query ends after exactly as many iterations as allowed."""
    result = motion_planner(name)(space_with(CLOSED), LEFT, RIGHT[None], iterations, np.random.default_rng(0))
    assert (result.path, result.iterations) == (None, iterations)


@ONE_EACH
def test_one_of_several_goals(name: str):
    """The path ends at one of the goals; those that are not free are left out."""
    space = space_with(BARRIER, rho=0.1)
    goals = vectors([0, 0], [3, 0], [1, 1], [1.5, -1.5])
    for seed in range(5):
        path = motion_planner(name)(space, LEFT, goals, 5000, np.random.default_rng(seed)).path
        assert path is not None
        assert space.path_free(path)
        assert (path[-1] == goals[2:]).all(axis=1).any()


@ONE_EACH
@pytest.mark.parametrize("ends", [[LEFT, LEFT], BOUNDS], ids=["to itself", "on the bounds"])
def test_ends_may_agree_or_lie_on_the_border(name: str, ends: FloatArray):
    """Start and goal may be one place, and the border belongs to the space."""
    path = motion_planner(name)(space_with(), ends[0], np.array(ends[1:]), 100, np.random.default_rng(0)).path
    assert path is not None
    np.testing.assert_array_equal(path[[0, -1]], ends)


@pytest.mark.parametrize("name", ["ompl:RRTstar", "ompl:InformedRRTstar", "ompl:AORRTC"])
def test_optimal_planners_come_close_to_the_shortest_path(name: str):
    """With iterations to spare their paths are a few per cent longer than the shortest."""
    space = space_with(BARRIER, rho=0.1)
    found = motion_planner(name)(space, LEFT, RIGHT[None], 2000, np.random.default_rng(0)).path
    shortest = ShortestPathTree(space, LEFT).path_to(RIGHT)
    assert found is not None
    assert shortest is not None
    assert length(found) < 1.05 * length(shortest)


def test_the_shortest_path_leads_to_the_nearest_goal():
    """Of several goals visibility takes the one with the shortest way to it, not the one that is close by."""
    space = space_with(BARRIER, rho=0.1)
    goals = vectors([0.3, -1], [0, 0], [-1, 1.9])
    path = motion_planner("visibility")(space, LEFT, goals, 0, np.random.default_rng(0)).path
    assert path is not None
    np.testing.assert_array_equal(path, [LEFT, goals[2]])


@pytest.mark.parametrize("name", ["rrt", "visibility", "ompl:RRT"])
def test_subproblems_are_solved_with_any_back_end(name: str):
    """The faithful preset plans a pick-and-place around a wall with the motion planner that the settings name."""
    scene = room(wall(0, -0.5, 0.2, 2), objects=(body("obj", -1, -0.5),), agent=(-1.5, -1.5), goal=(1.5, -0.5))
    counters = Counter[str]()
    solver_for = subproblem_solvers(
        Problem(scene), settings_for("faithful", motion=name), np.random.default_rng(0), counters, lambda: False
    )
    step = solver_for(Problem(scene).initial).pick_place(0, Region.of_goal(scene.goal))
    assert step is not None
    assert violations(scene, step) == set()
    assert (counters["rrt_iterations"] == 0) == (name == "visibility")


def test_back_ends_agree():
    """1,000 random queries, half of them through gaps without clearance.

    No back end finds a path that the exact one denies. Where the exact one finds a path for a disc 5 mm larger, which
    leaves this clearance on both sides, all of them find one, given many iterations.
    """
    rng = np.random.default_rng(0)
    rrt, ompl, exact = (motion_planner(name) for name in ("rrt", "ompl", "visibility"))
    missed = found = denied = 0
    for _ in range(100):
        cores = random_cores(rng)
        tight, roomy = space_with(*cores), space_with(*cores, rho=RADIUS - CLEARANCE)
        draws = rng.uniform(*BOUNDS, (2000, 2))
        draws = draws[tight.points_free(draws)][:20]
        for start, goal in draws[: len(draws) // 2 * 2].reshape(-1, 2, 2):
            path = exact(tight, start, goal[None], 0, rng).path
            assert path is None or (tight.path_free(path) and roomy.path_free(path))
            for plan, iterations in ((rrt, 1000), (ompl, 200)):
                rival = plan(tight, start, goal[None], iterations, rng).path
                assert rival is None or tight.path_free(rival)
                assert rival is None or path is not None
            if path is None:
                denied += 1
                continue
            found += 1
            missed += sum(plan(roomy, start, goal[None], 50_000, rng).path is None for plan in (rrt, ompl))
    assert missed == 0
    assert found > 300
    assert denied > 100

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from converter.plan import Plan, Segment, Status
from converter.replay import replay
from converter.scene import Scene
from converter.shape import FloatArray
from converter.trajectory import NOTHING, SpeedProfile, TimedPlan, Trajectory
from pcg.errors import InputError

PROFILES = st.builds(
    SpeedProfile,
    speed=st.floats(0.05, 5.0),
    acceleration=st.floats(0.05, 20.0) | st.just(math.inf),
    grasp_time=st.sampled_from([0.0, 0.3]),
)


def distance_to_path(points: FloatArray, path: FloatArray) -> FloatArray:
    """(n,) [m]: distances of points (n, 2) to a polyline (m, 2)."""
    starts, edges = path[:-1], np.diff(path, axis=0)
    lengths = np.maximum((edges**2).sum(axis=1), 1e-300)
    shares = np.clip(((points[:, None] - starts) * edges).sum(axis=2) / lengths, 0, 1)
    return np.hypot(*np.moveaxis(points[:, None] - starts - shares[..., None] * edges, 2, 0)).min(axis=1)


def test_a_long_piece_is_a_trapezoid():
    """1 m at 0.5 m/s and 1 m/s^2: half a second up over 0.125 m, 1.5 s at full speed, half a second down."""
    profile = SpeedProfile(0.5, 1.0)
    times = np.array([0.0, 0.25, 0.5, 1.25, 2.0, 2.25, 2.5, 9.0])
    distances, speeds = profile.progress(times, np.ones(8))
    np.testing.assert_allclose(profile.durations(np.ones(1)), [2.5])
    np.testing.assert_allclose(distances, [0, 0.03125, 0.125, 0.5, 0.875, 0.96875, 1, 1])
    np.testing.assert_allclose(speeds, [0, 0.25, 0.5, 0.5, 0.5, 0.25, 0, 0])


def test_a_short_piece_is_a_triangle():
    """0.04 m at 1 m/s^2 takes twice 0.2 s, and never reaches more than 0.2 m/s."""
    profile = SpeedProfile(0.5, 1.0)
    distances, speeds = profile.progress(np.array([0.1, 0.2, 0.3]), np.full(3, 0.04))
    np.testing.assert_allclose(profile.durations(np.array([0.04])), [0.4])
    np.testing.assert_allclose(distances, [0.005, 0.02, 0.035])
    np.testing.assert_allclose(speeds, [0.1, 0.2, 0.1])


def test_constant_speed_does_not_stop():
    """Without acceleration a piece takes its length over the speed."""
    profile = SpeedProfile(0.5, math.inf)
    np.testing.assert_allclose(profile.durations(np.array([1.0, 0.0])), [2.0, 0.0])
    distances, speeds = profile.progress(np.array([0.0, 0.5, 2.0]), np.ones(3))
    np.testing.assert_allclose(distances, [0, 0.25, 1])
    np.testing.assert_allclose(speeds, [0.5, 0.5, 0])


@given(PROFILES, st.floats(1e-6, 10.0))
def test_progress_is_continuous_and_within_the_limits(profile: SpeedProfile, length: float):
    """The speed is the derivative of the distance; neither speed nor acceleration is exceeded."""
    duration = float(profile.durations(np.array([length]))[0])
    times = np.linspace(0, duration, 1001)
    distances, speeds = profile.progress(times, np.full(1001, length))
    assert (np.diff(distances) >= -1e-12 * length).all()
    assert distances[0] == 0
    assert distances[-1] == pytest.approx(length)
    assert speeds.max() <= profile.speed * (1 + 1e-9)
    if math.isfinite(profile.acceleration):
        assert np.abs(np.diff(speeds)).max() <= profile.acceleration * duration / 1000 * (1 + 1e-6) + 1e-12
        between = np.diff(distances) / (duration / 1000)
        bounds = np.minimum(speeds[1:], speeds[:-1]), np.maximum(speeds[1:], speeds[:-1])
        slack = profile.acceleration * duration / 1000 + 1e-9
        assert (between >= bounds[0] - slack).all()
        assert (between <= bounds[1] + slack).all()


# The fixtures are immutable, so it does no harm that all examples share them.
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(profile=PROFILES, step=st.sampled_from([0.01, 0.05, 0.1, 1.0]))
def test_lines_between_rows_stay_on_the_path(small_room: Scene, small_plan: Plan, profile: SpeedProfile, step: float):
    """Time rises, way-points are rows, and no corner is cut."""
    rows = TimedPlan(small_room, small_plan, profile).rows(step)
    path = np.concatenate([segment.path for segment in small_plan.segments])
    assert rows.times[0] == 0
    assert (np.diff(rows.times) > 0).all()
    middles = (rows.agent[1:] + rows.agent[:-1]) / 2
    assert distance_to_path(np.concatenate([rows.agent, middles]), path).max() < 1e-9
    for point in path:
        assert np.hypot(*(rows.agent - point).T).min() < 1e-9
    np.testing.assert_allclose(np.hypot(*np.diff(rows.agent, axis=0).T).sum(), small_plan.path_length)


def at(trajectory: Trajectory, time: float) -> int:
    """The row at a moment."""
    return int(np.flatnonzero(np.isclose(trajectory.times, time))[0])


def test_objects_go_with_the_agent_while_held(small_room: Scene, small_plan: Plan):
    """In every row a held object keeps its offset; others are where the replay has them."""
    rows = TimedPlan(small_room, small_plan).rows(0.05)
    steps = replay(small_room, small_plan)
    assert set(rows.segment.tolist()) == set(range(5))
    for k, segment in enumerate(rows.segment):
        np.testing.assert_allclose(rows.objects[k], steps[segment].positions_with(rows.agent[k]), atol=1e-12)
    held = rows.held[:-1] != NOTHING
    np.testing.assert_array_equal(
        held, [s.mode == "carry" for s in map(small_plan.segments.__getitem__, rows.segment[:-1])]
    )


def test_a_row_tells_what_holds_from_there_on(small_room: Scene, small_plan: Plan):
    """At the moment of a grasp the object is held, at that of its release no more, nor at the end."""
    motion = TimedPlan(small_room, small_plan, SpeedProfile(1.0, math.inf))
    rows = motion.rows(0.1)
    grasp = small_plan.segments[0].length
    release = grasp + small_plan.segments[1].length
    assert rows.held[[at(rows, grasp), at(rows, release)]].tolist() == [0, NOTHING]
    assert rows.held[-1] == NOTHING
    assert not rows.velocity[-1].any()
    assert motion.duration == pytest.approx(small_plan.path_length)


def test_the_agent_rests_at_grasps_and_releases(small_room: Scene, small_plan: Plan):
    """Two carries make four rests, in which the object is held and nothing moves."""
    with_rests = TimedPlan(small_room, small_plan, SpeedProfile(1.0, math.inf, grasp_time=0.5))
    assert with_rests.duration == pytest.approx(small_plan.path_length + 4 * 0.5)
    resting = with_rests.sample(np.array([small_plan.segments[0].length + t for t in (0.1, 0.4)]))
    np.testing.assert_allclose(resting.agent, [[-1.0, -0.4]] * 2)
    assert resting.held.tolist() == [0, 0]
    assert not resting.velocity.any()


def test_outside_of_its_time_a_plan_rests(small_room: Scene, small_plan: Plan):
    """Before the begin at the start, after the end at the last place."""
    motion = TimedPlan(small_room, small_plan)
    around = motion.sample(np.array([-1.0, motion.duration + 1.0]))
    np.testing.assert_allclose(around.agent, [[0.0, -1.0], [0.0, -1.0]], atol=1e-12)
    np.testing.assert_allclose(around.objects[:, 0], [[-1.0, 0.0], [-1.0, 1.5]], atol=1e-12)


def test_a_plan_without_motion_has_one_row(small_room: Scene, small_plan: Plan):
    """No segments, or segments of one point: everything stays where it is."""
    point = Segment("move", None, np.array([[0.0, -1.0]]))
    for segments in ((), (point,)):
        rows = TimedPlan(small_room, replace(small_plan, segments=segments)).rows(0.1)
        assert rows.times.tolist() == [0.0]
        np.testing.assert_array_equal(rows.agent, [[0.0, -1.0]])
        np.testing.assert_array_equal(rows.objects[0], [[-1.0, 0.0], [0.0, 1.0]])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0.0, 1.0, 0.0), "speed: 0.0 m/s must be from"),
        ((math.nan, 1.0, 0.0), "speed: nan m/s must be from"),
        ((math.inf, 1.0, 0.0), "speed: inf m/s must be from"),
        ((1.0, 0.0, 0.0), "acceleration: 0.0 m/s"),
        ((1.0, 1.0, -1.0), "grasp_time: -1.0 s must be from 0"),
        ((1.0, 1.0, math.inf), "grasp_time: inf s must be from 0"),
    ],
)
def test_impossible_profiles_are_refused(arguments: tuple[float, float, float], message: str):
    """Each by its name."""
    with pytest.raises(InputError, match=message):
        SpeedProfile(*arguments)


@pytest.mark.parametrize(("step", "message"), [(0.0, "step: 0.0 s must be"), (1e-9, "step: 1e-09 s is too fine")])
def test_impossible_steps_are_refused(small_room: Scene, small_plan: Plan, step: float, message: str):
    """Steps are positive, and not so small that memory runs out."""
    with pytest.raises(InputError, match=message):
        TimedPlan(small_room, small_plan).rows(step)


def test_only_solved_plans_have_a_motion(small_room: Scene, small_plan: Plan):
    """The status is named."""
    with pytest.raises(InputError, match="status: exhausted"):
        TimedPlan(small_room, replace(small_plan, status=Status.EXHAUSTED, segments=()))

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from converter.formats import read_scene
from converter.plan import Plan, Segment, Status, read_plan
from converter.preset import with_preset
from converter.replay_mujoco import MujocoReplay, replay_dynamic, replay_kinematic
from converter.scene import Scene
from pcg.errors import InputError
from planner import settings_for, solve
from planner.verify import verify

ROOT = Path(__file__).parents[2]
GOLDEN = ROOT / "tests" / "golden"
NAMES = ["corner", "cube-free", "four-blocks", "maze-easy", "maze", "o-room", "two-blocks", "wall-easy", "wall"]


def planned(name: str, preset: str) -> tuple[Scene, Plan]:
    """A puzzle in a geometry and a plan that shapely finds valid; Maze takes long, so its plans are kept."""
    scene = with_preset(read_scene(ROOT / "data" / "puzzles" / f"{name}.yaml"), preset)
    if name == "maze":
        plan = read_plan(GOLDEN / f"maze-{preset}-plan.json")
    else:
        settings = settings_for("fast", method="Rnd+FPR", time_limit=900)
        plan = solve(scene, settings, np.random.default_rng(0)).to_plan(scene, settings, seed=0)
    assert verify(scene, plan) == []
    return scene, plan


@pytest.mark.parametrize("name", NAMES)
def test_plans_in_the_published_geometry_replay(name: str):
    """MuJoCo, which shares no code with planner and verifier, sees no deeper contact than they do."""
    scene, plan = planned(name, "published")
    seen = replay_kinematic(scene, plan)
    assert seen.valid
    assert seen.penetration <= scene.tolerance + 2e-6
    assert seen.goal_distance == 0


@pytest.mark.parametrize("name", NAMES)
def test_plans_in_the_clear_geometry_can_be_driven(name: str):
    """Servos, welds, friction and gravity bring the object to the goal; nothing else moves, nothing penetrates."""
    scene, plan = planned(name, "clear")
    assert replay_kinematic(scene, plan).valid
    seen = replay_dynamic(scene, plan)
    assert seen.valid
    assert seen.disturbance < 1e-3
    assert seen.tracking_error < 1e-3


@pytest.fixture
def clear_plan(small_room: Scene, small_plan: Plan) -> tuple[Scene, Plan]:
    """The small room with a valid plan: one carry from below, without the detour of `small_plan`."""
    segments = (
        Segment("move", None, np.array([[0.0, -1.0], [-1.0, -1.0], [-1.0, -0.4]])),
        Segment("carry", "obj", np.array([[-1.0, -0.4], [-1.2, 0.4], [-1.0, 1.1]])),
        Segment("move", None, np.array([[-1.0, 1.1], [0.0, -1.0]])),
    )
    return small_room, replace(small_plan, segments=segments)


Replays = pytest.mark.parametrize("replays", [replay_kinematic, replay_dynamic])


@Replays
def test_a_valid_plan_is_valid(clear_plan: tuple[Scene, Plan], replays: Callable[[Scene, Plan], MujocoReplay]):
    """Small penetration, goal reached."""
    seen = replays(*clear_plan)
    assert seen.valid
    assert seen.goal_reached


def test_a_plan_through_a_wall_is_not_valid(clear_plan: tuple[Scene, Plan]):
    """An agent that is put into a wall penetrates it; the shortest way out would be up, by its height."""
    scene, plan = clear_plan
    detour = Segment("move", None, np.array([[0.0, -1.0], [1.0, -0.9], [0.0, -1.0]]))
    seen = replay_kinematic(scene, replace(plan, segments=(detour, *plan.segments)))
    assert not seen.valid
    assert seen.penetration == pytest.approx(scene.agent.height)
    assert seen.segment == 0
    assert set(seen.bodies or ()) == {"agent", "wall"}


def test_a_driven_agent_is_stopped_by_a_wall(clear_plan: tuple[Scene, Plan]):
    """In the dynamic replay a wall is in the way: the agent falls behind its trajectory."""
    scene, plan = clear_plan
    detour = Segment("move", None, np.array([[0.0, -1.0], [0.0, -0.5], [1.5, -0.5], [0.0, -0.5], [0.0, -1.0]]))
    seen = replay_dynamic(scene, replace(plan, segments=(detour, *plan.segments)))
    assert seen.tracking_error > 0.3


@Replays
def test_a_plan_that_misses_the_goal_is_not_valid(
    clear_plan: tuple[Scene, Plan], replays: Callable[[Scene, Plan], MujocoReplay]
):
    """The distance from the goal is that from the rectangle, not from its centre."""
    scene, plan = clear_plan
    short = Segment("carry", "obj", np.array([[-1.0, -0.4], [-1.0, 0.7]]))
    seen = replays(scene, replace(plan, segments=(plan.segments[0], short)))
    assert not seen.valid
    assert not seen.goal_reached
    assert seen.goal_distance == pytest.approx(0.2, abs=1e-3)


def test_an_object_that_is_run_into_is_disturbed(clear_plan: tuple[Scene, Plan]):
    """An obstacle that is not held moves when it is pushed, and the replay tells by how much."""
    scene, plan = clear_plan
    push = Segment("move", None, np.array([[0.0, -1.0], [0.0, 0.8], [0.0, -1.0]]))
    seen = replay_dynamic(scene, replace(plan, segments=(push, *plan.segments)))
    assert seen.disturbance == pytest.approx(0.15, abs=0.02)


def test_only_solved_plans_are_replayed(clear_plan: tuple[Scene, Plan]):
    """A plan without a solution has no motion."""
    scene, plan = clear_plan
    with pytest.raises(InputError, match="status: timeout; only a solved plan has a motion"):
        replay_kinematic(scene, replace(plan, status=Status.TIMEOUT, segments=()))


def test_without_mujoco_the_message_says_how_to_get_it(clear_plan: tuple[Scene, Plan], monkeypatch: pytest.MonkeyPatch):
    """MuJoCo is optional."""
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(InputError, match=r"mujoco: not installed; .* pip install mujoco"):
        replay_kinematic(*clear_plan)

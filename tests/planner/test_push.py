"""Plans lifted from push solutions."""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from converter.convert import ConversionSettings, convert_level
from converter.plan import Plan, Status
from converter.preset import with_preset, with_tolerance
from converter.scene import Scene
from pcg.errors import InputError
from pcg.generate import random_levels
from pcg.solver import solve as solve_level
from pcg.xsb import parse_levels
from planner import push
from planner.settings import Settings
from planner.verify import verify
from tests.planner.scenes import room

PUSH = Settings(method="Push")
CORRIDOR = """
#######
##    #
#@$   #
##  #.#
#######
"""


def converted(text: str, preset: str = "clear") -> Scene:
    """The scene of the only level in a text."""
    (level,) = parse_levels(text, "level.xsb")
    return convert_level(level, ConversionSettings(preset=preset))


def plan_of(scene: Scene) -> Plan:
    """What Push makes of a scene."""
    return push.solve(scene, PUSH, np.random.default_rng(0)).to_plan(scene, PUSH, 0)


def test_random_levels_lift():
    """In preset clear every push solution becomes a plan that passes verification, also without any tolerance."""
    for generated in islice(random_levels(1), 60):
        scene = convert_level(generated.level)
        plan = plan_of(scene)
        assert plan.counters["pushes"] == generated.solution.pushes
        assert verify(scene, plan) == []
        exact = with_tolerance(scene, 0.0)
        assert verify(exact, plan_of(exact)) == []


def test_turned_boxes_lift():
    """The agent touches what it pushes, whatever its shape and angle, so these scenes are solved as well."""
    settings = ConversionSettings(size_jitter=0.4, yaw_jitter=0.8, merge_walls=True)
    for generated in islice(random_levels(2), 20):
        scene = convert_level(generated.level, settings)
        assert verify(scene, plan_of(scene)) == []


def test_pushes_in_one_direction_are_one_carry():
    """Three pushes to the right, then one down: two carries, with the agent behind the crate by their half sizes."""
    scene = converted(CORRIDOR)
    plan = plan_of(scene)
    assert plan.counters["pushes"] == 4
    assert [segment.mode for segment in plan.segments] == ["move", "carry", "move", "carry"]
    first, second = (segment.path for segment in plan.segments if segment.mode == "carry")
    behind = 0.1 + scene.agent.radius
    np.testing.assert_allclose(first, [[-0.4 - behind, 0], [0.8 - behind, 0]], atol=1e-12)
    np.testing.assert_allclose(second, [[0.8, behind], [0.8, -0.4 + behind]], atol=1e-12)
    assert verify(scene, plan) == []


def test_corridors_as_wide_as_the_agent():
    """In preset published there is no clearance; beside the outer walls the crate is carried in another grasp."""
    inner = "#########\n#########\n###    ##\n##@$   ##\n###  #.##\n#########\n#########\n"
    for tolerance in (1e-3, 0.0):
        scene = with_tolerance(converted(inner, "published"), tolerance)
        assert verify(scene, plan_of(scene)) == []
    border = "######\n#    #\n# @  #\n# $  #\n#.   #\n######\n"
    scene = converted(border, "published")
    straight = plan_of(with_preset(scene, "clear"))
    assert verify(scene, replace(straight, scene_hash=scene.geometry_hash)) != []
    assert verify(scene, plan_of(scene)) == []


def test_a_level_that_is_solved_at_the_start():
    """Nothing has to be pushed."""
    plan = plan_of(converted("#####\n#@* #\n#####\n"))
    assert (plan.status, plan.segments) == (Status.SOLVED, ())


def test_only_the_goal_object_has_to_arrive():
    """The scene of a level with two targets asks for one of them."""
    scene = converted("########\n#@$ . ##\n#####$.#\n########\n")
    assert verify(scene, plan_of(scene)) == []


def test_an_unsolvable_level_is_no_proof():
    """A crate in a corner cannot be pushed, but it might be carried."""
    plan = plan_of(converted("#####\n#$  #\n#@. #\n#####\n"))
    assert plan.status is Status.EXHAUSTED
    assert plan.certificate == "no sequence of pushes solves the source level"


def test_the_solver_may_give_up(monkeypatch: pytest.MonkeyPatch):
    """Undecided is neither solved nor unsolvable."""
    monkeypatch.setattr(push, "solve_level", lambda level: solve_level(level, max_states=1))
    plan = plan_of(converted(CORRIDOR))
    assert (plan.status, plan.certificate) == (Status.TIMEOUT, "the push solver reached its limit of states")


def test_pushes_that_collide_are_no_plan():
    """A wall that the level does not know stands in the way."""
    scene = converted(CORRIDOR)
    blocked = replace(scene, walls=(*scene.walls, replace(scene.walls[-1].at(np.array([0.4, 0.0])), name="new")))
    plan = plan_of(blocked)
    assert (plan.status, plan.segments) == (Status.EXHAUSTED, ())
    assert plan.certificate == "carry 1 of the push solution collides"


def test_a_lift_can_be_stopped():
    """As any search."""
    stopped = push.solve(converted(CORRIDOR), PUSH, np.random.default_rng(0), should_stop=lambda: True)
    assert (stopped.status, stopped.segments) == (Status.TIMEOUT, ())


def test_scenes_without_their_level_are_refused():
    """Where there is no level, where it is damaged, and where it is that of another scene."""
    with pytest.raises(InputError, match=r"room: method Push needs a scene converted from a level"):
        plan_of(room())
    scene = converted(CORRIDOR)
    with pytest.raises(InputError, match=r"level-1: source\.xsb: no level found"):
        plan_of(replace(scene, source={**scene.source, "xsb": "nothing"}))
    with pytest.raises(InputError, match=r"level-1: source: settings\.cell: .*greater than 0"):
        plan_of(replace(scene, source={**scene.source, "settings": {"cell": 0}}))
    moved = replace(scene, agent=replace(scene.agent, position=np.array([-0.4, 0.4])))
    with pytest.raises(InputError, match=r"source\.xsb is not the level of this scene"):
        plan_of(moved)

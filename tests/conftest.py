"""A scene and a plan that several tests share."""

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

from converter.plan import Plan, Segment, Status
from converter.scene import Agent, Body, Goal, Scene
from converter.shape import Part

# The gate gives the same answer every time and on a machine of any speed.
settings.register_profile("gate", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("gate")


def _box(name: str, x: float, y: float, size: tuple[float, float], edge_radius: float = 0.0) -> Body:
    return Body(name, np.array([x, y, 0.1]), 0.2, (Part.box(size, edge_radius),))


@pytest.fixture
def small_room() -> Scene:
    """A 4 m square room with a wall on the right, the goal-object at (-1, 0) and an obstacle at (0, 1)."""
    return Scene(
        name="small-room",
        bounds=np.array([[-2.0, -2.0], [2.0, 2.0]]),
        tolerance=1e-3,
        agent=Agent(np.array([0.0, -1.0]), 0.2),
        walls=(_box("wall", 1.0, 0.0, (0.2, 2.0)),),
        objects=(_box("obj", -1.0, 0.0, (0.4, 0.4), 0.05), _box("obstacle", 0.0, 1.0, (0.3, 0.3))),
        goal=Goal("obj", np.array([-1.0, 1.5]), np.array([0.5, 0.4])),
    )


@pytest.fixture
def small_plan(small_room: Scene) -> Plan:
    """Carries the goal-object from (-1, 0) over (-1.2, 0.8) to the goal; drives to it, around, and back to the start."""
    segments = (
        Segment("move", None, np.array([[0.0, -1.0], [-1.0, -1.0], [-1.0, -0.4]])),
        Segment("carry", "obj", np.array([[-1.0, -0.4], [-1.2, 0.4]])),
        Segment("move", None, np.array([[-1.2, 0.4], [-1.0, 0.4]])),
        Segment("carry", "obj", np.array([[-1.0, 0.4], [-0.8, 1.1]])),
        Segment("move", None, np.array([[-0.8, 1.1], [0.0, -1.0]])),
    )
    return Plan(
        scene="small-room",
        scene_hash=small_room.geometry_hash,
        method="by hand",
        seed=0,
        status=Status.SOLVED,
        time_s=0.0,
        tolerance=1e-3,
        segments=segments,
    )

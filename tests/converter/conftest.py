"""Hypothesis strategies for scenes, registered by type: `st.from_type(Scene)`."""

from typing import Any

import numpy as np
from hypothesis import strategies as st

from converter.scene import Agent, Body, Goal, Scene
from converter.shape import Part


def numbers(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers as people write them, and as computations leave them."""
    return st.one_of(
        st.integers(int(low * 1000) + 1, int(high * 1000)).map(lambda thousandths: thousandths / 1000),
        st.floats(low, high, allow_subnormal=False),
    )


@st.composite
def boxes(draw: st.DrawFn) -> Part:
    """Rounded boxes about the origin."""
    sides = draw(numbers(0.1, 3.0)), draw(numbers(0.1, 3.0))
    return Part.box(sides, draw(numbers(0.0, min(sides) / 2.1)))


@st.composite
def convex_polygons(draw: st.DrawFn) -> Part:
    """Polygons with corners on an ellipse, well apart from each other."""
    n = draw(st.integers(3, 8))
    angles = (np.arange(n) + [draw(st.floats(0, 0.5)) for _ in range(n)]) * 2 * np.pi / n
    axes = [draw(numbers(0.2, 2.0)), draw(numbers(0.2, 2.0))]
    return Part(np.column_stack([np.cos(angles), np.sin(angles)]) * axes, draw(numbers(0.0, 0.1)))


@st.composite
def moved_boxes(draw: st.DrawFn) -> Part:
    """Boxes somewhere in the frame of the body, as in L- and T-shapes."""
    part = draw(boxes())
    return Part(part.core + np.array([draw(numbers(-1.0, 1.0)), draw(numbers(-1.0, 1.0))]), part.edge_radius)


@st.composite
def round_parts(draw: st.DrawFn) -> Part:
    """Discs and capsules."""
    core = [[0.0, 0.0], [draw(numbers(0.1, 1.0)), draw(numbers(-1.0, 1.0))]][: draw(st.integers(1, 2))]
    return Part(np.array(core), draw(numbers(0.01, 0.5)))


def parts() -> st.SearchStrategy[Part]:
    """Every kind of part."""
    return st.one_of(boxes(), convex_polygons(), moved_boxes(), round_parts())


@st.composite
def bodies(draw: st.DrawFn, name: str = "body") -> Body:
    """Bodies of one or several parts."""
    height = draw(numbers(0.05, 2.0))
    return Body(
        name=name,
        position=np.array([draw(numbers(-9.0, 9.0)), draw(numbers(-9.0, 9.0)), height / 2]),
        height=height,
        parts=tuple(draw(st.lists(parts(), min_size=1, max_size=3))),
        yaw=draw(st.one_of(st.just(0.0), numbers(-4.0, 4.0))),
        color=draw(st.none() | st.tuples(*[st.floats(0, 1)] * 3)),
    )


@st.composite
def scenes(draw: st.DrawFn) -> Scene:
    """Scenes with two walls and one or two objects."""
    words = st.text(st.characters(categories=["L", "N", "P"]), min_size=1, max_size=8)
    names = draw(st.lists(words, min_size=4, max_size=4, unique=True))
    objects = tuple(draw(bodies(name)) for name in names[2 : draw(st.integers(3, 4))])
    plain: st.SearchStrategy[Any] = st.none() | st.booleans() | st.integers(0, 10**9) | words
    return Scene(
        name=draw(words),
        bounds=np.array([[-draw(numbers(1.0, 9.0)), -2.05], [2.05, draw(numbers(1.0, 9.0))]]),
        tolerance=draw(numbers(0.0, 0.01)),
        agent=Agent(np.array([draw(numbers(-9.0, 9.0)), 0.1]), draw(numbers(0.05, 0.5)), draw(numbers(0.05, 0.5))),
        walls=tuple(draw(bodies(name)) for name in names[:2]),
        objects=objects,
        goal=Goal(
            objects[0].name, np.array([draw(numbers(-9.0, 9.0)), 1.0]), np.array([draw(numbers(0.1, 1.0)), 0.35])
        ),
        preset=draw(st.sampled_from([None, "clear", "published"])),
        source=draw(st.dictionaries(words, plain | st.lists(plain, max_size=3), max_size=3)),
    )


st.register_type_strategy(Part, parts())
st.register_type_strategy(Body, bodies())
st.register_type_strategy(Scene, scenes())

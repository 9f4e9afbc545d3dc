"""Penetration along a path: analytic cases, and a plain twin by difference sets and dense sampling."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from converter.scene import Agent, Body
from converter.shape import FloatArray, Part
from planner.penetration import Prism, deepest_contacts

coordinates = st.floats(-1.0, 1.0).map(lambda x: round(x, 3))
points = st.tuples(coordinates, coordinates).map(np.array)
radii = st.sampled_from([0.0, 0.01, 0.2])
SAMPLES = 400


@st.composite
def convex_parts(draw: st.DrawFn) -> Part:
    """Regular-ish polygons with 3 to 7 vertices, capsules and discs."""
    n = draw(st.integers(1, 7))
    radius = draw(radii) if n > 2 else draw(st.sampled_from([0.01, 0.2]))
    angles = np.arange(n) * 2 * np.pi / n + draw(st.floats(0, 1))
    size = draw(st.floats(0.05, 0.6))
    stretch = np.array([draw(st.floats(0.2, 1.0)), 1.0])
    return Part(size * np.column_stack([np.cos(angles), np.sin(angles)]) * stretch, radius)


def prism(name: str, part: Part, position: FloatArray) -> Prism:
    """The part as a body of height 0.2 on the floor."""
    return Prism.of_body(Body(name, np.array([*position, 0.1]), 0.2, (part,)))


def box(name: str, x: float, y: float, size: float = 0.4, z: float = 0.1) -> Prism:
    """A sharp cube-like body of height 0.2."""
    return Prism.of_body(Body(name, np.array([x, y, z]), 0.2, (Part.box((size, size)),)))


def depth(mover: Prism, path: FloatArray, obstacle: Prism) -> float | None:
    """Deepest penetration, None if it is below any that counts."""
    contact = deepest_contacts(mover, np.asarray(path, dtype=float), [obstacle], 0.0).get(obstacle.name)
    return None if contact is None else contact.depth


def sampled_depth(a: Part, path: FloatArray, b: Part, b_position: FloatArray) -> float:
    """Greatest depth at `SAMPLES` + 1 places, each from the hull of all differences of vertices."""
    differences = (b.core[:, np.newaxis] + b_position - a.core[np.newaxis]).reshape(-1, 2)
    hull = shapely.convex_hull(shapely.multipoints(differences))
    places = path[0] + np.linspace(0, 1, SAMPLES + 1)[:, np.newaxis] * (path[1] - path[0])
    origins = shapely.points(places)
    inside = shapely.contains(hull, origins)
    border = shapely.boundary(hull) if hull.geom_type == "Polygon" else hull
    distances = shapely.distance(border, origins)
    return (
        float(np.where(inside & (hull.geom_type == "Polygon"), distances, -distances).max())
        + a.edge_radius
        + b.edge_radius
    )


@given(convex_parts(), convex_parts(), points, points, points)
def test_agrees_with_dense_sampling(a: Part, b: Part, start: FloatArray, end: FloatArray, place: FloatArray):
    """The reported depth bounds every sample, and no more than the distance between samples above the deepest."""
    path = np.array([start, end])
    sampled = sampled_depth(a, path, b, place)
    found = depth(prism("a", a, start), path, prism("b", b, place)) or 0.0
    spacing = float(np.hypot(*(end - start))) / SAMPLES
    assert max(sampled, 0.0) <= found + 1e-9
    assert found <= max(sampled + spacing / 2, 0.0) + 1e-9


@given(convex_parts(), convex_parts(), points, points)
def test_swapping_the_bodies_keeps_the_depth(a: Part, b: Part, place: FloatArray, other: FloatArray):
    """At rest the depth of one body in another is that of the other in the one."""
    first, second = prism("a", a, place), prism("b", b, other)
    assert depth(first, [place], second) == pytest.approx(depth(second, [other], first), abs=1e-12)


def test_disc_beside_a_wall():
    """A disc of radius 0.2 whose centre passes a box at 0.15 penetrates it by 0.05, at the box's side."""
    agent = Prism.of_agent(Agent(np.array([-1.0, 0.35]), 0.2))
    contact = deepest_contacts(agent, np.array([[-1.0, 0.35], [1.0, 0.35]]), [box("b", 0, 0)], 0.0)["b"]
    assert contact.depth == pytest.approx(0.05)
    assert contact.where[1] == pytest.approx(0.2)


def test_disc_through_a_box():
    """Crossing a box of half-width 0.2 through its centre, the disc's centre is 0.2 deep and its border 0.4."""
    agent = Prism.of_agent(Agent(np.array([-1.0, 0.0]), 0.2))
    contact = deepest_contacts(agent, np.array([[-1.0, 0.0], [1.0, 0.0]]), [box("b", 0, 0)], 0.0)["b"]
    assert contact.depth == pytest.approx(0.4)
    assert contact.where == pytest.approx([0.0, 0.0])


def test_sharp_boxes_that_touch_have_no_depth():
    """Sliding along a wall, face on face, and meeting it corner to corner are free."""
    wall = box("wall", 0, 0)
    assert depth(box("b", -1, 0.4), [[-1, 0.4], [1, 0.4]], wall) is None
    assert depth(box("b", -1, 1), [[-1, 1], [-0.4, 0.4]], wall) is None


def test_sharp_boxes_that_overlap():
    """Sharp boxes report their overlap, although both radii are 0."""
    assert depth(box("b", -1, 0.397), [[-1, 0.397], [1, 0.397]], box("wall", 0, 0)) == pytest.approx(0.003)


def test_cutting_a_corner_is_found_between_free_way_points():
    """Both ends are free; the deepest place lies inside the piece: box corners overlap by 0.1 along the diagonal."""
    found = depth(box("b", -0.3, 0.5), [[-0.3, 0.5], [0.5, -0.3]], box("wall", 0.4, 0.4))
    assert depth(box("b", -0.3, 0.5), [[-0.3, 0.5]], box("wall", 0.4, 0.4)) is None
    assert found == pytest.approx(0.1)


@pytest.mark.parametrize("turn", range(3))
def test_the_deepest_piece_of_a_path_counts(turn: int):
    """Wherever it stands in the path: the piece that enters by 0.1, beside one that enters by 0.05 and a free one."""
    there, shallow, deep = [-1.0, 0.0], [-0.35, 0.0], [-0.3, 0.0]
    path = [[there, shallow, there, deep], [there, deep, there, shallow], [shallow, there, deep, there]][turn]
    assert depth(box("b", 0, 0), path, box("wall", 0, 0)) == pytest.approx(0.1)


@pytest.mark.parametrize("x", [0.0, 1.0, -2.7])
def test_merged_vertices_change_nothing(x: float):
    """A core so thin that rounding merges its vertices is a line: a cube across it has to leave by half its side."""
    corners = np.array([[-1e-17, -1.0], [1e-17, -1.0], [1e-17, 1.0], [-1e-17, 1.0]])
    thin = prism("thin", Part(corners), np.array([x, 0.0]))
    assert depth(box("b", 0, 0), [[x, 0.0]], thin) == pytest.approx(0.2)
    assert depth(box("b", 0, 0), [[x - 1, 0.1], [x + 1, 0.1]], thin) == pytest.approx(0.2)
    assert depth(box("b", 0, 0), [[x + 0.2 + 1e-9, 0.0]], thin) is None


def test_bodies_on_top_of_each_other_do_not_meet():
    """Height intervals that only touch are disjoint."""
    assert depth(box("b", 0, 0, z=0.3), [[0, 0]], box("c", 0, 0)) is None
    assert depth(box("b", 0, 0, z=0.29), [[0, 0]], box("c", 0, 0)) == pytest.approx(0.4)


def test_the_agent_stands_on_the_floor():
    """What lies below the floor does not meet it, what rises above the floor by a little does."""
    agent = Prism.of_agent(Agent(np.zeros(2), 0.2))
    assert depth(agent, [[0.0, 0.0]], box("sunk", 0, 0, z=-0.15)) is None
    assert depth(agent, [[0.0, 0.0]], box("rising", 0, 0, z=-0.05)) is not None


def test_compound_bodies_report_their_deepest_part():
    """Of the parts of an L the one that is met deepest counts."""
    parts = (Part.box((0.6, 0.2)), Part(np.array([[0.1, -0.1], [0.3, -0.1], [0.3, 0.5], [0.1, 0.5]])))
    ell = Prism.of_body(Body("ell", np.array([0.0, 0.0, 0.1]), 0.2, parts))
    disc = Prism.of_agent(Agent(np.array([0.2, 0.6]), 0.12))
    assert depth(disc, [[0.2, 0.6]], ell) == pytest.approx(0.02)
    assert depth(disc, [[0.2, 0.6], [-0.2, 0.2]], ell) > 0.02


def test_gap_of_discs_and_boxes():
    """The gap is the distance of the outlines: negative in overlap, infinite at different heights."""
    agent = Prism.of_agent(Agent(np.array([0.5, 0.0]), 0.2))
    assert agent.gap(box("b", 0, 0)) == pytest.approx(0.1)
    assert agent.at(np.array([0.3, 0.0])).gap(box("b", 0, 0)) == pytest.approx(-0.1)
    assert agent.gap(box("b", 0, 0, z=1.0)) == np.inf


def test_each_of_several_obstacles_is_measured_by_its_own_radius():
    """Beside a sharp box a round post is met where only its own radius reaches, each under its own name."""
    post = prism("post", Part(np.zeros((1, 2)), 0.3), np.array([1.0, 0.0]))
    compound = Prism.of_body(Body("pair", np.array([-1.0, 0.0, 0.1]), 0.2, (Part.box((0.4, 0.4)),) * 2))
    agent = Prism.of_agent(Agent(np.array([0.5, 0.0]), 0.25))
    path = np.array([[0.5, 0.0], [-0.6, 0.0]])
    found = deepest_contacts(agent, path, [compound, post, box("far", 0, 2)], 0.01)
    assert {name: contact.depth for name, contact in found.items()} == pytest.approx({"pair": 0.05, "post": 0.05})
    assert found["post"].where == pytest.approx([1.0, 0.0])
    assert found["pair"].where == pytest.approx([-0.8, 0.0])


@pytest.mark.parametrize("x", [0.55, 0.15])
def test_allowed_depth_does_not_count(x: float):
    """A depth is left out if it is allowed, whether the cores are apart or intersect, and else reported whole."""
    agent = Prism.of_agent(Agent(np.array([0.0, 0.0]), 0.4))
    path, overlap = np.array([[x, 0.0]]), 0.4 + 0.2 - x
    assert deepest_contacts(agent, path, [box("b", 0, 0)], overlap + 1e-6) == {}
    assert deepest_contacts(agent, path, [box("b", 0, 0)], overlap - 1e-6)["b"].depth == pytest.approx(overlap)


def test_concentric_discs():
    """Two points have no normals to separate them: the depth is the sum of the radii."""
    post = prism("post", Part(np.zeros((1, 2)), 0.3), np.array([1.0, 0.0]))
    assert depth(Prism.of_agent(Agent(np.zeros(2), 0.2)), [[1.0, 0.0]], post) == pytest.approx(0.5)
    assert depth(Prism.of_agent(Agent(np.zeros(2), 0.2)), [[0.0, 0.0], [2.0, 0.0]], post) == pytest.approx(0.5)


@pytest.mark.parametrize("share", [0.0, 0.25, 0.6, 1.0])
def test_the_deepest_place_along_a_piece_is_exact(share: float):
    """A disc crosses a triangle at a height where its sides slope alike: it is deepest half-way, by a known depth."""
    triangle = prism("triangle", Part(np.array([[-0.5, 0.0], [0.5, 0.0], [0.0, 0.5]]), 0.0), np.zeros(2))
    agent = Prism.of_agent(Agent(np.zeros(2), 0.1))
    height = 0.5 - 0.5 * share
    # In the middle the two sides are (0.5 - height) / sqrt(2) away, the base is at height.
    expected = 0.1 + max(0.0, min(height, (0.5 - height) / np.sqrt(2)))
    assert depth(agent, [[-1.0, height], [1.0, height]], triangle) == pytest.approx(expected, abs=1e-12)
    assert depth(agent, [[-1.0, height], [0.0, height]], triangle) == pytest.approx(expected, abs=1e-12)
    assert depth(agent, [[0.0, height], [1.0, height]], triangle) == pytest.approx(expected, abs=1e-12)
    assert depth(agent, [[0.0, height]], triangle) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("mirror", [1.0, -1.0])
@pytest.mark.parametrize("reverse", [1, -1])
def test_the_deepest_place_lies_where_an_edge_between_the_ends_says(mirror: float, reverse: int):
    """A disc crosses a tower with two roofs: deepest not half-way between its walls, but under the crossing of two.

    At y = 0 the distances are 1 + x to the left wall, 1 - x to the right one, and to the roofs through (0, 0.8) and
    (0, 0.6) with slopes -3/4 and -4/3 they are 0.64 - 0.6 x and 0.36 - 0.8 x: 1 + x = 0.36 - 0.8 x at x = -16/45.
    """
    corners = np.array([[-1, -5], [1, -5], [1, 0.6 - 4 / 3], [-12 / 35, 37 / 35], [-1, 1.55]]) * [mirror, 1]
    tower = prism("tower", Part(corners[:: int(mirror)]), np.zeros(2))
    agent = Prism.of_agent(Agent(np.zeros(2), 0.1))
    path = np.array([[-5.0, 0.0], [5.0, 0.0]])[::reverse]
    contact = deepest_contacts(agent, path, [tower], 0.0)["tower"]
    assert contact.depth == pytest.approx(0.1 + 29 / 45)
    assert contact.where == pytest.approx([-mirror * 16 / 45, 0.0])


def test_gap_to_the_nearest_part():
    """Of several parts with their own radii the nearest outline decides."""
    parts = (Part(np.array([[0.0, 0.0]]), 0.3), Part(np.array([[1.0, 0.0]]), 0.1))
    pair = Prism.of_body(Body("pair", np.array([0.0, 0.0, 0.1]), 0.2, parts))
    agent = Prism.of_agent(Agent(np.array([1.5, 0.0]), 0.2))
    assert agent.gap(pair) == pytest.approx(0.2)
    assert pair.gap(agent) == pytest.approx(0.2)
    assert agent.at(np.array([-0.6, 0.0])).gap(pair) == pytest.approx(0.1)

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from converter.outline import MAX_ERROR, outline_polygon, rectangle_of
from converter.shape import Part, rotation

SLACK = 1e-9


def exact(part: Part) -> shapely.Geometry:
    """The part by shapely, its arcs about ten times finer than the polygon's."""
    core = shapely.convex_hull(shapely.MultiPoint(part.core))
    return core.buffer(part.edge_radius, quad_segs=400) if part.edge_radius > SLACK else core


@given(st.from_type(Part))
def test_polygons_lie_inside_and_close_to_the_outline(part: Part):
    """No vertex is outside of the part, and no point of its outline is farther than the allowed error."""
    polygon = shapely.Polygon(outline_polygon(part)) if part.edge_radius else exact(part)
    fineness = part.edge_radius * (1 - np.cos(np.pi / 1600))
    assert shapely.hausdorff_distance(polygon, exact(part)) <= MAX_ERROR + fineness + SLACK
    assert polygon.within(exact(part).buffer(fineness + SLACK))


@given(st.from_type(Part))
def test_polygons_are_convex_and_counter_clockwise(part: Part):
    """What is handed to a mesh is its own convex hull; coincident vertices are far below any tolerance."""
    polygon = outline_polygon(part)
    edges = np.roll(polygon, -1, axis=0) - polygon
    after = np.roll(edges, -1, axis=0)
    assert (edges[:, 0] * after[:, 1] - edges[:, 1] * after[:, 0] >= -SLACK).all()


def test_a_disc_has_as_many_vertices_as_the_error_needs():
    """A chord over the angle a leaves the arc by r (1 - cos(a / 2)): 100 vertices are enough for 0.2 m, 99 are not."""
    polygon = outline_polygon(Part(np.zeros((1, 2)), 0.2), 0.2 * (1 - np.cos(np.pi / 99.5)))
    assert len(polygon) == 100
    np.testing.assert_allclose(np.hypot(*polygon.T), 0.2)


def test_a_sharp_polygon_stays_as_it_is():
    """Without an edge radius there is nothing to approximate."""
    part = Part(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
    np.testing.assert_array_equal(outline_polygon(part), part.core)


@pytest.mark.parametrize("yaw", [0.0, 0.3, 2.0, -1.2])
def test_rectangles_are_recognised_in_any_direction(yaw: float):
    """Centre, size and direction give the corners back."""
    core = Part.box((0.6, 0.2)).core @ rotation(yaw) + np.array([1.0, -2.0])
    found = rectangle_of(core)
    assert found is not None
    np.testing.assert_allclose(found.size, [0.6, 0.2])
    corners = Part.box(found.size).core @ rotation(found.yaw) + found.centre
    np.testing.assert_allclose(corners, core, atol=1e-11)


@pytest.mark.parametrize(
    "core",
    [
        [[0, 0], [1, 0], [0, 1]],
        [[0, 0], [2, 0], [1.5, 1], [0.5, 1]],
        [[0, 0], [1, 0], [1.5, 1], [0.5, 1]],
        [[0, 0], [1, 0], [1, 1], [0.5, 1.2], [0, 1]],
    ],
)
def test_other_polygons_are_no_rectangles(core: list[list[float]]):
    """Triangles, trapezoids, parallelograms and pentagons are none."""
    assert rectangle_of(np.array(core, dtype=float)) is None

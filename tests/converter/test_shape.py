import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from converter.shape import Part, denoised, rotation


def outline(part: Part) -> shapely.Geometry:
    """The inflated polygon, by shapely."""
    return shapely.convex_hull(shapely.MultiPoint(part.core)).buffer(max(part.edge_radius, 1e-12), quad_segs=64)


@given(st.from_type(Part), st.floats(0, 0.04))
def test_straight_edges_stay_when_corners_change(part: Part, edge_radius: float):
    """With another edge radius a part keeps its extent along the normal of each of its edges."""
    if len(part.core) < 3:
        assert part.with_edge_radius(edge_radius) is part
        return
    changed = part.with_edge_radius(edge_radius)
    assert changed.edge_radius == edge_radius
    edges = np.roll(part.core, -1, axis=0) - part.core
    outward = np.stack([edges[:, 1], -edges[:, 0]], axis=1) / np.hypot(*edges.T)[:, np.newaxis]
    before = (part.core @ outward.T).max(axis=0) + part.edge_radius
    after = (changed.core @ outward.T).max(axis=0) + edge_radius
    np.testing.assert_allclose(after, before, rtol=0, atol=1e-9)


@given(st.from_type(Part))
def test_sharper_corners_only_add(part: Part):
    """A part lies within the same part with sharp corners."""
    if len(part.core) >= 3:
        assert outline(part.with_edge_radius(0.0)).buffer(1e-9).covers(outline(part))


def test_a_box_keeps_its_size():
    """A rounded box with another radius is the box of the same size with that radius."""
    changed = Part.box((0.4, 0.2), 0.02).with_edge_radius(0.05)
    np.testing.assert_allclose(changed.core, Part.box((0.4, 0.2), 0.05).core, atol=1e-12)


@pytest.mark.parametrize("edge_radius", [0.1, 0.11, 5.0])
def test_a_part_cannot_be_rounder_than_thin(edge_radius: float):
    """Two edge radii must fit; an inset polygon never turns inside out."""
    with pytest.raises(ValueError, match="too thin"):
        Part.box((0.4, 0.2)).with_edge_radius(edge_radius)


@given(st.floats(-4, 4), st.floats(0.1, 0.9), st.floats(-9, 9))
def test_a_vertex_may_lie_on_a_straight_side(yaw: float, share: float, offset: float):
    """Turned, moved and rounded to picometres the polygon stays one, whichever way rounding bends the side."""
    core = np.array([[0.0, 0.0], [1.3 * share, 0.7 * share], [1.3, 0.7], [1.0, 1.0], [0.0, 1.0]])
    turned = Part(denoised(core @ rotation(yaw) + offset))
    assert outline(turned).area == pytest.approx(outline(Part(core)).area)
    rounded_corners = turned.with_edge_radius(0.01)
    assert len(rounded_corners.core) == 5
    bent = core.copy()
    bent[1, 1] += 1e-6
    with pytest.raises(ValueError, match="must be convex"):
        Part(bent @ rotation(yaw) + offset)


def test_denoised_numbers_are_decimals():
    """Sums of decimals become what they would be on paper, and zero has no sign."""
    assert denoised([0.1 + 0.2, -1e-17, 1 / 3]).tolist() == [0.3, 0.0, 0.333333333333]
    assert not np.signbit(denoised([-1e-17]))

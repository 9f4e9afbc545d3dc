import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from converter.drawing import Drawing, box, disc, extent, footprint
from converter.scene import Body
from converter.shape import Part


def test_unit_is_a_share_of_the_longer_side():
    """A picture of 6 m x 3 m has units of 1 cm."""
    assert Drawing(np.zeros(2), np.array([6.0, 3.0]), (1.0, 1.0, 1.0), ()).unit == pytest.approx(0.01)


def test_box_and_disc_have_their_extent():
    """The outer size of a box includes its rounded edges."""
    assert np.allclose(extent((box((1.0, 2.0), (0.4, 0.6), 0.1),)), [[0.8, 1.7], [1.2, 2.3]])
    assert np.allclose(extent((disc((1.0, 2.0), 0.5), disc((2.0, 2.0), 0.1))), [[0.5, 1.5], [2.1, 2.5]])


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(-4, 4))
def test_footprint_is_turned_then_moved(x: float, y: float, yaw: float):
    """A point of a part lands where turning it about the centre and moving the centre takes it."""
    body = Body("body", np.array([0.0, 0.0, 0.1]), 0.2, (Part(np.array([[0.3, 0.1]]), 0.05),), yaw)
    (part,) = footprint(body, np.array([x, y]))
    turned = complex(0.3, 0.1) * np.exp(1j * yaw) + complex(x, y)
    assert np.allclose(part.core, [[turned.real, turned.imag]])
    assert part.radius == 0.05


def test_footprint_without_position_is_where_the_body_is():
    """Every part of a body is there, at the body's own place."""
    body = Body("body", np.array([1.0, 2.0, 0.1]), 0.2, (Part.box((0.2, 0.2)), Part.box((0.4, 0.1))))
    assert np.allclose(extent(footprint(body)), [[0.8, 1.9], [1.2, 2.1]])

"""Smooth tractions: moments, and smooth fields that are read back."""

import numpy as np
import pytest

from railhead.theory.friction.smooth_tractions import SmoothTractions

COEFFICIENTS = np.array([[1.0, -2.0], [0.5, 3.0], [-1.5, 0.25]])


@pytest.fixture
def smooth() -> SmoothTractions:
    """An ellipse of 3 x 2 mm about (1, -2) mm, in cells of at most 0.05 mm."""
    return SmoothTractions((1.0, -2.0), (3.0, 2.0), 0.05)


def test_the_smooth_traction_has_the_moments_of_the_one_it_stands_for(smooth) -> None:
    """Three fields with known factors, and their moments on another grid."""
    own = np.einsum("ik,iab->kab", COEFFICIENTS, smooth.fields)
    assert smooth.coefficients(smooth.x, smooth.y, own) == pytest.approx(COEFFICIENTS)
    other = SmoothTractions(smooth.centre, smooth.half, 0.2)
    coarse = np.einsum("ik,iab->kab", COEFFICIENTS, other.fields)
    assert smooth.coefficients(other.x, other.y, coarse) == pytest.approx(COEFFICIENTS, rel=1e-3)


def test_a_cubic_field_is_read_as_it_is(smooth) -> None:
    known = np.arange(20.0).reshape(10, 2) - 7
    field = smooth.values(known, smooth.x, smooth.y)
    assert smooth.read(field, derivative=False) == pytest.approx(known)


def test_the_derivative_of_a_quadratic_field_is_read(smooth) -> None:
    """d/dx of 7 + 5 X + X Y/2 + X^2 is 5 + Y/2 + 2 X, with X = x - 1 = 3 u and Y = y + 2 = 2 v."""
    X, Y = np.meshgrid(smooth.x - 1, smooth.y + 2, indexing="ij")
    found = smooth.read(np.array([7 + 5 * X + X * Y / 2 + X**2, 0 * X]), derivative=True)
    assert found[:, 0] == pytest.approx([5.0, 6.0, 1.0, *[0.0] * 7], abs=0.01)
    assert found[:, 1] == pytest.approx(0.0)


def test_a_response_is_linear_in_the_moments(smooth) -> None:
    matrix = np.arange(120.0).reshape(20, 6)
    own = np.einsum("ik,iab->kab", COEFFICIENTS, smooth.fields)
    found = smooth.response(matrix, smooth.x, smooth.y)(own)
    known = (matrix @ COEFFICIENTS.ravel()).reshape(10, 2)
    assert found == pytest.approx(smooth.values(known, smooth.x, smooth.y))

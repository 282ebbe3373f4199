"""FASTSIM beside another FASTSIM and a limit, and of patches beside ellipses."""

import math

import numpy as np
import pytest
from friction_data import named

import railhead as rh
from railhead.half_spaces import shearing
from railhead.planning import simulation_plan as planning
from railhead.theory.friction.kalker import Coefficients, coefficients
from railhead.theory.friction.rolling import Creepage
from studies.mechanics import fastsim


@pytest.fixture(scope="module")
def linear() -> Coefficients:
    return coefficients(4.336 / 3.465, 0.3)


@pytest.mark.parametrize("entry", named("curve"))
def test_forces_are_those_of_another_fastsim(entry, linear: Coefficients) -> None:
    """Within 0.5 % of mu N. All patches have one axis ratio to 1e-4."""
    assert entry["a_mm"] / entry["b_mm"] == pytest.approx(4.336 / 3.465, rel=1e-3)
    limit, G = entry["mu"] * entry["load_N"], entry["E_MPa"] / 2 / (1 + entry["nu"])
    creepage = Creepage(entry["xi_x"], entry["xi_y"], entry["phi_per_mm"])
    found = fastsim.fastsim(entry["a_mm"], entry["b_mm"], limit, G, linear, creepage)
    assert (found.along / limit, found.across / limit) == pytest.approx(
        (entry["fastsim_Fx_over_muN"], entry["fastsim_Fy_over_muN"]), abs=5e-3
    )


def test_it_slips_from_the_trailing_edge_on(linear: Coefficients) -> None:
    """A traction that grows linearly passes the bound's parabola one length from the trailing edge,
    the same on all strips; to the size of a step, 2 %."""
    xi, limit, a, b, G = 5e-4, 7500.0, 4.336, 3.465, 79615.0
    slope = xi * 3 * G * linear.c11 / (8 * a)  # of the traction along a strip
    behind = slope * math.pi * a**3 * b / (2 * limit)  # x + half = slope / (bound's curvature)
    y = b * (np.arange(4000) + 0.5) / 4000
    half = a * np.sqrt(1 - (y / b) ** 2)
    exact = np.sum(np.maximum(2 * half - behind, 0)) / np.sum(2 * half)
    found = fastsim.fastsim(a, b, limit, G, linear, Creepage(along=xi))
    assert found.stick_share == pytest.approx(exact, abs=0.02)


def test_the_ellipse_of_an_ellipse_is_itself() -> None:
    plan = planning.make(rh.find("hertz_ellipse").replace(["friction.coefficient=0.3"]))
    motion, pair, exactly = (1e-4, 2e-4, 1e-4), plan.context.half_spaces, plan.hertz
    of, G = (
        coefficients(exactly.a / exactly.b, pair.materials.poisson),
        pair.materials.shear_modulus,
    )
    known = fastsim.linear_forces(of, exactly.a, exactly.b, G, Creepage(*motion))
    patch = shearing.patches(pair, exactly, 64)
    np.testing.assert_allclose(fastsim.linear(patch, pair, motion), known, rtol=5e-3)
    followed = fastsim.fastsim(exactly.a, exactly.b, 7500.0, G, of, Creepage(*motion))
    forces, stick = fastsim.of_patches(patch, 7500.0, pair, motion)
    np.testing.assert_allclose([*forces, stick], followed, rtol=5e-3)

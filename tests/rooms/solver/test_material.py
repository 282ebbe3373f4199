"""Radial return: the yield surface is kept, the tangent is the derivative, limits are known."""

import numpy as np
import pytest

from railhead.solver.material import ROOT, Hardening, History, deviator, radial_return

MU, COUNT = 79615.0, 60
CURVES = {
    "perfect": Hardening.linear(480.0),
    "isotropic": Hardening.linear(480.0, 5000.0),
    "kinematic": Hardening.linear(480.0, 5000.0, 1.0),
    "mixed": Hardening.linear(480.0, 5000.0, 0.4),
    "curve": Hardening((0.0, 0.002, 0.01, 0.05), (400.0, 520.0, 610.0, 700.0), 0.3),
}


@pytest.fixture(params=CURVES)
def curve(request) -> Hardening:
    return CURVES[request.param]


def strains(seed: int, size: float = 0.01) -> np.ndarray:
    return size * np.random.default_rng(seed).normal(size=(COUNT, 6))


def stress(strain: np.ndarray, before: History, curve: Hardening) -> np.ndarray:
    after, _ = radial_return(strain, np.full(COUNT, MU), before, curve)
    return 2 * MU * (deviator(strain) - after.plastic)


def history(curve: Hardening) -> History:
    """After one step in random directions."""
    return radial_return(strains(1), np.full(COUNT, MU), History.virgin(COUNT, 6), curve)[0]


def test_stresses_end_on_the_yield_surface(curve: Hardening) -> None:
    before = history(curve)
    after, loss = radial_return(strains(2), np.full(COUNT, MU), before, curve)
    found = 2 * MU * (deviator(strains(2)) - after.plastic) - after.back
    growth = curve.stress_and_slope(after.equivalent)[0] - curve.initial_yield_stress
    radius = ROOT * (curve.initial_yield_stress + (1 - curve.kinematic) * growth)
    size = np.linalg.norm(found, axis=1)
    assert len(loss.points) > COUNT / 2
    assert size[loss.points] == pytest.approx(radius[loss.points], rel=1e-10)
    assert np.all(size <= radius * (1 + 1e-10))
    assert np.abs(after.plastic[:, :3].sum(axis=1)).max() < 1e-15  # no change of volume
    steps = np.linalg.norm(after.plastic - before.plastic, axis=1)
    assert after.equivalent - before.equivalent == pytest.approx(ROOT * steps)


def test_the_tangent_is_the_derivative(curve: Hardening) -> None:
    before, at = history(curve), strains(3)
    step = strains(4, 1e-7)
    slope = (stress(at + step, before, curve) - stress(at - step, before, curve)) / 2
    _, loss = radial_return(at, np.full(COUNT, MU), before, curve)
    tangent = 2 * MU * deviator(step)
    tangent[loss.points] -= loss.stress(step[loss.points])
    assert np.abs(slope - tangent).max() < 1e-6 * np.abs(slope).max()


def test_tension_follows_the_curve_whatever_hardens(curve: Hardening) -> None:
    """Along one deviator the equivalent stress is the curve at the equivalent plastic strain."""
    direction = np.array([1.0, -0.5, -0.5, 0.0, 0.0, 0.0])
    before = History.virgin(1, 6)
    for strain in (0.004, 0.012, 0.03):
        before, _ = radial_return(strain * direction[None], np.full(1, MU), before, curve)
        found = 2 * MU * (strain * direction - before.plastic[0])
        assert found[0] * 1.5 == pytest.approx(curve.stress_and_slope(before.equivalent)[0][0])


def test_reversed_loading_yields_earlier_with_kinematic_hardening() -> None:
    """Bauschinger: between both yield stresses lies twice the first one, not twice the last."""
    direction = np.array([[1.0, -0.5, -0.5, 0.0, 0.0, 0.0]])
    for kinematic, width in ((0.0, 2 * 530.0), (1.0, 2 * 480.0)):
        curve = Hardening.linear(480.0, 5000.0, kinematic)
        loaded = History(0.01 * direction, kinematic * 50 / 1.5 * direction, np.array([0.01]))
        top = 530.0 / 1.5  # first component of the deviator at yield
        for share, yields in ((0.999, 0), (1.001, 1)):
            low = top - share * width / 1.5
            strain = loaded.plastic + low / (2 * MU) * direction
            assert len(radial_return(strain, np.full(1, MU), loaded, curve)[1].points) == yields


def test_a_steep_segment_between_flat_ones_is_met() -> None:
    """Newton's method swings between the flat segments of such a curve without end."""
    curve = Hardening((0.0, 0.002, 0.0021, 0.05), (400.0, 400.0, 900.0, 900.0))
    strain = np.zeros((40, 6))
    strain[:, 0], strain[:, 1] = np.linspace(0.001, 0.02, 40), -np.linspace(0.001, 0.02, 40)
    after, loss = radial_return(strain, np.full(40, MU), History.virgin(40, 6), curve)
    size = np.linalg.norm(2 * MU * (deviator(strain) - after.plastic), axis=1)
    radius = ROOT * curve.stress_and_slope(after.equivalent)[0]
    assert size[loss.points] == pytest.approx(radius[loss.points], rel=1e-10)
    assert np.any((after.equivalent > 0.002) & (after.equivalent < 0.0021))

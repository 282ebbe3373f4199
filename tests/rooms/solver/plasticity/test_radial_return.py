"""Radial return: the yield surface is kept, the tangent is the derivative, limits are known."""

import numpy as np
import pytest

from railhead.solver.material import Hardening, Material, backs
from railhead.solver.plasticity.radial_return import ROOT, History, deviator, radial_return

MU, COUNT = 79615.0, 60
CURVES = {
    "perfect": Hardening.linear(480.0),
    "isotropic": Hardening.linear(480.0, 5000.0),
    "kinematic": Hardening.linear(480.0, 5000.0, 1.0),
    "mixed": Hardening.linear(480.0, 5000.0, 0.4),
    "curve": Hardening((0.0, 0.002, 0.01, 0.05), (400.0, 520.0, 610.0, 700.0), 0.3),
}


PARTS = [(60000.0, 500.0), (10000.0, 40.0), (2000.0, 0.0)]
CYCLIC = {
    "recalled": Hardening.linear(250.0, 1000.0).cyclic(PARTS, 0.0, (60.0, 8.0)),
    "recalled beyond a size": Hardening.linear(250.0).cyclic(PARTS, 5.0, (60.0, 8.0)),
}


@pytest.fixture(params=CURVES)
def curve(request) -> Hardening:
    return CURVES[request.param]


@pytest.fixture(params=CURVES | CYCLIC)
def law(request) -> Hardening:
    return (CURVES | CYCLIC)[request.param]


def strains(seed: int, size: float = 0.01) -> np.ndarray:
    return size * np.random.default_rng(seed).normal(size=(COUNT, 6))


def stress(strain: np.ndarray, before: History, curve: Hardening) -> np.ndarray:
    after, _ = radial_return(strain, np.full(COUNT, MU), before, curve)
    return 2 * MU * (deviator(strain) - after.plastic)


def history(curve: Hardening) -> History:
    """After one step in random directions."""
    virgin = History.virgin(COUNT, 6, backs([Material(2.6 * MU, 0.3, curve)]))
    return radial_return(strains(1), np.full(COUNT, MU), virgin, curve)[0]


def test_stresses_end_on_the_yield_surface(law: Hardening) -> None:
    before = history(law)
    after, loss = radial_return(strains(2), np.full(COUNT, MU), before, law)
    found = 2 * MU * (deviator(strains(2)) - after.plastic) - after.back.sum(axis=1)
    first, (most, rate) = law.initial_yield_stress, law.isotropic
    growth = law.stress_and_slope(after.equivalent)[0] - first
    voce = most * (1 - np.exp(-rate * after.equivalent))
    radius = ROOT * (first + (1 - law.kinematic) * growth + voce)
    size = np.linalg.norm(found, axis=1)
    assert len(loss.points) > COUNT / 2
    assert size[loss.points] == pytest.approx(radius[loss.points], rel=1e-10)
    assert np.all(size <= radius * (1 + 1e-10))
    assert np.abs(after.plastic[:, :3].sum(axis=1)).max() < 1e-15  # no change of volume
    steps = np.linalg.norm(after.plastic - before.plastic, axis=1)
    assert after.equivalent - before.equivalent == pytest.approx(ROOT * steps)


@pytest.mark.parametrize("ahead", [0.0, 0.3])
def test_the_tangent_is_the_derivative(law: Hardening, ahead: float) -> None:
    """Also where plastic strain has run ahead of the back stresses."""
    earlier, at = history(law), strains(3)
    now = radial_return(strains(2), np.full(COUNT, MU), earlier, law)[0]
    before = now.extrapolated(earlier, ahead, np.arange(0, COUNT, 2))
    step = strains(4, 1e-7)
    slope = (stress(at + step, before, law) - stress(at - step, before, law)) / 2
    _, loss = radial_return(at, np.full(COUNT, MU), before, law)
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


def test_tension_follows_the_exact_recall_in_one_step() -> None:
    """s = sy + H p + Q (1 - exp(-b p)) + sum C/g (1 - exp(-g p)), of the part without g C p."""
    law = CYCLIC["recalled"]
    strain = 0.03 * np.array([[1.0, -0.5, -0.5, 0.0, 0.0, 0.0]])
    after, _ = radial_return(strain, np.full(1, MU), History.virgin(1, 6, 3), law)
    p = after.equivalent[0]
    exact = 250 + 1000 * p + 60 * (1 - np.exp(-8 * p)) + 2000 * p
    exact += 120 * (1 - np.exp(-500 * p)) + 250 * (1 - np.exp(-40 * p))
    found = 1.5 * 2 * MU * (strain[0, 0] - after.plastic[0, 0])
    assert p > 0.02 and found == pytest.approx(exact, rel=1e-10)


def test_a_recall_exponent_is_of_second_order_and_ends_at_the_limit() -> None:
    """Half the steps have a quarter of the error; a step of any size ends near C/g."""
    law = Hardening.linear(200.0).cyclic([(50000.0, 200.0)], 5.0)
    direction = np.array([[1.0, -0.5, -0.5, 0.0, 0.0, 0.0]])

    def pulled(steps: int, most: float) -> float:
        """Size of the back stress over C/g after tension in steps."""
        now = History.virgin(1, 6)
        for strain in np.linspace(0, most, steps + 1)[1:]:
            now = radial_return(strain * direction, np.full(1, MU), now, law)[0]
        return float(1.5 * now.back[0, 0, 0] * 200 / 50000)

    sizes = [pulled(steps, 0.006) for steps in (16, 32, 64)]
    assert 0.7 < sizes[-1] < 0.95
    assert (sizes[0] - sizes[1]) / (sizes[1] - sizes[2]) == pytest.approx(4, rel=0.2)
    assert pulled(1, 1.0) == pytest.approx(1, abs=0.01) and pulled(64, 1.0) == pytest.approx(1)


@pytest.mark.parametrize(
    "given, error",
    [
        (([(0.0, 1.0)],), "backstress has"),
        (([(1.0,)],), "backstress has"),
        (([(1.0, -1.0)],), "backstress has"),
        (([], 0.5), "recall_exponent is 0.5; give 0, or 1 to"),
        (([], 0.0, (-1.0, 0.0)), "isotropic has"),
    ],
)
def test_constants_that_are_no_steel_are_refused(given, error: str) -> None:
    with pytest.raises(ValueError, match=error):
        Hardening.linear(400.0).cyclic(*given)


def test_reversed_loading_yields_earlier_with_kinematic_hardening() -> None:
    """Bauschinger: between both yield stresses lies twice the first one, not twice the last."""
    direction = np.array([[1.0, -0.5, -0.5, 0.0, 0.0, 0.0]])
    for kinematic, width in ((0.0, 2 * 530.0), (1.0, 2 * 480.0)):
        curve = Hardening.linear(480.0, 5000.0, kinematic)
        loaded = History.virgin(1, 6)
        loaded.plastic[:], loaded.equivalent[:] = 0.01 * direction, 0.01
        loaded.back[:] = kinematic * 50 / 1.5 * direction
        top = 530.0 / 1.5  # first component of the deviator at yield
        for share, yields in ((0.999, 0), (1.001, 1)):
            strain = loaded.plastic + (top - share * width / 1.5) / (2 * MU) * direction
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


def test_constant_tension_and_torsion_to_and_fro_is_the_closed_form() -> None:
    """de/dp = (s - X)/sy and dX/dp = C (s - X)/sy - g X, which have no step of their own: the
    axial strain over the accumulated strain after 4 cycles of shear +-0.02. Strains xx, yy, zz
    follow from stresses s, 0, 0 by Newton's method with the consistent tangent."""
    s, sy, c, g, lam = 100.0, 400.0, 4e4, 100.0, 1.5 * MU
    law = Hardening.linear(sy).cyclic([(c, g)])
    elastic = 2 * MU * np.eye(4) + lam * np.outer([1, 1, 1, 0], [1, 1, 1, 0])
    ends = np.concatenate([[0.0], np.tile([0.02, -0.02], 4)])
    cycles = [np.linspace(a, b, 61)[1:] for a, b in zip(ends, ends[1:], strict=False)]
    strain, now = np.zeros((1, 4)), History.virgin(1, 4)
    for strain[0, 3] in np.concatenate([[0.0], *cycles]) / np.sqrt(2):
        for _ in range(30):
            after, loss = radial_return(strain, np.full(1, MU), now, law)
            wrong = [s, 0.0, 0.0] - (strain @ elastic - 2 * MU * after.plastic)[0, :3]
            if np.abs(wrong).max() < 1e-6:
                break
            tangent = elastic - loss.matrix.sum(axis=0)
            strain[0, :3] += np.linalg.solve(tangent[:3, :3], wrong)
        assert np.abs(wrong).max() < 1e-6
        now = after
    p, rate, limit = now.equivalent[0], (c + g * sy) / sy, c * s / (c + g * sy)
    exact = (s - limit) / sy * p + limit / sy * (1 - np.exp(-rate * p)) / rate
    assert now.plastic[0, 0] == pytest.approx(exact, rel=2e-3)

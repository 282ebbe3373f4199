"""Wear of a cylinder on a crown in full slip: closed forms, and steps of any length."""

from dataclasses import dataclass

import numpy as np
import pytest
from pressing import flat

from railhead.theory import wear
from railhead.theory.bem import pressure_solver
from railhead.theory.bem.grid_patch import PatchSolution
from railhead.theory.elastic import hertz

RADIUS, CROWN, LOAD, SLIP, RATE = 460.0, 300.0, 80e3, 0.3 * 0.01, 6.75e-7
MODULUS = hertz.contact_modulus(207e3, 0.3, 207e3, 0.3)
PASSES = 0.3565 / (RATE * SLIP * LOAD)
PLACES = np.linspace(-20.0, 20.0, 4001)
STEP = PLACES[1] - PLACES[0]
SPLINES = wear.Splines(PLACES.size, 80)


def hats(s: np.ndarray) -> np.ndarray:
    """Weights (n, m) of straight lines through values at s (m,) at PLACES."""
    return np.maximum(1 - np.abs(PLACES[:, None] - s) / (s[1] - s[0]), 0.0)


def largest(patch: PatchSolution, part: float = 0.1) -> float:
    """Largest pressure, averaged across over a part of the half width."""
    step = patch.s[1] - patch.s[0]
    return wear.averaged(patch.pressure.max(axis=0), step, part * patch.half_extents[1]).max()


@dataclass
class Crown:
    """A crown that wears under a cylinder which slips everywhere; `cells` each way."""

    cells: int = 64

    def press(self, depth: np.ndarray, passes: float = 0.0) -> PatchSolution:
        """The contact after some more passes, of a crown worn by a depth at PLACES."""
        found = pressure_solver.solve_developed(
            lambda x, s: x**2 / (2 * RADIUS) + s**2 / (2 * CROWN) + np.interp(s, PLACES, depth),
            MODULUS,
            [((0.0, 0.0), (9.0, 11.0))],
            flat,
            load=LOAD,
            cells=self.cells,
            tolerance=1e-7,
            lines=lambda s: RATE * SLIP * passes * STEP / (s[1] - s[0]) * SPLINES.between(hats(s)),
        )
        return found.windows[0]

    def advance(self, depth, share):
        """As of `wear.Advance`."""
        passes = share * PASSES
        patch = self.press(depth, passes)
        force = (patch.x[1] - patch.x[0]) * patch.pressure.sum(axis=0)
        return depth + (RATE * SLIP * passes * SPLINES.projected(hats(patch.s) @ force)), share

    def worn(self, count: int) -> tuple[np.ndarray, float]:
        """Depth at PLACES and largest pressure after the whole wear in equal steps."""
        start = wear.Stage(0.0, np.zeros_like(PLACES), 0.0, 1.0)
        *_, last = wear.march(self.advance, start, [(n + 1) / count for n in range(count)])
        patch = self.press(last.depth)
        return last.depth, largest(patch)


def test_one_passage_in_full_slip_takes_the_chords_of_hertz():
    ellipse = hertz.point_contact(1 / RADIUS, 1 / CROWN, MODULUS, LOAD)
    crown = Crown(cells=128)
    passes = 1e-6 * PASSES
    depth, _ = crown.advance(np.zeros_like(PLACES), 1e-6)
    peak = RATE * passes * SLIP * ellipse.p0 * np.pi / 2 * ellipse.a
    known = peak * np.maximum(1 - (PLACES / ellipse.b) ** 2, 0.0)
    inside = np.abs(PLACES) < ellipse.b - 1.0  # splines round the kink at its end
    assert np.abs(depth - known)[inside].max() < 3e-3 * peak
    assert np.abs(depth - known).max() < 0.02 * peak
    assert STEP * depth.sum() == pytest.approx(RATE * passes * SLIP * LOAD, rel=1e-3)


def test_worn_crown_has_the_pressure_and_depth_of_the_prototype_at_first_order():
    few, more = Crown().worn(6), Crown().worn(12)
    limits = [
        2 * late - early
        for early, late in zip((few[1], few[0].max()), (more[1], more[0].max()), strict=True)
    ]
    assert limits == pytest.approx([840.0, 0.0416], rel=3e-3)
    assert 0 < few[1] - more[1] < 0.015 * 840 and 0 < more[0].max() - few[0].max() < 6e-4
    half = np.flatnonzero(more[0] > 5e-4)[[0, -1]]
    assert np.ptp(PLACES[half]) == pytest.approx(13.5, abs=0.3)
    assert STEP * more[0].sum() == pytest.approx(RATE * SLIP * LOAD * PASSES, rel=5e-4)


@pytest.mark.parametrize("cells", [48, 96])
def test_much_wear_has_its_pressure_on_any_grid_though_its_groove_ends_in_a_corner(cells):
    """0.15 mm deep and 600 MPa by a solution on lines that stay in place."""
    crown, depth = Crown(cells=cells), np.zeros_like(PLACES)
    for _ in range(12):
        depth, _ = crown.advance(depth, 2.0 / 0.3565 / 12)
    patch = crown.press(depth)
    assert depth.max() == pytest.approx(0.15, rel=4e-3)
    assert largest(patch) == pytest.approx(600, rel=0.01)


def test_chosen_steps_reach_the_change_that_is_asked_and_go_on_from_any_of_them():
    """The rate of a depth 1 - exp(-4 t) falls; backward Euler is of first order."""

    def advance(depth, share):
        after = (depth + 4 * share) / (1 + 4 * share)
        return after, float((1 - depth[0]) / (1 - after[0]) - 1)

    start = wear.Stage(0.0, np.zeros(1), 0.0, wear.FIRST)
    whole = list(wear.march_freely(advance, start, 0.3))
    again = list(wear.march_freely(advance, whole[1], 0.3))
    assert whole[-1].done == 1.0 and len(again) == len(whole) - 2
    assert np.array_equal(again[-1].depth, whole[-1].depth)
    assert max(stage.change for stage in whole) <= 0.6 and 8 < len(whole) < 30
    *_, same = wear.march(advance, start, [stage.done for stage in whole])
    assert same.depth == pytest.approx(whole[-1].depth)


def test_splines_keep_area_and_parabolas_and_their_matrix_is_symmetric():
    parabola = 1 + PLACES - PLACES**2
    assert np.abs(SPLINES.projected(parabola) - parabola).max() < 1e-8
    bump = np.where(np.abs(PLACES) < 3.3, 1.0, 0.0)
    assert SPLINES.projected(bump).sum() == pytest.approx(bump.sum(), rel=1e-9)
    weights = hats(np.linspace(-8, 8, 60))
    matrix = SPLINES.between(weights)
    assert np.abs(matrix - matrix.T).max() < 1e-9 * matrix.max()
    assert matrix == pytest.approx(weights.T @ SPLINES.projected(weights))
    assert np.linalg.eigvalsh(matrix).min() > -1e-9 * matrix.max()


def test_averages_keep_a_parabola_but_for_its_curvature_and_the_area_of_a_spike():
    """Weights that fall to zero at a width w have the variance w^2/6."""
    s = np.arange(-10, 10, 0.1)
    middle = wear.averaged(100 - s**2, 0.1, 2.0)[np.abs(s) < 5]
    assert middle == pytest.approx((100 - s**2)[np.abs(s) < 5] - 4 / 6, abs=0.01)
    spike = np.where(np.arange(s.size) == 100, 80.0, 0.0)
    found = wear.averaged(spike, 0.1, 2.0)
    assert found.sum() == pytest.approx(80.0) and found.max() == pytest.approx(4.0, rel=0.02)


def test_steps_that_cannot_follow_the_rate_stop_the_march():
    """A rate that doubles in every step, however short."""
    start = wear.Stage(0.0, np.zeros(1), 0.0, wear.FIRST)
    stages = wear.march_freely(lambda depth, share: (depth + share, 2.0), start, 0.1)
    with pytest.raises(ValueError, match=r"changes by 200% in a step of 0\.\d%"):
        list(stages)


def test_laws_have_the_rates_of_their_sources():
    usfd, energy = wear.WearLaw(wear.USFD), wear.WearLaw.of_energy(6.75e-7)
    assert usfd.rate(0.0) == pytest.approx(6.75e-7, rel=1e-3) == usfd.rate(10.0)
    assert energy.rate(0.3) == energy.rate(300.0) == pytest.approx(6.75e-7)
    for density, mass in ((10.4, 55.0), (40.0, 55.0), (77.2, 55.0), (100.0, 55 + 61.9 * 22.8)):
        assert usfd.rate(density) * density == pytest.approx(wear.VOLUME * mass, rel=1e-9)


def test_damage_is_that_of_the_law_between_its_limits():
    found = [wear.damage(force) for force in (0.0, 15.0, 40.0, 65.0, 120.0, 175.0, 500.0)]
    assert found == pytest.approx([0.0, 0.0, 5e-6, 1e-5, 5e-6, 0.0, 0.0])

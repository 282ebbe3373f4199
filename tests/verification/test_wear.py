"""Wear of a cylinder on a crown in full slip: closed forms, and steps of any length."""

from dataclasses import dataclass

import numpy as np
import pytest
from pressing import flat

from railhead.theory import wear
from railhead.theory.bem import pressure_solver
from railhead.theory.bem.grid_patch import PatchSolution
from railhead.theory.elastic import hertz
from railhead.theory.wear import Stage, WearLaw

RADIUS, CROWN, LOAD, SLIP, RATE = 460.0, 300.0, 80e3, 0.3 * 0.01, 6.75e-7
MODULUS = hertz.contact_modulus(207e3, 0.3, 207e3, 0.3)
PASSES = 0.3565 / (RATE * SLIP * LOAD)
PLACES = np.linspace(-20.0, 20.0, 4001)


def opening(patch: PatchSolution, lines) -> np.ndarray:
    """Opening of each line, mm, by the force per width of a pressed patch."""
    return lines(patch.s) * (patch.x[1] - patch.x[0]) * patch.pressure.sum(axis=0)


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
            lines=self.lines(passes),
        )
        return found.windows[0]

    def lines(self, passes: float):
        """Compliance of the lines."""
        return lambda s: np.full(s.shape, RATE * SLIP * passes)

    def advance(self, depth, shares):
        """As of `wear.Advance`."""
        after = []
        for share in shares:
            patch = self.press(depth, share * PASSES)
            worn = opening(patch, self.lines(share * PASSES))
            after.append(depth + wear.onto(PLACES, patch.s, worn))
        return after

    def worn(self, count: int) -> tuple[np.ndarray, float]:
        """Depth at PLACES and largest pressure after the whole wear in equal steps."""
        start = Stage(0.0, np.zeros_like(PLACES), 0.0, 1.0)
        ends = [(n + 1) / count for n in range(count)]
        *_, last = wear.march(self.advance, start, ends)
        return last.depth, self.press(last.depth).max_pressure


def test_one_passage_in_full_slip_takes_the_chords_of_hertz():
    ellipse = hertz.point_contact(1 / RADIUS, 1 / CROWN, MODULUS, LOAD)
    crown = Crown(cells=128)
    passes = 1e-6 * PASSES
    (depth,) = crown.advance(np.zeros_like(PLACES), [1e-6])
    peak = RATE * passes * SLIP * ellipse.p0 * np.pi / 2 * ellipse.a
    known = peak * np.maximum(1 - (PLACES / ellipse.b) ** 2, 0.0)
    assert np.abs(depth - known).max() < 3e-3 * peak
    area = (PLACES[1] - PLACES[0]) * depth.sum()
    assert area == pytest.approx(RATE * passes * SLIP * LOAD, rel=1e-3)


def test_worn_crown_has_the_pressure_and_depth_of_the_prototype_at_any_step():
    few, more = Crown().worn(3), Crown().worn(12)
    assert more[1] == pytest.approx(840, abs=4)
    assert more[0].max() == pytest.approx(0.0416, abs=3e-4)
    # First order at the ends of the patch: three steps are off by no more than twelve change.
    assert 0 < few[1] - more[1] < 4
    assert 0 < more[0].max() - few[0].max() < 2e-4
    half = np.flatnonzero(more[0] > 1e-6)[[0, -1]]
    assert np.ptp(PLACES[half]) == pytest.approx(13.5, abs=0.3)
    area = (PLACES[1] - PLACES[0]) * more[0].sum()
    assert area == pytest.approx(RATE * SLIP * LOAD * PASSES, rel=5e-4)


def test_chosen_steps_reach_the_accuracy_and_go_on_from_any_of_them():
    crown = Crown(cells=48)
    start = Stage(0.0, np.zeros_like(PLACES), 0.0, wear.FIRST)
    whole = list(wear.march_freely(crown.advance, start, 0.02))
    again = list(wear.march_freely(crown.advance, whole[1], 0.02))
    assert whole[-1].done == 1.0 and len(again) == len(whole) - 2
    assert np.array_equal(again[-1].depth, whole[-1].depth)
    fine, _ = crown.worn(4 * len(whole))
    assert np.abs(whole[-1].depth - fine).max() < 0.02 * fine.max()
    loose = list(wear.march_freely(crown.advance, start, 0.2))
    assert len(loose) < len(whole)


def test_laws_have_the_rates_of_their_sources():
    usfd, energy = WearLaw(wear.USFD), WearLaw.of_energy(6.75e-7)
    assert usfd.rate(0.0) == pytest.approx(6.75e-7, rel=1e-3) == usfd.rate(10.0)
    assert energy.rate(0.3) == energy.rate(300.0) == pytest.approx(6.75e-7)
    for density, mass in ((10.4, 55.0), (40.0, 55.0), (77.2, 55.0), (100.0, 55 + 61.9 * 22.8)):
        assert usfd.rate(density) * density == pytest.approx(wear.VOLUME * mass, rel=1e-9)


def test_damage_is_that_of_the_law_between_its_limits():
    found = [wear.damage(force) for force in (0.0, 15.0, 40.0, 65.0, 120.0, 175.0, 500.0)]
    assert found == pytest.approx([0.0, 0.0, 5e-6, 1e-5, 5e-6, 0.0, 0.0])

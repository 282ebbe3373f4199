"""Passes of shipped scenes on real profiles, with and without friction."""

from types import SimpleNamespace

import numpy as np
import pytest
from solved import planned, scene_of

import railhead as rh
from railhead.contact import solid
from railhead.half_spaces import pass_contact
from railhead.half_spaces.surface import develop
from railhead.postprocess.pass_rows import Passes, RailState
from railhead.results import pipeline
from railhead.run import passes_of_scene
from railhead.theory.elastic import hertz

FAST = ("effects.finite_bodies=off", "wheel.steel=none", "mesh.patch_size=4", "rolling.passes=1")


def groove(y: np.ndarray, up: np.ndarray) -> RailState:
    """A section whose surface has moved up (n,) at y (n,), mm."""
    zero = np.zeros((1, 1))
    return RailState(y=y[:1], depth=y[:1], stress=zero[..., None], strain=zero, across=y, up=up)


@pytest.mark.parametrize("inclination", [0.0, 0.05])
@pytest.mark.parametrize("profile", ["54E1", "60E1"])
def test_the_profile_with_its_groove_is_read_as_it_was_laid(profile, inclination, tmp_path):
    """A groove of 20 um, 5 mm beside the crown, comes back within 1 um, and nothing elsewhere."""
    keys = [f"rail.profile={profile}", f"rail.inclination={inclination}", "rail.extent=head"]
    scene = rh.find("uic54_22t5_axle").replace(keys)
    surface = develop(solid.locate(scene))
    centre = float(np.interp(5.0, surface.y, surface.s))
    laid = passes_of_scene.groove_on_profile(surface, [centre], inclination)
    across = np.linspace(-60.0, 60.0, 121)
    shape = -0.02 * np.exp(-((across / 4) ** 2))
    np.savetxt(
        tmp_path / "rail.csv",
        laid([groove(across, shape)]),
        "%.6f",
        ",",
        header="y [mm],z [mm]",
        comments="",
    )
    worn = solid.rail_profile(scene.replace([f"rail.profile={tmp_path / 'rail.csv'}"]))
    y = np.linspace(-30.0, 30.0, 400)
    new = solid.rail_profile(scene)
    normal = np.cos(np.arctan(new.slope(y)))
    expected = np.interp(np.interp(y, surface.y, surface.s) - centre, across, shape)
    assert (worn.height(y) - new.height(y)) * normal == pytest.approx(expected, abs=1e-3)


LINE = "rail.extent=half-space rail.yield_stress=300 friction.coefficient=0.4 load=110kN"
ROLLS = "rolling.passes=4 rolling.creepage_along=0.02 effects.finite_bodies=off"


@pytest.mark.parametrize(
    ("keys", "limit"),
    [
        ("", 2.316),  # Johnson, Contact Mechanics, 9.2, at Q/P 0.4
        ("rail.hardening_modulus=5000 rail.kinematic_fraction=1", 2.40),
        ("rail.hardening_modulus=5000", None),  # isotropic: it shakes down in the end
    ],
)
def test_beyond_melan_s_limit_a_line_does_not_shake_down(keys, limit):
    """A verdict of a mesh that is too coarse at the surface is undecided."""
    context = planned("long_roller", *f"{LINE} {ROLLS} {keys}".split()).context
    rail = context.scene.rail
    for share in (0.99, 1.02, 1.04, 1.2):
        rows = [{"pressure_max_MPa": share * (limit or 2.316) * 300 / 3**0.5}]
        said = Passes(rows=rows, verdict="shakes down", words="as it was")
        found = passes_of_scene.within_melan_s_limit(said, context, rail)
        kept = limit is None or share < 1.03
        assert found.verdict == ("shakes down" if kept else "undecided")
        assert ("Melan" in found.words) != kept
        ratchets = Passes(rows=rows, verdict="ratchets")
        assert passes_of_scene.within_melan_s_limit(ratchets, context, rail) is ratchets


@pytest.mark.slow
def test_a_real_pair_rolls_with_and_without_friction():
    """Two elements on a half length, answered by half-spaces."""
    free = pipeline.run(scene_of("uic54_22t5_axle", *FAST))
    rubs = pipeline.run(
        scene_of("uic54_22t5_axle", *FAST, "friction.coefficient=0.3", "rolling.force_along=10kN")
    )
    for result in (free, rubs):
        checks = result.summary["checks"]
        assert checks["passes_energy"] < 0.03 and checks["passes_converged"] == 0
        assert checks["effects_left_out"] == 0
    first, other = (each.summary["result"]["passes"][0] for each in (free, rubs))
    assert first["strain_increment_max"] == pytest.approx(0.0068, rel=0.2)
    assert first["groove_mm"] == pytest.approx(0.016, rel=0.15)
    assert np.ptp(free.solved.passes.profile[:, 0]) > 60
    assert "no tractions act" in free.summary["result"]["passes_words"]
    assert "one way: yield does not change them" in rubs.summary["result"]["passes_words"]
    assert first["traction_work_N"] == 0 < other["traction_work_N"]
    assert other["forward_mm"] > 1.1 * first["forward_mm"]  # dragged along


CONTACT = pass_contact.ellipse_contact(hertz.point_contact(0.01, 0.02, 1e5, 1e3), keeps=True)
PLAIN = CONTACT.patches[0]


def tractions(x: np.ndarray, s: np.ndarray, found: np.ndarray, *, half: bool) -> np.ndarray:
    """Tractions (2, nx, ns) on the grid of PLAIN of those found (n, 2) at x, s (n,)."""
    solved = SimpleNamespace(plan=SimpleNamespace(half_y=half))
    bound = 0.3 * PLAIN.pressure
    made = passes_of_scene._with_tractions(solved, CONTACT, [bound], x, s, found)
    return made.patches[0].traction


def test_tractions_do_not_depend_on_the_order_of_points():
    """On a grid, whose squares have two triangulations, and as far off as on two ranks."""
    rng = np.random.default_rng(1)
    ticks = 1.3 * np.linspace(PLAIN.grid.x[0], PLAIN.grid.x[-1], 31)
    x, s = (each.ravel() for each in np.meshgrid(ticks, ticks))
    found = 50 * np.column_stack([np.cos(9 * x * s), np.sin(9 * x * s)])
    mixed = rng.permutation(len(x))
    noise = rng.uniform(-1e-9, 1e-9, (2, len(x)))
    one = tractions(x, s, found, half=False)
    other = tractions((x + noise[0])[mixed], (s + noise[1])[mixed], found[mixed], half=False)
    assert other == pytest.approx(one, abs=1e-4)


def test_tractions_found_on_half_of_a_patch_are_mirrored_and_bounded():
    """Those along are even, those across odd, and none is above friction times pressure."""
    places = np.meshgrid(PLAIN.grid.x, PLAIN.grid.s[PLAIN.grid.s > 0], indexing="ij")
    x, s = (each.ravel() for each in places)
    found = np.column_stack([np.full(len(x), 50.0), 20 * s / s.max()])
    along, across = tractions(x, s, found, half=True)
    assert along == pytest.approx(along[:, ::-1]) and across == pytest.approx(-across[:, ::-1])
    size, bound = np.hypot(along, across), 0.3 * PLAIN.pressure
    assert (size <= bound * (1 + 1e-9)).all() and across.max() > 5
    free = bound > 55
    assert free.any() and along[free] == pytest.approx(50.0)

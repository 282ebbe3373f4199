"""Friction of solids: half-spaces, and what finite bodies add."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI
from one_line import refusal

import railhead as rh
from railhead.planning import simulation_plan as planning
from railhead.run import mesh_solution, solid_friction
from railhead.run.solid_friction import SolidFriction, shared_patches
from railhead.solver.system.contact_system import LoadCase
from railhead.solver.system.fields import gather
from railhead.theory.friction.rolling import Creepage, HalfSpaceFriction
from railhead.theory.friction.tangential import TractionInfluence

MU = 0.3


def sampled(case: str, *keys: str) -> tuple[SolidFriction, LoadCase]:
    """Friction of a coarse model of a case, sampled, with its load case."""
    scene = rh.find(case).replace([f"friction.coefficient={MU}", *keys])
    plan = planning.make(scene)
    model = mesh_solution.assemble(plan, mesh_solution.generate(plan, plan.grading, MPI.COMM_WORLD))
    load = LoadCase(load=scene.load, active=plan.forecast.touching(model.interface.points))
    pressed = model.press(load)
    half_space = plan.contact.half_space
    patches = shared_patches(model, gather(model, pressed), parabolic=half_space)
    said: list[str] = []
    friction = SolidFriction(model, pressed, patches, said.append, parabolic=half_space)
    assert friction.unsuited() == ""
    friction.sample()
    assert said[-1] == f"friction: response of the bodies, {len(said)} of {len(said)}"
    return friction, load


@pytest.fixture(scope="module")
def half_spaces() -> SolidFriction:
    """R 420 x 300, 25 kN, on two elements a semi-axis; a whole model that rolls."""
    keys = ("rolling.creepage_across=0.1%", "mesh.patch_size=1.5")
    return sampled("hertz_ellipse", *keys)[0]


@pytest.mark.parametrize("motion", [Creepage(0.0, 1e-3), Creepage(5e-4, -5e-4, 1e-4)])
def test_like_half_spaces_roll_as_under_hertz_s_pressure(half_spaces, motion) -> None:
    """Boundary elements under the exact pressure; condensation was 0.03 of mu N off here."""
    plan = rh.plan(rh.find("hertz_ellipse"), quiet=True).plan
    ellipse, t = plan.hertz, (np.arange(64) + 0.5) / 32 - 1
    x, y = ellipse.a * t, ellipse.b * t
    pressure = ellipse.pressure(x[:, None], y)
    other = HalfSpaceFriction(x, y, pressure, MU, half_spaces.pair, rolling=True).solve(motion)
    (found,) = half_spaces.tractions(motion)
    assert np.abs(np.subtract(found.forces, other.forces)[:2] / other.limit).max() < 0.003
    assert np.divide(*found.areas) == pytest.approx(np.divide(*other.areas), abs=0.01)


def test_what_finite_bodies_add_is_what_tractions_do_to_them() -> None:
    """A rail head and a wheel segment that are shifted across: the jump of the pressed bodies under
    the tractions themselves, less that of half-spaces, beside what smooth tractions predict. Across
    it is a third of the half-spaces' own. The rest is error of the mesh."""
    keys = ("friction.force_across=3kN", "effects.plasticity=off", "mesh.patch_size=2")
    friction, load = sampled("uic54_thesis", *keys)
    (found,) = friction.tractions(Creepage(), (None, 3e3))
    (grid,) = friction.patches
    before = friction.pressed.displacement
    after = friction.press_again(load, [found]).displacement
    smooth = grid.smooth
    own = grid.points.jumps(after - before).T.reshape(2, *grid.pressed.shape)
    influence = TractionInfluence(grid.x, grid.y, friction.pair, rolling=False)(found.traction)
    added = -smooth.response(friction._added[0, 0, 0], grid.x, grid.y)(found.traction)
    inside = found.bound > 0
    measured, predicted = ((own + influence)[1, inside].mean(), added[1, inside].mean())
    assert abs(predicted) > 0.2 * influence[1, inside].mean()
    assert measured == pytest.approx(predicted, rel=0.05)


def test_t_gamma_is_the_energy_of_the_slip_of_bodies_that_pressing_strains() -> None:
    """A rail head and a wheel segment: traction times slip on three grids, extrapolated, beside
    T-gamma; force times creepage is a tenth less. The reading errs by a third of the strain."""
    scene = rh.find("uic54_thesis").replace([
        "friction.coefficient=0.03", "rolling.creepage_along=0.01%", "effects.plasticity=off",
        "mesh.patch_size=2",
    ])  # fmt: skip
    result = rh.solve(scene, quiet=True)
    fine = result.mesh_solution.solution.friction
    energy = [
        each.weights @ (each.traction * each.slip).sum(axis=1) for each in (fine, fine.coarse)
    ]
    t_gamma, force = result.friction.t_gamma, result.friction.force_along
    assert t_gamma == pytest.approx(2 * energy[0] - energy[1], rel=0.01)
    assert abs(t_gamma / (force * 1e-4) - 1) > 0.05
    assert result.friction.resolution.force_along < 0.3 * abs(
        result.friction.without_creepage.force_along
    )


def test_a_patch_that_smooth_tractions_do_not_suit_is_said_to_be_so(half_spaces) -> None:
    def unsuited(*changes: dict) -> str:
        friction = half_spaces
        (patch,) = (each.patch for each in friction.patches)
        patches = [replace(patch, **each) for each in changes]
        return SolidFriction(friction.model, friction.pressed, patches, friction.stage).unsuited()

    assert unsuited({"half": (25.0, 3.4)}).startswith("a surface that ends")
    assert unsuited({}, {"centre": (5.0, 0.0)}).startswith("two patches")


def test_too_many_unknowns_for_condensation_are_one_line(monkeypatch) -> None:
    monkeypatch.setattr(solid_friction, "LARGEST_CONDENSED", 1000)
    keys = [f"friction.coefficient={MU}", "rolling.creepage_along=0.1%", "mesh.patch_size=2.6"]
    scene = rh.find("hertz_ellipse").replace([*keys, "wheel.young_modulus=inf"])
    assert "unlike materials, at most 1000" in refusal(lambda: rh.solve(scene, quiet=True))

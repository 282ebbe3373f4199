"""The answer of a pressed contact to tangential tractions."""

import numpy as np
import pytest
from mpi4py import MPI

from railhead.planning import simulation_plan as planning
from railhead.run import mesh_solution
from railhead.scene import catalogue
from railhead.solver.algebra.coulomb import ContactCompliance
from railhead.solver.system.condensation import StaticCondensation
from railhead.solver.system.contact_system import LoadCase


def condensed(case: str, *keys: str) -> ContactCompliance:
    keys = ("friction.coefficient=0.3", "friction.force_along=6000", *keys)
    plan = planning.make(catalogue.find(case).replace(list(keys)))
    model = mesh_solution.assemble(plan, mesh_solution.generate(plan, plan.grading, MPI.COMM_WORLD))
    settings, response = model.setup.friction, model.response()
    touching = plan.forecast.touching(model.setup.kinematics.lift(model.interface.points))
    pressed = response.press(LoadCase(load=plan.scene.load or 0.0, active=touching))
    return StaticCondensation(model, response, settings, pressed).condense(pressed)


@pytest.mark.parametrize("rigid", [(), ("wheel.young_modulus=inf",)])
def test_movements_are_reciprocal(rigid: tuple[str, ...]) -> None:
    """Betti: what the tractions of one node work on the movement by those of another is what these
    work on the movement by the first, and tractions work on their own movement."""
    contact = condensed("long_roller", "mesh.patch_size=0.5", *rigid)
    weights = np.repeat(contact.area, contact.tangents.shape[1])
    work = -contact.shape_functions.T @ (weights[:, None] * contact.displacement_compliance)
    np.testing.assert_allclose(work, work.T, rtol=0, atol=1e-12 * np.abs(work).max())
    assert np.linalg.eigvalsh(work).min() > 0


def test_a_penalty_s_trial_tractions_are_those_of_the_movement() -> None:
    """Of half-spaces around the bodies too; a penalty knows no other stress."""
    keys = "wheel.young_modulus=70000", "solver.method=penalty", "mesh.patch_size=3"
    contact = condensed("hertz_ellipse", *keys)
    expected = np.repeat(contact.tau, 2)[:, None] * contact.displacement_compliance
    np.testing.assert_allclose(
        contact.trial_compliance, expected, atol=1e-9 * np.abs(expected).max()
    )

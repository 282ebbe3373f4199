"""The answer of a pressed contact to tangential tractions."""

import numpy as np
import pytest
from mpi4py import MPI

from railhead.planning import simulation_plan as planning
from railhead.run import mesh_solution
from railhead.scene import catalogue
from railhead.solver.friction.condensation import StaticCondensation
from railhead.solver.system.contact_system import LoadCase


@pytest.mark.parametrize("rigid", [(), ("wheel.young_modulus=inf",)])
def test_movements_are_reciprocal(rigid: tuple[str, ...]) -> None:
    """Betti: what the tractions of one node work on the movement by those of another is what these
    work on the movement by the first, and tractions work on their own movement."""
    keys = ("friction.coefficient=0.3", "friction.force_along=9900", "mesh.patch_size=0.5", *rigid)
    plan = planning.make(catalogue.find("long_roller").replace(list(keys)))
    model = mesh_solution.assemble(
        plan, mesh_solution.generate(plan, plan.grading(), MPI.COMM_WORLD)
    )
    settings, response = model.setup.friction, model.response()
    touching = plan.forecast.touching(model.setup.kinematics.lift(model.interface.points))
    pressed = response.press(LoadCase(load=plan.scene.load or 0.0, active=touching))
    contact = StaticCondensation(model, response, settings, pressed).condense(pressed)
    weights = np.repeat(contact.weights, contact.tangents.shape[1])
    work = -contact.shape_functions.T @ (weights[:, None] * contact.displacement_compliance)
    np.testing.assert_allclose(work, work.T, rtol=0, atol=1e-12 * np.abs(work).max())
    assert np.linalg.eigvalsh(work).min() > 0

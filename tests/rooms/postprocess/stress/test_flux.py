"""The force that the elements' stresses carry around a contact is the one that acts on it."""

from dataclasses import replace

import numpy as np
import pytest
from painted import LAME

from railhead.postprocess.stress.flux import contact_force, pressure_force
from railhead.solver.system.fields import ContactFields

TOUCHED = 2.0  # mm, radius of a disc on the common plane


def touching(case, displacement, pressure):
    """The blocks with a displacement, touching where a pressure (x, y) is positive."""
    fields = case.fields
    top = fields.points[np.isclose(fields.points[:, 2], 0.0)]
    zeros, up = np.zeros(len(top)), np.tile([0.0, 0.0, 1.0], (len(top), 1))
    contact = ContactFields(
        points=top,
        weights=zeros + 1.0,
        pressure=pressure(*top[:, :2].T),
        indicator=zeros,
        gap=zeros,
        normals=up,
        facet=zeros.astype(int),
        xi=top[:, :2],
        facet_nodes=np.zeros((0, 3), dtype=int),
        facing=np.zeros(0, dtype=bool),
    )
    return replace(fields, displacement=displacement, contact=contact)


@pytest.mark.parametrize(
    ("cell", "degree"), [("tetrahedron", 1), ("tetrahedron", 2), ("hexahedron", 1)]
)
def test_uniform_stress_times_the_area_of_the_weight(blocks, cell, degree) -> None:
    """A disc of radius r with the weight 1, falling as a cubic to 0 at 2 r."""
    case = blocks(cell, degree, cut=False)
    strain = np.array([[1.0, 0.2, 0.1], [0.2, -0.5, 0.3], [0.1, 0.3, -2.0]]) * 1e-3
    disc = lambda x, y: np.where(np.hypot(x, y) < TOUCHED, 1.0, 0.0)  # noqa: E731
    fields = touching(case, case.fields.points @ strain.T, disc)
    stress = LAME[0] * np.trace(strain) * np.eye(3) + 2 * LAME[1] * strain
    touched = fields.contact.points[fields.contact.pressure > 0]
    radius = 1.1 * np.hypot(*touched[:, :2].T).max()
    t = (np.arange(1000) + 0.5) / 1000
    area = np.pi * radius**2 * (1 + 2 * np.mean((1 + t) * (1 - 3 * t**2 + 2 * t**3)))
    for body in (1, 2):
        assert contact_force(fields, body) == pytest.approx(area * stress[:, 2], rel=0.02)


@pytest.mark.parametrize("cut", [True, False])
def test_hertz_load_around_the_patch(blocks, cut) -> None:
    """Exact displacements at the nodes of half-spaces, sides of the blocks included."""
    case = blocks("tetrahedron", 2, cut)
    fields = touching(case, case.fields.displacement, case.ellipse.pressure)
    for body in (1, 2):
        along, across, force = contact_force(fields, body) / case.ellipse.load
        assert force == pytest.approx(-1.0, rel=0.01)
        assert abs(along) < 0.01 and abs(across) < 0.01


@pytest.mark.parametrize("slave", [1, 2])
def test_pressure_pushes_the_rail_away_from_the_wheel(blocks, slave) -> None:
    case = blocks("tetrahedron", 1)
    fields = touching(case, case.fields.displacement, lambda x, y: 0.0 * x + 2.0)
    contact = replace(fields.contact, normals=(1.5 - slave) * 2 * fields.contact.normals)
    fields = replace(fields, contact=contact, slave=slave)
    total = 4 * 2.0 * len(contact.points)
    assert pressure_force(fields) == pytest.approx([0.0, 0.0, -total])

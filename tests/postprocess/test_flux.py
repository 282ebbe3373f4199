"""The flux of the elements' stresses through a slab is the load that the body carries."""

from dataclasses import replace

import numpy as np
import pytest

from railhead.postprocess.flux import through_slab
from railhead.solver.gather import ContactFields

YOUNG, POISSON = 1000.0, 0.25
LAME = (YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), YOUNG / (2 * (1 + POISSON)))


def squeezed(case, strain):
    """Both blocks under a linear displacement, the lower one touched everywhere on its top."""
    fields = case.fields
    top = fields.points[np.isclose(fields.points[:, 2], 0.0)]
    zeros = np.zeros(len(top))
    contact = ContactFields(
        top, zeros, zeros + 1.0, zeros, zeros, top, zeros.astype(int), top[:, :2],
        np.zeros((0, 3), dtype=int),
    )  # fmt: skip
    lame = np.tile(LAME, (len(fields.cells), 1))
    return replace(fields, displacement=fields.points @ strain.T, lame=lame, contact=contact)


@pytest.mark.parametrize(
    ("cell", "degree"), [("tetrahedron", 1), ("tetrahedron", 2), ("hexahedron", 1)]
)
@pytest.mark.parametrize("cut", [True, False])
def test_uniform_stress_times_area(blocks, cell, degree, cut) -> None:
    """But for the bend of the weight within cells that are half as thick as the slab."""
    case = blocks(cell, degree, cut)
    strain = np.array([[1.0, 0.2, 0.1], [0.2, -0.5, 0.3], [0.1, 0.3, -2.0]]) * 1e-3
    fields = squeezed(case, strain)
    stress = LAME[0] * np.trace(strain) + 2 * LAME[1] * strain[2, 2]
    width = np.ptp(fields.points, axis=0) * (2 if cut else 1)
    for body in (1, 2):
        found = through_slab(fields, body, 1.234, 2.0)
        assert found == pytest.approx(-stress * width[0] * width[1], rel=0.04)


def test_hertz_load_through_a_slab_below_the_patch(blocks) -> None:
    """Exact displacements at the nodes: what is missing passes beside the block."""
    case = blocks("tetrahedron", 2)
    fields = squeezed(case, np.eye(3))
    lame = np.tile((207000 * 0.3 / (1.3 * 0.4), 207000 / 2.6), (len(fields.cells), 1))
    fields = replace(fields, displacement=case.fields.displacement, lame=lame)
    b = case.ellipse.b
    for body in (1, 2):
        assert through_slab(fields, body, b, 2.0) == pytest.approx(case.ellipse.load, rel=0.06)
        assert through_slab(fields, body, b, 2.0) < case.ellipse.load


def test_a_thin_body_is_cut_half_way_down(blocks) -> None:
    fields = squeezed(blocks("tetrahedron", 1), np.diag([0.0, 0.0, -1e-3]))
    half = -0.5 * fields.points[:, 2].min()
    assert through_slab(fields, 1, 1e3, 1.0) == pytest.approx(through_slab(fields, 1, half, 1.0))

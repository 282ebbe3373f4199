"""Two blocks in Hertz contact with exact fields at their nodes, whole or a quarter."""

from dataclasses import dataclass
from typing import cast

import numpy as np
import pytest
from dolfinx.mesh import CellType, create_box
from mpi4py import MPI
from painted import LAME, POISSON, YOUNG

from railhead.postprocess import symmetry, vtu
from railhead.postprocess.findings import Array, Findings, Frame
from railhead.postprocess.patch import half_space
from railhead.solver import compat
from railhead.solver.system.fields import ContactFields, Fields
from railhead.theory.elastic.halfspace import hertz_displacement
from railhead.theory.elastic.hertz import Ellipse, contact_modulus, point_contact
from railhead.theory.elastic.subsurface import stress


@dataclass(frozen=True)
class Case:
    """What the pictures and files are made from; stress (n, 6) at the nodes, MPa. findings: of
    exact Hertz."""

    fields: Fields
    stress: Array
    findings: Findings
    ellipse: Ellipse

    @property
    def volume(self):
        """Cells of the whole blocks."""
        return symmetry.grid(vtu.volume_grid(self.fields, self.stress), self.fields.mirrors)


@pytest.fixture(scope="session")
def blocks():
    """make(cell, degree, cut=, radii=, load=): Case; blocks of 3 x 3 x 3 semi-axes a quarter."""

    def make(
        cell: str = "hexahedron",
        degree: int = 1,
        cut: bool = True,
        radii: tuple[float, float] = (420.0, 300.0),
        load: float = 25000.0,
    ) -> Case:
        modulus = contact_modulus(YOUNG, POISSON, YOUNG, POISSON)
        ellipse = point_contact(1 / radii[0], 1 / radii[1], modulus, load)
        size = np.array([3.0 * ellipse.a, 3.0 * ellipse.b, 3.0 * ellipse.b])
        lower, cells = _block(cell, degree, cut, size, -size[2])
        upper, more = _block(cell, degree, cut, size, 0.0)
        flip = np.array([1.0, 1.0, -1.0])
        moved = [
            hertz_displacement(ellipse, lower, YOUNG, POISSON),
            hertz_displacement(ellipse, upper * flip, YOUNG, POISSON) * flip,
        ]
        stresses = [
            stress(ellipse, POISSON, lower),
            stress(ellipse, POISSON, upper * flip) * [1, 1, 1, 1, -1, -1],
        ]
        fields = Fields(
            points=np.concatenate([lower, upper]),
            displacement=np.concatenate(moved),
            cells=np.concatenate([cells, more + len(lower)]),
            body=np.repeat([1, 2], [len(cells), len(more)]),
            lame=np.tile(LAME, (len(cells) + len(more), 1)),
            cell=cell,
            degree=degree,
            slave=1,
            mirrors=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)) if cut else (),
            contact=cast(ContactFields, None),  # the quadrature points are not looked at
        )
        bodies = {"rail": POISSON, "wheel": POISSON}
        found = half_space.of_hertz(ellipse, Frame((0.0, 0.0, 0.0), 0.0), bodies, section=False)
        return Case(fields, np.concatenate(stresses), found, ellipse)

    return make


def _block(cell: str, degree: int, cut: bool, size: Array, bottom: float):
    """Nodes and cells, in the order of dolfinx, of one block, a quarter of it when cut."""
    low, count = ([0.0, 0.0], 6) if cut else (-size[:2], 12)
    corners = [np.array([*low, bottom]), np.array([*size[:2], bottom + size[2]])]
    mesh = create_box(MPI.COMM_SELF, corners, [count, count, 6], getattr(CellType, cell))
    space = compat.vector_space(mesh, degree)
    points = np.array(space.tabulate_dof_coordinates())
    points[np.abs(points) < 1e-9 * size[0]] = 0.0
    return points, compat.cell_dofs(space).astype(np.int64)

"""The mesh of a scene."""

import ctypes
from collections.abc import Iterator

import numpy as np
import pytest
from mpi4py import MPI

from railhead.meshing.isolated_process import M_PERTURB
from railhead.planning import plan as planning
from railhead.run import build
from railhead.scene import catalogue
from railhead.solver import compat

LIBC = ctypes.CDLL(None)


@pytest.fixture(autouse=True)
def unfilled() -> Iterator[None]:
    yield
    LIBC.mallopt(M_PERTURB, 0)


def test_the_mesh_does_not_depend_on_what_memory_held() -> None:
    """Of these bodies gmsh makes 3041 tetrahedra where it finds zeros, and 3038 where it finds the
    bytes 0xfe or 0xaa."""
    plan = planning.make(catalogue.find("uic54_thesis").replace(["mesh.patch_size=1.0"]))
    found = []
    for byte in (0xFF, 0x01, 0x55):
        LIBC.mallopt(M_PERTURB, byte)
        made = build.generate(plan, plan.grading(), MPI.COMM_WORLD)
        found.append((made.cells, np.sort(compat.node_points(made.mesh), axis=0)))
    for cells, points in found[1:]:
        assert cells == found[0][0]
        np.testing.assert_array_equal(points, found[0][1])

"""Simplifications against the models they stand for, on the same meshes."""

from dataclasses import replace

import numpy as np
import pytest
from dolfinx import mesh as dmesh
from mpi4py import MPI
from scipy.spatial import cKDTree

from railhead.meshing.bodies import CONTACT, SUPPORT
from railhead.meshing.mesh import ContactMesh
from railhead.solver import compat


def mirrored(made: ContactMesh, axis: int, size: float) -> ContactMesh:
    """A mesh of blocks cut at coordinate 0 of an axis, joined with its mirror image."""
    old = made.mesh
    points, cells = old.geometry.x, compat.cell_nodes(old)
    off = np.abs(points[:, axis]) > 1e-12
    image = np.arange(len(points))
    image[off] = len(points) + np.arange(off.sum())
    flip = np.where(np.arange(3) == axis, -1.0, 1.0)
    whole = np.concatenate([points, points[off] * flip])
    both = np.concatenate([cells, image[cells][:, [1, 0, 2, 3]]])
    new = compat.straight_mesh(MPI.COMM_WORLD, both, whole, "tetrahedron")
    bodies = np.zeros(len(cells), dtype=np.int32)
    bodies[made.cell_tags.indices] = made.cell_tags.values
    bodies = np.tile(bodies, 2)[new.topology.original_cell_index]
    cell_tags = dmesh.meshtags(new, 3, np.arange(len(both), dtype=np.int32), bodies)

    new.topology.create_connectivity(2, 3)
    facets = dmesh.exterior_facet_indices(new.topology)
    owner = np.array([new.topology.connectivity(2, 3).links(facet)[0] for facet in facets])
    height = np.abs(dmesh.compute_midpoints(new, 2, facets)[:, 2])
    kind = np.where(height < 1e-9, CONTACT, np.where(height > size - 1e-9, SUPPORT, 0))
    tagged = kind > 0
    values = (kind + bodies[owner])[tagged].astype(np.int32)
    facet_tags = dmesh.meshtags(new, 2, facets[tagged], values)
    return replace(made, mesh=new, cell_tags=cell_tags, facet_tags=facet_tags)


def test_quarter_and_whole_model_agree_on_mirrored_meshes(two_blocks, solve) -> None:
    """One mesh and its images: approach and every pressure to 1e-8."""
    made, setup = two_blocks()
    part, quarter = solve(made, setup, load=3000.0)
    whole = mirrored(mirrored(made, 0, 10.0), 1, 10.0)
    model, full = solve(whole, replace(setup, planes=()), load=3000.0)
    assert full.newton.converged
    assert full.approach == pytest.approx(quarter.approach, rel=1e-8)
    points = model.interface.points
    images = cKDTree(points)
    for x, y in ((1, 1), (-1, 1), (1, -1), (-1, -1)):
        distance, partner = images.query(part.interface.points * [x, y, 1])
        assert distance.max() < 1e-9
        scale = quarter.pressure.max()
        np.testing.assert_allclose(full.pressure[partner], quarter.pressure, atol=1e-8 * scale)

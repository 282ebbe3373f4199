"""Recovery of fields on the contact surface from values at quadrature points."""

from collections.abc import Callable

import basix
import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from railhead.postprocess.findings import Array, Frame, Surface
from railhead.solver.space.facets import facet_type
from railhead.solver.system.fields import Fields

_TRIANGLES = {
    ("triangle", 1): [[0, 1]],
    ("triangle", 2): [[0, 2], [2, 1]],
    ("quadrilateral", 1): [[0, 1]],
    ("quadrilateral", 2): [[0, 2], [2, 1]],
    ("tetrahedron", 1): [[0, 1, 2]],
    ("tetrahedron", 2): [[0, 5, 4], [5, 1, 3], [4, 3, 2], [3, 4, 5]],
    ("tetrahedron", 3): [
        [0, 7, 5],
        [7, 9, 5],
        [7, 8, 9],
        [8, 3, 9],
        [8, 1, 3],
        [5, 9, 6],
        [9, 4, 6],
        [9, 3, 4],
        [6, 4, 2],
    ],
    ("hexahedron", 1): [[0, 1, 2], [1, 3, 2]],
    ("hexahedron", 2): [
        [0, 4, 5],
        [4, 8, 5],
        [4, 1, 8],
        [1, 6, 8],
        [5, 8, 2],
        [8, 7, 2],
        [8, 6, 7],
        [6, 3, 7],
    ],
}


def facing_facets(fields: Fields) -> NDArray[np.int64]:
    """(f, k) nodes of the slave's contact facets that face the other body wholly, as in
    `ContactFields.facet_nodes`.
    """
    return fields.contact.facet_nodes[fields.contact.facing]


def triangulated(
    fields: Fields, facets: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Nodes (n,) of facets (f, k), ascending numbers in `Fields.points`, and flat triangles (t, 3)
    through all of them, as rows of these nodes; of a section, lines (t, 2).
    """
    nodes = np.unique(facets)
    rows = np.searchsorted(nodes, facets)
    pattern = _TRIANGLES[fields.cell, fields.degree]
    return nodes, np.concatenate([rows[:, each] for each in pattern])


def project(fields: Fields, values: Array) -> Array:
    """Nodal values x (n,) at the nodes of `facing_facets`, ascending, of values (q,) at all contact
    points: the L2 projection M x = int phi values dA with the shape functions phi and their mass
    matrix M = int phi phi^T dA, integrated over these facets.
    """
    contact, facets = fields.contact, facing_facets(fields)
    members, nodes = contact.facing[contact.facet], np.unique(facets)
    element = basix.create_element(
        basix.ElementFamily.P,
        getattr(basix.CellType, facet_type(fields.cell)),
        fields.degree,
        basix.LagrangeVariant.gll_warped,
    )
    phi = element.tabulate(0, contact.xi[members])[0][..., 0]
    columns = np.searchsorted(nodes, contact.facet_nodes[contact.facet[members]])
    rows = np.repeat(np.arange(len(phi)), phi.shape[1])
    shape = (len(phi), len(nodes))
    basis = sp.csr_matrix((phi.ravel(), (rows, columns.ravel())), shape=shape)
    weighted = basis.T @ sp.diags(contact.weights[members])
    return np.asarray(splu((weighted @ basis).tocsc()).solve(weighted @ values[members]))


def recover_surface(fields: Fields, frame: Frame, pressure: Callable[[Array], Array]) -> Surface:
    """Points, pressure, gap and displacement on the slave's contact surface.

    pressure: function that gives the smooth pressure (n,), MPa, at points (n, 3) in space, mm.
    """
    nodes, triangles = triangulated(fields, facing_facets(fields))
    points = fields.points[nodes]
    return Surface(
        points=points,
        local=frame.local(points)[:, :2],
        triangles=triangles,
        pressure=pressure(points),
        gap=project(fields, fields.contact.gap),
        displacement=fields.displacement[nodes],
    )

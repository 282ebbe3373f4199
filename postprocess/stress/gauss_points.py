"""Stresses from the displacement, in the cells and at the nodes; tension is positive."""

import basix
import numpy as np
from numpy.typing import NDArray

from railhead.postprocess.findings import COLUMN, ROW, Array
from railhead.solver.space.cells import centroid, inverse, quadrature_degree, tabulate
from railhead.solver.system.fields import Fields

OUT = np.diag([0.0, 1.0, 0.0])  # the hoop direction of a meridian section


def stress_at_reference_point(
    fields: Fields, cells: NDArray[np.int64], reference: Array
) -> tuple[Array, Array, Array]:
    """Position (m, 3) mm, stress (m, 6) MPa and |det J| (m,) at one reference point of m cells. J
    is the Jacobian of the map from the reference cell to the d coordinates of the mesh.

    Stress components xx, yy, zz, xy, xz, yz in global axes. Plastic strains are those of a linear
    function fitted to the Gauss points of each cell. reference (d,): reference coordinates.
    """
    x, stress, size = stress_of_total_strain(fields, cells, reference)
    if fields.plastic_strain is not None:
        points, _ = _sample_rule(fields)
        corner, *rest = np.linalg.pinv(np.column_stack([np.ones(len(points)), points]))
        shares = corner + reference @ np.array(rest)
        strain = np.einsum("g,mgij->mij", shares, fields.plastic_strain.strain[cells])
        stress = stress - _relief(fields, cells, strain)
    return x, stress, size


def stress_at_gauss_points(fields: Fields, cells: NDArray[np.int64]) -> tuple[Array, Array, Array]:
    """Positions (m, g, 3), mm, stresses (m, g, 6), MPa, and volumes (m, g), mm3, at all g Gauss
    points of m cells. Components are xx, yy, zz, xy, xz, yz in global axes. Volumes are of a plane
    section times its thickness, of a meridian section of the whole turn.
    """
    points, stresses, volumes = [], [], []
    for g, (reference, weight) in enumerate(zip(*_sample_rule(fields), strict=True)):
        x, stress, size = stress_of_total_strain(fields, cells, reference)
        if fields.plastic_strain is not None:
            stress = stress - _relief(fields, cells, fields.plastic_strain.strain[cells, g])
        points.append(x)
        stresses.append(stress)
        volumes.append(weight * size * fields.kinematics.measure(fields.kinematics.flatten(x)))
    return np.stack(points, axis=1), np.stack(stresses, axis=1), np.stack(volumes, axis=1)


def _sample_rule(fields: Fields) -> tuple[Array, Array]:
    """Reference coordinates (g, d) of the points in a cell at which stresses are sampled, and their
    weights (g,).

    In elastic solutions they are the superconvergent points of the cells, in solutions with yield
    the quadrature points that carry plastic strains.
    """
    rule = 1 if fields.degree == 1 and fields.cell in ("tetrahedron", "triangle") else 2
    if fields.plastic_strain is not None:
        rule = quadrature_degree(fields.cell, fields.degree, fields.kinematics)
    points, weights = basix.make_quadrature(getattr(basix.CellType, fields.cell), rule)
    return np.asarray(points), np.asarray(weights)


def _relief(fields: Fields, cells: NDArray[np.int64], strain: Array) -> Array:
    """Stress 2 mu eps_p (m, 6), MPa, of plastic strains eps_p (m, 3, 3), which have no trace;
    components xx, yy, zz, xy, xz, yz.
    """
    return np.asarray(2 * fields.lame[cells, 1, None] * strain[:, ROW, COLUMN])


def stress_of_total_strain(
    fields: Fields, cells: NDArray[np.int64], reference: Array
) -> tuple[Array, Array, Array]:
    """Position (m, 3) mm, stress (m, 6) MPa and |det J| (m,) at one reference point of m cells. The
    stress is the elastic one of the total strain, with plastic strain ignored; components xx,
    yy, zz, xy, xz, yz in global axes. Its dilatation is averaged over the cell, or taken at the
    cell's centroid, where `Kinematics` has that (`averaged`, `mean_dilatation`).
    """
    x, strain, size = _strain(fields, cells, reference)
    dilatation = strain
    if fields.kinematics.averaged:
        dilatation = _mean_strain(fields, cells)
    elif fields.kinematics.mean_dilatation:
        _, dilatation, _ = _strain(fields, cells, centroid(fields.cell))
    lam, mu = fields.lame[cells].T[..., None, None]
    trace = np.trace(dilatation, axis1=1, axis2=2)[:, None, None]
    stress = lam * trace * np.eye(3) + 2 * mu * strain
    return x, stress[:, ROW, COLUMN], size


def _mean_strain(fields: Fields, cells: NDArray[np.int64]) -> Array:
    """Strain (m, 3, 3) in global axes of m cells, averaged over the volume of each cell."""
    order = quadrature_degree(fields.cell, fields.degree, fields.kinematics)
    rule = basix.make_quadrature(getattr(basix.CellType, fields.cell), order)
    total, volume = np.zeros((len(cells), 3, 3)), np.zeros((len(cells), 1, 1))
    for point, weight in zip(*rule, strict=True):
        x, strain, size = _strain(fields, cells, point)
        part = (weight * size * fields.kinematics.measure(x))[:, None, None]
        total += part * strain
        volume += part
    return np.asarray(total / volume)


def _strain(
    fields: Fields, cells: NDArray[np.int64], reference: Array
) -> tuple[Array, Array, Array]:
    """Position (m, 3) mm, strain (m, 3, 3) in global axes and |det J| (m,) at one reference point
    of m cells. In a meridian section the strain includes the hoop strain.
    """
    phi = tabulate(fields.cell, fields.degree, reference[None])[:, 0]
    kinematics = fields.kinematics
    at, u = fields.points[fields.cells[cells]], fields.displacement[fields.cells[cells]]
    nodes, u = kinematics.flatten(at), kinematics.flatten(u)
    jacobian = (phi[1:] @ nodes).transpose(0, 2, 1)
    inverted, size = inverse(jacobian)
    grad_u = (phi[1:] @ u).transpose(0, 2, 1) @ inverted
    strain = kinematics.axes.T @ (0.5 * (grad_u + grad_u.transpose(0, 2, 1))) @ kinematics.axes
    x = phi[0] @ at
    if kinematics.revolved:
        r = x[:, 0]
        on_axis = r <= 1e-12 * np.abs(r).max(initial=0.0)  # there u/r is du/dr
        hoop = np.where(on_axis, grad_u[:, 0, 0], u[..., 0] @ phi[0] / np.where(on_axis, 1.0, r))
        strain += hoop[:, None, None] * OUT
    return x, strain, np.abs(size)


def nodal_stress(fields: Fields) -> Array:
    """Stress (n, 6), components xx, yy, zz, xy, xz, yz in global axes, at all nodes, MPa.

    Each is the average of the stresses of the cells around the node, weighted by |det J| there.
    Bodies share no node, so their stresses do not mix.
    """
    kind = getattr(basix.CellType, fields.cell)
    element = basix.create_element(
        basix.ElementFamily.P, kind, fields.degree, basix.LagrangeVariant.gll_warped
    )
    total = np.zeros((len(fields.points), 6))
    weight = np.zeros(len(fields.points))
    every = np.arange(len(fields.cells))
    for place, reference in enumerate(np.asarray(element.points)):
        _, stress, volume = stress_at_reference_point(fields, every, reference)
        np.add.at(total, fields.cells[:, place], stress * volume[:, None])
        np.add.at(weight, fields.cells[:, place], volume)
    return total / weight[:, None]

"""Stresses from the displacement: at nodes, and on the axis below the contact."""

from __future__ import annotations

from itertools import combinations_with_replacement

import basix
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from postprocess.findings import Array, DepthAxis, Frame
from solver.elasticity import quadrature_degree
from solver.facets import middle, tabulate
from solver.gather import Fields

NEIGHBOURS = 1200  # samples of one local fit: about three element sizes around
FLAT_NEIGHBOURS = {"triangle": 120, "quadrilateral": 60}  # the same in a section
FIT_DEGREE = 3
OUT = np.diag([0.0, 1.0, 0.0])  # the hoop direction of a meridian section
_ROW, _COLUMN = np.array([0, 1, 2, 0, 0, 1]), np.array([0, 1, 2, 1, 2, 2])


def _at(fields: Fields, cells: NDArray[np.int64], reference: Array) -> tuple[Array, Array, Array]:
    """Position (m, 3), stress (m, 6) in global axes and |det J| at one reference point."""
    x, strain, size = _strain(fields, cells, reference)
    dilatation = strain
    if fields.kinematics.averaged:
        dilatation = _mean_strain(fields, cells)
    elif fields.kinematics.mean_dilatation:
        _, dilatation, _ = _strain(fields, cells, middle(fields.cell))
    lam, mu = fields.lame[cells].T[..., None, None]
    trace = np.trace(dilatation, axis1=1, axis2=2)[:, None, None]
    stress = lam * trace * np.eye(3) + 2 * mu * strain
    return x, stress[:, _ROW, _COLUMN], size


def _mean_strain(fields: Fields, cells: NDArray[np.int64]) -> Array:
    """Strain (m, 3, 3) in global axes, averaged over the volume of each cell."""
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
    """Position (m, 3), strain (m, 3, 3) in global axes and |det J| at one reference point."""
    phi = tabulate(fields.cell, fields.degree, reference[None])[:, 0]
    kinematics = fields.kinematics
    at, u = fields.points[fields.cells[cells]], fields.displacement[fields.cells[cells]]
    nodes, u = kinematics.flatten(at), kinematics.flatten(u)
    jacobian = np.einsum("jd,mdk->mkj", phi[1:], nodes)
    gradient = np.einsum("jd,mjk->mdk", phi[1:], np.linalg.inv(jacobian))
    grad_u = np.einsum("mdi,mdk->mik", u, gradient)
    strain = 0.5 * (grad_u + grad_u.transpose(0, 2, 1))
    x = np.einsum("d,mdk->mk", phi[0], at)
    if kinematics.dim == 2:
        strain = kinematics.axes.T @ strain @ kinematics.axes
    if kinematics.revolved:
        strain += _hoop(u[..., 0] @ phi[0], x[:, 0], grad_u[:, 0, 0])[:, None, None] * OUT
    return x, strain, np.abs(np.linalg.det(jacobian))


def _hoop(u: Array, r: Array, slope: Array) -> Array:
    """u_r/r (m,), and its limit du_r/dr on the axis."""
    on_axis = r <= 1e-12 * np.abs(r).max(initial=0.0)
    return np.where(on_axis, slope, u / np.where(on_axis, 1.0, r))


def nodal(fields: Fields) -> Array:
    """(n, 6) stress xx, yy, zz, xy, xz, yz at all nodes in global axes, MPa: the average of the
    cells around each node, weighted by their volume. Bodies share no node, so they do not mix."""
    kind = getattr(basix.CellType, fields.cell)
    element = basix.create_element(
        basix.ElementFamily.P, kind, fields.degree, basix.LagrangeVariant.gll_warped
    )
    total = np.zeros((len(fields.points), 6))
    weight = np.zeros(len(fields.points))
    every = np.arange(len(fields.cells))
    for place, reference in enumerate(np.asarray(element.points)):
        _, stress, volume = _at(fields, every, reference)
        np.add.at(total, fields.cells[:, place], stress * volume[:, None])
        np.add.at(weight, fields.cells[:, place], volume)
    return total / weight[:, None]


def below(
    fields: Fields, frame: Frame, centre: tuple[float, float], body: int, name: str, depth: Array
) -> DepthAxis:
    """Stress on the axis below (x, s) = centre in one body, in the contact frame.

    At each depth a polynomial of degree 3 is fitted to the stresses at the Gauss points of the
    cells around, the mirror images across symmetry planes included (moving least squares,
    Lancaster and Salkauskas 1981; Gauss points as in Zienkiewicz and Zhu 1992).
    """
    into = np.array([0.0, 0.0, -1.0 if body == 1 else 1.0])
    start = np.array([*centre, 0.0])
    axis = start + depth[:, None] * into
    points, stress = _samples(fields, frame, body, start, 3.0 * float(depth.max()))
    tree = cKDTree(points)
    count = min(FLAT_NEIGHBOURS.get(fields.cell, NEIGHBOURS), len(points))
    distance, index = tree.query(axis, k=count)
    out = np.empty((len(depth), 6))
    for row, (d, i) in enumerate(zip(distance, index, strict=True)):
        radius = d[-1] * (1 + 1e-9)
        basis = _monomials((points[i] - axis[row]) / radius)
        weighted = basis.T * (1 - (d / radius) ** 2)
        # In a section the monomials depend on each other: the least of the solutions.
        out[row] = np.linalg.lstsq(weighted @ basis, weighted @ stress[i], rcond=1e-12)[0][0]
    return DepthAxis(name, depth, out)


def _gauss(fields: Fields) -> Array:
    """Reference points (g, d) at which stresses are best."""
    rule = 1 if fields.degree == 1 and fields.cell in ("tetrahedron", "triangle") else 2
    return np.asarray(basix.make_quadrature(getattr(basix.CellType, fields.cell), rule)[0])


def _monomials(x: Array) -> Array:
    """(n, 3) -> (n, 20): all products of at most three coordinates, 1 first."""
    factors = np.column_stack([np.ones(len(x)), x])
    combined = combinations_with_replacement(range(4), FIT_DEGREE)
    i, j, k = np.array(list(combined)).T
    return np.asarray(factors[:, i] * factors[:, j] * factors[:, k])


def _samples(
    fields: Fields, frame: Frame, body: int, centre: Array, reach: float
) -> tuple[Array, Array]:
    """Gauss points (k, 3) and stresses (k, 6) of one body around the contact, contact frame."""
    local = frame.local(fields.points)
    corners = fields.kinematics.dim + 1
    middle = local[fields.cells[:, :corners]].mean(axis=1)
    near = np.linalg.norm(middle - centre, axis=1) < reach
    cells = np.flatnonzero((fields.body == body) & near)
    if len(cells) < 30:
        cells = np.flatnonzero(fields.body == body)
    found = [_at(fields, cells, point)[:2] for point in _gauss(fields)]
    points = frame.local(np.concatenate([x for x, _ in found]))
    axes = frame.axes
    tensor = np.zeros((len(points), 3, 3))
    stress = np.concatenate([s for _, s in found])
    tensor[:, _ROW, _COLUMN] = tensor[:, _COLUMN, _ROW] = stress
    stress = (axes @ tensor @ axes.T)[:, _ROW, _COLUMN]
    for normal in fields.mirrors:
        plane = int(np.argmax(np.abs(normal)))
        image = points.copy()
        image[:, plane] *= -1
        sign = np.where((plane == _ROW) != (plane == _COLUMN), -1.0, 1.0)
        points = np.concatenate([points, image])
        stress = np.concatenate([stress, stress * sign])
    return points, stress

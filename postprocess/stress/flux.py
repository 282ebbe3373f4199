"""The force that the elements' own stresses carry away from the contact in a body."""

import basix
import numpy as np

from railhead.meshing.bodies import RAIL
from railhead.postprocess.findings import SYMMETRIC, Array
from railhead.postprocess.stress.body_geometry import Solid
from railhead.postprocess.stress.gauss_points import stress_at_reference_point
from railhead.solver.system.fields import Fields

QUADRATURE_DEGREE = 6  # in each cell
OUTER_RATIO = 2.2  # semi-axis of the outer ellipsoid over the largest distance of a touching point
DEPTH_SHARE = 0.9  # of the depth of the body: where the outer ellipsoid ends


def contact_force(fields: Fields, body: int) -> Array:
    """Force (3,) in space of the wheel on the rail, N, of the whole model, from the stresses sigma
    of the body with this tag, tractions of friction included.

    The function phi is 1 in an ellipsoid around all touching points and falls smoothly to 0 at an
    ellipsoid twice as large. In equilibrium int sigma grad(phi) over the body is the force on its
    contact surface: the other surfaces within the larger ellipsoid carry no traction. The finite-
    element equations hold for shape functions only, so the difference from the force is an error of
    the stresses.
    """
    contact, cells = fields.contact, np.flatnonzero(fields.body == body)
    touching = contact.points[contact.pressure > 0]
    low, high = touching.min(axis=0), touching.max(axis=0)
    for normal in fields.mirrors:
        low = np.where(np.abs(normal) > 0.5, -high, low)  # the half at positive coordinates
    centre = (low + high) / 2
    away = touching - centre
    reach = OUTER_RATIO * float(np.hypot(away[:, 0], away[:, 1]).max())
    into = np.array([0.0, 0.0, -1.0 if body == RAIL else 1.0])
    height = float(np.ptp(fields.points[np.unique(fields.cells[cells]), 2]))
    top = contact.points[np.argmax(contact.pressure)]
    depth = min(reach, DEPTH_SHARE * Solid(fields, cells).extent(top, into, height))
    scale = 1 / np.array([reach, reach, depth])
    scale /= max(1.0, OUTER_RATIO * float(np.linalg.norm(away * scale, axis=1).max()))

    radius = np.linalg.norm((fields.points[fields.cells[cells]] - centre) * scale, axis=2)
    cells = cells[(radius.min(axis=1) < 1.0) & (radius.max(axis=1) > 0.5)]
    kinematics, total = fields.kinematics, np.zeros(3)
    rule = basix.make_quadrature(getattr(basix.CellType, fields.cell), QUADRATURE_DEGREE)
    for reference, weight in zip(*rule, strict=True):
        x, stress, size = stress_at_reference_point(fields, cells, reference)
        size = weight * size * kinematics.measure(kinematics.flatten(x))
        local = (x - centre) * scale
        rho = np.linalg.norm(local, axis=1)
        share = np.clip(2 * rho - 1, 0.0, 1.0)
        slope = -12 * share * (1 - share) * size  # of 1 - 3 share^2 + 2 share^3
        gradient = (slope / np.maximum(rho, 0.5))[:, None] * local * scale
        total += np.einsum("nij,nj->i", stress[:, SYMMETRIC], gradient)
    return _whole(fields, total if body == RAIL else -total)


def pressure_force(fields: Fields) -> Array:
    """Force (3,) in space of the pressure on the rail, N, of the whole model: the integral of
    pressure times the normal over the contact, without friction.
    """
    contact = fields.contact
    total = (contact.weights * contact.pressure) @ contact.normals
    return _whole(fields, -total if fields.slave == RAIL else total)


def _whole(fields: Fields, force: Array) -> Array:
    """Force (3,) on the whole model, N, from the force on the part that was cut at symmetry planes.
    Components along the normals of the planes are zero; the others are those of all copies.
    """
    for normal in fields.mirrors:
        force = np.where(np.abs(normal) > 0.5, 0.0, force)
    return fields.copies * force

"""Rotation and lateral displacement of finite bodies around the contact; half-spaces have none."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from railhead.meshing.bodies import RAIL
from railhead.postprocess.findings import Array, Frame, OnePatch
from railhead.theory.elastic.halfspace import boussinesq_displacement, mirrored

if TYPE_CHECKING:
    from railhead.solver.system.fields import Fields

FIT_RING = (2.5, 5.0)  # radii of the nodes that are fitted, over the longest half length


def motion(
    fields: Fields, body: int, patches: tuple[OnePatch, ...], load: float
) -> tuple[float, float]:
    """Rotation about x (rad, from y to z) and displacement along y (mm) of a body around its most
    loaded patch, beyond those of half-spaces.

    The rigid motion u_y = c - angle (z - z0), u_z = d + angle (y - y0) is fitted to the
    displacements u of the nodes in a ring around the patches. There (y0, z0) is the centre of the
    most loaded patch. The displacements of half-spaces under point loads at the patches are
    subtracted first. fields: of a solid; where it is cut at y = 0 the motion means nothing. body:
    tag of the body. patches: most loaded first. load: normal force on all patches, N. Returns
    (angle, c), zeros where no node lies in the ring.
    """
    nodes = np.unique(fields.cells[fields.body == body])
    points, moved = fields.points[nodes], fields.displacement[nodes].copy()
    young, poisson = _constants(fields, body)
    first = patches[0]
    reach = max(max(patch.a, patch.b) for patch in patches)
    chosen = np.linalg.norm(points - first.centre, axis=1) < FIT_RING[1] * reach
    for patch in patches:
        chosen &= np.linalg.norm(points - patch.centre, axis=1) > FIT_RING[0] * max(
            patch.a, patch.b
        )
    if not chosen.any():
        return 0.0, 0.0
    points, moved = points[chosen], moved[chosen]
    for patch in patches:
        moved -= _half_space(points, patch, body, patch.share * load, young, poisson)
    y, z = (points - first.centre).T[1:]
    one, none = np.ones_like(y), np.zeros_like(y)
    table = np.concatenate([np.column_stack([one, none, -z]), np.column_stack([none, one, y])])
    found = np.linalg.lstsq(table, np.concatenate(moved.T[1:]), rcond=None)[0]
    return float(found[2]), float(found[0])


def _constants(fields: Fields, body: int) -> tuple[float, float]:
    """Young's modulus (MPa) and Poisson's ratio of the body with this tag."""
    lam, mu = fields.lame[np.argmax(fields.body == body)]
    return float(mu * (3 * lam + 2 * mu) / (lam + mu)), float(lam / (2 * (lam + mu)))


def _half_space(
    points: Array, patch: OnePatch, body: int, load: float, young: float, poisson: float
) -> Array:
    """Displacement (n, 3) in space, mm, at points (n, 3) of a half-space with a normal point load
    at the centre of a patch.

    body: tag; the rail's half-space lies below the tangent plane, the wheel's above. load: N.
        young: Young's modulus, MPa. poisson: Poisson's ratio. Points outside the half-space are
        moved to its surface.
    """
    frame = Frame(patch.centre, patch.angle)
    local, mirror = mirrored(frame.local(points), upwards=body != RAIL)
    found = boussinesq_displacement(local, load, young, poisson) * mirror
    return np.asarray(found @ frame.axes)

"""Stresses at any points of both bodies."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from railhead.meshing.bodies import BODY_NAMES
from railhead.postprocess.findings import COLUMN, ROW, Array
from railhead.postprocess.stress.recovery import Recovery
from railhead.solver.fields import Fields

OUTSIDE = 1.5  # radii of the nearest cell: a point farther from it lies outside the body


def stress_at(fields: Fields, points: Array, body: str | None = None) -> Array:
    """Smooth stress (n, 6), components xx, yy, zz, xy, xz, yz in global axes, MPa, at points (n, 3)
    of the undeformed bodies, mm. NaN outside. Where a symmetry plane cut the model, the half that
    was left out is there as well; a plane section has the stress of its plane at every point.

    body: "rail" or "wheel"; None: for each point the body with the nearer cell.
    ValueError: points of another shape or not finite, or another body.
    """
    points = np.asarray(points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise ValueError(f"points must be a finite array (n, 3), got shape {points.shape}")
    tags = [int(tag) for tag in np.unique(fields.body) if body in (None, BODY_NAMES[tag])]
    if not tags:
        raise ValueError(f"body {body!r} is no deformable one; give rail or wheel, or None")
    turned = np.arctan2(points[:, 1], points[:, 0]) if fields.kinematics.revolved else None
    if turned is not None:  # into the meridian section
        radius = np.hypot(points[:, 0], points[:, 1])
        points = np.column_stack([radius, 0.0 * radius, points[:, 2]])
    folded = points.copy()
    for normal in np.array(fields.mirrors).reshape(-1, 3):
        axis, middle = int(np.argmax(np.abs(normal))), fields.points.mean(axis=0)
        folded[:, axis] = np.copysign(folded[:, axis], middle[axis])
    least = np.full(len(points), OUTSIDE)
    owner = np.zeros(len(points), dtype=int)
    axes = fields.kinematics.axes
    for tag in tags:
        corners = fields.points[fields.cells[fields.body == tag]] @ axes.T
        centres = corners.mean(axis=1)
        radii = np.linalg.norm(corners - centres[:, None], axis=2).max(axis=1)
        distance, cell = cKDTree(centres).query(folded @ axes.T)
        nearer = distance / radii[cell] < least
        least[nearer], owner[nearer] = (distance / radii[cell])[nearer], tag
    stress = np.full((len(points), 6), np.nan)
    for tag in np.unique(owner[owner > 0]):
        own = owner == tag
        stress[own] = Recovery(fields, np.flatnonzero(fields.body == tag)).at(points[own])
    return stress if turned is None else _turned(stress, turned)


def _turned(stress: Array, angle: Array) -> Array:
    """Stresses (n, 6) turned about the axis z by angles (n,), rad."""
    cosine, sine, zero = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    rows = (cosine, -sine, zero), (sine, cosine, zero), (zero, zero, zero + 1.0)
    turn = np.array(rows).transpose(2, 0, 1)
    tensor = stress[:, [0, 3, 4, 3, 1, 5, 4, 5, 2]].reshape(-1, 3, 3)
    return np.asarray((turn @ tensor @ turn.transpose(0, 2, 1))[:, ROW, COLUMN])

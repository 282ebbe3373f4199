"""Mirror images of a model that was cut at its symmetry planes.

The contact lies inside a whole model and on the border of one that was cut, so the cuts show in the
points themselves. A cut model lies at x >= 0 or at y >= 0, with the origin on the plane.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from railhead.postprocess.findings import Array, Surface

_TOLERANCE = 1e-9  # of the extent of the model


def cut_axes(local: Array) -> list[int]:
    """Axes (0: x, 1: s) across which points (n, 2 or 3) in the contact frame lie on one side."""
    return [axis for axis in (0, 1) if local[:, axis].min() > -_TOLERANCE * np.ptp(local[:, axis])]


def whole(surface: Surface) -> Surface:
    """The contact surface with its mirror images; it is returned as it is if it was not cut."""
    for axis in cut_axes(surface.local):
        points, local = surface.points.copy(), surface.local.copy()
        points[:, axis] *= -1
        local[:, axis] *= -1
        image = surface.triangles[:, ::-1] + len(points)
        surface = replace(
            surface,
            points=np.concatenate([surface.points, points]),
            local=np.concatenate([surface.local, local]),
            triangles=np.concatenate([surface.triangles, image]),
            pressure=np.tile(surface.pressure, 2),
            gap=np.tile(surface.gap, 2),
        )
    return surface

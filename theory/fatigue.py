"""Fatigue of steel by rolling: criteria of stress paths, by Dang Van and by Findley.

A path is the stress at one material point while a load passes. Stresses are in MPa, tension
positive, in columns xx, yy, zz, xy, xz, yz. Neither criterion knows a limit of a steel.
"""

import math
from itertools import product

import numpy as np

from railhead.theory.array_types import Array
from railhead.theory.elastic.subsurface import directions, principal

STEP = math.radians(15)  # between the planes of Findley's first search
STARTS = 2  # planes, more than 30 degrees apart, beside which better ones are looked for
FINEST = math.radians(0.25)  # step at which its last search ends
FEWEST = 64  # stresses of a path in the first search
TWICE = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # a shear stress stands twice in the tensor


def dang_van(paths: Array, slope: float, steps: int = 1000) -> tuple[Array, Array, Array]:
    """Dang Van's stress at each of n points, (n,), the largest shear stress of it, (n,), and the
    normal of its plane, (n, 3).

    paths: (n, t, 6). slope: c, of the hydrostatic stress.
    With s the deviator and s0 the centre of the smallest sphere around its path, Dang Van's stress
    is the largest tau + c s_h of the path: tau is the largest shear stress of s - s0, s_h the
    hydrostatic stress (Dang Van, ASTM STP 1191, 1993). The shear stress is the largest tau alone.
    The normal is that of the flatter one of the two planes of tau where tau + c s_h is largest, z
    being upright. As many steps towards the farthest point find the centre to about their inverse
    of the radius (Badoiu and Clarkson, 2003).
    """
    hydrostatic = paths[..., :3].mean(axis=-1)
    deviator = paths.copy()
    deviator[..., :3] -= hydrostatic[..., None]
    scaled, each = deviator * np.sqrt(TWICE), np.arange(len(paths))
    centre, squares = scaled.mean(axis=1), (scaled**2).sum(axis=-1)
    for step in range(1, steps + 1):
        farthest = (squares - 2 * (scaled @ centre[..., None])[..., 0]).argmax(axis=1)
        centre += (scaled[each, farthest] - centre) / (step + 1)
    alternating = deviator - (centre / np.sqrt(TWICE))[:, None]
    ends = principal(alternating.reshape(-1, 6))
    shear = (ends[:, 0] - ends[:, 2]).reshape(hydrostatic.shape) / 2
    total = shear + slope * hydrostatic
    worst = total.argmax(axis=1)
    axes = directions(alternating[each, worst])
    planes = np.stack([axes[:, 0] + axes[:, 2], axes[:, 0] - axes[:, 2]]) / math.sqrt(2)
    flatter = np.abs(planes[:, :, 2]).argmax(axis=0)
    return total[each, worst], shear.max(axis=1), planes[flatter, each]


def findley(paths: Array, slope: float) -> tuple[Array, Array]:
    """Findley's stress, MPa, at the worst of n points and the normal (..., 3) of its plane: the
    largest amplitude of the shear stress on a plane plus k times the largest normal stress on it
    (Findley, J. Eng. Ind. 81, 1959).

    paths: (..., n, t, 6); each n points by themselves. slope: k.
    The amplitude is half the longest chord of the shear stress' path on the plane. Planes and
    directions of chords are tried about 15 degrees apart (STEP), on long paths with at least 64
    (FEWEST) of their stresses; then those beside the two best planes (STARTS) with all, in steps
    that are halved where none is better, down to 0.25 degrees (FINEST).
    """
    groups = paths.reshape(-1, *paths.shape[-3:])
    turns = range(round(math.pi / STEP))
    tilts = STEP * np.arange(round(math.pi / 2 / STEP) + 1)
    rings = [(tilt, max(round(2 * len(turns) * math.sin(tilt)), 1)) for tilt in tilts]
    planes = [(tilt, 2 * math.pi * n / ring) for tilt, ring in rings for n in range(ring)]
    angles = np.array([[(*plane, STEP * turn) for turn in turns] for plane in planes])
    lattice, normals = _weights(angles), _vectors(angles[:, 0])[0]
    near = np.abs(normals @ normals.T) > math.cos(2 * STEP)
    path, start = [], []
    for group in groups:
        thinned = group[:, :: max(group.shape[1] // FEWEST, 1)]
        values = np.array([_on_planes(each, *lattice, slope) for each in thinned])
        for _ in range(STARTS):
            point, plane, turn = np.unravel_index(int(values.argmax()), values.shape)
            path.append(group[point])
            start.append(angles[plane, turn])
            values[:, near[plane]] = -np.inf

    way, at, each = np.array(path), np.array(start), np.arange(len(path))
    beside, size = np.array([*product((0.0, -1.0, 1.0), repeat=3)]), np.full(len(path), STEP / 2)
    while (size > FINEST).any():
        around = at[:, None] + size[:, None, None] * beside
        values = _on_planes(way, *_weights(around[:, :, None]), slope)[..., 0]
        best = values.argmax(axis=1)
        size = np.where(best == 0, size / 2, size)
        at = around[each, best]
    values = values.max(axis=1).reshape(-1, STARTS)
    first = np.arange(len(groups)) * STARTS + values.argmax(axis=1)
    shape = paths.shape[:-3]
    return values.max(axis=1).reshape(shape), _vectors(at[first])[0].reshape(*shape, 3)


def _on_planes(path: Array, shear: Array, normal: Array, slope: float) -> Array:
    """Findley's stress (..., m, k), MPa, of a path (..., t, 6) on m planes with chords in k
    directions, by the weights of `_weights`.
    """
    flat = shear.reshape(*shear.shape[:-3], -1, 6)
    chords = np.ptp(path @ np.swapaxes(flat, -1, -2), axis=-2).reshape(shear.shape[:-1])
    pulled = (path @ np.swapaxes(normal, -1, -2)).max(axis=-2)
    return np.asarray(chords / 2 + slope * pulled[..., None])


def _weights(angles: Array) -> tuple[Array, Array]:
    """Weights of xx, yy, zz, xy, xz, yz in the shear stress on m planes along k directions each,
    (..., m, k, 6), and in the normal stress (..., m, 6). angles: (..., m, k, 3), as of `_vectors`.
    """
    normals, along = _vectors(angles)
    i, j = np.array([0, 1, 2, 0, 0, 1]), np.array([0, 1, 2, 1, 2, 2])
    shear, normal = (
        (normals[..., i] * each[..., j] + normals[..., j] * each[..., i]) * TWICE / 2
        for each in (along, normals)
    )
    return shear, normal[..., 0, :]


def _vectors(angles: Array) -> tuple[Array, Array]:
    """Unit normals (..., 3) of planes and unit vectors (..., 3) in them, by angles (..., 3), rad:
    tilt of the normal from z, its turn about z, and turn of the vector in the plane.
    """
    (a, b, c), (u, v, w) = (np.moveaxis(each(angles), -1, 0) for each in (np.cos, np.sin))
    normals = np.stack([u * b, u * v, a], axis=-1)
    along = np.stack([w * -v + c * a * b, w * b + c * a * v, -c * u], axis=-1)
    return normals, along

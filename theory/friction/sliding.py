"""Stresses below a Hertz contact that slides: under a pressure p and a traction mu p at once.

The body is the half-space z <= 0, dragged along +x; tension is positive. The origin is the centre
of the patch; x runs along the rail, y across it, z out of the body. Lengths in mm, stresses in MPa.
Known closed forms: Hamilton and Goodman 1966, Hamilton 1983 (circle), Sackfield and Hills 1983
(ellipse), Johnson, Contact Mechanics, 7.1 (strip).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from railhead.theory.array_types import Array, Complex
from railhead.theory.elastic.hertz import Ellipse
from railhead.theory.elastic.line import Hertz, LineContact
from railhead.theory.elastic.subsurface import half_space_points, von_mises

DIRECTIONS, DIGITS = (36, 720), 18.0  # fewest and most plane waves; logarithm of their precision
AT_ONCE = 50_000  # waves times points that are added up in one step
ZOOMS = 4  # grids, each finer than the last, on which the largest stress is looked for
SURFACE = 1e-14  # least depth over the half width: beside a branch cut, not on it


@dataclass(frozen=True)
class PeakStress:
    """Largest von Mises stress in the plane y = 0, along the rail through the middle of the patch,
    between the depths that were searched. The drag always acts along the rail. Where the width of a
    pressed strip runs across the rail, this plane holds the strip's line.

    von_mises: MPa.
    x: place along the rail from the centre of the patch, mm; a positive coefficient of friction
        drags the half-space to +x.
    depth: below the surface, mm; 0 only where the surface alone was searched.
    """

    von_mises: float
    x: float
    depth: float


def stress(contact: Hertz, friction: float, poisson: float, points: ArrayLike) -> Array:
    """Stress (n, 6), columns xx, yy, zz, xy, xz, yz, MPa, at points (n, 3), mm, of the half-space z
    <= 0 under Hertz's pressure p and a traction friction * p that acts on it along +x. Axes lie
    at the centre of the patch: x along the rail, y across it, z out of the body.

    The pressure is a sum of plane waves, and a wave of pressure and traction needs only plane
    strain and shear out of its plane. Of the waves of one direction e, those of all lengths add up
    in closed form. For an ellipse, whose sections across e hold C (1 - s^2/m^2) with m^2 = a^2
    e_x^2 + b^2 e_y^2, C = pi a b p0/(2 m), s = x e_x + y e_y, with w = (s + i depth)/m and L =
    ln((w + 1)/(w - 1)), the sums are

        I_0 = -(2 C/m) (w L - 2)      I_1 = (2 i C depth/m^2) (L - 2 w/(w^2 - 1))

    for waves exp(-k depth) and k depth exp(-k depth). Directions e ~ (b cos t, a sin t) are even in
    t. The midpoint rule is exact to rounding on the patch and deeper than a tenth of it, 1e-3 p0 at
    its edge and 5e-3 p0 on the surface beside it. Its error falls as exp(-2 n h) with the number n
    of directions, as the nearest branch point lies h = depth/max(a, b) beside real angles t. Of a
    strip there is one direction, and I_0 = i F/pi in the terms of `theory.elastic.line`.
    ValueError: a point above the surface, or another shape.
    """
    xyz = half_space_points(points)
    x, y, depth = xyz[:, 0], xyz[:, 1], -xyz[:, 2]
    if isinstance(contact, LineContact):
        direction = np.array([0.0, 1.0] if contact.across else [1.0, 0.0])
        i_0, i_1 = _strip_waves(contact, y if contact.across else x, depth)
        return _plane_wave(i_0, i_1, direction, friction, poisson)
    a, b, total = contact.a, contact.b, np.zeros((len(xyz), 6))
    shallowest = max(float(depth.min(initial=math.inf)), SURFACE)
    count = math.ceil(np.clip(DIGITS * max(a, b) / shallowest, *DIRECTIONS))
    angles = math.pi / count * (np.arange(count)[:, None] + 0.5)
    for t in np.array_split(angles, 1 + count * len(xyz) // AT_ONCE):
        e = np.array([b * np.cos(t), a * np.sin(t)])
        length = np.linalg.norm(e, axis=0)
        e /= length
        i_0, i_1 = _ellipse_waves(contact, e, x * e[0] + y * e[1], depth)
        waves = _plane_wave(i_0, i_1, e, friction, poisson)
        total += np.einsum("t,tnc->nc", (a * b / length**2).ravel(), waves)
    return np.asarray(total / (2 * math.pi * count))


def peaks(contact: Hertz, friction: float, poisson: float) -> dict[str, PeakStress]:
    """Largest von Mises stresses in the plane along x through the middle of the patch. friction:
    coefficient mu.

    below: between depths of 0.1 and 1.5 times the smaller half length, of a line contact its half
        width, to 1e-4 (relative).
    surface: on the surface, to 1e-3. With friction it lies at the trailing edge, x = -a.
    """
    depth = min(contact.half_lengths)
    depths = {"below": (0.1 * depth, 1.5 * depth), "surface": (0.0, 0.0)}
    return {name: _highest(contact, friction, poisson, ends) for name, ends in depths.items()}


def _highest(
    contact: Hertz, friction: float, poisson: float, depths: tuple[float, float]
) -> PeakStress:
    """Largest von Mises stress in the plane y = 0 between two depths (mm), on grids that shrink
    around the highest point of the grid before. friction: coefficient mu.
    """
    a, _ = contact.half_lengths
    low, high = np.array([-1.2 * a, depths[0]]), np.array([1.2 * a, depths[1]])
    lowest, highest = low, high
    for _ in range(ZOOMS):
        x, depth = (np.unique(np.linspace(*ends, 13)) for ends in zip(low, high, strict=True))
        grid = np.stack(np.meshgrid(x, depth, indexing="ij"), axis=-1).reshape(-1, 2)
        points = np.column_stack((grid[:, 0], np.zeros(len(grid)), -grid[:, 1]))
        values = von_mises(stress(contact, friction, poisson, points))
        best = grid[np.argmax(values)]
        reach = (high - low) / 6
        low, high = np.maximum(best - reach, lowest), np.minimum(best + reach, highest)
    return PeakStress(float(values.max()), float(best[0]), float(best[1]))


def _strip_waves(contact: LineContact, s: Array, depth: Array) -> tuple[Complex, Complex]:
    """I_0 and I_1, (n,) complex, MPa: sums of the waves exp(-k depth) and k depth exp(-k depth) of
    a strip at distances s and depths (n,), mm.
    """
    w = contact.half_width
    zeta = s + 1j * np.maximum(depth, SURFACE * w)
    root = np.sqrt(zeta - w) * np.sqrt(zeta + w)
    potential = contact.p0 * w / (zeta + root)  # F/pi
    return 1j * potential, -depth * potential / root


def _ellipse_waves(contact: Ellipse, e: Array, s: Array, depth: Array) -> tuple[Complex, Complex]:
    """I_0 and I_1, (t, n) complex, MPa: sums of the waves exp(-k depth) and k depth exp(-k depth)
    of an ellipse in t directions e (2, t, 1), unit vectors, at s = x e_x + y e_y (t, n) and depths
    (n,), mm.
    """
    m = np.hypot(contact.a * e[0], contact.b * e[1])
    C = math.pi * contact.a * contact.b * contact.p0 / (2 * m)
    w = s / m + 1j * np.maximum(depth / m, SURFACE)
    L = np.log((w + 1) / (w - 1))
    return -2 * C / m * (w * L - 2), 2j * C / m**2 * depth * (L - 2 * w / (w * w - 1))


def _plane_wave(i_0: Complex, i_1: Complex, e: Array, friction: float, poisson: float) -> Array:
    """Stress (..., n, 6), columns xx, yy, zz, xy, xz, yz, MPa, of waves exp(i k s - k d) of a
    pressure p and a traction friction * p along x: the real part of the sum over all wave numbers.

    i_0, i_1: sums of p exp(-k d) and of p k d exp(-k d), (..., n) complex, MPa; e (2, ...): unit
        vector of s, the direction of the waves in the surface; d: depth; t: across s.
    In the plane of s and d: under p, s_ss = -(1 - k d) p, s_dd = -(1 + k d) p, s_sd = i k d p;
    under q along s, s_ss = i (2 - k d) q, s_dd = i k d q, s_sd = -(1 - k d) q; under q across,
    s_td = -q and s_st = i q.
    """
    along, across = friction * e[0], -friction * e[1]
    ss = (i_1 - i_0 + 1j * along * (2 * i_0 - i_1)).real
    dd = (-i_0 - i_1 + 1j * along * i_1).real
    sd = (1j * i_1 - along * (i_0 - i_1)).real
    tt, td, st = poisson * (ss + dd), (-across * i_0).real, (1j * across * i_0).real
    c, s = e
    return np.stack(
        (
            c * c * ss - 2 * c * s * st + s * s * tt,
            s * s * ss + 2 * c * s * st + c * c * tt,
            dd,
            c * s * (ss - tt) + (c * c - s * s) * st,
            s * td - c * sd,  # z points up
            -s * sd - c * td,
        ),
        axis=-1,
    )

"""Rigid parabolas and paraboloids on an elastic layer bonded to a rigid base.

In plane strain p(t) = sqrt(1 - t^2) sum c_n U_2n(t), t = x/a, vanishes at both ends, so a is where
it does. The slope of the surface, u' = -x/R, is that of the half-plane, a sum of Chebyshev
polynomials, and a smooth rest: the compliance of the layer over that of the half-plane, less one,
in wave numbers. That of a bonded layer follows from plane strain in Fourier space; its limits are
tested. In space it is the same in wave numbers of any direction.
"""

import numpy as np
from numpy.polynomial import Polynomial
from scipy.fft import irfft2, rfft2
from scipy.interpolate import RectBivariateSpline
from scipy.optimize import brentq

TERMS, POINTS, WAVES = 16, 120, 400


def relative_compliance(kh, poisson: float):
    """Of the bonded layer over the half-plane, at wave number times thickness."""
    kappa, kh = 3 - 4 * poisson, np.minimum(kh, 300.0)
    above = 2 * kappa * np.sinh(2 * kh) - 4 * kh
    return above / (2 * kappa * np.cosh(2 * kh) + 1 + kappa**2 + 4 * kh**2)


def strip(
    load: float, radius: float, young: float, poisson: float, thickness: float
) -> tuple[float, float]:
    """Half width (mm) and largest pressure (MPa) under a load, N/mm."""
    modulus = young / (2 * (1 - poisson**2))
    nodes, weights = np.polynomial.legendre.leggauss(WAVES)
    top = 20 / thickness
    wave, weights = (nodes + 1) / 2 * top, weights / 2 * top
    rest = (relative_compliance(wave * thickness, poisson) - 1) * weights
    at = np.cos((np.arange(POINTS // 2) + 0.5) * np.pi / POINTS)
    angle = (np.arange(2 * POINTS) + 0.5) * np.pi / (2 * POINTS)
    orders = 2 * np.arange(TERMS)
    basis = np.sin(np.multiply.outer(angle, orders + 1)) * np.sin(angle)[:, None]
    basis *= np.pi / (2 * POINTS)

    def terms(half: float):
        inner = np.cos(half * np.multiply.outer(wave, np.cos(angle))) @ basis  # the rest is even
        smooth = half * np.sin(half * np.multiply.outer(at, wave)) * rest @ inner
        slope = np.pi * np.cos(np.multiply.outer(np.arccos(at), orders + 1)) + smooth
        found = np.linalg.lstsq(slope / (np.pi * modulus), half * at / radius, rcond=None)[0]
        return np.asarray(found)

    def excess(half: float) -> float:
        return float(half * terms(half)[0] * np.pi / 2 - load)

    half = float(brentq(excess, 1e-3 * thickness, radius / 10))
    return half, float(terms(half) @ (-1.0) ** np.arange(TERMS))


def patch(
    load: float,
    radii: tuple[float, float],
    young: float,
    poisson: float,
    thickness: float,
    reach: tuple[float, float],
    cells: int = 128,
) -> dict[str, float]:
    """Half lengths along both radii (mm), area (mm2) and largest pressure (MPa) of a rigid
    paraboloid: conjugate gradients on cells (I. A. Polonsky and L. M. Keer, Wear 231, 1999) in a
    box of half the size `reach`, in a period four times as long."""
    step = 2 * np.array(reach) / cells
    x, y = ((np.arange(cells) - cells / 2 + 0.5) * size for size in step)
    gap = x[:, None] ** 2 / (2 * radii[0]) + y**2 / (2 * radii[1])
    period = 4 * cells
    kx = 2 * np.pi * np.fft.fftfreq(period, step[0])[:, None]
    ky = 2 * np.pi * np.fft.rfftfreq(period, step[1])
    wave = np.maximum(np.hypot(kx, ky), 1e-9)
    compliance = 2 * (1 - poisson**2) / young / wave
    compliance *= relative_compliance(wave * thickness, poisson)
    compliance[0, 0] = thickness * (1 + poisson) * (1 - 2 * poisson) / (young * (1 - poisson))
    compliance *= np.sinc(kx * step[0] / (2 * np.pi)) * np.sinc(ky * step[1] / (2 * np.pi))

    def deflection(p):
        shape = (period, period)
        return np.asarray(irfft2(rfft2(p, shape) * compliance, shape)[:cells, :cells])

    total = load / step.prod()
    p = np.sqrt(np.maximum(1 - (1.3 * x[:, None] / reach[0]) ** 2 - (1.3 * y / reach[1]) ** 2, 0))
    p *= total / p.sum()
    direction, square, going = np.zeros_like(p), 1.0, 0.0
    for _ in range(300):
        residual, on = deflection(p) + gap, p > 0
        residual -= residual[on].mean()
        square, before = float((residual[on] ** 2).sum()), square
        direction = np.where(on, going * square / before * direction - residual, 0.0)
        change = deflection(direction)
        change -= change[on].mean()
        length = -(residual[on] @ direction[on]) / (change[on] @ direction[on])
        last, p = p, np.maximum(p + length * direction, 0.0)
        back = (p == 0) & (residual < 0)
        p[back] -= length * residual[back]
        going = float(not back.any())
        p *= total / p.sum()
        if np.abs(p - last).sum() < 1e-6 * total:
            break
    squared = RectBivariateSpline(x, y, p**2, kx=1, ky=1)

    def end(angle: float) -> float:
        """Where p^2 vanishes: a cubic through its last quarter."""
        c, s = np.cos(angle), np.sin(angle)
        r = np.linspace(0.0, 1 / np.hypot(c / reach[0], s / reach[1]), 4 * cells)
        outer = r[squared.ev(r * c, r * s) > 0].max()
        r = np.linspace(0.75, 0.97, 80) * outer
        roots = Polynomial.fit(r, squared.ev(r * c, r * s), 3).roots()
        return float(min(roots.real, key=lambda root: abs(root - outer)))

    angles, turns = (np.arange(60) + 0.5) * np.pi / 120, 2 * np.arange(4)
    squares = np.array([end(angle) for angle in angles]) ** -2.0  # smooth all the way round
    series = np.linalg.lstsq(np.cos(np.multiply.outer(angles, turns)), squares, rcond=None)[0]
    area = float((1 / (np.cos(np.multiply.outer(angles, turns)) @ series)).sum() * np.pi / 60)
    a, b = (float((np.cos(turns * angle) @ series) ** -0.5) for angle in (0.0, np.pi / 2))
    return {"a_mm": a, "b_mm": b, "area_mm2": area, "max_MPa": float(p.max())}

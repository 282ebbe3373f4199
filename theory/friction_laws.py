"""What lies between two surfaces that roll: coefficients of friction that depend on slip or on
temperature and follow along the rail, heat, and an elastic layer.

Of a static coefficient mu_0, a kinetic one mu_k, and a slip velocity s_h at which half of their
difference is gone, at a slip velocity s:

    exponential  mu = mu_k + (mu_0 - mu_k) 2^(-s/s_h)
    linear       mu = mu_k + (mu_0 - mu_k) max(0, 1 - s/(2 s_h))

Rolling with friction that falls with slip has several steady solutions (Vollebregt and
Schuttelaars, J. Sound Vib. 331, 2012), unless the coefficient follows its law mu(s) along a memory
length d_c:

    d mu/dx = (mu(s) - mu)/d_c    with mu_0 at the leading edge, x being the way through the patch

Heat flows into each body alone along its normal, as the surfaces pass the patch much faster than
heat spreads (Peclet number V a rho c/lambda of 10 and more; Carslaw and Jaeger; Ertz and Knothe,
Wear 253, 2002). A flux q that a body takes raises its surface, s behind the leading edge, by

    T(s) = 1/sqrt(pi lambda rho c V) int_0^s q(t)/sqrt(s - t) dt

Where two like bodies touch, they share the mean of their bulk temperatures at once.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from railhead.theory.array_types import Array, Mask

DENSITY = 7850.0  # kg/m3, steel

TURNS, SETTLED = 60, 1e-7  # between tractions and coefficient; change of the bound, relative
SLOWEST = 0.02  # least part of a change of the coefficient that is taken
ALIKE = 1e-3  # of mu N: most by which the bounds of two steady states may differ
LONGER = "the law falls too steeply; give a longer memory (friction.memory in a scene)"

Solved = TypeVar("Solved")


@dataclass(frozen=True, kw_only=True)
class Heat:
    """Two bodies of one material that roll, their warmth, and how they divide the heat of friction.
    The constants are steel's (Ertz and Knothe, Wear 253, 2002).

    speed: V of rolling, m/s.
    bulk_rail, bulk_wheel: temperatures far from the patch, deg C.
    conductivity: lambda, W/(m K).
    density: rho, kg/m3.
    specific_heat: c, J/(kg K).
    share: of the heat of friction that the rail takes, 0 to 1; with 1/2 both surfaces are equally
        hot.
    """

    speed: float
    bulk_rail: float = 0.0
    bulk_wheel: float = 0.0
    conductivity: float = 50.0
    density: float = DENSITY
    specific_heat: float = 450.0
    share: float = 0.5

    @property
    def bulk(self) -> Array:
        """Bulk temperatures of rail and wheel, (2,), deg C."""
        return np.array([self.bulk_rail, self.bulk_wheel])

    def temperatures(self, x: Array, flux: Array) -> Array:
        """Temperatures of the surfaces of rail and wheel (2, nx, ny), deg C, in a patch that moves
        to +x, under a heat flux of friction (nx, ny), W/mm2. x (nx,): cell centres, mm.
        """
        taken = np.array([self.share, 1 - self.share])[:, None, None] * flux
        return np.asarray(self.bulk.mean() + self._weights(x) @ taken)

    def _weights(self, x: Array) -> Array:
        """Rise at each cell by a flux of 1 W/mm2 in each cell of its line, (nx, nx), K mm2/W. A
        flux that is constant in a cell of half width h adds 2 (sqrt(d + h) - sqrt(d - h)) at a
        distance d behind its centre, and 2 sqrt(h) there.
        """
        half = (x[1] - x[0]) / 2
        behind = np.maximum(x[None, :] - x[:, None] + half * np.array([1, -1])[:, None, None], 0.0)
        near, far = np.sqrt(1e-3 * behind)  # to the front and the rear end of a cell, sqrt(m)
        product = self.conductivity * self.density * self.specific_heat * self.speed
        return np.asarray(2e6 / math.sqrt(math.pi * product) * (near - far))


@dataclass(frozen=True)
class Falling:
    """A coefficient that falls (or rises) with slip from a static to a kinetic one.

    kinetic: coefficient at large slip velocities.
    half: slip velocity at which half of the difference is gone, mm/s.
    linear: whether it falls linearly, else exponentially.
    """

    kinetic: float
    half: float
    linear: bool = False

    def __call__(self, static: Array, slip: Array, temperature: Array) -> Array:
        """Coefficient (nx, ny) of the static coefficient, the slip velocity (mm/s) and the mean
        temperature of both surfaces (deg C), each (nx, ny).
        """
        gone = slip / self.half
        left = np.maximum(1 - gone / 2, 0.0) if self.linear else 2.0**-gone
        return np.asarray(self.kinetic + (static - self.kinetic) * left)

    def largest(self, static: Array, bulk: float) -> Array:
        """Largest coefficient (nx, ny) at any slip; static: (nx, ny)."""
        return np.maximum(static, self.kinetic)


@dataclass(frozen=True)
class ByTemperature:
    """A coefficient that depends on the temperature: linear between pairs, constant beyond.

    table: pairs of temperature (deg C, rising) and coefficient.
    """

    table: tuple[tuple[float, float], ...]

    @property
    def kinetic(self) -> float:
        """Last coefficient of the table."""
        return self.table[-1][1]

    def __call__(self, static: Array, slip: Array, temperature: Array) -> Array:
        """Coefficient (nx, ny), as of `Falling`."""
        return np.interp(temperature, *np.transpose(self.table))

    def largest(self, static: Array, bulk: float) -> Array:
        """Largest coefficient (nx, ny) from a temperature on, deg C: friction does not cool."""
        most = max(np.interp(max(hot, bulk), *np.transpose(self.table)) for hot, _ in self.table)
        return np.full(static.shape, most)


Law = Falling | ByTemperature


@dataclass(frozen=True, kw_only=True)
class Interface:
    """What lies between two surfaces that roll, beside Coulomb's friction.

    heat: warmth of the bodies; its speed is that of slip, too.
    law: of the coefficient; None: it is the static one everywhere.
    memory: length along which the coefficient follows its law, mm; None: the length of a cell for
        a law of slip, else 0.
    layer: an elastic layer's thickness over its shear modulus, mm/MPa.
    """

    heat: Heat | None = None
    law: Law | None = None
    memory: float | None = None
    layer: float = 0.0

    def rise(self, x: Array, traction: Array, slip: Array) -> Array | None:
        """Rise of the surfaces of rail and wheel (2, nx, ny) above the bulk of each body, K, at
        tractions (2, nx, ny), MPa, and a slip (2, nx, ny) per rolled length; x (nx,): cell centres,
        mm. None without `heat`.
        """
        if self.heat is None:
            return None
        hot = self.heat.temperatures(x, self.heat.speed * (traction * slip).sum(axis=0))
        return np.asarray(hot - self.heat.bulk[:, None, None])

    def largest(self, static: Array) -> Array:
        """Largest coefficient (nx, ny) that the law has at any slip; static: (nx, ny)."""
        if self.law is None or self.heat is None:
            return static
        return np.maximum(static, self.law.largest(static, float(self.heat.bulk.mean())))

    def coefficient(
        self, x: Array, static: Array, inside: Mask, slip: Array, rise: Array | None
    ) -> Array:
        """Coefficient (nx, ny) by the law. static: coefficient; inside: whether a cell lies in the
        patch; both (nx, ny). slip: half a cell ahead of the centres; rise: as of `rise`.
        ValueError: a law without `heat`.
        """
        if self.law is None or self.heat is None or rise is None:
            raise ValueError("a law of friction needs a speed")
        velocity = 1e3 * self.heat.speed * np.linalg.norm(slip, axis=0)
        aim = self.law(static, velocity, rise.mean(axis=0) + self.heat.bulk.mean())
        length = self.memory
        if length is None:
            length = float(x[1] - x[0]) if isinstance(self.law, Falling) else 0.0
        return followed(aim, static, inside, (x[1] - x[0]) / length) if length else aim

    def along_line(
        self, x: Array, static: Array, pressure: Array, traction: Array, slip: Array
    ) -> tuple[Array, Array | None]:
        """Coefficient (n,) by the law, or without one the static one, and rises of the surfaces of
        rail and wheel (2, n), K, or None, at n places x, mm, of a line in any order. static:
        coefficient; pressure, traction along x, MPa; slip along x at the places themselves.
        """
        order = np.argsort(x)
        grid = np.linspace(x.min(), x.max(), len(x))
        mu, p, *rest = (
            np.interp(grid, x[order], each[order])[:, None]
            for each in (static, pressure, traction, slip)
        )
        q, s = np.array(rest)[:, None]
        rise = self.rise(grid, q, s)
        if self.law is not None:
            mu = self.coefficient(grid, mu, p > 0, s, rise)
        hot = None if rise is None else np.array([np.interp(x, grid, each[:, 0]) for each in rise])
        return np.interp(x, grid, mu[:, 0]), hot


def settled(
    bound: Array, solve: Callable[[Array, Solved | None], Solved], law: Callable[[Solved], Array]
) -> Solved:
    """Tractions under the bound that a law has at their slip, in turns with Aitken's factor.

    bound: the first one, of any shape. solve: tractions under a bound, from those of the turn
    before. law: the bound at the slip of such tractions. After the bound has settled there is one
    turn more. ValueError: they do not settle.
    """
    before, factor = np.zeros_like(bound), 1.0
    found: Solved | None = None
    for _ in range(TURNS):
        found = solve(bound, found)
        change = law(found) - bound
        if np.abs(change).sum() <= SETTLED * bound.sum():
            return solve(bound + change, found)
        if before.any():
            turned = change - before
            factor *= -float((before * turned).sum() / (turned * turned).sum())
            factor = min(max(factor, SLOWEST), 1.0)
        bound, before = bound + factor * change, change
    raise ValueError(f"tractions and coefficient of friction do not settle; {LONGER}")


def agree(bound: Array, other: Array) -> None:
    """Raise ValueError where the bounds of the tractions of two steady states, of any shape, differ
    by more than 1e-3 (ALIKE) of their sum.
    """
    apart = np.abs(bound - other).sum() / bound.sum()
    if apart > ALIKE:
        raise ValueError(f"several steady states, {apart:.2g} of mu N apart; {LONGER}")


def followed(aim: Array, start: Array, inside: Mask, step: float) -> Array:
    """Coefficient (nx, ny) that follows another one, `aim`, along x from the last cell of a line to
    the first: d mu/dx = (aim - mu)/d_c, exact where `aim` is constant in each cell.

    start: coefficient where a line enters the patch; inside: whether a cell lies in the patch;
        both (nx, ny). step: length of a cell over d_c.
    """
    found, share = start.copy(), -np.expm1(-step)
    for i in range(len(aim) - 1, -1, -1):
        ahead = np.where(inside[i + 1], found[i + 1], start[i]) if i + 1 < len(aim) else start[i]
        found[i] = np.where(inside[i], ahead + share * (aim[i] - ahead), start[i])
    return found

"""Forces of rolling ellipses over creepages: tables for programs that need thousands of them.

An ellipse of like half-spaces with semi-axes a (along) and b rolls under a normal force N with a
coefficient mu. Its forces over mu N depend on a/b, Poisson's ratio nu and the creepages, which are
given here as the forces over mu N that they would cause by Kalker's linear theory:

    X = G a b C11 xi_x/(mu N)    Y = G a b C22 xi_y/(mu N)    S = G (a b)^(3/2) C23 phi/(mu N)

so that force_along = X, and force_across = Y + S, where all are small. The moment is over
mu N sqrt(a b). Signs are those of `rolling`: forces of the wheel on the rail.

Under a coefficient that falls exponentially with slip from mu to mu_k (`laws`) they
depend on three more numbers, which one table has fixed: mu_k/mu, s_half G a b/(V mu N) at a speed
V, and the memory over sqrt(a b).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from railhead.theory.array_types import Array, packed, read_arrays
from railhead.theory.friction.kalker import coefficients
from railhead.theory.friction.rolling import (
    Creepage,
    HalfSpaceFriction,
    TangentialSolution,
    grid_over,
)
from railhead.theory.friction.tangential import MaterialPair
from railhead.theory.friction_laws import Falling, Heat, Interface

NORMAL = 2 * math.pi / 3  # N of an ellipse with a b = 1 and a largest pressure of 1
FARTHEST = 10.0  # X, Y and S, at most: beyond it the whole patch slips
NEAR = 2.0  # X, Y and S of most contacts, at most
PLACES = 90  # in 99 of 100 draws 95 % of all errors are within the largest: 0.95^90 < 0.01
FLAT, HELD = 0.75, 0.98  # shares of those places with less error than the rest, and than estimated
BESIDE = 0.7  # of the other creepages, where axes are refined
CUBIC = 4  # nodes that a cubic needs
AXES = "axis_ratio", "along", "across", "spin"
NUMBERS = "force_along", "force_across", "moment"
Law = tuple[float, float, float]
"""mu_k/mu, s_half G a b/(V mu N) and memory over sqrt(a b) of a law of friction."""


class Ellipse:
    """Rolling friction of an ellipse with a b = 1 mm2, G = 1 MPa, mu = 1 and a largest pressure of
    1 MPa, on two grids.

    scales: (3,) creepages along and across, and spin (1/mm), at X = 1, Y = 1, S = 1.
    """

    def __init__(
        self, axis_ratio: float, poisson: float, cells: int, law: Law | None = None
    ) -> None:
        """axis_ratio: a/b; cells: of the finer grid each way, even; law: of friction, None:
        Coulomb's. Raises ValueError for values that `kalker.coefficients` refuses.
        """
        linear = coefficients(axis_ratio, poisson)
        self.scales = NORMAL / np.array([linear.c11, linear.c22, linear.c23])
        self._law = law
        self._grids = [_friction(axis_ratio, poisson, n, law) for n in (cells // 2, cells)]
        self._last: list[TangentialSolution | None] = [None, None]

    def __call__(self, along: float, across: float, spin: float) -> Array:
        """Forces along and across over mu N and moment over mu N sqrt(a b), and their errors, (2,
        3), at X, Y and S. Both grids are extrapolated by the first order of the upstream
        differences; the error of each is the root mean square of the three changes from one grid
        to the other, as one alone may change little by chance. ValueError: a law has several steady
        states, or does not settle.
        """
        creepage = Creepage(*(self.scales * (along, across, spin)))
        for i, grid in enumerate(self._grids):
            self._last[i] = grid.solve(creepage, None if self._law else self._last[i])
        coarse, fine = (np.array(each.forces) / NORMAL for each in self._last if each)
        return np.array([2 * fine - coarse, np.full(3, np.sqrt(np.mean((fine - coarse) ** 2)))])


def _friction(axis_ratio: float, poisson: float, cells: int, law: Law | None) -> HalfSpaceFriction:
    """Friction of `Ellipse` on about cells x cells cells that cover the ellipse."""
    semi = math.sqrt(axis_ratio), 1 / math.sqrt(axis_ratio)
    grid = grid_over((0.0, 0.0), semi, cells)
    u, v = grid.x / semi[0], grid.s / semi[1]
    pressure = np.sqrt(np.clip(1 - u[:, None] ** 2 - v**2, 0.0, None))
    pressure *= NORMAL / (pressure.sum() * grid.cell)
    # At 1 mm/s slip velocities are slips per rolled length.
    surfaces = law and Interface(
        heat=Heat(speed=1e-3), law=Falling(law[0], law[1] * NORMAL), memory=law[2]
    )
    pair = MaterialPair(1.0, poisson)
    return HalfSpaceFriction(grid.x, grid.s, pressure, 1.0, pair, rolling=True, interface=surfaces)


def refined(
    function: Callable[[float], Array], ends: tuple[float, float], accuracy: float, *, log: bool
) -> list[float]:
    """Rising places from end to end, between which straight lines follow a function to an accuracy:
    intervals are halved until the value in their middle is that near to the line.

    function: value (n,) at a place. log: the middle is the geometric mean, else that of x/(1 + x).
    """

    def middle(low: float, high: float) -> float:
        """Middle of an interval."""
        if log:
            return math.sqrt(low * high)
        t = (low / (1 + low) + high / (1 + high)) / 2
        return t / (1 - t)

    known = {place: function(place) for place in ends}
    waiting = [ends]
    while waiting:
        low, high = waiting.pop()
        at = middle(low, high)
        share = math.log(at / low) / math.log(high / low) if log else (at - low) / (high - low)
        value, line = function(at), (1 - share) * known[low] + share * known[high]
        if np.abs(value - line).max() > accuracy:
            known[at] = value
            waiting += [(low, at), (at, high)]
    return sorted(known)


def axes(
    poisson: float,
    cells: int,
    accuracy: float,
    ratios: tuple[float, float],
    law: Law | None = None,
) -> dict[str, list[float]]:
    """Axes of a table, by AXES: axis ratios between two, X and Y from 0, S from -10 to 10
    (FARTHEST), finer where the forces bend. Straight lines along each axis follow them to
    the accuracy (over mu N), with the other creepages at 0 and at 0.7 (BESIDE) each. law: as of
    `Ellipse`.
    """

    def forces(ellipse: Ellipse, places: Iterable[Array]) -> Array:
        """Forces (3 n,) of an ellipse at n places X, Y, S."""
        return np.concatenate([ellipse(*place)[0] for place in places])

    circle, corners = (
        Ellipse(1.0, poisson, cells, law),
        np.array(list(product((0.0, BESIDE), repeat=3))),
    )

    def bent(axis: int) -> list[float]:
        """Places on an axis of creepage."""
        beside = corners[corners[:, axis] == 0]

        def at(value: float) -> Array:
            """Forces (12,) at a value of the creepage."""
            return forces(circle, beside + value * np.eye(3)[axis])

        return refined(at, (0.0, FARTHEST), accuracy, log=False)

    along, across, spin = map(bent, range(3))
    found = [ratios[0]]
    if ratios[1] > ratios[0]:
        found = refined(
            lambda ratio: forces(Ellipse(ratio, poisson, cells, law), corners[1:]),
            ratios,
            accuracy,
            log=True,
        )
    both = [-value for value in spin[:0:-1]] + spin
    return dict(zip(AXES, (found, along, across, both), strict=True))


def solve(
    poisson: float,
    cells: int,
    ratio: float,
    along: float,
    rest: Sequence[Sequence[float]],
    law: Law | None = None,
) -> Array:
    """Forces and errors (2, 3, m, k) of an ellipse at X = along and at all Y (m values) and S (k
    values) of `rest`; law: as of `Ellipse`.
    """
    ellipse = Ellipse(ratio, poisson, cells, law)
    across, spin = rest
    values = np.array([[ellipse(along, each, turn) for turn in spin] for each in across])
    return np.asarray(np.moveaxis(values, (2, 3), (0, 1)))


@dataclass(frozen=True, kw_only=True)
class CreepTable:
    """Forces of rolling ellipses over axis ratio and creepages; called with a contact it returns
    its forces.

    poisson: Poisson's ratio.
    cells: of the finer of both grids, each way.
    axes: rising values by name of AXES: a/b, X, Y and S.
    kalker: (3, r) Kalker's C11, C22 and C23 at the axis ratios.
    values: (2, 3, r, n, m, k) forces along and across over mu N and moment over mu N sqrt(a b), and
        the errors of the grid.
    interpolation: (3,) errors that 95 % of places are within (`checked`).
    law: of friction, as of `Ellipse`; None: Coulomb's.
    local: (2, 3) rest r and factor f of the error of interpolation at a place, f (d + r) by the
        difference d of cubics from straight lines there (`checked`).
    """

    poisson: float
    cells: int
    axes: dict[str, Array]
    kalker: Array
    values: Array
    interpolation: Array
    law: Law | None = None
    local: Array = field(default_factory=lambda: np.zeros((2, 3)))

    @cached_property
    def _at(self) -> RegularGridInterpolator:
        """Interpolator of forces along and across and of the moment, and of their errors, (6,), at
        log(a/b), X, Y, S: monotone cubics between the nodes.
        """
        ratio, *rest = (self.axes[name] for name in AXES)
        grid = np.moveaxis(self.values.reshape(6, *self.values.shape[2:]), 0, -1)
        if len(ratio) < CUBIC:  # few ratios near each other: the same forces beyond them
            more = CUBIC - len(ratio)
            ratio = np.append(ratio, ratio[-1] * (1 + np.arange(1, more + 1)))
            grid = np.concatenate([grid, np.repeat(grid[-1:], more, axis=0)])
        return RegularGridInterpolator((np.log(ratio), *rest), grid, method="pchip")

    def scaled(self, ratio: float, place: Array) -> tuple[Array, Array]:
        """Forces and errors, (3,) each, of an axis ratio at X, Y, S of either sign (3,), as of
        `_read`: the errors are those of the grid and of interpolation.
        """
        forces, grid, bent = self._read(ratio, place)
        return forces, np.hypot(grid, self.local[1] * (bent + self.local[0]))

    def _read(self, ratio: float, place: Array) -> tuple[Array, Array, Array]:
        """Forces, errors of the grid, and by how much cubics between the nodes differ from straight
        lines, (3,) each, of an axis ratio at X, Y, S of either sign (3,). X or Y beyond the table
        reduces all three together to its border. Raises ValueError for an axis ratio or S outside
        of the table, for what is not finite, and under a law for X and Y beyond it, too: forces go
        on falling.
        """
        low, high = self.axes["axis_ratio"][[0, -1]]
        if not low * (1 - 1e-9) <= ratio <= high * (1 + 1e-9):
            raise ValueError(f"a/b = {ratio:.4g} is outside of the table, {low:g} to {high:g}")
        if not (abs(place[2]) <= FARTHEST and np.isfinite(place).all()):
            raise ValueError(
                f"X, Y, S = {place} is not allowed; give finite ones, S within -10 to 10"
            )
        beyond = float(np.abs(place).max()) / FARTHEST
        if self.law and beyond > 1:
            raise ValueError(f"a creepage is {beyond:.3g} times the largest of a table with a law")
        place = place / max(1.0, beyond)
        x, y, turn = place
        mirrored = np.sign(y) if y else 1.0  # (x, -y, -s) has the mirrored forces
        at = [math.log(min(max(ratio, low), high)), abs(x), abs(y), mirrored * turn]
        found = self._at(at).reshape(2, 3)
        signs = np.array([np.sign(x), mirrored, mirrored])
        straight = self._at(at, method="linear").reshape(2, 3)
        return signs * found[0], found[1], np.abs(found[0] - straight[0])

    def __call__(
        self,
        a: float,
        b: float,
        shear_modulus: float,
        limit: float,
        *,
        along: float = 0.0,
        across: float = 0.0,
        spin: float = 0.0,
    ) -> tuple[Array, Array]:
        """Force along and across (N) and moment (N mm) of the wheel on the rail, and their errors,
        (3,) each, of an ellipse with semi-axes a along and b across, mm.
        shear_modulus: G, MPa. limit: mu N, N. along, across: creepages; spin: 1/mm. The numbers of
        a law are those of the table, whatever the contact. Raises ValueError as `scaled`, and for
        a, b, G and mu N that are not positive and finite.
        """
        given = {"a": a, "b": b, "shear_modulus": shear_modulus, "limit": limit}
        for name, value in given.items():
            if not 0 < value < math.inf:
                raise ValueError(f"{name} = {value} is not allowed; give a finite one above 0")
        c, nodes = math.sqrt(a * b), np.log(self.axes["axis_ratio"])
        kalker = np.array([np.interp(math.log(a / b), nodes, each) for each in self.kalker])
        motion = np.array([along, across, c * spin])
        forces, errors = self.scaled(a / b, shear_modulus * c * c * kalker * motion / limit)
        units = limit * np.array([1.0, 1.0, c])
        return units * forces, units * errors

    def checked(self, seed: int = 0) -> CreepTable:
        """The table with interpolation errors that hold at 95 % of all places with |X|, |Y| and |S|
        up to 2 (NEAR), and of all up to 10 (FARTHEST), with 99 % confidence: the largest at 90
        (PLACES) random ones of each, even in X, Y, S and log(a/b).

        The error at a place grows with the bend of the forces there. Three quarters (FLAT) of these
        places have less error than the rest r, and 98 % (HELD) less than f (d + r) of `local`.
        """
        random, off, bent = np.random.default_rng(seed), [], []
        nodes = np.log(self.axes["axis_ratio"])
        for most in (NEAR, FARTHEST):
            for place in random.uniform((0, 0, -most), most, (PLACES, 3)):
                log = random.uniform(nodes[0], nodes[-1])
                ellipse = Ellipse(math.exp(log), self.poisson, self.cells, self.law)
                linear = [np.interp(log, nodes, each) for each in self.kalker]
                exact = ellipse(*(place * NORMAL / linear / ellipse.scales))[0]
                forces, _, bend = self._read(math.exp(log), place)
                off.append(np.abs(exact - forces))
                bent.append(bend)
        rest = np.quantile(off, FLAT, axis=0)
        factor = np.quantile(off / (bent + rest), HELD, axis=0)
        return replace(self, interpolation=np.max(off, axis=0), local=np.array([rest, factor]))

    def save(self, path: str | Path) -> None:
        """Write a .npz file: the axes, `force_along`, `force_across`, `moment` (r, n, m, k), the
        same with `_error`, `kalker`, `poisson`, `cells`, `interpolation`, `local` and `law`, of
        Coulomb's without numbers. OSError as of writing.
        """
        named = dict(zip(NUMBERS, self.values[0], strict=True))
        named |= {f"{name}_error": each for name, each in zip(NUMBERS, self.values[1], strict=True)}
        rest: dict[str, Any] = {"kalker": self.kalker, "interpolation": self.interpolation}
        rest["local"] = self.local
        rest |= {"poisson": self.poisson, "cells": self.cells, "law": self.law or ()}
        Path(path).write_bytes(packed({**self.axes, **named, **rest}))

    @classmethod
    def load(cls, path: str | Path) -> CreepTable:
        """The table of a .npz file that `save` wrote. Raises ValueError or KeyError for another,
        OSError where it cannot be read.
        """
        held: dict[str, Any] = read_arrays(Path(path))
        values = [[held[name + end] for name in NUMBERS] for end in ("", "_error")]
        kinetic, half, memory = held["law"] if held["law"].size else (0.0, 0.0, 0.0)
        return cls(
            poisson=float(held["poisson"]),
            cells=int(held["cells"]),
            axes={name: held[name] for name in AXES},
            kalker=held["kalker"],
            values=np.array(values),
            interpolation=held["interpolation"],
            law=(kinetic, half, memory) if kinetic else None,
            local=held["local"],
        )

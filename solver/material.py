"""Constants of isotropic solids: elastic moduli, flow curves and back stresses."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from railhead.theory.array_types import Array, Index

LARGEST_EXPONENT = 30  # of the recall


@dataclass(frozen=True)
class Backstress:
    """A part X of the back stress that grows with plastic strain, and is recalled:

        dX = 2/3 C deps_p - g phi X dp,    phi = (|X| g / C)^chi

    with the von Mises size |X| and the equivalent plastic strain p (Armstrong and Frederick 1966,
    CEGB report RD/B/N731; chi > 0: Jiang and Sehitoglu 1996, J. Appl. Mech. 63:720).

    modulus: C, MPa, positive. recall: g, not negative; 0 is Prager's rule, without recall.
    """

    modulus: float
    recall: float = 0.0


@dataclass(frozen=True)
class Hardening:
    """Curve of uniaxial true stress over plastic strain, linear between its k points, and what
    cycles add to it.

    strain: plastic strain of the points (k,), ascending, the first 0.
    stress: stress of the points (k,), MPa; the first is the initial yield stress. Of a single point
        it and the slope after it may be arrays (n,) over points of a body, see `at`.
    kinematic: share of the curve's hardening, 0 to 1, by which the yield surface moves instead of
        growing (Prager's rule).
    final_hardening_modulus: slope d stress / d plastic strain after the last point, MPa.
    backstresses: parts of the back stress; with any, `kinematic` is 0.
    recall_exponent: chi of all backstresses; 0: Armstrong and Frederick.
    isotropic: (Q in MPa, b) of Voce's growth of the yield stress, Q (1 - exp(-b p)).
    """

    strain: tuple[float, ...]
    stress: tuple[float, ...]
    kinematic: float = 0.0
    final_hardening_modulus: float = 0.0
    backstresses: tuple[Backstress, ...] = ()
    recall_exponent: float = 0.0
    isotropic: tuple[float, float] = (0.0, 0.0)

    @classmethod
    def linear(cls, stress: float, modulus: float = 0.0, kinematic: float = 0.0) -> Hardening:
        """Curve with the initial yield stress `stress` (MPa) and the constant slope `modulus`, d
        stress / d plastic strain (MPa); kinematic: share of the hardening by which the yield
        surface moves.
        """
        return cls((0.0,), (stress,), kinematic, modulus)

    def cyclic(
        self,
        backstress: Sequence[Sequence[float]],
        recall_exponent: float = 0.0,
        isotropic: Sequence[float] = (0.0, 0.0),
    ) -> Hardening:
        """This curve with back stresses of pairs (C in MPa, g), a recall exponent and Voce's (Q in
        MPa, b). Raises ValueError (one line) for what is no pair, C that is not positive, another
        negative or infinite number, and a recall exponent between 0 and 1.
        """
        listed = backstress if isinstance(backstress, Sequence) else [backstress]
        pairs = {"backstress": listed, "isotropic": [isotropic]}
        for name, given in pairs.items():
            for each in given:
                least = 0 if name == "isotropic" else 1e-300
                right = np.shape(each) == (2,) and np.all(np.isfinite(each))
                if not right or each[0] < least or each[1] < 0:
                    what = "(Q, b), both 0 or more" if not least else "(C, g), C > 0 and g >= 0"
                    raise ValueError(f"{name} has {each!r}; give {what}")
        if not (recall_exponent == 0 or 1 <= recall_exponent <= LARGEST_EXPONENT):
            allowed = f"give 0, or 1 to {LARGEST_EXPONENT}"
            raise ValueError(f"recall_exponent is {recall_exponent!r}; {allowed}")
        parts = tuple(Backstress(float(c), float(g)) for c, g in backstress)
        voce = float(isotropic[0]), float(isotropic[1])
        return replace(
            self, backstresses=parts, recall_exponent=float(recall_exponent), isotropic=voce
        )

    def at(self, points: Index) -> Hardening:
        """The law at points with the given numbers (k,), where values are arrays over points."""
        single = self.stress[0], self.final_hardening_modulus
        if not any(map(np.ndim, single)):
            return self
        stress, slope = (np.broadcast_to(e, max(map(np.size, single)))[points] for e in single)
        own: dict[str, Any] = {"stress": (stress,), "final_hardening_modulus": slope}
        return replace(self, **own)

    @property
    def initial_yield_stress(self) -> float:
        """Stress at which plastic strain begins, MPa."""
        return self.stress[0]

    @cached_property
    def constants(self) -> tuple[Array, Array, Array]:
        """Modulus, MPa, and recall of the back stresses (b,), and what takes the norm of each to
        its von Mises size over its limit C/g. Prager's part is one where it has one modulus.
        """
        moves = self.kinematic and len(self.strain) == 1
        prager = self.kinematic * self.final_hardening_modulus if moves else 0.0
        modulus = np.array([each.modulus for each in self.backstresses] or [prager])
        recall = np.array([each.recall for each in self.backstresses] or [0.0])
        return modulus, recall, np.sqrt(1.5) * recall / np.maximum(modulus, 1e-300)

    @cached_property
    def segments(self) -> tuple[Array, Array, Array]:
        """Plastic strain and stress (MPa) of the points (k,), and the slope after each, MPa."""
        strain, stress = np.array(self.strain), np.array(self.stress)
        slopes = np.append(np.diff(stress) / np.diff(strain), self.final_hardening_modulus)
        return strain, stress, slopes

    def stress_and_slope(self, plastic: Array) -> tuple[Array, Array]:
        """Stress of the curve (n,) and its slope (n,), or (,) where it is one, MPa, at equivalent
        plastic strains (n,).
        """
        if len(self.strain) == 1:
            slope = np.asarray(self.final_hardening_modulus)
            return self.stress[0] + slope * plastic, slope
        strain, stress, slopes = self.segments
        segment = np.searchsorted(strain, plastic, side="right") - 1
        return stress[segment] + slopes[segment] * (plastic - strain[segment]), slopes[segment]

    def radius(self, plastic: Array) -> tuple[Array, Array]:
        """Stress kappa (n,), sqrt(3/2) times the radius of the yield surface, and its slope (n,),
        or (,) where it is one, MPa, at equivalent plastic strains (n,).
        """
        curve, slope = self.stress_and_slope(plastic)
        share, (most, rate) = 1 - self.kinematic, self.isotropic
        grown, slope = share * curve + self.kinematic * self.stress[0], share * slope
        if not most:
            return np.asarray(grown), np.asarray(slope)
        left = most * np.exp(-rate * plastic)
        return np.asarray(grown + most - left), np.asarray(slope + rate * left)


@dataclass(frozen=True)
class Material:
    """Isotropic solid.

    young_modulus: Young's modulus E, MPa; math.inf: the body is rigid.
    poisson_ratio: Poisson's ratio nu, in [0, 0.5).
    hardening: flow curve; None: the body stays elastic.
    Values may be arrays (k,) over the local cells of the body in rising order, ghosts included.
    """

    young_modulus: Any
    poisson_ratio: Any
    hardening: Hardening | None = None

    @property
    def lame(self) -> tuple[Any, Any]:
        """Lame's constants (lambda, mu), MPa."""
        e, nu = self.young_modulus, self.poisson_ratio
        return e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))


def backs(materials: Iterable[Material]) -> int:
    """Number of back stresses that the points of these materials need, at least 1."""
    laws = (each.hardening for each in materials)
    return max([1, *(len(law.backstresses) for law in laws if law)])

"""What a model is made of: bodies, contacts, supports and loads. Any consistent units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

from railhead.solver.material import Hardening, Material
from railhead.solver.space.supports import Clamp, Direction, Hub, Slide, finite
from railhead.solver.system.surfaces import Contact


@dataclass(frozen=True)
class Elastic:
    """Isotropic linear elasticity with Young's modulus and Poisson's ratio."""

    young_modulus: float
    poisson_ratio: float

    def __post_init__(self) -> None:
        """Raises ValueError for what is no finite number, a modulus that is not positive, and a
        ratio outside [0, 0.5).
        """
        for each in fields(Elastic):
            finite(type(self).__name__, each.name, getattr(self, each.name))
        if self.young_modulus <= 0:
            raise ValueError(f"young_modulus must be positive, not {self.young_modulus!r}")
        if not 0 <= self.poisson_ratio < 0.5:
            raise ValueError(f"poisson_ratio must lie in [0, 0.5), not {self.poisson_ratio!r}")

    def material(self, section: str | None) -> Material:
        """Elastic constants for a section. In plane stress they are those with which plane strain
        has the strains of plane stress: E (1 + 2 nu)/(1 + nu)^2 and nu/(1 + nu).
        """
        young, nu = self.young_modulus, self.poisson_ratio
        if section == "plane stress":
            return Material(young * (1 + 2 * nu) / (1 + nu) ** 2, nu / (1 + nu))
        return Material(young, nu)


@dataclass(frozen=True)
class Plastic(Elastic):
    """Elasticity, and von Mises yield.

    yield_stress: stress of first yield.
    hardening: slope of stress over plastic strain of linear isotropic hardening.
    backstress: pairs (C, g) of back stresses, see `Backstress`; g = 0 is linear kinematic.
    recall_exponent: chi of all back stresses: 0 (Armstrong and Frederick), or 1 and more (Jiang and
        Sehitoglu).
    isotropic: (Q, b) of Voce's growth of the yield stress, Q (1 - exp(-b p)).
    """

    yield_stress: float
    hardening: float = 0.0
    backstress: Sequence[tuple[float, float]] = ()
    recall_exponent: float = 0.0
    isotropic: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        """Raises ValueError as `Elastic`, for a yield stress that is not positive, a negative
        hardening, and for what `law` refuses.
        """
        super().__post_init__()
        if self.yield_stress <= 0 or self.hardening < 0:
            raise ValueError("yield_stress must be positive, and hardening not negative")
        self.law()

    def law(self) -> Hardening:
        """Law of yield. Raises ValueError (one line) as `Hardening.cyclic`."""
        curve = Hardening.linear(self.yield_stress, self.hardening)
        return curve.cyclic(self.backstress, self.recall_exponent, self.isotropic)

    def material(self, section: str | None) -> Material:
        """Elastic constants with the flow curve; raises ValueError in plane stress."""
        if section == "plane stress":
            raise ValueError("Plastic is not there in plane stress: use plane strain or 3-D")
        return Material(self.young_modulus, self.poisson_ratio, self.law())


@dataclass(frozen=True)
class Body:
    """Cells with a tag, their material, and a force per volume (c,)."""

    tag: int
    material: Elastic
    force: Direction | None = None


@dataclass(frozen=True)
class Force:
    """Force along the free direction of a hub, of the meshed part: in a plane section per
    unit of depth, in an axisymmetric one of the whole turn. move: motion (c,) of the hub across its
    free direction, from the start.
    """

    value: float
    move: Direction | None = None


@dataclass(frozen=True)
class Move:
    """Motion (c,) of a hub from the start of all loads."""

    vector: Direction


Part = Body | Contact | Clamp | Slide | Hub
Load = Force | Move

"""What a model is made of: bodies, contacts, supports and loads. Any consistent units.

Constants of materials are numbers, or dolfinx Functions that are constant in each cell (DG0).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Self

import numpy as np
from ufl.algorithms import extract_arguments

from railhead.solver import compat
from railhead.solver.material import Hardening, Material
from railhead.solver.space.supports import Clamp, Hub, Slide
from railhead.solver.space.vectors import Direction, finite
from railhead.solver.system.surfaces import Contact
from railhead.theory.array_types import Array, Index

OfPoints = Callable[[Array], Array]
"""Points (n, c) -> values at them."""


def cell_values(name: str, given: Any, cells: Index) -> Any:
    """Values of a dolfinx Function in local cells (k,); a number as it is. Raises ValueError for a
    Function that is no number in each cell, and for an array.
    """
    if not hasattr(given, "function_space"):
        if type(given) is np.ndarray and given.ndim:
            raise ValueError(f"{name} must be a number or a dolfinx Function (DG0), not an array")
        return given
    space = given.function_space
    dofs = compat.cell_dofs(space)
    if dofs.shape[1] * space.dofmap.index_map_bs != 1:
        raise ValueError(f"{name} must be one number in each cell: a Function of degree 0 (DG)")
    return given.x.array[dofs[cells, 0]]


@dataclass(frozen=True)
class Elastic:
    """Isotropic linear elasticity with Young's modulus and Poisson's ratio."""

    young_modulus: Any
    poisson_ratio: Any

    def __post_init__(self) -> None:
        """Raises ValueError for what is no finite number, a modulus that is not positive, and a
        ratio outside [0, 0.5).
        """
        self._must_lie("young_modulus", lambda x: x > 0, "positive")
        self._must_lie("poisson_ratio", lambda x: (x >= 0) & (x < 0.5), "in [0, 0.5)")

    def _must_lie(self, name: str, fits: Callable[[Array], Any], where: str) -> None:
        """Raise ValueError where a constant is no finite number or lies elsewhere; where: in words.
        A Function is looked at where the body is (`over`).
        """
        given = getattr(self, name)
        if hasattr(given, "function_space"):
            return
        shape = given.shape if type(given) is np.ndarray else ()
        values = finite(type(self).__name__, name, given, *shape)
        if not np.all(fits(values)):
            raise ValueError(f"{name} must be {where}, not {values[~fits(values)][0]}")

    def over(self, cells: Index) -> Self:
        """The material with arrays (k,) of the values in local cells in place of Functions. Raises
        ValueError as `cell_values` and for values that a number may not have.
        """
        given = {e.name: getattr(self, e.name) for e in fields(self)}
        found = {name: cell_values(name, value, cells) for name, value in given.items()}
        return replace(self, **found)

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

    yield_stress: Any
    hardening: Any = 0.0
    backstress: Sequence[tuple[float, float]] = ()
    recall_exponent: float = 0.0
    isotropic: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        """Raises ValueError as `Elastic`, for a yield stress that is not positive, a negative
        hardening, and for what `law` refuses.
        """
        super().__post_init__()
        self._must_lie("yield_stress", lambda x: x > 0, "positive")
        self._must_lie("hardening", lambda x: x >= 0, "0 or more")
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
class Energy:
    """A law of one's own, in finite strain.

    psi: energy per volume before deformation, a UFL expression of `Model.u`.
    """

    psi: Any

    def __post_init__(self) -> None:
        """Raises ValueError for what is no UFL expression of a number, and for test functions."""
        if getattr(self.psi, "ufl_shape", None) != () or extract_arguments(self.psi):
            given = f"{self.psi!s:.60}"
            raise ValueError(f"psi must be a UFL expression of a number, not {given}")


@dataclass(frozen=True)
class Body:
    """Cells with a tag, their material, and what loads them.

    force: per volume (c,), numbers or a dolfinx Function or UFL expression of vectors.
    thermal_strain: strain of all directions that carries no stress, a number or a Function (DG0):
        expansion coefficient times the change of temperature.
    """

    tag: int
    material: Elastic | Energy
    force: Any = None
    thermal_strain: Any = 0.0


@dataclass(frozen=True, eq=False)
class Pressure:
    """Pressure on facets, against their outward normals before they deform: a number, or a function
    of points (n, c) that gives (n,).
    """

    tag: int
    value: float | OfPoints


@dataclass(frozen=True, eq=False)
class Traction:
    """Force per area on facets: a vector (c,), or a function of points (n, c) that gives (n, c)."""

    tag: int
    vector: Direction | OfPoints


@dataclass(frozen=True, eq=False)
class Spring:
    """Facets on an elastic foundation that is fixed: stiffness, force per area and displacement; a
    number of all directions, or one along each axis of the mesh (c,).
    """

    tag: int
    stiffness: float | Direction


@dataclass(frozen=True)
class Force:
    """Load of a hub: a force along its free direction, and a motion across that.

    value: force, positive along `Hub.free`; in a plane section for each unit of depth, in an
        axisymmetric one for the whole turn.
    move: motion (c,) of the hub since the start of all loads, without a part along `Hub.free`;
        None: it does not move across.
    """

    value: float
    move: Direction | None = None


@dataclass(frozen=True)
class Move:
    """Load of a hub: its motion since the start of all loads.

    vector: the motion (c,) of all facets of the hub, or a dolfinx Function of vectors, whose value
        at each node of these facets is the motion of the node.
    """

    vector: Any


Part = Body | Contact | Clamp | Slide | Hub | Pressure | Traction | Spring
Load = Force | Move


def movers(
    contacts: Sequence[Contact], supports: Sequence[Clamp | Slide | Hub]
) -> list[Hub | None]:
    """Of each contact the hub that moves its rigid primary surface. Raises ValueError for a hub of
    a rigid surface that is in no contact.
    """
    hubs = [each for each in supports if isinstance(each, Hub) and each.rigid]
    for hub in hubs:
        if not any(hub.tag is each.primary for each in contacts):
            raise ValueError(f"{hub} moves a rigid surface that is not the primary of a Contact")
    return [next((hub for hub in hubs if hub.tag is each.primary), None) for each in contacts]


def compatible(
    contacts: Sequence[Contact], supports: Sequence[Clamp | Slide | Hub], springs: bool
) -> None:
    """Raise ValueError for a pair of surfaces that is there twice, for facets that are held twice,
    and where nothing holds the bodies; springs: whether there are some.
    """
    pairs = [
        {str(each.secondary), str(each.gap if each.primary is None else each.primary)}
        for each in contacts
    ]
    for contact, pair in zip(contacts, pairs, strict=True):
        if pairs.count(pair) > 1:
            raise ValueError(f"{contact}: these surfaces have a second Contact")
    for part in supports:
        for other in supports:
            along = isinstance(other, Slide) and getattr(part, "slides", False)
            fits = isinstance(part, Slide) or along or part is other
            if part.tag == other.tag and not fits:
                raise ValueError(f"{part}: {other} holds the same facets")
    stays = [each for each in supports if getattr(each, "free", None) is None]
    held = stays or len(supports) > 1 or springs
    if not held and all(len(each.tags) == 2 for each in contacts):
        raise ValueError("nothing holds the bodies: give a Clamp, a Slide or a second Hub")

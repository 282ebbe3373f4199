"""What is solved: bodies, contact law, supports and symmetry."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from railhead.solver.interface.jumps import Gap
from railhead.solver.interface.laws import Law
from railhead.solver.material.elasticity import Material
from railhead.solver.space.cells import Array
from railhead.solver.space.kinematics import SOLID, Kinematics

LINEAR = ("auto", "direct", "multigrid")  # how linear systems are solved
FarField = Callable[[float, int, Array], Array]
"""(load N, body tag, points in space (n, 3)) -> displacement (n, 3) of the supported faces, mm."""


@dataclass(frozen=True)
class Side:
    """Tags of one body: its cells, its contact facets and its supported facets."""

    tag: int
    contact: int
    support: int
    material: Material

    @property
    def rigid(self) -> bool:
        """Not meshed: only its exact surface takes part."""
        return bool(np.isinf(self.material.young_modulus))


@dataclass(frozen=True)
class LoadPath:
    """How bodies that yield are loaded. steps: from the first yield to the load; cycles: how often;
    unload: take it away in the end; near: points in space (n, 3) mm -> mask of those where yield is
    followed."""

    steps: int
    cycles: int
    unload: bool
    near: Callable[[Array], NDArray[np.bool_]]


@dataclass(frozen=True)
class Rub:
    """The wheel over the rail.

    coefficient: of friction.
    axes (3, 3): unit vectors along, across and out of the rail at the origin (3,), mm.
    slip: points (n, 3) -> rigid slip (4, n, 3) of creepages and a spin of 1 and, once, of what
        turns about axes in the tangent plane at the origin.
    known: creepage along and across and spin (1/mm) where it rolls.
    free: index (0 along, 1 across) of motions that follow from a force of the wheel on the rail, N.
    legs: shares of the load and of these forces, one after the other.
    far: (0 or 1, body tag, points (n, 3)) -> displacement (n, 3) of the supported faces under 1 N
        along or across, mm.
    """

    coefficient: float
    rolling: bool
    axes: Array
    origin: tuple[float, float, float]
    slip: Callable[[Array], Array]
    known: tuple[float, float, float]
    free: tuple[tuple[int, float], ...]
    legs: tuple[tuple[float, float], ...] = ((1.0, 1.0),)
    far: Callable[[int, int, Array], Array] | None = None


@dataclass(frozen=True)
class Setup:
    """What is solved.

    fixed, moving: the body held at its support and the one pushed along `direction` by its rigid
    hub. gap: exact gap seen from the slave. planes: facet tag and normal of each symmetry plane.
    far_field: prescribed displacement of both supports on top of the rigid motion.
    load_control: the load is given and the approach an unknown, or the reverse. kinematics: what
    the mesh's coordinates stand for; directions, normals, gap and far field are those of space.
    path: where a body yields. rub: where surfaces do.
    ValueError for a slave that is not one of the bodies, or rigid, and for an unknown `linear`.
    """

    fixed: Side
    moving: Side
    slave: int
    gap: Gap
    degree: int
    law: Law = field(default_factory=Law)
    direction: tuple[float, float, float] = (0.0, 0.0, -1.0)
    planes: tuple[tuple[int, tuple[float, float, float]], ...] = ()
    far_field: FarField | None = None
    load_control: bool = True
    linear: str = "auto"
    kinematics: Kinematics = SOLID
    path: LoadPath | None = None
    rub: Rub | None = None

    def __post_init__(self) -> None:
        bodies = {side.tag: side for side in (self.fixed, self.moving)}
        if self.slave not in bodies or bodies[self.slave].rigid:
            raise ValueError(f"slave {self.slave} is no body that deforms; there are {[*bodies]}")
        if self.linear not in LINEAR:
            raise ValueError(f"linear {self.linear!r} is unknown; give one of {LINEAR}")

    @property
    def parts(self) -> int:
        """How many times the modelled part makes up the whole."""
        return 1 if self.kinematics.revolved else int(2 ** len(self.planes))

    @property
    def push(self) -> Array:
        """The direction in the mesh's coordinates (c,)."""
        return self.kinematics.flatten(np.array(self.direction))

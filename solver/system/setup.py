"""Input of a contact model: bodies, contact law, supports, symmetry, friction, load history."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhead.solver.material import Material
from railhead.solver.space.contact_interface import ContactLaw, Gap
from railhead.solver.space.kinematics import SOLID, Kinematics, must_be_orthonormal
from railhead.theory.array_types import Array
from railhead.theory.friction import tangential
from railhead.theory.friction.tangential import MaterialPair
from railhead.theory.friction_laws import Interface

LINEAR_SOLVERS = ("auto", "direct", "multigrid")
FarField = Callable[[float, int, Array], Array]
"""(load N of the whole model, body tag, points in space (n, 3) mm) -> displacement in space (n, 3),
mm, that the supported faces have beside the rigid motion."""


@dataclass(frozen=True)
class ContactBody:
    """One of the two bodies: tags of its cells and faces, and its material.

    tag: MeshTags value of the body's cells.
    contact: MeshTags value of the facets of its contact surface.
    support: MeshTags value of the facets that hold the body: of `Setup.fixed` they are fixed, of
        `Setup.moving` they belong to the rigid hub.
    material: elastic constants and flow curve. An infinite Young's modulus makes the body rigid; a
        rigid body has no cells or facets, and its tags only name it.
    """

    tag: int
    contact: int
    support: int
    material: Material

    @property
    def rigid(self) -> bool:
        """Whether the body is not meshed, and takes part by its exact surface alone."""
        return bool(np.isinf(self.material.young_modulus))


@dataclass(frozen=True, kw_only=True)
class LoadPath:
    """Load history of bodies that may yield.

    steps: number of equal load steps from first yield up to the load.
    unload: whether the load is removed at the end, so that the residual state is computed.
    near: function that says in which cells plastic strain is followed: from their centroids in
        space (n, 3), mm, to True or False of each (n,). Cells for which it is False stay elastic.
        At contact points it is always followed if the slave has a flow curve.
    """

    steps: int
    unload: bool
    near: Callable[[Array], NDArray[np.bool_]]


@dataclass(frozen=True, kw_only=True)
class FrictionSettings:
    """Coulomb friction of the wheel over the rail: a shift from rest, or steady rolling. The wheel
    is `Setup.moving`, the rail `Setup.fixed`. Forces are those of the whole model.

    coefficient: points (n, 3) mm -> coefficient of friction (n,), positive.
    rolling: True: steady rolling along +x; False: the wheel is shifted.
    axes: (3, 3) rows: unit vectors along the rail, across it and out of it at the origin.
    origin: (x, y, z) of the point that moments refer to, mm.
    rigid_slip: points (n, 3) mm -> velocity in space (4, n, 3) of the undeformed wheel over the
        rail, of which components along tangents are used, under four motions: unit creepage along,
        unit creepage across, spin of 1/mm, and the wheel's own rotation per rolled length without
        its part about the normal. The fourth is no unit motion and has the factor 1; it is zero in
        a shift, whose units are 1 mm, 1 mm and 1 rad.
    creepage: prescribed creepage along and across, and spin in 1/mm; for a shift mm, mm and rad.
        Zero where a force is prescribed instead.
    force_controlled: (index, force) of each motion that follows from a prescribed force of the
        wheel on the rail, N; index 0 is along, 1 across.
    load_steps: (share of the load, share of the prescribed tangential forces) at the end of each
        load step.
    far_field: (0 along or 1 across, body tag, points (n, 3) mm) -> displacement (n, 3) mm of the
        supported faces under a force of 1 N of the wheel on the rail; None: tangential forces do
        not move the supported faces.
    interface: law of the coefficient and heat, of sections that roll and where tractions are those
        of half-spaces on a grid; a layer of the latter alone. None: Coulomb's law alone.
    """

    coefficient: Callable[[Array], Array]
    rolling: bool
    axes: Array
    origin: tuple[float, float, float]
    rigid_slip: Callable[[Array], Array]
    creepage: tuple[float, float, float]
    force_controlled: tuple[tuple[int, float], ...]
    load_steps: tuple[tuple[float, float], ...] = ((1.0, 1.0),)
    far_field: Callable[[int, int, Array], Array] | None = None
    interface: Interface | None = None

    def __post_init__(self) -> None:
        """Check axes and load steps; raises ValueError for axes that are no right-handed unit
        vectors at right angles, and without a load step.
        """
        must_be_orthonormal("axes", self.axes)
        if not self.load_steps:
            raise ValueError("load_steps must hold at least one step")

    def resultants(
        self, points: Array, weights: Array, traction: Array, planes: Sequence[Any]
    ) -> tuple[tuple[float, float], float]:
        """Force (along, across), N, and moment about the normal at the origin, N mm, of the whole
        model, from tractions (n, 3), MPa, at points (n, 3) of the meshed part, mm. Images cancel
        the force normal to a symmetry plane and, with any plane, the moment.

        weights: area of each point (n,), mm2, images included. planes: `Setup.planes`.
        """
        total = weights @ traction
        for _, normal in planes:
            total = total - np.array(normal) * (total @ np.array(normal))
        along, across = self.axes[:2] @ total
        turning = np.cross(points - np.array(self.origin), traction)
        moment = 0.0 if planes else float(weights @ turning @ self.axes[2])
        return (float(along), float(across)), moment


@dataclass(frozen=True, kw_only=True)
class Setup:
    """Input of a contact model. Directions, normals, gap and far field are vectors in space, also
    where the mesh is a plane section.

    fixed: the body that is held at its support.
    moving: the body that a rigid hub at its support pushes along `direction`.
    slave: tag of the body whose contact surface carries the contact points.
    gap: exact initial gap in mm and the slave's outward normals, from points on the slave.
    degree: polynomial degree of the displacement, 1 or 2.
    cut: whether the contact points lie on the pieces into which the facets of both bodies cut each
        other, so that a constant pressure stays constant on any two meshes; False: on the slave's
        whole facets, which are fewer points.
    law: contact law, Nitsche's method or a penalty.
    direction: unit vector of the approach, from the moving body towards the fixed one.
    planes: (facet tag, unit normal, of either sense) of each symmetry plane, in which the
        displacement along the normal is zero.
    far_field: (load N of the whole model, body tag, points (n, 3) mm) -> displacement (n, 3), mm,
        of both supports beside the rigid motion; None: zero, and a load cannot be given with an
        approach.
    load_control: True: the load along `direction` is prescribed and the approach unknown; False:
        the reverse.
    linear: method for linear systems, one of `LINEAR_SOLVERS`: a factorisation, multigrid, or
        'auto', which factorises small systems.
    tolerance: of Newton's method: norm of the residual over that of the nodal contact forces.
    kinematics: what the mesh coordinates stand for in space: their axes and origin, the thickness
        of a plane section (mm), whether a section is revolved, and whether the volume strain is
        averaged in each cell.
    load_path: load history of bodies that may yield; None: all bodies stay elastic, also those with
        a flow curve.
    friction: settings of Coulomb friction; None: the contact is frictionless.

    Raises ValueError for a slave that is no deformable body, an unknown `linear`, a load path where
    no body can yield, and a direction or a plane's normal that is no unit vector.
    """

    fixed: ContactBody
    moving: ContactBody
    slave: int
    gap: Gap
    degree: int
    cut: bool = True
    law: ContactLaw = field(default_factory=ContactLaw)
    direction: tuple[float, float, float] = (0.0, 0.0, -1.0)
    planes: tuple[tuple[int, tuple[float, float, float]], ...] = ()
    far_field: FarField | None = None
    load_control: bool = True
    linear: str = "auto"
    tolerance: float = 1e-8
    kinematics: Kinematics = SOLID
    load_path: LoadPath | None = None
    friction: FrictionSettings | None = None

    def __post_init__(self) -> None:
        """Check slave, linear solver, load path and directions."""
        must_be_orthonormal("direction", np.array([self.direction]))
        for _, normal in self.planes:
            must_be_orthonormal("planes", np.array([normal]))
        bodies = {body.tag: body for body in (self.fixed, self.moving)}
        if self.slave not in bodies or bodies[self.slave].rigid:
            raise ValueError(f"slave {self.slave} is no body that deforms; there are {[*bodies]}")
        if self.linear not in LINEAR_SOLVERS:
            raise ValueError(f"linear {self.linear!r} is unknown; give one of {LINEAR_SOLVERS}")
        if self.load_path and not any(body.material.hardening for body in bodies.values()):
            raise ValueError("load_path needs a body whose material has a hardening")

    @property
    def parts(self) -> int:
        """Number of symmetric images that make up the whole model, the meshed part included: 2 to
        the power of the number of symmetry planes, 1 for a section that is revolved.
        """
        return self.kinematics.copies(len(self.planes))

    @property
    def material_pair(self) -> MaterialPair:
        """Combined elastic constants of both bodies for tangential contact of half-spaces; the
        moving body is the wheel.
        """
        moving, fixed = self.moving.material, self.fixed.material
        return tangential.pair(
            moving.young_modulus, moving.poisson_ratio, fixed.young_modulus, fixed.poisson_ratio
        )

    def exact(self, points: Array) -> tuple[Array, Array]:
        """The function `gap` in the c coordinates of the mesh: gap (n,), mm, and outward normals
        (n, c) of the slave at points (n, c). The gap is infinite where there is none.
        """
        gap, normals = self.gap(self.kinematics.lift(points))
        return np.where(np.isfinite(gap), gap, np.inf), self.kinematics.flatten(normals)

    @property
    def push(self) -> Array:
        """Components (c,) of the unit vector of the approach along the c coordinates of the
        mesh.
        """
        return self.kinematics.flatten(np.array(self.direction))

"""What the coordinates of a mesh stand for: a solid, or a plane section through one.

A section is meshed in two coordinates. In plane strain it is `thickness` mm deep and nothing
changes along its normal; revolved about the axis r = 0 of its coordinates (r, z) it stands for the
whole body of revolution, with the hoop strain u_r/r.
"""

from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

import numpy as np
import ufl

from railhead.theory.array_types import Array


@dataclass(frozen=True)
class Kinematics:
    """Meaning of the d coordinates of a mesh, and the strains that follow from it.

    axes: rows (d, 3): unit vectors of the coordinates in space.
    offset: position in space of the section's origin (3,), mm.
    thickness: of a section in plane strain, mm; 1 for a solid and for a meridian section.
    revolved: whether the section is revolved about its second axis, the line r = 0: a meridian
        section.
    mean_dilatation: whether the trace of the strain is replaced in every cell by its mean over the
        volume, so that nearly incompressible cells do not lock (B-bar; Nagtegaal, Parks and Rice
        1974, Hughes 1980). The divergence of quadratic functions is linear, so that its mean is its
        value at the centroid. In a meridian section it is integrated, see `averaged`.
    """

    axes: Array = field(default_factory=lambda: np.eye(3))
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    thickness: float = 1.0
    revolved: bool = False
    mean_dilatation: bool = False

    def __post_init__(self) -> None:
        """Check the axes; raises ValueError where they are no right-handed unit vectors at right
        angles.
        """
        must_be_orthonormal("axes", self.axes)

    @property
    def averaged(self) -> bool:
        """Whether the mean dilatation has to be integrated over each cell: in a meridian section,
        where u_r/r and the weight 2 pi r vary within a cell."""
        return self.revolved and self.mean_dilatation

    @property
    def dim(self) -> int:
        """Number of coordinates of the mesh."""
        return len(self.axes)

    @property
    def shears(self) -> list[tuple[int, int]]:
        """Pairs of coordinates of the shear components in Mandel's notation, in their order:
        (1, 2), (0, 2), (0, 1) of a solid, (0, 1) of a section.
        """
        return list(combinations(range(self.dim), 2))[::-1]

    @property
    def load_power(self) -> int:
        """Power of Hertz's half length, and of his stresses, that the load is proportional to: 2
        where bodies touch along a line across the mesh (a section in plane strain), else 3.
        """
        return 2 if self.dim == 2 and not self.revolved else 3

    @property
    def varying(self) -> list[int]:
        """Numbers of the horizontal axes of space (0: x, 1: y) along which fields vary: both in a
        solid, one of them in a section.
        """
        return [int(np.argmax(np.abs(axis))) for axis in self.axes[:-1]]

    def copies(self, planes: int) -> int:
        """Number of copies of the meshed part, itself included, that make up the whole model, which
        so many symmetry planes cut; 1 of a meridian section, which stands for the whole turn.
        """
        return 1 if self.revolved else int(2**planes)

    def lift(self, points: Array) -> Array:
        """Points in space (n, 3), mm, from points in the d coordinates of the mesh (n, d), mm."""
        return self.in_space(points) + np.array(self.offset)

    def flatten(self, vectors: Array) -> Array:
        """Components (..., d) along the d coordinates of the mesh, from vectors in space (..., 3);
        the part normal to a section is dropped. Of points subtract `offset` first.
        """
        return vectors if self.dim == 3 else vectors @ self.axes.T

    def in_space(self, vectors: Array) -> Array:
        """Vectors in space (..., 3), from components along the d coordinates of the mesh (...,
        d).
        """
        return vectors if self.dim == 3 else vectors @ self.axes

    def tensors(self, mandel: Array) -> Array:
        """Symmetric tensors in space (..., 3, 3), from m components in Mandel's notation (..., m).

        In a solid these are 11, 22, 33 and sqrt(2) times 23, 13, 12. In a section they are 11, 22,
        the component normal to the section (the hoop of a meridian section), and sqrt(2) times 12.
        """
        own = np.zeros((*mandel.shape[:-1], 3, 3))
        own[..., [0, 1, 2], [0, 1, 2]] = mandel[..., :3]
        for column, (i, j) in enumerate(self.shears, 3):
            own[..., i, j] = own[..., j, i] = mandel[..., column] / np.sqrt(2)
        axes = self.axes if self.dim == 3 else np.vstack([self.axes, np.cross(*self.axes)])
        return np.asarray(axes.T @ own @ axes)

    def dyads(self, vectors: Array, others: Array) -> Array:
        """Symmetric dyads sym(v x w) (n, m) of vectors v, w (n, d) in the mesh, in Mandel's
        notation as in `tensors`; the component normal to a section is zero.
        """
        out = np.zeros((len(vectors), 3 + len(self.shears)))
        out[:, : self.dim] = vectors * others
        for column, (i, j) in enumerate(self.shears, 3):
            both = vectors[:, i] * others[:, j] + vectors[:, j] * others[:, i]
            out[:, column] = both / np.sqrt(2)
        return out

    def measure(self, points: Array) -> Array:
        """Volume of the body over the volume of the mesh, which is an area in a section, at points
        (n, d), mm; surfaces of the body and of the mesh have the same factor (n,). It is 1 in a
        solid, the thickness of a plane section, and 2 pi r in a revolved one, mm.
        """
        if self.revolved:
            return np.asarray(2 * np.pi * points[..., 0])
        return np.full(points.shape[:-1], self.thickness)

    def divergence(self, value: Array, gradient: Array, points: Array) -> Array:
        """Trace of the strain (..., k, d), 1/mm, of the displacements that are one of k basis
        functions along one of the d coordinates.

        value: values of the basis functions (..., k).
        gradient: their gradients (..., k, d), 1/mm.
        points: coordinates in the mesh (..., d), mm.
        """
        out = gradient.copy()
        if self.revolved:
            out[..., 0] += value / points[..., 0]
        return out

    def energy(self, u: Any, v: Any, lam: Any, mu: Any, mesh: Any, degree: int) -> Any:
        """UFL form: integral of lambda tr eps(u) tr eps(v) + 2 mu eps(u) : eps(v), with the weight
        2 pi r where the section is revolved.

        u, v: trial and test function. lam, mu: Lame's constants, MPa. mesh: dolfinx mesh. degree:
            degree of the quadrature.
        The thickness of a section is not included. With mean dilatation the first term is taken at
        the centroid; where it has to be integrated over each cell (`averaged`), it is left out.
        """
        dx = ufl.dx(metadata={"quadrature_degree": degree})
        middle = ufl.dx(metadata={"quadrature_degree": 0}) if self.mean_dilatation else dx
        product = ufl.inner(_eps(u), _eps(v))
        if not self.revolved:
            return lam * ufl.div(u) * ufl.div(v) * middle + 2 * mu * product * dx
        r = ufl.SpatialCoordinate(mesh)[0]
        shear = 2 * mu * (product + u[0] / r * v[0] / r)
        volume = 0 if self.averaged else lam * self.dilatation(u, r) * self.dilatation(v, r)
        return 2 * np.pi * r * (volume + shear) * dx

    def stored(self, u: Any, lam: Any, mu: Any) -> Any:
        """UFL expression of the strain energy per volume of a displacement u, lam/2 tr(eps)^2 +
        mu eps : eps.
        """
        eps = _eps(u)
        hoop = u[0] / ufl.SpatialCoordinate(u.function_space.mesh)[0] if self.revolved else 0
        return lam / 2 * (ufl.tr(eps) + hoop) ** 2 + mu * (ufl.inner(eps, eps) + hoop * hoop)

    @staticmethod
    def dilatation(w: Any, r: Any) -> Any:
        """UFL expression of the trace of the strain, div w + w_r/r, of a displacement w in a
        meridian section with the radius r.
        """
        return ufl.div(w) + w[0] / r

    def rigid_motions(self, points: Array) -> list[Array]:
        """Displacements (..., d) of each rigid motion, which carry no stress, at points (..., d):
        unit translations, then unit rotations about the origin; for a revolved section the axial
        translation alone.
        """
        shift = [np.broadcast_to(e, points.shape) for e in np.eye(self.dim)]
        if self.revolved:
            return shift[1:]
        if self.dim == 2:
            return [*shift, np.stack([-points[..., 1], points[..., 0]], axis=-1)]
        return [*shift, *(np.cross(e, points) for e in np.eye(3))]


def must_be_orthonormal(name: str, axes: Array) -> None:
    """Raise ValueError, with the name of what is given, for rows (k, 3) that are no unit vectors at
    right angles, or for three that are left-handed.
    """
    rows = np.asarray(axes, float)
    if rows.ndim != 2 or not np.allclose(rows @ rows.T, np.eye(len(rows)), atol=1e-6):
        raise ValueError(f"{name} must be unit vectors at right angles, not {rows.tolist()}")
    if len(rows) == 3 and np.linalg.det(rows) < 0:
        raise ValueError(f"{name} must be right-handed, not {rows.tolist()}")


SOLID = Kinematics()


def _eps(w: Any) -> Any:
    """UFL expression (d, d) of the small strain, the symmetric gradient of a displacement w (d,)
    on d coordinates.
    """
    return ufl.sym(ufl.grad(w))

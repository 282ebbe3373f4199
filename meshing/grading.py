"""How fine the mesh is where: fine in the predicted patch, growing with the distance from it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import trapezoid

LONG = 3.0  # a / b from which elements are stretched along the rail, by a / b over it ...
MAX_STRETCH = 3.0  # ... and at most so much
FAR_SIZE = 0.6  # longest stretched element over a, times elements per minor semi-axis, and ...
FAR_GROWTH = 1.5  # ... its growth with the distance over the usual one


def suited_stretch(a: float, b: float) -> float:
    """Ratio of length along the rail to width of the elements that suit a patch with half lengths a
    along the rail and b across it, mm: a / b / 3, between 1 and 3.
    """
    return min(MAX_STRETCH, max(1.0, a / b / LONG))


MARGIN = 1.15  # semi-axes of the fine ellipsoid over those of the patch


@dataclass(frozen=True, kw_only=True)
class Grading:
    """Element size: `size` inside an ellipsoid around the patch, plus growth times distance outside
    of it.

    The distance is the larger of two: that to the ellipsoid to first order, 2 rho (rho - 1) / |grad
    rho^2| with rho = |x / semi-axes|, and that to its bounding box. Both are exact on the axes, and
    neither leaves out the tips of a needle.

    centre: (x, y, z) of the patch in space, mm.
    a: semi-axis of the patch along x, mm.
    b: semi-axis of the patch along the tangent across the rail, mm.
    angle: of that tangent to the horizontal, rad; positive where z rises with y.
    size: element size inside the ellipsoid, mm. On curved edges gmsh makes smaller elements, down
        to a fifth of it.
    growth: increase of the size per distance from the ellipsoid.
    coarsest: largest element size, mm; gmsh gets it apart from the formula. Those of further
        patches have no effect.
    stretch: ratio of the elements' length along the rail to their width. gmsh meshes in coordinates
        where x is divided by it, and sizes are isotropic there.
    also: gradings of further patches, with the same stretch; the smallest size holds.
    """

    centre: tuple[float, float, float]
    a: float
    b: float
    angle: float
    size: float
    growth: float = 0.3
    coarsest: float = 1e22
    stretch: float = 1.0
    also: tuple[Grading, ...] = ()

    @property
    def _fine(self) -> tuple[float, float, float]:
        """Semi-axes of the fine ellipsoid, mm: along the rail (divided by the stretch), across it,
        normal to the surface.
        """
        return MARGIN * self.a / self.stretch, MARGIN * self.b, self.depth

    @property
    def depth(self) -> float:
        """Depth of the fine zone below the surface, mm: the smaller of a and b, without the
        margin.
        """
        return min(self.a, self.b)

    @property
    def resolution(self) -> float:
        """Number of elements per smaller semi-axis of this patch: min(a, b) over the size. Where
        the elements are stretched more than suits the patch (`suited_stretch`), that is divided by
        the ratio of both stretches.
        """
        spared = max(1.0, self.stretch / suited_stretch(self.a, self.b))
        return self.depth / (self.size * spared)

    @property
    def _linear_sizes(self) -> list[tuple[float, float]]:
        """(size in mm at the ellipsoid, growth per distance) of one or two sizes that grow linearly
        with the distance; the smaller one is the element size.

        With a stretch there are two, because long elements far from a patch would miss how its
        field changes along the rail. The second size starts coarser and grows more slowly.
        """
        near = self.size, self.growth
        if self.stretch == 1:
            return [near]
        first = FAR_SIZE * self.size * self.a / self.depth / self.stretch
        return [near, (first, FAR_GROWTH * self.growth / self.stretch)]

    def _size(self, distance: NDArray[np.float64]) -> NDArray[np.float64]:
        """Element size (n,) at distances (n,), at least zero, from the fine ellipsoid; for this
        patch alone and without the limit `coarsest`. Both are in mm of the coordinates in which x
        is divided by `stretch`.
        """
        return np.minimum.reduce([size + growth * distance for size, growth in self._linear_sizes])

    def turned(self) -> Grading:
        """The grading for a section along the rail, where x takes the place of y: centre (0, x, z),
        a and b exchanged, angle 0. Further patches stay as they are: a section along the rail has
        none.
        """
        x, _, z = self.centre
        return replace(self, centre=(0.0, x, z), a=self.b, b=self.a, angle=0.0)

    def expression(self, *, section: bool = False, coordinates: str = "yz") -> str:
        """The element size as a formula for gmsh's MathEval, in mm and in the stretched
        coordinates, without the limit `coarsest`.

        section: whether the size is that of the plane x = centre, so that x does not enter.
        coordinates: gmsh's names of y and z.
        """
        cx, cy, cz = self.centre
        y, z = (_offset(*each) for each in zip(coordinates, (cy, cz), strict=True))
        across, normal = y, z
        if self.angle:
            c, s = f"({np.cos(self.angle):.15g})", f"({np.sin(self.angle):.15g})"
            across, normal = f"({c}*{y}+{s}*{z})", f"({c}*{z}-{s}*{y})"
        terms = list(zip((across, normal), self._fine[1:], strict=True))
        if not section:
            terms.insert(0, (_offset("x", cx / self.stretch), self._fine[0]))

        def norm(power: int) -> str:
            """Formula of the norm of the offset from the centre, each component divided by its
            semi-axis to this power; a small constant keeps it above zero.
            """
            squares = "+".join(f"{x}*{x}/{e ** (2 * power):.15g}" for x, e in terms)
            return f"Sqrt({squares}+{1e-12 / min(self._fine) ** (2 * power - 2):.15g})"

        ellipsoid = f"{norm(1)}*({norm(1)}-1)/{norm(2)}"
        beyond = [f"Max(0,Abs({x})-({e:.15g}))" for x, e in terms]
        box = f"Sqrt({'+'.join(f'{d}*{d}' for d in beyond)}+1e-300)"
        distance = f"Max({box},{ellipsoid})"
        sizes = [f"{size:.15g}+{growth:.15g}*{distance}" for size, growth in self._linear_sizes]
        own = sizes[0] if len(sizes) == 1 else f"Min({','.join(sizes)})"
        for other in self.also:
            also = other.expression(section=section, coordinates=coordinates)
            own = f"Min({own},{also})"
        return own

    def at(self, y: float, z: float) -> float:
        """Element size in mm at a point (y, z), mm, of the section through the centre of the patch,
        without the limit `coarsest`. With a stretch it is the width of the elements.
        """
        dy, dz = y - self.centre[1], z - self.centre[2]
        c, s = np.cos(self.angle), np.sin(self.angle)
        offset = np.array([c * dy + s * dz, c * dz - s * dy])
        rho = max(float(np.linalg.norm(offset / self._fine[1:])), 1e-9)
        steep = max(float(np.linalg.norm(offset / np.square(self._fine[1:]))), 1e-9)
        box = float(np.linalg.norm(np.maximum(np.abs(offset) - self._fine[1:], 0.0)))
        own = self._size(np.array(max(box, rho * (rho - 1) / steep)))
        return float(min([float(own), *(other.at(y, z) for other in self.also)]))

    def along(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Length of the elements along the rail (n,), mm, on the line through the centre of the
        patch along the rail, at positions x (n,) in space, mm. The limit `coarsest` is left out.
        """
        outside = np.maximum(np.abs(x - self.centre[0]) - MARGIN * self.a, 0.0)
        own = self.stretch * self._size(outside / self.stretch)
        return np.minimum.reduce([own, *(other.along(x) for other in self.also)])

    def layers(self, length: float) -> list[float]:
        """Ends of graded layers of hexahedra along the rail, from the centre of the patch to
        `length` (mm), as fractions of it: increasing, the last one 1; at least two.
        """
        x = np.linspace(0.0, length, 2001)
        density = 1.0 / self.along(self.centre[0] + x)
        count = np.concatenate([[0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(x))])
        ends = np.linspace(0.0, count[-1], max(2, round(count[-1])) + 1)[1:]
        return [float(v) for v in np.interp(ends, count, x) / length]

    def predicted_triangles(self, reach: float) -> float:
        """Predicted number of triangles of the section of one whole body, not cut at its middle,
        that reaches `reach` mm from the patch: the integral of 1/size^2 times a factor that fits
        gmsh's meshes. Further patches, `coarsest` and `stretch` are left out.
        """
        radius = np.geomspace(1e-3 * self.size, reach, 400)
        fine = MARGIN * np.sqrt(self.b * self.depth)
        size = self.size + self.growth * np.maximum(radius - fine, 0.0)
        return 2.3 * float(trapezoid(np.pi * radius / size**2, radius))

    def predicted_cells(self, reach: float, *, hexahedra: bool = False) -> float:
        """Predicted number of cells of one whole body, not cut at symmetry planes: the integral of
        1/size^3 times a factor that fits gmsh's meshes, without the limit `coarsest`. The cells of
        all further patches are added.

        reach: distance that the body extends from the patch along the rail, mm.
        hexahedra: whether the cells are hexahedra swept in layers, otherwise tetrahedra.
        """
        others = sum(other.predicted_cells(reach, hexahedra=hexahedra) for other in self.also)
        distance = np.concatenate([[0.0], np.geomspace(1e-3 * self.size, reach, 400)])
        size = self._size(distance)
        if hexahedra:
            across, down = (edge + distance for edge in self._fine[1:])
            area = np.pi / 2 * across * down
            quads = area[0] / size[0] ** 2 + float(trapezoid(1 / size**2, area))
            return others + quads * 2 * len(self.layers(reach))
        along, across, down = (edge + distance for edge in self._fine)
        along = np.minimum(along, reach / self.stretch)
        volume = 2 * np.pi / 3 * along * across * down
        return others + 4.4 * float(volume[0] / size[0] ** 3 + trapezoid(1 / size**3, volume))


def _offset(name: str, origin: float) -> str:
    """Formula of a coordinate less its value at an origin; of an origin at zero the name alone, as
    each term costs time wherever gmsh asks for a size.
    """
    return f"({name}-({origin:.15g}))" if origin else name

"""How fine the mesh is where: fine in the predicted patch, growing with the distance from it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import trapezoid


@dataclass(frozen=True)
class Grading:
    """Element size h inside an ellipsoid around the patch, plus growth * distance outside of it.

    centre (x, y, z) and semi-axes a (along x) and b (along the tangent across) in mm; angle of the
    tangent to the horizontal in rad; size h and coarsest size in mm.
    """

    centre: tuple[float, float, float]
    a: float
    b: float
    angle: float
    size: float
    growth: float = 0.3
    margin: float = 1.15
    coarsest: float = 1e22

    @property
    def depth(self) -> float:
        """Depth of the fine zone, mm."""
        return min(self.a, self.b)

    def expression(self, *, section: bool = False) -> str:
        """The size as a gmsh MathEval formula; section: in the plane x = centre alone."""
        cx, cy, cz = self.centre
        c, s = f"({np.cos(self.angle):.15g})", f"({np.sin(self.angle):.15g})"
        dx = "0" if section else f"(x-({cx:.15g}))"
        dy, dz = f"(y-({cy:.15g}))", f"(z-({cz:.15g}))"
        across = f"({c}*{dy}+{s}*{dz})"
        normal = f"({c}*{dz}-{s}*{dy})"
        tiny = f"{(1e-6 * self.size) ** 2:.6g}"
        distance = f"Sqrt({dx}*{dx}+{dy}*{dy}+{dz}*{dz}+{tiny})"
        ea, eb = self.margin * self.a, self.margin * self.b
        rho = (
            f"Sqrt({dx}*{dx}/{ea**2:.15g}+{across}*{across}/{eb**2:.15g}"
            f"+{normal}*{normal}/{self.depth**2:.15g}+1e-12)"
        )
        return f"{self.size:.15g}+{self.growth:.15g}*Max(0,{distance}*(1-1/{rho}))"

    def at(self, y: float, z: float) -> float:
        """The size at a point of the section through the centre."""
        dy, dz = y - self.centre[1], z - self.centre[2]
        c, s = np.cos(self.angle), np.sin(self.angle)
        rho = np.hypot((c * dy + s * dz) / (self.margin * self.b), (c * dz - s * dy) / self.depth)
        return float(self.size + self.growth * np.hypot(dy, dz) * max(0.0, 1 - 1 / max(rho, 1e-9)))

    def along(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """The same on the line through the centre along the rail."""
        outside = np.maximum(np.abs(x - self.centre[0]) - self.margin * self.a, 0.0)
        return self.size + self.growth * outside

    def layers(self, length: float) -> list[float]:
        """Ends of graded layers from the patch centre to `length`, as fractions of it."""
        x = np.linspace(0.0, length, 2001)
        density = 1.0 / self.along(self.centre[0] + x)
        count = np.concatenate([[0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(x))])
        ends = np.linspace(0.0, count[-1], max(2, round(count[-1])) + 1)[1:]
        return [float(v) for v in np.interp(ends, count, x) / length]

    def predicted_cells(self, reach: float, *, hexahedra: bool = False) -> float:
        """Cells of one whole body: the integral of the density 1/size^3 (factors: gmsh's habit)."""
        radius = np.geomspace(1e-3 * self.size, reach, 400)
        fine = self.margin * (self.a * self.b * self.depth) ** (1 / 3)
        size = self.size + self.growth * np.maximum(radius - fine, 0.0)
        if hexahedra:
            quads = float(trapezoid(np.pi * radius / size**2, radius))
            return quads * 2 * len(self.layers(reach))
        return 4.4 * float(trapezoid(2 * np.pi * radius**2 / size**3, radius))

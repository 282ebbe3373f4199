"""Records of the results of one solution, and words for pictures of it: what tables, files and
pictures share.

The contact frame: x along the rail, s along the common tangent across it, height along the outward
normal n of the rail. Its origin is the first contact of the undeformed bodies. Of several patches,
and of one that is turned from the first contact (`has_own_plane`), the frame is that of the most
loaded one, on which the integral of the pressure is largest, with its origin at the centre of
pressure. Depth is the distance into the body, positive in rail and wheel. Stress components of
depth axes are in this frame, in the order (xx, ss, nn, xs, xn, sn); tension is positive.
"""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from railhead.theory.array_types import Array as Array
from railhead.theory.array_types import Index as Index
from railhead.theory.elastic.subsurface import max_shear, von_mises

Place = tuple[float, float, float]
Target = Path | None
"""PNG file of a picture, or None: the figure is not written."""
Drawing = Callable[[Target], Any]
"""Draws a picture on a target and returns its figure."""
HERTZIAN = 0.02  # relative deviation from an ellipsoid below which semi-axes are those of one
ROW, COLUMN = np.array([0, 1, 2, 0, 0, 1]), np.array([0, 1, 2, 1, 2, 2])  # of six components
SYMMETRIC = np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]])  # places of a tensor among them
NO_DEPTH = 1e-9  # of a semi-axis: rounding at the surface
TURNED = 0.02  # rad: on planes turned by less, areas differ by 0.1 % (S1002 on 60E1, 0.016 rad)
PEAK_SAMPLES = 8  # either side of the largest one
LBF = 4.4482216152605  # N
FACTORS = {
    "mm": {"mm": 1.0, "um": 1e3, "m": 1e-3, "in": 1 / 25.4},
    "N": {"N": 1.0, "kN": 1e-3, "lbf": 1 / LBF, "kip": 1e-3 / LBF, "kips": 1e-3 / LBF},
    "MPa": {
        **{"MPa": 1.0, "N/mm2": 1.0, "GPa": 1e-3, "Pa": 1e6},
        **{"ksi": 0.14503773773, "psi": 145.03773773},
    },
    "um": {"um": 1.0, "m": 1e-6, "in": 1e-3 / 25.4},
}
"""By base unit, what a reader may have instead, and how many of it are one base unit."""
_FACTOR = re.compile(r"([A-Za-z]+)(\d?)")


@dataclass(frozen=True)
class Frame:
    """Axes of a contact: x along the rail, s along the common tangent across the rail, and the
    outward normal of the rail.

    origin: (3,) first contact or centre of pressure of a patch, in space, mm.
    angle: contact angle, from the horizontal axis y to the tangent s, rad; positive where s rises.
    lean: angle at which x rises, rad.
    """

    origin: tuple[float, float, float]
    angle: float
    lean: float = 0.0

    @property
    def axes(self) -> Array:
        """(3, 3) rows: unit vectors in space of x, of s and of the rail's outward normal."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        ahead, up = np.cos(self.lean), np.sin(self.lean)
        return np.array([[ahead, 0.0, up], [-s * up, c, s * ahead], [-c * up, -s, c * ahead]])

    def place(self, x: float, s: float, height: float = 0.0) -> Place:
        """Point (x, y, z) in space, mm, from x, s and the height over the tangent plane, mm,
        positive along the rail's outward normal.
        """
        px, py, pz = np.array(self.origin) + np.array([x, s, height]) @ self.axes
        return float(px), float(py), float(pz)

    def local(self, points: Array) -> Array:
        """Coordinates (n, 3) in the contact frame, mm: x, s and height over the tangent plane, of
        points (n, 3) in space, mm.
        """
        return np.asarray((points - np.array(self.origin)) @ self.axes.T)


def has_own_plane(angles: Sequence[float], first: float) -> bool:
    """Whether results are given in the tangent plane of the most loaded patch, not in that of the
    first contact: there are several patches, or one that is turned by more than 0.02 rad (TURNED).
    At the root of a flange the bodies deform until they touch beside the first contact, and its
    plane, prolonged to the patch, is not the bodies' surface.

    angles: contact angles of all patches, rad; empty for a section, which keeps the first contact.
    first: contact angle at the first contact, rad.
    """
    return len(angles) > 1 or any(abs(angle - first) > TURNED for angle in angles)


@dataclass(frozen=True, kw_only=True)
class Surface:
    """Fields at the n nodes of a contact surface; of a cut model those of the modelled part, unless
    `symmetry.surface` made it. Of half-spaces the nodes are cell centres on the whole surface.

    points (n, 3): undeformed nodes in space, mm.
    local (n, 2): x and s of the nodes in the contact frame, mm.
    triangles (t, 3): nodes of each triangle; of a section lines (t, 2).
    pressure (n,): smooth contact pressure at the nodes, never negative, MPa.
    gap (n,): gap of the deformed surfaces, mm: of finite elements negative where they overlap, of
        boundary elements 0 in the patch and infinite where the bodies do not face each other, of
        exact Hertz NaN.
    displacement (n, 3): of the nodes in space, mm; of half-spaces NaN.
    """

    points: Array
    local: Array
    triangles: Index
    pressure: Array
    gap: Array
    displacement: Array


@dataclass(frozen=True, kw_only=True)
class OnePatch:
    """One separate contact patch, in its own tangent plane; a single patch of finite elements has
    its lengths and area in the contact frame. A patch that a symmetry plane cuts is whole; one
    beside a symmetry plane is without its image.

    centre (3,): centre of pressure in space, mm.
    angle: contact angle of the tangent plane, rad, about its line ahead, which rises by `lean`.
    a, b: half lengths along x and along s, mm.
    area: on the tangent plane, mm2.
    max_pressure: largest pressure, MPa.
    share: integral of the pressure of the patch as listed over that of all patches and all their
        images, 0 to 1.
    """

    centre: tuple[float, float, float]
    angle: float
    a: float
    b: float
    area: float
    max_pressure: float
    share: float
    lean: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Patch:
    """The contact patch, with the mirror images of a model that was cut at symmetry planes; x and s
    are those of the contact frame, `Findings.frame`.

    a, b: half lengths of the smooth pressure along x and s, mm; where the shape error is at most
        1 %, those of Hertz's ellipsoid by the moments of the pressure. Of a line contact one is the
        half width and the other the half length of the line. Of several patches they are those of
        the most loaded one.
    centre: (x, s) of the centre of pressure, mm; of several patches that of the most loaded one.
    area: of all patches, each on its own tangent plane, mm2.
    max_pressure: largest pressure of all patches, MPa.
    mean_pressure: integral of the pressure over `area`, MPa: normal force over area, not load over
        area.
    outlines: closed curves (k, 2) of (x, s), mm, of all patches: each has one, and each hole
        another. Left out are images of patches beside a symmetry plane, and holes of half-spaces.
    each: the separate patches, most loaded first, also where there is one; empty for a section.
    scatter: relative differences of a, b, area and max_pressure, by these names, from other
        readings of the same solution; infinite where such a reading failed, empty for half-spaces.
        They are no measure of the error by the mesh.
    unbalance: relative difference of the force of the pressure that is shown from that of the
        computed one, of several patches the largest; 0 for half-spaces.
    """

    a: float
    b: float
    centre: tuple[float, float]
    area: float
    max_pressure: float
    mean_pressure: float
    outlines: list[Array]
    each: tuple[OnePatch, ...] = ()
    scatter: dict[str, float] = field(default_factory=dict)
    unbalance: float = 0.0

    @property
    def box(self) -> tuple[Array, Array]:
        """Smallest and largest (x, s) of all outlines, each (2,), mm."""
        every = np.concatenate(self.outlines)
        return every.min(axis=0), every.max(axis=0)

    @property
    def main(self) -> Array:
        """The outline (k, 2) whose box holds the centre, mm: the one with the largest box if there
        are more, the first of all if there is none.
        """
        around = [
            line
            for line in self.outlines
            if np.all(line.min(axis=0) < self.centre) and np.all(self.centre < line.max(axis=0))
        ]
        return max(around or self.outlines[:1], key=lambda line: float(np.ptp(line, axis=0).prod()))


@dataclass(frozen=True)
class Peak:
    """Largest value of a stress in a body.

    value: MPa.
    depth: below the contact surface, mm.
    place: in space, mm.
    """

    value: float
    depth: float
    place: Place


@dataclass(frozen=True)
class Largest:
    """Largest stresses of one body, apart from those near sharp edges.

    tau: largest shear stress.
    von_mises: largest von Mises stress.
    edges: (largest shear, largest von Mises stress) near sharp edges; each is None unless it
        exceeds that elsewhere. It depends on the mesh. Both are None for half-spaces.
    """

    tau: Peak
    von_mises: Peak
    edges: tuple[Peak | None, Peak | None] = (None, None)


@dataclass(frozen=True)
class DepthAxis:
    """Stresses on a line along the normal into one body, from the tangent plane at the centre of
    pressure of a patch.

    body: 'rail' or 'wheel'.
    depth (k,): distance from the tangent plane into the body, mm, ascending, from 0; of boundary
        elements from just below the surface.
    stress (k, 6): components (xx, ss, nn, xs, xn, sn) in the contact frame of the patch, n out of
        the rail in both bodies, MPa, tension positive.
    line: start of the axis in space (mm) and its unit vector into the body.
    """

    body: str
    depth: Array
    stress: Array
    line: tuple[Place, Place]

    def peak(self, values: Array) -> tuple[float, float]:
        """Depth (mm) and value of the maximum of values (k,) at the depths of the axis.

        The maximum is that of a quartic polynomial fitted to the eight values on either side of the
        largest one. A largest value at either end is returned as it is.
        """
        top = int(np.argmax(values))
        around = slice(max(top - PEAK_SAMPLES, 0), min(top + PEAK_SAMPLES + 1, len(values)))
        z = self.depth[around] - self.depth[top]
        if not 0 < top < len(values) - 1:
            return float(self.depth[top]), float(values[top])
        curve = np.polynomial.Polynomial.fit(z, values[around], min(4, len(z) - 1))
        roots = curve.deriv().roots()
        inside = roots.real[
            (np.abs(roots.imag) < 1e-9) & (z[0] <= roots.real) & (roots.real <= z[-1])
        ]
        if not len(inside):
            return float(self.depth[top]), float(values[top])
        best = inside[np.argmax(curve(inside))]
        return float(self.depth[top] + best), float(curve(best))

    @property
    def largest(self) -> Largest:
        """Largest shear and von Mises stress on this axis, each with its depth and place."""
        return Largest(self._peak(max_shear(self.stress)), self._peak(von_mises(self.stress)))

    def _peak(self, values: Array) -> Peak:
        """Maximum of values (k,) at the depths of the axis, in MPa, with its place in space."""
        depth, value = self.peak(values)
        x, y, z = (float(at + depth * into) for at, into in zip(*self.line, strict=True))
        return Peak(value, depth, (x, y, z))


@dataclass(frozen=True)
class AxisPressure:
    """Contact pressure on a line along x or along s. Of finite elements in a plane section the line
    across the section has two points, its ends.

    coordinate (k,): x or s in the contact frame, mm; of a meridian section the radius, negative on
        the other side.
    pressure (k,): smooth pressure at each coordinate, MPa; the line may reach beyond the patch,
        where it is zero.
    at: the other coordinate of the line, mm: that of the largest pressure of the most loaded patch,
        or of the centre of an ellipse; 0 for sections and exact Hertz.
    """

    coordinate: Array
    pressure: Array
    at: float = 0.0


@dataclass(frozen=True)
class Units:
    """Units of displayed numbers; files remain in mm, N and MPa.

    chosen: displayed unit by base unit ("mm", "N", "MPa", "um"); others remain.
    """

    chosen: Mapping[str, str] = field(default_factory=dict)

    def unit(self, unit: str) -> str:
        """Displayed unit for a product of powers of base units; other units and words remain."""
        return _FACTOR.sub(lambda each: self.chosen.get(each[1], each[1]) + each[2], unit)

    def value(self, value: float, unit: str) -> float:
        """Value in the displayed unit; unit: that of the argument, powers of base units, of which
        at most one is divided by ("N/mm2"). Other units and words have no effect.
        """
        over, _, under = unit.partition("/")
        for part, sign in ((over, 1), (under, -1)):
            for name, power in _FACTOR.findall(part):
                if name in self.chosen:
                    value *= FACTORS[name][self.chosen[name]] ** (sign * int(power or 1))
        return value

    def text(self, value: float, unit: str, digits: int = 4) -> str:
        """Text of a value, with so many significant digits, and of its unit, both as displayed."""
        return f"{brief(self.value(value, unit), digits)} {self.unit(unit)}"

    def place(self, point: Sequence[float]) -> str:
        """Text "(x, y, z) mm" of a point (3,), mm, in the displayed unit, four digits each."""
        inside = ", ".join(f"{self.value(each, 'mm'):.4g}" for each in point)
        return f"({inside}) {self.unit('mm')}"

    @property
    def others(self) -> str:
        """Displayed units that differ from mm, N and MPa, as text like "kN, in", or empty."""
        return ", ".join(to for base, to in self.chosen.items() if base not in (to, "um"))


def brief(value: float, digits: int = 4) -> str:
    """Text of a number with so many significant digits, without a power of ten up to 1e7."""
    rounded = float(f"{value:.{digits}g}") + 0.0  # -0 is 0
    return f"{rounded:.0f}" if 1e4 <= abs(rounded) < 1e7 else f"{rounded:.{digits}g}"


def keyed(key: str, value: object) -> Any:
    """A value of a dotted key of a scene as people write it: a slope as "1:20", others as is."""
    if key != "rail.inclination" or not isinstance(value, float) or not value:
        return value
    return f"{'-' * (value < 0)}1:{1 / abs(value):.4g}"


BASE_UNITS = Units()  # mm, N, MPa


@dataclass(frozen=True)
class Subject:
    """Words for titles, axis labels and legends of pictures.

    title: case, load and pair of profiles; stands above every picture.
    gauge: whether negative s is the gauge side and positive s the field side.
    rolls: whether the wheel rolls, towards positive x.
    has_friction: whether the solution has friction.
    revolved: whether the model is a meridian section of bodies of revolution.
    method: what made the numbers, for legends.
    units: of the numbers that are shown.
    """

    title: str = ""
    gauge: bool = False
    rolls: bool = False
    has_friction: bool = False
    revolved: bool = False
    method: str = "finite elements"
    units: Units = BASE_UNITS

    def label(self, axis: int) -> str:
        """Label, with its unit and direction, of the picture's axis for x (axis 0) or s (axis 1);
        of a meridian section for the radius.
        """
        if self.revolved:
            return "r, from the axis, mm"
        if axis == 0:
            return "x, along the rail, mm" + (" (rolls towards +x)" if self.rolls else "")
        return "s, across the rail, mm" + ("\n(gauge side < 0 < field side)" if self.gauge else "")


@dataclass(frozen=True, kw_only=True)
class Findings:
    """Everything that is read out of one solution. Bodies that are rigid have no entry by body
    name. Measures of a mesh are NaN for half-spaces.

    frame: axes of the contact; of several patches those of the most loaded one.
    patch: the contact patch.
    surface: fields on the contact surface of the slave, the body whose facets carry the pressure.
    depth: stresses on the axis into each body from the centre of the most loaded patch, by body
        name; empty where stresses are not read.
    along, across: smooth pressure along x and along s through the most loaded patch.
    shape_error: largest deviation of the third and fourth moments of the most loaded patch's
        pressure from those of Hertz's pressure, as `PressureMoments.shape_error`.
    hertzian: whether the pressure is nearly Hertz's: there is one patch, and its shape error is
        below 2 %.
    largest: largest stresses anywhere in the body but near sharp edges, by body name; empty where
        stresses are not read.
    also: axes from the other patches, in the order of `Patch.each`, into the body of `axis`.
    notes: remarks that every picture shows below it.
    subject: words for titles and labels of pictures.
    noise: relative L2 difference of computed and smooth pressure.
    elements_across: numbers of elements over the length and over the width of the most loaded
        patch.
    edge_distance: smallest distance of a point with pressure from an edge of the bodies, over the
        smaller half length of the patch; infinite without edges. Of half-spaces by boundary
        elements the distance is that in y from the outlines to the ends of the profiles; NaN of
        exact Hertz.
    misfit: largest relative difference of smooth and element stresses around the places of the
        largest ones.
    dissipated: energy dissipated by friction per rolled length, N; NaN where nothing rolls, and
        until friction is read.
    surface_error: relative error of the largest stresses, by key of summary.json, by the grid of
        the tractions at the surface; empty without such a grid.
    """

    frame: Frame
    patch: Patch
    surface: Surface
    along: AxisPressure
    across: AxisPressure
    shape_error: float
    hertzian: bool
    depth: dict[str, DepthAxis] = field(default_factory=dict)
    largest: dict[str, Largest] = field(default_factory=dict)
    also: tuple[DepthAxis, ...] = ()
    notes: tuple[str, ...] = ()
    subject: Subject = Subject()
    noise: float = math.nan
    elements_across: tuple[float, float] = (math.nan, math.nan)
    edge_distance: float = math.nan
    misfit: float = math.nan
    dissipated: float = math.nan
    surface_error: Mapping[str, float] = field(default_factory=dict)

    @property
    def axis(self) -> DepthAxis:
        """Stresses on the axis from the centre of pressure of the most loaded patch into the rail,
        or into the wheel where the rail is rigid.
        """
        return self.depth.get("rail") or next(iter(self.depth.values()))

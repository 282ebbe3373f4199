"""The patch before anything is meshed: what the mesh is refined around, how finely, and what Newton
starts from.

Where the gap over Hertz's ellipse is Hertz's parabola and nothing else comes close, the forecast is
that ellipse. Elsewhere boundary elements solve for the patch or the patches, on the exact gap over
the developed surface of the rail.

The pressure has a ridge on lines in a patch where the relative curvature jumps. It is continuous
there, its slope across is not bounded (K. L. Johnson, Contact Mechanics, 1985, section 5.1), and
elements of one size flatten it. Elements grow from the patches outwards.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from scipy.spatial import cKDTree

from railhead.contact.solid import Contact
from railhead.half_spaces.surface import Developed
from railhead.meshing.grading import Grading, suited_stretch
from railhead.planning.context import Context
from railhead.postprocess.findings import Frame
from railhead.theory.array_types import Array, Mask
from railhead.theory.bem.grid_patch import PatchSolution
from railhead.theory.elastic.line import Hertz

MINOR = 0.02  # share of the load below which a patch is left out
JUMP = 0.2  # least jump of the relative curvature, over its larger side, that makes a ridge
BESIDE = 1e-6  # mm, distance from a joint at which the curvature of each side is taken
ELEMENTS_PER_SEMI_AXIS = 6.0  # default resolution of a solid with quadratic cells
LINEAR_REFINEMENT = 2.0  # factor on the resolution for linear cells
SECTION_REFINEMENT = 2.0  # factor on the default resolution of a section, where cells cost little
GROWTH = 0.3  # increase of the element size per distance from a patch of default resolution
FULL_GROWTH = 7 / 6  # resolution over the default one above which the growth is smaller
FINEST_SHARE = 0.5  # least ratio of the element sizes in another patch and in the most loaded one
RIDGE_SHARE = 0.25  # element size on a ridge of the pressure over that of its patch
RIDGE_WIDTH = 0.125  # half width of the refined ridge over the element size of its patch
STRETCHES = 9  # stretches that are tried where patches share a mesh
COARSEST = 0.25  # largest element over the half length of the bodies
COARSEST_ACROSS = 1 / 3  # largest element over the width of a profile, for the sake of fillets
HALF_SPACE_REACH = 8.0  # half the edge of the blocks over the major semi-axis
# The same of sections with friction, whose supports do not follow tangential forces: with 8 the
# creepage of a force is 1.3 % below Carter's on any mesh, with 24 it is 0.1 % off.
FRICTION_REACH = 24.0
BODY_REACH = 12.0  # least half length of real bodies over the major semi-axis
MIN_BODY_REACH = 80.0  # mm, least half length of real bodies


@dataclass(frozen=True)
class Zone:
    """An expected contact patch.
    centre: (x, y, z) in space, mm.
    a: half length along the rail, mm; of a line contact both half lengths are its half width.
    b: half length along the tangent across the rail, mm.
    angle: angle of that tangent to the horizontal, rad; positive where z rises with y.
    """

    centre: tuple[float, float, float]
    a: float
    b: float
    angle: float


def touches_nearby(known: cKDTree, touches: Mask, reach: float, points: Array) -> Mask:
    """Whether the known point nearest to each of the points (n, 3) in space, mm, touches and is
    closer than `reach` (mm): (n,) booleans.
    known: KD tree of the known points (m, 3), mm; touches: (m,) whether each of them touches.
    """
    distance, index = known.query(points)
    return np.asarray(touches[index] & (distance < reach))


def in_ellipse(frame: Frame, semi_axes: tuple[float, float], turn: float, points: Array) -> Mask:
    """Whether each of the points (n, 3) in space, mm, lies in an ellipse of the tangent plane,
    closer to the plane than the larger semi-axis: (n,) booleans.
    frame: axes at the contact point. semi_axes: along and across before the ellipse is turned, mm.
    turn: angle of the first semi-axis to the rail in the tangent plane, rad.
    """
    x, s, height = frame.local(points).T
    c, t = math.cos(turn), math.sin(turn)
    a, b = semi_axes
    inside = ((c * x + t * s) / a) ** 2 + ((c * s - t * x) / b) ** 2 < 1.0
    return np.asarray(inside & (np.abs(height) < max(a, b)))


@dataclass(frozen=True)
class Forecast:
    """Expectation of the contact before it is solved.
    zones: patches, most loaded first, never empty.
    moments: centre (x, s) and two semi-axes of an ellipse with the moments of the whole pressure,
        along and across the rail, in the frame of the first contact, mm.
    touching: function of points (n, 3) in space, mm, that gives (n,) whether they are expected to
        touch.
    hertzian: before a solution, exact Hertz is the forecast; after one, the solved pressure is
        Hertz's.
    reason: why exact Hertz stands in where the gap is not a parabola; else empty.
    """

    zones: tuple[Zone, ...]
    moments: tuple[float, float, float, float]
    touching: Callable[[Array], Mask]
    hertzian: bool
    reason: str = ""

    @property
    def minor(self) -> float:
        """Smaller half length of the most loaded patch, mm; of a line contact its half width."""
        return min(self.zones[0].a, self.zones[0].b)


def forecast(context: Context) -> Forecast:
    """Expected patches: exact Hertz where the gap is a parabola or boundary elements find no patch,
    else boundary elements. Patches below 2 % (MINOR) of the contact force are left out.
    """
    contact, found = context.contact, context.half_spaces.elastic
    if isinstance(found, str):  # where nothing else is known the finite elements will tell
        reason = f"boundary elements: {found}" if found else ""
        return replace(_hertz(contact, context.hertz), reason=reason)
    surface, points, forces = context.half_spaces.developed, [], []
    for window in found.windows:
        points.append(surface.points(*window.places))
        forces.append(window.cell * window.pressure.ravel())
    everything, force = np.concatenate(points), np.concatenate(forces)
    known = np.isfinite(everything).all(axis=1)  # cells beyond the profile carry nothing
    everything, force = everything[known], force[known]
    kept = tuple(
        _zone(patch, surface) for patch in found.patches if patch.force > MINOR * found.force
    )
    return Forecast(
        kept,
        _moments(contact.frame.local(everything), force),
        partial(touches_nearby, cKDTree(everything), force > 0, max(zone.b for zone in kept)),
        False,
    )


def _hertz(contact: Contact, ellipse: Hertz) -> Forecast:
    """Forecast of one patch from exact Hertz. The half lengths are the semi-axes, in mm; for a line
    contact both are its half width.
    """
    touch, frame = contact.touch, contact.frame
    touching = partial(in_ellipse, frame, (ellipse.a, ellipse.b), touch.orientation)
    a, b = ellipse.half_lengths
    zone = Zone(contact.origin, a, b, touch.angle)
    return Forecast((zone,), (0.0, 0.0, a, b), touching, True)


def _zone(patch: PatchSolution, surface: Developed) -> Zone:
    """Zone of a boundary-element patch from the whole cells that carry pressure, with the centre of
    its box on the rail's surface and half lengths in mm.
    """
    ends = [
        (axis[index.min()], axis[index.max()], axis[1] - axis[0])
        for axis, index in zip((patch.x, patch.s), np.nonzero(patch.pressure), strict=True)
    ]
    (x, a), (s, b) = (((low + high) / 2, (high - low + step) / 2) for low, high, step in ends)
    (middle,) = surface.points(np.array([x]), np.array([s]))
    centre = (float(middle[0]), float(middle[1]), float(middle[2]))
    return Zone(centre, float(a), float(b), patch.plane)


def _moments(local: Array, force: Array) -> tuple[float, float, float, float]:
    """Centre (x, s) and semi-axes (along, across) in mm of the ellipse with the moments of a
    pressure.
    local: points (n, 3) in the frame of the first contact, mm.
    force: (n,) weights, N; semi-axes are the square root of five times the variance.
    """
    x, s = (float(np.average(local[:, axis], weights=force)) for axis in (0, 1))
    a, b = (
        math.sqrt(5 * float(np.average((local[:, axis] - middle) ** 2, weights=force)))
        for axis, middle in ((0, x), (1, s))
    )
    return x, s, a, b


def ridges(contact: Contact, zone: Zone) -> list[Zone]:
    """Lines along the rail in a patch, on the rail's surface, at which the relative curvature
    across jumps by more than 20 % (JUMP). They are zones without width (b = 0).
    """
    found = []
    for _, profile, shift in contact.cross_profiles:
        for joint in profile.joints:
            y = joint + shift
            across = (y - zone.centre[1]) / (zone.b * math.cos(zone.angle))
            if abs(across) < 1 and _jump(contact, y) > JUMP:
                z = float(contact.profiles["rail"][0].height(y))
                length = zone.a * math.sqrt(1 - across**2)
                found.append(Zone((zone.centre[0], y, z), length, 0.0, zone.angle))
    return found


def _jump(contact: Contact, y: float) -> float:
    """Jump of the relative curvature across at y (mm), over the larger of the curvatures on both
    sides.
    """
    (rail, _), (wheel, shift) = contact.profiles["rail"], contact.profiles["wheel"]
    left, right = (
        float(rail.curvature(beside) - wheel.curvature(beside - shift))
        for beside in (y - BESIDE, y + BESIDE)
    )
    return abs(right - left) / max(abs(left), abs(right), 1e-300)


def body_reach(contact: Contact, hertz: Hertz, forecast: Forecast, *, friction: bool) -> float:
    """Half length of the bodies along the rail, mm, whatever the scene says: a multiple of the
    largest half length of the forecast patches and Hertz's patch, and at least 80 mm
    (MIN_BODY_REACH) for real bodies; beyond the farthest patch where the surfaces
    have a shape, or the first contact is beside x = 0.
    friction: whether it is simulated.
    """
    sizes = [size for zone in forecast.zones for size in (zone.a, zone.b)]
    major = max(*sizes, *hertz.half_lengths)
    if contact.half_space:
        return (FRICTION_REACH if friction and contact.plane else HALF_SPACE_REACH) * major
    varies = contact.shape is not None or contact.origin[0] != 0
    ahead = max(abs(zone.centre[0]) for zone in forecast.zones) if varies else 0.0
    return ahead + max(MIN_BODY_REACH, BODY_REACH * major)


@dataclass(frozen=True, kw_only=True)
class Sizing:
    """Decisions that make the element sizes of a plan.
    context: scene, contact, and decisions on all effects.
    order: polynomial order of the displacement, 1 or 2.
    patch_size: element size in the most loaded patch, mm.
    reach: half length of the bodies along the rail, mm, where the scene gives none; of half-spaces
        half the edge of the blocks.
    forecast: patches that are expected.
    """

    context: Context
    order: int
    patch_size: float
    reach: float
    forecast: Forecast

    @property
    def contact(self) -> Contact:
        """First contact of the undeformed bodies."""
        return self.context.contact

    @property
    def resolution(self) -> float:
        """Elements per smaller semi-axis of the most loaded patch of the forecast, at this patch
        size.
        """
        return self.forecast.minor / self.patch_size

    @property
    def solid_resolution(self) -> float:
        """Elements per smaller semi-axis of a solid at default settings: 6, of linear cells 12."""
        return ELEMENTS_PER_SEMI_AXIS * (LINEAR_REFINEMENT if self.order == 1 else 1.0)

    @property
    def default_resolution(self) -> float:
        """Elements per smaller semi-axis where neither an accuracy nor a patch size is prescribed:
        `solid_resolution`, twice as many in a section.
        """
        return self.solid_resolution * (SECTION_REFINEMENT if self.contact.plane else 1.0)

    @property
    def growth(self) -> float:
        """Increase of the element size per distance from the patch, dimensionless: 0.3 (GROWTH),
        smaller for finer patches. It is larger for coarser ones that the error laws choose, of
        solids with quadratic cells and Nitsche's method, whose laws were measured so.
        """
        coarser, scene = self.solid_resolution / self.resolution, self.context.scene
        others = self.order == 1 or self.contact.plane or scene.solver.method == "penalty"
        least = 1.0 if others or scene.mesh.patch_size else max(1.0, coarser)
        return GROWTH * min(least, FULL_GROWTH * coarser)

    @property
    def coarsest(self) -> float:
        """Largest element size, mm: the smallest of a quarter of `reach` (COARSEST) and a third of
        the width of each profile (COARSEST_ACROSS).
        """
        widths = [np.ptp(profile.domain) for profile, _ in self.contact.profiles.values()]
        return min([COARSEST * self.reach, *(COARSEST_ACROSS * width for width in widths)])

    @cached_property
    def grading(self) -> Grading:
        """Element sizes around the patches of the forecast; smaller patches get smaller elements.
        Elements of a solid are stretched along the rail as far as this saves cells.
        """
        most = max(suited_stretch(zone.a, zone.b) for zone in self.forecast.zones)
        if len(self.forecast.zones) == 1:
            return self._stretched(most)
        tried = (self._stretched(float(k)) for k in np.linspace(1.0, most, STRETCHES))
        hexahedra = self.context.scene.mesh.cell == "hexahedron"
        return min(tried, key=lambda g: g.predicted_cells(self.reach, hexahedra=hexahedra))

    def _stretched(self, stretch: float) -> Grading:
        """Element sizes with that ratio of length along the rail to width; patches that suit a
        smaller stretch get smaller elements instead. Ridges of the pressure are refined in
        tetrahedra.
        """

        def around(zone: Zone) -> Grading:
            """Element sizes around one zone."""
            share = min(zone.a, zone.b) / self.forecast.minor
            size = self.patch_size * min(1.0, max(share, FINEST_SHARE))
            size *= min(1.0, suited_stretch(zone.a, zone.b) / stretch)
            return Grading(
                centre=zone.centre,
                a=zone.a,
                b=zone.b,
                angle=zone.angle,
                size=size,
                growth=self.growth,
                coarsest=self.coarsest,
                stretch=stretch,
            )

        first, *others = (around(zone) for zone in self.forecast.zones)
        # Rows of hexahedra would run across everything.
        if self.context.scene.mesh.cell == "tetrahedron":
            for zone, patch in zip(self.forecast.zones, (first, *others), strict=True):
                width, size = RIDGE_WIDTH * patch.size, RIDGE_SHARE * patch.size
                others += [
                    replace(patch, centre=line.centre, a=line.a, b=width, size=size)
                    for line in ridges(self.contact, zone)
                ]
        return replace(first, also=tuple(others))

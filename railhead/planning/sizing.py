"""Element sizes of a plan: how fine around the forecast patches, and how they grow from there."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from railhead.contact.solid import Contact
from railhead.meshing.grading import Grading, suited_stretch
from railhead.planning.forecast import Forecast, Zone, ridges
from railhead.theory.elastic.line import Hertz

ELEMENTS_PER_SEMI_AXIS = 6.0  # default resolution of a solid with quadratic cells
LINEAR_REFINEMENT = 2.0  # factor on the resolution for linear cells
SECTION_REFINEMENT = 2.0  # factor on the default resolution of a section, where cells cost little
GROWTH = 0.3  # largest increase of the element size per distance; smaller for finer patches
FULL_GROWTH = 7 / 6  # resolution over the default one up to which the growth is the largest
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


def reach(contact: Contact, hertz: Hertz, forecast: Forecast, *, friction: bool) -> float:
    """Half length of the bodies along the rail, mm, whatever the scene says: a multiple of the
    largest half length of the forecast patches and Hertz's patch, and at least 80 mm
    (MIN_BODY_REACH) for real bodies; beyond the farthest patch where the surfaces have a shape.
    friction: whether it is simulated.
    """
    sizes = [size for zone in forecast.zones for size in (zone.a, zone.b)]
    major = max(*sizes, *hertz.half_lengths)
    if contact.half_space:
        return (FRICTION_REACH if friction and contact.plane else HALF_SPACE_REACH) * major
    ahead = max(abs(zone.centre[0]) for zone in forecast.zones) if contact.shape else 0.0
    return ahead + max(MIN_BODY_REACH, BODY_REACH * major)


@dataclass(frozen=True, kw_only=True)
class Sizing:
    """Rules of the element sizes of a plan, and what they depend on.
    contact: first contact of the undeformed bodies, with their own profiles.
    gap_contact: contact whose profiles make the gap: circles of curvature where `true_profile` is
        off.
    forecast: patches around which the mesh is refined.
    cell: 'tetrahedron' or 'hexahedron'; in a section these stand for triangles and quadrilaterals.
    order: polynomial order of the displacement, 1 or 2.
    patch_size: element size in the most loaded patch, mm.
    reach: half length of the bodies along the rail where the scene gives none, mm (`Plan.reach`).
    """

    contact: Contact
    gap_contact: Contact
    forecast: Forecast
    cell: str
    order: int
    patch_size: float
    reach: float

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
        """Increase of the element size per distance from the patch, dimensionless, 0.3 (GROWTH) at
        most; smaller for finer patches.
        """
        return min(GROWTH, GROWTH * FULL_GROWTH * self.solid_resolution / self.resolution)

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
        hexahedra = self.cell == "hexahedron"
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
        if self.cell == "tetrahedron":  # rows of hexahedra would run across everything
            for zone, patch in zip(self.forecast.zones, (first, *others), strict=True):
                width, size = RIDGE_WIDTH * patch.size, RIDGE_SHARE * patch.size
                others += [
                    replace(patch, centre=line.centre, a=line.a, b=width, size=size)
                    for line in ridges(self.gap_contact, zone)
                ]
        return replace(first, also=tuple(others))

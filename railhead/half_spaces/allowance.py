"""By how much finite elements and half-space boundary elements may differ, both being right.

Relative, for the largest pressure and the area, in named parts from the geometry alone:
size        the curvature that held and free faces of the bodies add (theory.elastic)
conformity  1 - cos of half the range of the normals in the patch, on the rail and, by the slope of
            the gap, on the wheel: what a developed plane neglects
share       of several patches: their compliances differ by where the bodies end and by how far side
            forces move the bodies, and those on two rails displace each other through the wheel
            alone; with them the loads change that they carry
            (F ~ d^(3/2), p ~ F^(1/3), area ~ F^(2/3))
twist       the change by the rotation and the movement aside of the bodies where they touch

A load beside the web twists a rail: a wheel that only moves down presses along the contact normal,
and the moment of that force about the centre of twist turns the head. Where the radii of both
bodies change, another place is another patch. The compliance was measured with finite elements:
54E1 and 60E1, a metre long, foot held (`railhead study calibrate`).
"""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from railhead.contact import closed_forms, placed_bodies
from railhead.contact.solid import Contact
from railhead.geometry import profiles
from railhead.half_spaces.pressing import HalfSpacePair
from railhead.half_spaces.surface import Section
from railhead.meshing.bodies import BODY_NAMES, RAIL, WHEEL
from railhead.postprocess.patch.separate_patches import SMALLEST
from railhead.theory.array_types import Array
from railhead.theory.bem.grid_patch import PatchSolution
from railhead.theory.bem.pressure_solver import BoundaryElementSolution
from railhead.theory.elastic import halfspace, hertz
from railhead.theory.elastic.line import Hertz

MEASURED = json.loads((Path(__file__).parent / "data" / "twist.json").read_text(encoding="utf-8"))
COMPLIANCE: dict[str, float] = MEASURED["compliance"]  # twist times E over the moment, 1/mm3
CENTRE: float = MEASURED["centre_mm"]  # depth of the centre of twist below the crown (67 to 76 mm)
STEEP = 0.1  # rad, angle of contacts up to which the centre of twist was measured
SIDEWAYS = {"54E1": 0.5, "60E1": 0.7}
"""Movement of a head beside that by its twist, times E over the side force, 1/mm: 0.4 to 0.5 and
0.65 to 0.75 around the patches of finite elements with the foot held, at 0.35 to 0.5 rad."""
SIDE = 0.5
"""Share of the straight side of a head up to which it ends. On five flanges on 54E1 and 60E1 the
pressure of finite elements differs by 0.3 to 1.1 %, and the allowance is 0.7 to 2.2 %."""
GIVE, EDGE, EDGES = {WHEEL: 0.0025, RAIL: 0.001}, 2.0, 1.5
"""Movement aside of a wheel, or of a head of a crossing, that is held at a depth below several
patches, times E over the side force and the depth, 1/mm2; and factors on what free edges add to a
curvature, and between patches, as their images are point forces. Finite elements of 19 blades and
noses with contacts at 1 to 46 deg differ by 0.1 to 14 % in pressure; 17 of the sums of all parts
are 1.0 to 6 times as large, all within both estimates. Between wide heads it is 20 times."""
Allowance = dict[str, float]
"""Relative difference allowed between finite elements and half-spaces: parts by name, and their
"total"."""


def added_stress(
    pair: HalfSpacePair, deformable: Sequence[int], solved: BoundaryElementSolution
) -> float:
    """Stress, MPa, that held and free faces of the bodies add under a patch of force F: F/(2 pi
    H^2) of a face held at the depth H, half of that of an edge at the distance H, as
    Boussinesq's stresses fall. The face that adds most counts. solved: the contact between half-
    spaces; the others are as in `allowance`.
    """
    return max(
        patch.force / (2 * math.pi * square)
        for span, patches in _patches(pair, solved)
        for patch in patches
        for body in _bodies(pair, deformable, span)
        for square in (body.depth**2, *(2 * (end - patch.centroid[1]) ** 2 for end in body.ends))
    )


@dataclass(frozen=True)
class _Body:
    """A deformable body of finite size.

    wheel: whether it is the wheel.
    weight: its (1 - nu^2)/E over the sum of those of both bodies, 0 to 1.
    poisson: Poisson's ratio.
    depth: nominal depth at which it is held, mm, as `placed_bodies.depth`.
    ends: positions s of its free edges on the developed rail, mm.
    give: its movement aside, times E over the side force, 1/mm; that of a plain rail, 0 here, is in
        `twist` and `sideways`.
    """

    wheel: bool
    weight: float
    poisson: float
    depth: float
    ends: tuple[float, float]
    give: float

    def curvatures(self, s: float) -> tuple[float, float]:
        """Curvatures of the surface at s (mm), over F/(pi E*), 1/mm^3, that the held face adds
        along and across under a force F, and that free edges add across; along it is -1/2 of that.
        """
        edges = sum(halfspace.free_edge(abs(s - end), self.poisson) for end in self.ends)
        return self.weight * halfspace.held_below(self.depth, self.poisson), self.weight * edges

    def influence(self, s: Array) -> Array:
        """Influence matrix (n, n), 1/mm, of the faces where the body ends, at places s (n,), mm.
        It is the displacement over F/(pi E*), by forces F at the same places through the images at
        free edges and held face. A displacement common to all places is left out.
        """
        psi = halfspace.image_force(self.poisson)
        apart = [abs(s - end) for end in self.ends]
        edges = sum(psi / (distance[:, None] + distance) for distance in apart)
        below = halfspace.held_below(self.depth, self.poisson) * (s[:, None] - s) ** 2 / 2
        return np.asarray(self.weight * (edges + below))

    def aside(self, lean: Array) -> Array:
        """Influence matrix (n, n), 1/mm, as of `influence`, of the movement aside: lean (n,) is the
        part across the track of a unit force along each normal, and also the part of a way aside
        that is along it.
        """
        unit = self.weight * self.give * math.pi / (1 - self.poisson**2)
        return np.asarray(unit * np.outer(lean, lean))


def allowance(pair: HalfSpacePair, deformable: Sequence[int], twist: float) -> dict[str, Allowance]:
    """Allowed relative differences by "max_MPa" and "area_mm2", of a solid contact of profiles.
    That of the pressure is of the patch that may have the largest one. That of the area is the mean
    of all patches, by their areas.

    pair: of a solid contact that is none of half-spaces.
    deformable: tags of the bodies that deform.
    twist: relative change of pressure and area by the rotation and the movement of the bodies,
        which is taken over as a part.
    Raises ValueError where boundary elements find no closed patch.
    """
    solved = pair.boundary_elements
    spans = [(patches, _bodies(pair, deformable, span)) for span, patches in _patches(pair, solved)]
    pairs = [(patch, around) for patches, around in spans for patch in patches]
    forces = np.zeros(1) if len(pairs) == 1 else _force_changes(pair, spans)
    # A force is in the largest pressure to the power 1/3, and in the area to the power 2/3.
    found = [
        (
            patch,
            {
                "size": _size(patch, around),
                "conformity": _conformity(patch, solved.contact_modulus),
                "twist": twist,
                "share": float(force) / 3,
            },
        )
        for (patch, around), force in zip(pairs, forces, strict=True)
    ]
    _, top = max(found, key=lambda each: each[0].max_pressure * (1 + sum(each[1].values())))
    areas = [patch.area for patch, _ in found]
    mean = {
        name: float(np.average([parts[name] for _, parts in found], weights=areas)) for name in top
    }
    allowed = {"max_MPa": top, "area_mm2": {**mean, "share": 2 * mean["share"]}}
    return {key: {**parts, "total": sum(parts.values())} for key, parts in allowed.items()}


def _patches(
    pair: HalfSpacePair, solved: BoundaryElementSolution
) -> list[tuple[Section, list[PatchSolution]]]:
    """Each body on the rail's side and the patches of a half-space solution that are nearest to its
    contact, but those with at most 0.2 % (SMALLEST) of the force.
    """
    spans = pair.developed.sections
    kept = [each for each in solved.patches if each.force > SMALLEST * solved.force]
    of = [pair.developed.at(each.centroid[1]) for each in kept]
    return [(span, [k for k, near in zip(kept, of, strict=True) if near is span]) for span in spans]


def _bodies(pair: HalfSpacePair, deformable: Sequence[int], span: Section) -> list[_Body]:
    """The deformable bodies of a contact, by their tags, with the places of their free edges on the
    developed surface of the rail. The head of a standard rail ends on its straight sides (SIDE),
    below the profile.
    """
    contact, scene = pair.contact, pair.contact.scene
    modulus = closed_forms.contact_modulus(scene)
    found = []
    for tag in deformable:
        part, depth = scene.bodies[BODY_NAMES[tag]], placed_bodies.depth(scene, tag)
        weight = modulus / closed_forms.plane_strain_modulus(scene, tag)
        if tag == RAIL:
            side = SIDE * profiles.head_side(placed_bodies.standard_rail(scene))
            low, high = span.ends[0] - side, span.ends[1] + side
        else:
            low, high = placed_bodies.tread(contact, span.touch)
        ends = span.middle + low, span.middle + high
        give = GIVE[tag] * depth if tag == WHEEL or scene.rail.varies else 0.0
        found.append(_Body(tag == WHEEL, weight, part.poisson_ratio, depth, ends, give))
    return found


def _size(patch: PatchSolution, around: list[_Body]) -> float:
    """Relative change of the largest pressure of a patch, as `hertz.pressure_rise`: magnitudes
    of that by held faces and of that by free edges (EDGE), each of all bodies.
    """
    held, edges = np.sum([body.curvatures(patch.centroid[1]) for body in around], axis=0)
    half = patch.half_extents
    by_edges = hertz.pressure_rise(-edges / 2, edges, *half)
    return hertz.pressure_rise(held, held, *half) + EDGE * abs(by_edges)


def _conformity(patch: PatchSolution, contact_modulus: float) -> float:
    """Sum of 1 - cos of three slopes: half the range of the normals in a patch, and the slopes of
    the gap at its ends along and across, by Hertz's pressure on the half lengths of the patch and
    its force. contact_modulus: E*, MPa.
    """
    a, b = patch.half_extents
    unit = patch.force / (math.pi * contact_modulus)
    along, across = (unit * each for each in halfspace.own_curvatures(a, b))
    normals = np.ptp(patch.angle[patch.pressure.any(axis=0)])
    return sum(1 - math.cos(slope) for slope in (normals / 2, a * along, b * across))


def _force_changes(
    pair: HalfSpacePair, spans: Sequence[tuple[list[PatchSolution], list[_Body]]]
) -> Array:
    """Magnitude (n,) of the relative change of the force on each of n patches by held and free
    faces, by the way aside, and by rails that are apart, whose magnitudes add up; the sum of forces
    is fixed. A force changes by 3/2 of the relative change of its patch's compression.
    spans: patches on each rail, and the bodies there. Half-spaces let patches on unlike rails
        displace each other through the rail, too.
    """
    patches = [each for patches, _ in spans for each in patches]
    force = np.array([each.force for each in patches])
    x, s = np.transpose([each.centroid for each in patches])
    places, lean = pair.developed.points(x, s), np.sin(pair.developed.angle(s))
    of = np.repeat(np.arange(len(spans)), [len(patches) for patches, _ in spans])
    same = of[:, None] == of
    apart = np.where(same, np.inf, np.linalg.norm(places[:, None] - places, axis=-1))
    faces, aside, rails = np.zeros((3, *same.shape))
    for number, (_, around) in enumerate(spans):
        here = (of == number)[:, None]
        for body in around:
            felt = here & (same | body.wheel)
            faces += np.where(felt, EDGES * body.influence(s), 0.0)
            aside += np.where(felt, body.aside(lean), 0.0)
            rails -= np.where(here & ~felt, body.weight / apart, 0.0)
    stiffness = [1.5 / halfspace.own_approach(*patch.half_extents) for patch in patches]
    rest = np.array([faces, aside, rails]) @ force
    middle = np.average(rest, axis=1, weights=stiffness)[:, None]
    return np.asarray(np.abs(rest - middle).sum(axis=0) * stiffness / force)


def lever(contact: Contact, centre: float = CENTRE) -> float:
    """Distance in y of the contact normal from the centre of twist, at the height of this centre,
    mm, positive on the field side.
    centre: depth of the centre of twist below the crown, mm.
    """
    touch, inclination = contact.touch, contact.scene.rail.inclination
    return touch.y + (touch.z + centre) * touch.slope - centre * inclination


def twist(contact: Contact, ellipse: Hertz) -> float:
    """Rotation of the rail head, rad, positive towards the middle of the track, under the vertical
    load of `ellipse`, whose own load is the normal force. A measured rail is taken for the softer
    one of the standard rails.
    """
    moment = -ellipse.load * math.cos(contact.touch.angle) * lever(contact)
    rail = contact.scene.rail
    compliance = COMPLIANCE.get(rail.profile, max(COMPLIANCE.values()))
    return compliance * moment / rail.young_modulus


def sideways(contact: Contact, ellipse: Hertz) -> float:
    """Movement of the wheel along y relative to the rail head, mm, as the side force of a contact
    with the load of `ellipse` bends the web, beside that by `twist`. It is 0 for other than
    standard rails, and up to 0.1 rad (STEEP).
    """
    rail, angle = contact.scene.rail, contact.touch.angle
    force = ellipse.load * math.sin(angle) if abs(angle) > STEEP else 0.0
    return -SIDEWAYS.get(rail.profile, 0.0) * force / rail.young_modulus


def twisted(contact: Contact, angle: float, aside: float) -> Contact:
    """Contact with the wheel lowered onto the rail whose head is turned by `angle` (rad) about its
    crown and moved by -aside (mm) along y relative to the wheel. The turn is positive towards the
    middle of the track.
    Not for half-spaces. Raises PlacementError where the wheel misses the rail.
    """
    assert contact.pair is not None and contact.pose is not None
    rail = contact.scene.rail
    if rail.profile in COMPLIANCE:
        slope = math.tan(math.atan(rail.inclination) + angle)
        turned = profiles.rail_head(rail.profile, slope)
    else:
        turned = profiles.rolled(contact.pair.rail, math.tan(angle))
    pair = replace(contact.pair, rail=turned)
    beside = contact.pose.moved(y=aside)
    pose = beside.moved(z=-pair.touches(beside)[0].gap)
    return replace(contact, touch=pair.touches(pose)[0], pair=pair, pose=pose)


def moved(pair: HalfSpacePair, angle: float, aside: float) -> float:
    """Relative change of the largest pressure or of the area, the larger one and never negative,
    where the rail is turned by `angle` (rad) and moved by -aside (mm), by boundary elements. It is
    0 for a block, a rigid rail, a contact in the plane of symmetry and one radius each.
    Raises ValueError where the wheel misses the twisted rail or there is no closed patch.
    """
    scene, contact = pair.contact.scene, pair.contact
    still = not (angle or aside) or scene.rail.profile == "arc" or scene.rail.varies
    if still or pair.one_radius or contact.why_asymmetric_in_y() is None:
        return 0.0
    before, other = pair.boundary_elements, twisted(contact, angle, aside)
    load = scene.load or before.load
    after = HalfSpacePair(other, closed_forms.ellipse(scene, other, load)).pressed(load)
    pressure, area = after.max_pressure / before.max_pressure, after.area / before.area
    return max(abs(pressure - 1), abs(area - 1))

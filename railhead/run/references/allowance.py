"""By how much finite elements and half-space boundary elements may differ, both being right.

Relative, for the largest pressure and the area, in named parts from the geometry alone:
size        the curvature that held and free faces of the bodies add (theory/finite_bodies.py)
conformity  1 - cos of half the range of the normals in the patch, on the rail and, by the slope of
            the gap, on the wheel: what a developed plane neglects
share       of several patches: their compliances differ by where the bodies end, and with them the
            loads they carry (F ~ d^(3/2), p ~ F^(1/3), area ~ F^(2/3))
twist       the change by the rotation and the movement aside of the bodies where they touch
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from railhead.contact import bodies
from railhead.meshing.tags import BODY_NAMES, RAIL
from railhead.planning.plan import Plan
from railhead.planning.references import boundary_elements, closed_forms, rail_twist
from railhead.planning.references.boundary_elements import Developed
from railhead.postprocess.patch.separate_patches import SMALLEST
from railhead.theory.bem.boundary_element import Solution
from railhead.theory.bem.patch import PatchSolution
from railhead.theory.elastic import finite_bodies

Array = NDArray[np.float64]


@dataclass(frozen=True)
class _Body:
    """A deformable body of finite size.

    weight: its share of the compliance of both bodies.
    poisson: Poisson's ratio.
    depth: distance from the contact to the held face, mm.
    ends: positions s of its free edges on the developed rail, mm.
    """

    weight: float
    poisson: float
    depth: float
    ends: tuple[float, float]

    def curvature(self, s: float) -> float:
        """Curvature of the surface at s (mm) that held and free faces add under a force F, over
        F/(pi E*), 1/mm^3.
        """
        edges = sum(finite_bodies.free_edge(abs(s - end), self.poisson) for end in self.ends)
        return self.weight * (finite_bodies.held_below(self.depth, self.poisson) + edges)

    def between(self, s: Array) -> Array:
        """Displacement of places s (n,), mm, by unit forces at the same places through the images
        at free edges and held face, over F/(pi E*): a matrix (n, n), 1/mm. A displacement common
        to all places is left out.
        """
        psi = finite_bodies.image(self.poisson)
        apart = [abs(s - end) for end in self.ends]
        edges = sum(psi / (distance[:, None] + distance) for distance in apart)
        below = finite_bodies.held_below(self.depth, self.poisson) * (s[:, None] - s) ** 2 / 2
        return np.asarray(self.weight * (edges + below))


def allowance(
    plan: Plan, solution: Solution, motion: tuple[float, float]
) -> dict[str, dict[str, float]]:
    """Allowed relative differences of "max_MPa" and "area_mm2", for a plan of a solid contact and
    its half-space solution: by quantity, the parts by name and their "total".

    motion: relative rotation of the rail (rad) and lateral movement of the wheel (mm). Raises
        ValueError where the effect of a motion cannot be computed.
    """
    patches = [each for each in solution.patches if each.force > SMALLEST * solution.force]
    around = _bodies(plan, boundary_elements.develop(plan.contact))
    shift, areas = _shares(patches, around), np.array([patch.area for patch in patches])
    twist = 0.0
    if plan.contact.why_asymmetric_in_y() is not None:
        twist = rail_twist.change(plan.contact, plan.context.boundary_elements, *motion)
    allowed = {}
    for key, share in (
        ("max_MPa", float(shift.max()) / 3),
        ("area_mm2", float(2 / 3 * shift @ areas / areas.sum())),
    ):
        parts = {
            "size": max(_size(patch, around) for patch in patches),
            "conformity": max(_conformity(patch, solution.contact_modulus) for patch in patches),
            "share": share,
            "twist": twist,
        }
        allowed[key] = {**parts, "total": sum(parts.values())}
    return allowed


def _bodies(plan: Plan, surface: Developed) -> list[_Body]:
    """The deformable bodies of a plan, with the developed surface of the contact."""
    scene, touch = plan.scene, plan.contact.touch
    modulus = closed_forms.contact_modulus(scene)
    found = []
    for tag in plan.deformable:
        weight = modulus / closed_forms.plane_strain_modulus(scene, tag)
        if tag == RAIL:
            ends = float(surface.s[0]), float(surface.s[-1])
        else:
            low, high = plan.contact.profiles["wheel"][0].domain
            half = (scene.wheel.width or math.inf) / 2
            ends = max(low - touch.wheel_y, -half), min(high - touch.wheel_y, half)
        poisson = plan.poisson_ratios[BODY_NAMES[tag]]
        found.append(_Body(weight, poisson, bodies.depth(scene, tag), ends))
    return found


def _size(patch: PatchSolution, around: list[_Body]) -> float:
    """Relative change of the largest pressure of a patch by held and free faces of the bodies."""
    curvature = sum(body.curvature(patch.centroid[1]) for body in around)
    return finite_bodies.change(curvature, *patch.half_extents)


def _conformity(patch: PatchSolution, contact_modulus: float) -> float:
    """Sum of 1 - cos of three slopes: half the range of the normals in a patch, and the slopes of
    the gap at its ends along and across.
    """
    a, b = patch.half_extents
    unit = patch.force / (math.pi * contact_modulus)
    along, across = (unit * each for each in finite_bodies.own_curvatures(a, b))
    used = patch.angle[patch.pressure.any(axis=0)]
    slopes = (float(np.ptp(used)) / 2, a * along, b * across)
    return sum(1 - math.cos(slope) for slope in slopes)


def _shares(patches: list[PatchSolution], around: list[_Body]) -> Array:
    """Relative change (n,) of the force on each of n patches by held and free faces, the sum of
    forces being fixed: force changes by 3/2 of the relative change of its compression.
    """
    force = np.array([patch.force for patch in patches])
    if len(patches) == 1:
        return np.zeros(1)
    s = np.array([patch.centroid[1] for patch in patches])
    rest = sum(body.between(s) @ force for body in around)
    stiffness = [1.5 / finite_bodies.own_approach(*patch.half_extents) for patch in patches]
    return np.asarray(np.abs(rest - np.average(rest, weights=stiffness)) * stiffness / force)

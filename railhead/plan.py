"""What will be simulated, how finely, and why: decided before anything is built."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from meshing.bodies import Options
from meshing.sizing import Grading
from meshing.tags import BODIES, RAIL, SYMMETRY_X, SYMMETRY_Y, WHEEL
from railhead import accuracy, geometry, machine
from railhead.geometry import Contact
from railhead.scene import Scene, SceneError
from theory import hertz
from theory.hertz import Ellipse

ELEMENTS_PER_SEMI_AXIS = 6.0  # default patch resolution for quadratic cells
LINEAR_REFINEMENT = 2.0  # linear cells are made so much smaller
GROWTH = 0.3  # of the element size with distance, at most; finer patches grow more slowly
FULL_GROWTH = 7 / 6  # times the default resolution, up to which the growth is the largest
COARSEST = 0.25  # largest element over the half length of the bodies
HALF_SPACE_REACH = 8.0  # edge of the blocks over the major semi-axis: the far field is exact
BODY_REACH = 12.0  # half length of real bodies over the major semi-axis, at least
MIN_BODY_REACH = 80.0  # mm
UNKNOWNS_PER_CELL = {
    ("tetrahedron", 1): 0.6,
    ("tetrahedron", 2): 4.5,
    ("hexahedron", 1): 3.2,
    ("hexahedron", 2): 25.0,
}


@dataclass(frozen=True)
class Effect:
    """One physical effect or simplification: called for by the scene, on, and why."""

    called_for: bool
    on: bool
    why: str

    def summary(self) -> dict[str, Any]:
        """As in summary.json."""
        return {"called_for": self.called_for, "on": self.on, "why": self.why}


@dataclass(frozen=True)
class Plan:
    """Decisions for one scene; `estimate` is exact Hertz with the curvatures at first contact."""

    scene: Scene
    contact: Contact
    estimate: Ellipse
    effects: dict[str, Effect]
    order: int
    patch_size: float
    reach: float

    @property
    def default_resolution(self) -> float:
        """Elements per smaller semi-axis without an asked accuracy."""
        return ELEMENTS_PER_SEMI_AXIS * (LINEAR_REFINEMENT if self.order == 1 else 1.0)

    @property
    def resolution(self) -> float:
        """Elements per smaller semi-axis of the predicted patch."""
        return min(self.estimate.a, self.estimate.b) / self.patch_size

    def at_resolution(self, n: float) -> Plan:
        """The same plan with n elements per smaller semi-axis."""
        return replace(self, patch_size=min(self.estimate.a, self.estimate.b) / n)

    @property
    def half_x(self) -> bool:
        """Only x >= 0 is modelled."""
        return self.effects["symmetry_x"].on

    @property
    def half_y(self) -> bool:
        """Only y >= 0 is modelled."""
        return self.effects["symmetry_y"].on

    @property
    def planes(self) -> tuple[tuple[int, tuple[float, float, float]], ...]:
        """Facet tag and normal of the symmetry planes in use."""
        planes = []
        if self.half_x:
            planes.append((SYMMETRY_X, (1.0, 0.0, 0.0)))
        if self.half_y:
            planes.append((SYMMETRY_Y, (0.0, 1.0, 0.0)))
        return tuple(planes)

    @property
    def slave(self) -> int:
        """The softer body carries the contact quadrature and the stress of Nitsche's method."""
        scene = self.scene
        return (
            RAIL
            if plane_strain_modulus(scene, RAIL) <= plane_strain_modulus(scene, WHEEL)
            else WHEEL
        )

    @property
    def options(self) -> Options:
        """Cells, degree of the geometry, and whether one half is left out."""
        curved = self.order > 1 and not self.contact.half_space
        return Options(self.scene.mesh.cell, 2 if curved else 1, self.half_x)

    def grading(self, a: float | None = None, b: float | None = None) -> Grading:
        """Sizes around the predicted patch, or around one of the given semi-axes (mm)."""
        return Grading(
            self.contact.origin,
            a or self.estimate.a,
            b or self.estimate.b,
            self.contact.touch.angle,
            self.patch_size,
            min(GROWTH, GROWTH * FULL_GROWTH * self.default_resolution / self.resolution),
            coarsest=COARSEST * self.reach,
        )

    @property
    def unknowns(self) -> int:
        """Predicted from the element density."""
        bodies = sum(self.effects[f"deformable_{name}"].on for name in ("rail", "wheel"))
        share = bodies * 0.5 ** (self.half_x + self.half_y)
        cell = self.scene.mesh.cell
        cells = self.grading().predicted_cells(self.reach, hexahedra=cell == "hexahedron")
        return int(share * cells * UNKNOWNS_PER_CELL[cell, self.order])

    @property
    def seconds(self) -> float:
        """Predicted for the whole process without pictures."""
        return machine.START + machine.seconds(self.unknowns)

    def summary(self) -> dict[str, Any]:
        """As in summary.json."""
        return {
            "effects": {name: effect.summary() for name, effect in self.effects.items()},
            "unknowns": self.unknowns,
            "predicted_seconds": self.seconds,
            "patch_size_mm": self.patch_size,
            "slave": BODIES[self.slave],
            "contact_angle_rad": self.contact.touch.angle,
        }


def plane_strain_modulus(scene: Scene, body: int) -> float:
    """E / (1 - nu^2), MPa."""
    part = scene.rail if body == RAIL else scene.wheel
    return part.young_modulus / (1 - part.poisson_ratio**2)


def contact_modulus(scene: Scene) -> float:
    """E*, MPa."""
    rail, wheel = scene.rail, scene.wheel
    return hertz.contact_modulus(
        rail.young_modulus, rail.poisson_ratio, wheel.young_modulus, wheel.poisson_ratio
    )


def estimate(scene: Scene, contact: Contact, load: float | None = None) -> Ellipse:
    """Exact Hertz for the pair; the normal force of a vertical load is load / cos(angle)."""
    touch, modulus = contact.touch, contact_modulus(scene)
    load = load if load is not None else scene.load
    cosine = math.cos(touch.angle)
    if load is not None:
        return hertz.point_contact(touch.curvature_x, touch.curvature_y, modulus, load / cosine)
    return hertz.point_contact_from_approach(
        touch.curvature_x, touch.curvature_y, modulus, float(scene.approach or 0.0) * cosine
    )


def make(scene: Scene) -> Plan:
    """Decide. Raises SceneError for a pair that cannot be solved as a point contact."""
    contact = geometry.locate(scene)
    ellipse = estimate(scene, contact)
    order = scene.mesh.order or (2 if scene.mesh.cell == "tetrahedron" else 1)
    minor, major = sorted((ellipse.a, ellipse.b))
    n = ELEMENTS_PER_SEMI_AXIS * (LINEAR_REFINEMENT if order == 1 else 1.0)
    if scene.accuracy is not None:
        n = accuracy.resolution(scene.accuracy, order)
    size = scene.mesh.patch_size or minor / n
    if contact.half_space:
        reach = HALF_SPACE_REACH * major
    else:
        reach = max(MIN_BODY_REACH, BODY_REACH * major)
    return Plan(scene, contact, ellipse, _effects(scene, contact), order, size, reach)


def _effects(scene: Scene, contact: Contact) -> dict[str, Effect]:
    force = scene.effects.symmetry
    across = contact.mirror_across
    if force == "on" and across is not None:
        raise SceneError("effects.symmetry", f"'on' is not allowed: {across}; give auto or off")
    allowed = force != "off"
    forced = "" if allowed else "; switched off by effects.symmetry"
    rigid = [
        name
        for name, part in (("rail", scene.rail), ("wheel", scene.wheel))
        if math.isinf(part.young_modulus)
    ]
    return {
        "symmetry_x": Effect(
            True, allowed, f"the wheel stands straight: x = 0 mirrors bodies and load{forced}"
        ),
        "symmetry_y": Effect(
            across is None,
            allowed and across is None,
            f"{across or 'profiles and load mirror at y = 0'}{forced}",
        ),
        "far_field": Effect(
            contact.half_space,
            contact.half_space,
            "half-spaces: the blocks' outer faces follow the exact displacement far from the patch"
            if contact.half_space
            else "the bodies end where they really end",
        ),
        "deformable_rail": Effect(
            "rail" not in rigid, "rail" not in rigid, _stiffness(scene, RAIL)
        ),
        "deformable_wheel": Effect(
            "wheel" not in rigid, "wheel" not in rigid, _stiffness(scene, WHEEL)
        ),
    }


def _stiffness(scene: Scene, body: int) -> str:
    young = (scene.rail if body == RAIL else scene.wheel).young_modulus
    return (
        "E is infinite: only its surface takes part" if math.isinf(young) else f"E = {young:g} MPa"
    )

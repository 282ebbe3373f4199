"""What will be simulated, how finely, and why: decided before anything is built."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from railhead.contact import bodies, dimension, plane_section
from railhead.contact import solid as geometry
from railhead.contact.solid import Contact
from railhead.meshing.bodies import ELEMENTS_PER_TURN, Body, Options
from railhead.meshing.sizing import Grading, suited_stretch
from railhead.meshing.tags import BODIES, RAIL, SYMMETRY_X, SYMMETRY_Y, WHEEL
from railhead.planning import effects
from railhead.planning.accuracy import error_envelopes, uncertainty
from railhead.planning.accuracy.error_envelopes import Family, Setting
from railhead.planning.accuracy.uncertainty import Uncertainty
from railhead.planning.cost import machine
from railhead.planning.effects import Context, Effect
from railhead.planning.effects.base import touching
from railhead.planning.effects.interface import friction
from railhead.planning.effects.material import plasticity
from railhead.planning.effects.shape.true_profile import one_radius
from railhead.planning.patch.forecast import Forecast, Zone, forecast
from railhead.planning.patch.ridges import ridges
from railhead.planning.references import closed_forms
from railhead.scene.scene import Scene, SceneError
from railhead.scene.sections import Rail, Wheel
from railhead.theory.elastic import contacts
from railhead.theory.elastic.contacts import Hertz

if TYPE_CHECKING:
    from railhead.solver.material.elasticity import Material

ELEMENTS_PER_SEMI_AXIS = 6.0  # default patch resolution for quadratic cells
LINEAR_REFINEMENT = 2.0  # linear cells are made so much smaller
SECTION_REFINEMENT = 2.0  # so are those of a section, where they cost nearly nothing
GROWTH = 0.3  # of the element size with distance, at most; finer patches grow more slowly
FULL_GROWTH = 7 / 6  # times the default resolution, up to which the growth is the largest
FINEST_SHARE = 0.5  # elements in a further patch over those in the most loaded one, at least
RIDGE_SHARE = 0.25  # elements on a ridge of the pressure over those of its patch ...
RIDGE_WIDTH = 0.125  # ... and half the width that has them, over the latter
STRETCHES = 9  # tried where patches share a mesh
COARSEST = 0.25  # largest element over the half length of the bodies ...
COARSEST_ACROSS = 1 / 3  # ... and over the width of a profile: coarser ones cut through fillets
HALF_SPACE_REACH = 8.0  # edge of the blocks over the major semi-axis: the far field is exact
BODY_REACH = 12.0  # half length of real bodies over the major semi-axis, at least
MIN_BODY_REACH = 80.0  # mm
SECTION_PER_TURN = 5  # elements on a full turn of a fillet of a whole section (4: 3 % less twist)
SECTION_CELLS = 8.5  # for each mm of a whole section beyond those of its head (measured)


@dataclass(frozen=True)
class Plan:
    """Decisions for one scene; `forecast` is the patch that is expected; load_steps: of bodies that
    yield, from first yield to the load."""

    context: Context
    effects: dict[str, Effect]
    order: int
    patch_size: float
    reach: float
    forecast: Forecast
    load_steps: int

    @property
    def scene(self) -> Scene:
        """What was asked for."""
        return self.context.scene

    @property
    def contact(self) -> Contact:
        """First contact of the undeformed bodies."""
        return self.context.contact

    @property
    def estimate(self) -> Hertz:
        """Exact Hertz with the curvatures at first contact."""
        return self.context.hertz

    @property
    def solid_resolution(self) -> float:
        """Elements per smaller semi-axis of a solid at default settings."""
        return ELEMENTS_PER_SEMI_AXIS * (LINEAR_REFINEMENT if self.order == 1 else 1.0)

    @property
    def default_resolution(self) -> float:
        """Elements per smaller semi-axis without an asked accuracy."""
        return self.solid_resolution * (SECTION_REFINEMENT if self.section else 1.0)

    @property
    def resolution(self) -> float:
        """Elements per smaller semi-axis of the predicted patch."""
        return self.forecast.minor / self.patch_size

    @property
    def setting(self) -> Setting:
        """What the errors of this plan depend on besides the element size."""
        scene, zone = self.scene, self.zone
        moduli = [closed_forms.plane_strain_modulus(scene, tag) for tag in BODIES]
        contact = self.contact
        shape = "half-spaces" if contact.half_space else "bodies"
        if self.section:
            shape = "meridian" if contact.revolved else "plane strain"
        return Setting(
            shape=shape,
            turned=contact.line and not contact.lengthwise,
            cell=scene.mesh.cell,
            order=self.order,
            method=scene.solver.method,
            theta=scene.solver.theta,
            gamma_factor=scene.solver.gamma_factor,
            poisson=max(self.poisson_ratios.values()),
            least_poisson=min(self.poisson_ratios.values()),
            ellipse=self.forecast.hertzian,
            parabolic=contact.half_space,
            axis_ratio=max(zone) / min(zone),
            stiffness=0.0 if math.isinf(max(moduli)) else min(moduli) / max(moduli),
        )

    @property
    def family(self) -> Family | None:
        """Whose error laws hold for this plan: none were measured with yield or friction."""
        return error_envelopes.family(self.setting) if self.plain else None

    @property
    def plain(self) -> bool:
        """Whether it is elastic and frictionless."""
        return not (self.effects["plasticity"].on or self.effects["friction"].on)

    @property
    def section(self) -> bool:
        """Whether two dimensions are enough."""
        return bool(self.contact.plane)

    @property
    def zone(self) -> tuple[float, float]:
        """Half lengths of the most loaded patch along and across, mm; of a line its half width."""
        return self.forecast.zones[0].a, self.forecast.zones[0].b

    def at_resolution(self, n: float) -> Plan:
        """The same plan with n elements per smaller semi-axis."""
        return replace(self, patch_size=self.forecast.minor / n)

    def flipped(self, name: str) -> Plan:
        """The same plan with one effect in its other state."""
        effect = self.effects[name]
        if self.section and ("off" if effect.on else "on") in effect.refused:
            return self
        if name == "axisymmetry" and effect.called_for:
            return _decided(self.scene.replace([f"effects.{name}={'off' if effect.on else 'on'}"]))
        return replace(self, effects={**self.effects, name: replace(effect, on=not effect.on)})

    def turned_on(self, name: str, why: str) -> Plan:
        """The same plan with an effect that the solution calls for."""
        effect = replace(self.effects[name], called_for=True, on=True, why=why)
        return replace(self, effects={**self.effects, name: effect})

    def price(self, name: str) -> tuple[int, float]:
        """Unknowns and seconds that an effect's state is predicted to cost; negative: it saves."""
        other = self.flipped(name)
        return self.unknowns - other.unknowns, self.seconds - other.seconds

    @property
    def left_out(self) -> float:
        """Relative error that effects left out by the plan add to every quantity."""
        return sum(effect.error for effect in self.effects.values())

    @cached_property
    def uncertainty(self) -> Uncertainty | None:
        """That comes from measured profiles; None without any."""
        return uncertainty.of_profiles(self.context)

    @property
    def hidden(self) -> float:
        """Relative error that measured profiles may hide; no mesh makes it smaller."""
        return self.uncertainty.relative if self.uncertainty else 0.0

    @property
    def profiles(self) -> dict[str, dict[str, Any]]:
        """How profiles from files were read and smoothed, by body, as in summary.json."""
        if self.contact.half_space:
            return {}
        places = {"rail": self.contact.touch.y, "wheel": self.contact.touch.tread}
        found = {}
        for body in geometry.measured_bodies(self.scene):
            each = geometry.from_file(self.scene, body)
            at_contact = each.wavelength(places[body])
            found[body] = {**each.summary(), "smoothing_at_contact_mm": at_contact}
        return found

    @property
    def deformable(self) -> tuple[int, ...]:
        """Tags of the bodies that are meshed."""
        return tuple(tag for tag in BODIES if self.effects[f"deformable_{BODIES[tag]}"].on)

    @property
    def shown(self) -> Rail | Wheel:
        """The body whose stresses are reported: the rail, unless it is rigid."""
        return self.scene.rail if RAIL in self.deformable else self.scene.wheel

    @property
    def poisson_ratios(self) -> dict[str, float]:
        """Of the bodies that are meshed, by name, the one shown first."""
        return {BODIES[tag]: self._part(tag).poisson_ratio for tag in self.deformable}

    def _part(self, body: int) -> Rail | Wheel:
        return self.scene.rail if body == RAIL else self.scene.wheel

    def material(self, body: int) -> Material:
        """Elastic constants of RAIL or WHEEL as simulated."""
        from railhead.solver.material.elasticity import Material

        part = self._part(body)
        young = part.young_modulus if body in self.deformable else math.inf
        return Material(young, part.poisson_ratio)

    @cached_property
    def surfaces(self) -> Contact:
        """The contact whose profiles make the gap."""
        if self.contact.lengthwise or self.effects["true_profile"].on:
            return self.contact
        return one_radius(self.contact)

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
        if self.half_x or self.contact.revolved:
            planes.append((SYMMETRY_X, (1.0, 0.0, 0.0)))
        if self.half_y:
            planes.append((SYMMETRY_Y, (0.0, 1.0, 0.0)))
        return tuple(planes)

    @property
    def slave(self) -> int:
        """The body that carries the contact quadrature and the stress of Nitsche's method: the
        softer one, or the one that stays elastic where the other yields."""
        yields = {RAIL: self.scene.rail.yields, WHEEL: self.scene.wheel.yields}
        elastic = [tag for tag in self.deformable if not yields[tag]]
        if self.effects["plasticity"].on and len(elastic) == 1 and len(self.deformable) == 2:
            return elastic[0]
        return min(
            self.deformable, key=lambda tag: closed_forms.plane_strain_modulus(self.scene, tag)
        )

    @property
    def options(self) -> Options:
        """Cells, degree of the geometry, and whether one half is left out."""
        curved = self.order > 1 and not self.contact.half_space
        cell = self.scene.mesh.cell
        per_turn = SECTION_PER_TURN if self.with_foot else ELEMENTS_PER_TURN
        return Options(cell, 2 if curved else 1, self.half_x, self.contact.plane, per_turn)

    def parts(self) -> list[Body]:
        """Sections and sweeps of the deformable bodies. Raises SceneError where they make none."""
        contact = self.contact
        half = contact.revolved or (self.half_x if contact.plane == "xz" else self.half_y)
        make = plane_section.bodies if contact.plane else bodies.bodies
        whole = self.effects["rail_section"].on
        return make(contact, self.reach, self.deformable, whole_section=whole, half=half)

    @property
    def with_foot(self) -> bool:
        """The rail is meshed with web and foot."""
        section = self.effects["rail_section"]
        return section.on and not section.refused and RAIL in self.deformable

    @property
    def growth(self) -> float:
        """Of the element size with the distance from the patch."""
        return min(GROWTH, GROWTH * FULL_GROWTH * self.solid_resolution / self.resolution)

    @cached_property
    def coarsest(self) -> float:
        """The largest element size (mm)."""
        widths = [np.ptp(profile.domain) for _, profile, _ in touching(self.contact)]
        return min([COARSEST * self.reach, *(COARSEST_ACROSS * width for width in widths)])

    def grading(self) -> Grading:
        """Sizes around the patches of the forecast; smaller patches get smaller elements. Elements
        are stretched along the rail as far as it saves cells."""
        if self.section:
            return self._stretched(1.0)
        most = max(suited_stretch(zone.a, zone.b) for zone in self.forecast.zones)
        if len(self.forecast.zones) == 1:
            return self._stretched(most)
        tried = (self._stretched(float(k)) for k in np.linspace(1.0, most, STRETCHES))
        hexahedra = self.scene.mesh.cell == "hexahedron"
        return min(tried, key=lambda g: g.predicted_cells(self.reach, hexahedra=hexahedra))

    def _stretched(self, stretch: float) -> Grading:
        """Patches that want less than this stretch get smaller elements instead."""

        def around(zone: Zone) -> Grading:
            share = min(zone.a, zone.b) / self.forecast.minor
            size = self.patch_size * min(1.0, max(share, FINEST_SHARE))
            size *= min(1.0, suited_stretch(zone.a, zone.b) / stretch)
            return Grading(
                zone.centre, zone.a, zone.b, zone.angle, size, self.growth,
                coarsest=self.coarsest, stretch=stretch,
            )  # fmt: skip

        first, *others = (around(zone) for zone in self.forecast.zones)
        if self.scene.mesh.cell == "tetrahedron":  # rows of hexahedra would run across everything
            for zone, patch in zip(self.forecast.zones, (first, *others), strict=True):
                width, size = RIDGE_WIDTH * patch.size, RIDGE_SHARE * patch.size
                others += [
                    replace(patch, centre=line.centre, a=line.a, b=width, size=size)
                    for line in ridges(self.surfaces, zone)
                ]
        return replace(first, also=tuple(others))

    @cached_property
    def unknowns(self) -> int:
        """Predicted from the element density."""
        cell = self.scene.mesh.cell
        share = 0.5 ** (self.half_x + self.half_y)
        if self.section:
            share *= len(self.deformable) * (0.5 if self.contact.revolved else 1.0)
            triangles = self.grading().predicted_triangles(self.reach)
            return int(share * triangles * unknowns_per_cell("section", cell, self.order))
        cells = self.grading().predicted_cells(self.reach, hexahedra=cell == "hexahedron")
        cells *= len(self.deformable)
        if self.with_foot:
            half = bodies.rail_reach(self.contact, self.reach, whole_section=True)
            cells += SECTION_CELLS * 2 * half
        return int(share * cells * unknowns_per_cell("solid", cell, self.order))

    @property
    def seconds(self) -> float:
        """Predicted for the whole process without pictures."""
        return machine.START + self.solving

    @property
    def solving(self) -> float:
        """Predicted for one mesh without the start of the process, s."""
        more = plasticity.WORK * self.load_steps if self.effects["plasticity"].on else 0.0
        if self.effects["friction"].on and not self.section:
            more += friction.WORK * self.unknowns / friction.AT
        return self.cost.time(self.unknowns) * (1 + more)

    @property
    def cost(self) -> machine.Cost:
        """What an unknown of this kind of model takes without yield and friction."""
        if self.section:
            return machine.SECTION
        kind = self.scene.mesh.cell, self.order
        known = machine.HALF_SPACES if self.contact.half_space else machine.PROFILES
        return machine.OTHER.get(kind, known)

    @property
    def memory(self) -> int:
        """Predicted peak, bytes."""
        each = self.cost.bytes
        if self.effects["plasticity"].on:
            each += plasticity.BYTES
        if self.effects["friction"].on:
            each += friction.BYTES
        return machine.BASE_BYTES + each * self.unknowns

    def summary(self) -> dict[str, Any]:
        """As in summary.json."""
        return {
            "effects": {name: self._effect(name) for name in self.effects},
            "unknowns": self.unknowns,
            "predicted_seconds": self.seconds,
            "chosen": effects.chosen(self.effects),
            "patch_size_mm": self.patch_size,
            "slave": BODIES[self.slave],
            "contact_angle_rad": self.contact.touch.angle,
            **(
                {}
                if (found := friction.rolled(self.context)) is None
                else {"wheelset": found.summary()}
            ),
            "forecast": {"hertzian": self.forecast.hertzian, "reason": self.forecast.reason},
            "profiles": self.profiles,
            "profile_uncertainty": self.uncertainty and vars(self.uncertainty),
        }

    def _effect(self, name: str) -> dict[str, Any]:
        unknowns, seconds = self.price(name)
        cost = {"unknowns": unknowns, "seconds": seconds}
        return {**self.effects[name].summary(), "predicted_cost": cost}


@cache
def _cell_table() -> dict[str, Any]:
    file = Path(__file__).parent / "cost" / "data" / "cells.json"
    table: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    return table


def unknowns_per_cell(kind: str, cell: str, order: int) -> float:
    """Of a predicted cell in a 'solid' or 'section': measured by `studies.accuracy.cells`."""
    return float(_cell_table()[kind][cell][str(order)])


def make(scene: Scene) -> Plan:
    """Decide. Raises SceneError for a pair that cannot be solved as a point contact, an accuracy
    that no mesh is expected to meet, and bodies that cannot be built."""
    plan = _decided(scene)
    if scene.accuracy is not None and scene.budget is None and plan.family is not None:
        least = plan.family.least + plan.left_out
        if scene.accuracy < least:
            instead = " or solver.method=nitsche" if scene.solver.method == "penalty" else ""
            raise SceneError(
                "accuracy",
                f"{scene.accuracy:g} is out of reach of the error laws of the family "
                f"{plan.family.name}; give {math.ceil(1e4 * least) / 1e4:g} or more, a "
                f"budget{instead}",
            )
    plan.parts()
    return plan


def _decided(scene: Scene) -> Plan:
    """Whether or not its bodies can be built."""
    kind = dimension.choose(scene)
    contact = geometry.locate(scene) if kind.kind == "solid" else plane_section.locate(scene, kind)
    predicted = closed_forms.finite(scene, contact)
    context, decided = effects.decide(scene, kind, contact, predicted)
    expected = forecast(context)
    order = scene.mesh.order or (2 if scene.mesh.cell == "tetrahedron" else 1)
    major = max(max(zone.a, zone.b) for zone in expected.zones)
    major = max(major, *contacts.half_lengths(predicted))
    if contact.half_space:
        reach = HALF_SPACE_REACH * major
    else:
        reach = max(MIN_BODY_REACH, BODY_REACH * major)
    size = scene.mesh.patch_size or expected.minor
    plan = Plan(context, decided, order, size, reach, expected, plasticity.steps(context))
    if scene.mesh.patch_size:
        return plan
    plan = plan.at_resolution(plan.default_resolution)
    if scene.accuracy is None or plan.family is None:
        return plan
    return plan.at_resolution(plan.family.finest(scene.accuracy - plan.left_out))

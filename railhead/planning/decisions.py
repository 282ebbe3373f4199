"""What a plan decides: effects, element sizes, steps, and the model that follows from them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from railhead.contact import closed_forms, placed_bodies, solid
from railhead.contact.plane_section import SectionContact
from railhead.meshing.bodies import (
    BODY_NAMES,
    ELEMENTS_PER_TURN,
    RAIL,
    SYMMETRY_X,
    SYMMETRY_Y,
    WHEEL,
    Body,
    Options,
)
from railhead.planning import cost, error_envelopes
from railhead.planning.context import Effect
from railhead.planning.effects import interface, material
from railhead.planning.error_envelopes import Family
from railhead.planning.forecast import Sizing
from railhead.scene.scene import Scene
from railhead.theory.elastic.line import Hertz

SECTION_PER_TURN = 5  # elements on a full turn of a fillet of a whole rail (4: 3 % less twist)
SECTION_CELLS = 8.5  # cells of web and foot for each mm of a whole rail (measured)
TOLERANCE_SHARE = 0.02  # of an error envelope of the mesh: the residual adds 4 % to it at most
LARGEST_TOLERANCE = 1e-3  # of Newton's method on meshes whose envelopes are larger than the values
DEFAULT_TOLERANCE = 1e-6  # of Newton's method where no error of the mesh is known
STEP_ORDER = 1.5  # of the error of load steps; 1.5 to 2.2 were measured from two steps on
LOAD_STEP_SHARE = 0.25  # largest share of an accuracy that the error of load steps takes
MOST_STEPS = 16  # largest factor on the usual number of load steps
ELLIPTIC = 0.01  # largest deviation of the gap of patches that are read as ellipses, as below
PARABOLA = 3e-4  # largest deviation of the gap from a parabola, over the approach, and ...
FAR = 4.0  # ... least distance of edges and supports, over half lengths, of semi-ellipsoids


@dataclass(frozen=True, kw_only=True)
class Decisions(Sizing):
    """Decisions for one scene, those on element sizes (`Sizing`) included.

    load_steps: number of load steps from first yield to the load; it counts only where yield is on.

    Where half-spaces answer (`by_half_spaces`), there is no mesh, and sizes and order have no
    effect.
    """

    load_steps: int

    @property
    def scene(self) -> Scene:
        """The scene that is planned."""
        return self.context.scene

    @property
    def effects(self) -> Mapping[str, Effect]:
        """Decisions on effects by name, in the order of `effects.EFFECTS`."""
        return self.context.decided

    @property
    def hertz(self) -> Hertz:
        """Exact Hertz with the curvatures at first contact, under the load or approach of the
        scene; its load is the normal force.
        """
        return self.context.hertz

    @property
    def setting(self) -> dict[str, Any]:
        """Properties of the plan that its errors depend on, besides the element size and friction.
        shape: 'half-spaces' (meshed blocks), 'bodies' (solids that end), 'plane strain' or
            'meridian'; of sections also between half-spaces.
        turned: whether the width of a line contact runs across the rail.
        cell, method, theta, gamma_factor: as the scene has them under mesh and solver.
        order: of the displacement, 1 or 2.
        poisson, least_poisson: largest and least Poisson's ratio of the deformable bodies.
        ellipse: whether the patch is expected to be read as Hertz's.
        axis_ratio: longer over shorter half length of the most loaded patch; 1 of a line contact.
        stiffness: smaller over larger E/(1 - nu^2) of the two bodies; 0 where one is rigid, also by
            choice.
        overload: load over that of first yield where yield is simulated, else 0.
        """
        scene, contact = self.scene, self.contact
        moduli = [
            young / (1 - scene.bodies[name].poisson_ratio ** 2)
            for name, young in self.context.young_moduli.items()
        ]
        ratios = [part.poisson_ratio for part in self.context.deformable.values()]
        return {
            "shape": "half-spaces" if contact.solid_half_space else contact.error_family_shape,
            "turned": contact.prescribed_length == "a_mm",
            "cell": scene.mesh.cell,
            "order": self.order,
            "method": scene.solver.method,
            "theta": scene.solver.theta,
            "gamma_factor": scene.solver.gamma_factor,
            "poisson": max(ratios),
            "least_poisson": min(ratios),
            "ellipse": self.forecast.hertzian and self.context.half_spaces.gap_deviation < ELLIPTIC,
            "axis_ratio": max(self.zone) / min(self.zone),
            "stiffness": 0.0 if math.isinf(max(moduli)) else min(moduli) / max(moduli),
            "overload": self.context.overload if self.effects["plasticity"].on else 0.0,
        }

    @property
    def family(self) -> Family | None:
        """Family of calibrated error envelopes whose laws hold for this plan. None where half-
        spaces answer without a mesh, where friction changes the pressure or the yield, and where no
        family was calibrated for such a model. Half-spaces that are meshed have a family of their
        own, and so have bodies that yield.
        """
        rubs = self.effects["friction"].on
        changed = interface.unlike(self.context) or self.effects["plasticity"].on
        return None if self.by_half_spaces or (rubs and changed) else self.family_of(self.setting)

    def family_of(self, setting: Mapping[str, Any]) -> Family | None:
        """Family of a setting like that of this plan, with the laws of friction in sections."""
        rubs = self.effects["friction"].on and self.plane_model
        return error_envelopes.family(setting, parabolic=self.parabolic, friction=rubs)

    @cached_property
    def parabolic(self) -> bool:
        """Whether the pressure of bodies that stay elastic is Hertz's semi-ellipsoid: between half-
        spaces, and of solids whose gap is a parabola within 0.03 % (PARABOLA) and whose supports
        and edges across are farther than 4 (FAR) half lengths. What images of supports and edges,
        twice as far away, change in the patch is a parabola, too, up to the fifth power of
        half of 1/FAR.
        """
        contact = self.contact
        if not contact.curved_solid or self.context.half_spaces.gap_deviation > PARABOLA:
            return contact.half_space
        y = contact.touch.y
        ends = [
            abs(end + shift - y) for _, each, shift in contact.cross_profiles for end in each.domain
        ]
        return FAR * max(self.zone) < min(*ends, *self.held.values())

    @property
    def stresses_asked(self) -> bool:
        """Whether the stresses of the solution are read, which has friction or not."""
        return self.scene.asks("friction_stresses" if self.effects["friction"].on else "stresses")

    @property
    def by_half_spaces(self) -> bool:
        """Whether half-spaces answer, by boundary elements or exact Hertz, without a mesh."""
        return not self.effects["finite_bodies"].on

    @property
    def elastic_laws_hold(self) -> bool:
        """Whether error envelopes, and costs, of elastic and frictionless bodies hold."""
        return not (self.effects["plasticity"].on or self.effects["friction"].on)

    @property
    def plane_model(self) -> bool:
        """Whether a section in two dimensions is solved: plane strain, or a meridian section."""
        return bool(self.contact.plane)

    @property
    def zone(self) -> tuple[float, float]:
        """Half lengths (along the rail, along the tangent across it) of the most loaded patch of
        the forecast, mm; of a line contact both are its half width.
        """
        return self.forecast.zones[0].a, self.forecast.zones[0].b

    def at_resolution(self, n: float) -> Self:
        """The plan whose patch size makes n elements per smaller semi-axis of the most loaded
        patch.
        """
        return replace(self, patch_size=self.forecast.minor / n)

    def with_yield(self, why: str) -> Self:
        """The plan in which yield is called for and simulated, and bodies that have a yield stress
        deform; why: the reason as a sentence.
        """
        context = self.context
        named = [f"deformable_{name}" for name, part in context.stressed.items() if part.yields]
        for name in ("plasticity", *named):
            if not (effect := self.effects[name]).on:
                effect = replace(effect, called_for=True, on=True, why=why, error=0.0)
                context = context.with_decision(name, effect)
        return replace(self, context=context)

    @property
    def omission_error(self) -> float:
        """Sum of the relative errors that effects left out by the plan add to every quantity; those
        of unknown size count as 0.
        """
        return sum(effect.error for effect in self.effects.values())

    @property
    def load_step_errors(self) -> dict[str, float]:
        """Relative errors that load steps leave where bodies yield, by key of summary.json; empty
        without yield, and where none were measured (`error_envelopes.load_steps`).
        """
        if not self.effects["plasticity"].on:
            return {}
        known = error_envelopes.load_steps(self.context.overload, line=self.contact.line)
        fewer = (material.steps(self.context) / self.load_steps) ** STEP_ORDER
        return {name: fewer * error for name, error in known.items()}

    @property
    def error_without_meshes(self) -> float:
        """Largest relative error that no finer mesh reduces, of the numbers that an accuracy
        counts: by load steps and by effects that are left out.
        """
        return self.omission_error + max(self.load_step_errors.values(), default=0)

    def for_accuracy(self, accuracy: float) -> Self:
        """The plan whose load steps leave at most 0.25 (LOAD_STEP_SHARE) of a relative accuracy,
        and whose mesh is expected to meet the rest, the finest one that the error laws cover where
        none does. Without laws the element size stays as it is. There are at most 16 (MOST_STEPS)
        times the usual load steps.
        """
        usual = replace(self, load_steps=material.steps(self.context))
        error = usual.error_without_meshes - self.omission_error
        more = (error / (LOAD_STEP_SHARE * accuracy)) ** (1 / STEP_ORDER)
        steps = math.ceil(usual.load_steps * min(max(more, 1.0), MOST_STEPS))
        plan = replace(self, load_steps=steps if error else self.load_steps)
        if self.family is None:
            return plan
        return plan.at_resolution(self.family.finest(accuracy - plan.error_without_meshes))

    @cached_property
    def uncertainty(self) -> dict[str, Any] | None:
        """Relative error that measured profiles may hide, as of `error_envelopes.of_profiles`;
        boundary elements are solved at the first call.
        """
        return error_envelopes.of_profiles(self.context)

    @property
    def profile_error(self) -> float:
        """Relative error of largest pressure and area, one number, that measured profiles may hide:
        0 without such profiles, infinite where boundary elements find no patch. No mesh makes it
        smaller.
        """
        return float(self.uncertainty["relative"]) if self.uncertainty else 0.0

    @property
    def profiles(self) -> dict[str, dict[str, Any]]:
        """By body ('rail', 'wheel') whose profile comes from a file: remarks on reading, noise and
        smoothing wavelengths, as in summary.json.
        """
        bodies = solid.measured_bodies(self.scene)
        return {body: solid.from_file(self.scene, body).summary() for body in bodies}

    @property
    def deformable(self) -> tuple[int, ...]:
        """Tags of the bodies that deform, RAIL before WHEEL: meshed where there is a mesh."""
        return tuple(tag for tag in BODY_NAMES if self.effects[f"deformable_{BODY_NAMES[tag]}"].on)

    @property
    def poisson_ratios(self) -> dict[str, float]:
        """Poisson's ratio by 'rail' and 'wheel' of the bodies that the pressure stresses. The depth
        axis of the first one is reported.
        """
        return {name: part.poisson_ratio for name, part in self.context.stressed.items()}

    @property
    def rigid(self) -> dict[str, float]:
        """Poisson's ratio of those of `poisson_ratios` that are not meshed."""
        ratios = self.poisson_ratios.items()
        return {name: nu for name, nu in ratios if name not in self.context.deformable}

    @property
    def half_x(self) -> bool:
        """Whether only x >= 0 is modelled, with a symmetry plane at x = 0. False for a meridian
        section, which ends at x = 0 in any case.
        """
        return self.effects["symmetry_x"].on

    @property
    def half_y(self) -> bool:
        """Whether only y >= 0 is modelled, with a symmetry plane at y = 0."""
        return self.effects["symmetry_y"].on

    @property
    def planes(self) -> tuple[tuple[int, tuple[float, float, float]], ...]:
        """Facet tag and unit normal (x, y, z) of each symmetry plane in use, x first; the axis of a
        meridian section counts as the plane x = 0.
        """
        planes = (
            (self.half_x or self.contact.revolved, SYMMETRY_X, (1.0, 0.0, 0.0)),
            (self.half_y, SYMMETRY_Y, (0.0, 1.0, 0.0)),
        )
        return tuple((tag, normal) for used, tag, normal in planes if used)

    @property
    def slave(self) -> int:
        """Tag of the body that carries the contact quadrature and the stress of Nitsche's method,
        one of those that deform. This is the body that stays elastic where the other one yields,
        else the softer one.
        """
        yields = {RAIL: self.scene.rail.yields, WHEEL: self.scene.wheel.yields}
        elastic = [tag for tag in self.deformable if not yields[tag]]
        if self.effects["plasticity"].on and len(elastic) == 1 and len(self.deformable) == 2:
            return elastic[0]
        return min(
            self.deformable, key=lambda tag: closed_forms.plane_strain_modulus(self.scene, tag)
        )

    @property
    def held(self) -> dict[str, float]:
        """Vertical distance from the first contact to where each meshed body is held, mm, by 'rail'
        and 'wheel'; of a support that is not level its nearest point. The approach is that of these
        places, and of rigid bodies. Empty for half-spaces, also where they stand for bodies.
        """
        half_space = self.by_half_spaces or self.contact.half_space
        return {
            BODY_NAMES[body.tag]: min(
                abs(float(body.pose.outward(np.array([0.0, *point]))[2]) - self.contact.touch.z)
                for curve in body.section
                if curve.role == "support"
                for point in curve.points
            )
            for body in ([] if half_space else self.parts())
        }

    @property
    def options(self) -> Options:
        """Options of the mesher: cell, geometric order, symmetry at x = 0, plane of a section and
        elements per full turn of a fillet.
        """
        curved = self.order > 1 and not self.contact.half_space
        per_turn = SECTION_PER_TURN if self.with_foot else ELEMENTS_PER_TURN
        return Options(
            self.scene.mesh.cell, 2 if curved else 1, self.half_x, self.contact.plane, per_turn
        )

    def parts(self) -> list[Body]:
        """Sections and sweeps of the deformable bodies, rail first; of a model cut at y = 0, or of
        a section cut at x = 0, half outlines. Raises SceneError where a dimension of the scene
        makes no valid body.
        """
        contact = self.contact
        half = self.options.symmetry in dict(self.planes)
        whole = self.effects["rail_section"].on
        if isinstance(contact, SectionContact):
            return contact.bodies(self.reach, self.deformable, whole_section=whole, half=half)
        return placed_bodies.bodies(
            contact, self.reach, self.deformable, whole_section=whole, half=half
        )

    @property
    def with_foot(self) -> bool:
        """Whether the rail is meshed with web and foot: it deforms, and the effect `rail_section`
        is on. False for half-spaces and in sections along the rail.
        """
        section = self.effects["rail_section"]
        return section.on and not section.refused and RAIL in self.deformable

    @cached_property
    def unknowns(self) -> int:
        """Predicted number of unknowns of the mesh, from the density of elements and the symmetry
        planes; 0 where half-spaces answer.
        """
        if self.by_half_spaces:
            return 0
        cell = self.scene.mesh.cell
        share = 0.5 ** len(self.planes)
        if self.plane_model:
            triangles = len(self.deformable) * self.grading.predicted_triangles(self.reach)
            each = cost.unknowns_per_cell("section", cell, self.order)
            return int(share * triangles * each)
        cells = self.grading.predicted_cells(self.reach, hexahedra=cell == "hexahedron")
        cells *= len(self.deformable)
        if self.with_foot:
            half = placed_bodies.rail_reach(self.contact, self.reach, whole_section=True)
            cells += SECTION_CELLS * 2 * half
        return int(share * cells * cost.unknowns_per_cell("solid", cell, self.order))

    @property
    def newton_tolerance(self) -> float:
        """Tolerance of Newton's method, residual over the contact force: that of the scene, else
        0.02 (TOLERANCE_SHARE) of an expected error, but at most 1e-3 (LARGEST_TOLERANCE).

        That error is the smallest envelope of elastic, frictionless bodies on this mesh. Without
        envelopes, or with yield, it is the accuracy of the scene. Without an accuracy, and with
        friction, the tolerance is 1e-6 (DEFAULT_TOLERANCE).
        """
        family, n = self.family, self.resolution
        if self.scene.solver.tolerance is not None:
            return self.scene.solver.tolerance
        if family is not None and self.elastic_laws_hold:
            smallest = min(family.mesh(name, n) for name in family.laws)
        elif self.scene.accuracy and not self.effects["friction"].on:
            smallest = self.scene.accuracy
        else:
            return DEFAULT_TOLERANCE
        return min(TOLERANCE_SHARE * smallest, LARGEST_TOLERANCE)

    @property
    def condenses(self) -> bool:
        """Whether friction, where it acts, is solved by static condensation to the contact points,
        which needs factors of the bodies: in sections, with unlike materials, and where bodies
        yield.
        """
        return self.plane_model or interface.unlike(self.context) or self.effects["plasticity"].on

"""What will be simulated, how finely, and why: decided before anything is built."""

import math
from dataclasses import dataclass
from typing import Any

from railhead.contact import closed_forms, plane_section
from railhead.half_spaces import torque_free
from railhead.meshing.bodies import (
    BODY_NAMES,
)
from railhead.planning import effects
from railhead.planning.decisions import Decisions
from railhead.planning.effects import material
from railhead.planning.forecast import body_reach, forecast
from railhead.planning.price import Price
from railhead.scene.scene import Scene, SceneError

MOST_UNKNOWNS = 1e9  # of a mesh that is planned: a thousand times the largest that was solved


@dataclass(frozen=True, kw_only=True)
class Plan(Decisions):
    """Decisions for one scene, what they cost, and how both are told."""

    @property
    def price(self) -> Price:
        """Predicted seconds and memory, and prices of accuracies."""
        return Price(self)

    def to_dict(self) -> dict[str, Any]:
        """Output of `railhead plan --json`: case, scene, plan, contact, hertz, patches, mesh,
        solver and prices.
        Lengths are in mm, angles in rad, pressures in MPa. Relative radii are infinite where the
        relative curvature is 0.
        """
        scene, touch, ellipse = self.scene, self.contact.touch, self.hertz
        along, across = (
            1 / curvature if curvature else math.inf
            for curvature in (touch.curvature_x, touch.curvature_y)
        )
        return {
            "case": scene.name,
            "scene": scene.model_dump(exclude_none=True),
            "plan": self.summary(),
            "contact": {
                "y_mm": touch.y,
                "z_mm": touch.z,
                "angle_rad": touch.angle,
                "relative_radius_along_mm": along,
                "relative_radius_across_mm": across,
            },
            "hertz": {"a_mm": ellipse.a, "b_mm": ellipse.b, "p0_MPa": ellipse.p0},
            "patches": [
                {"centre_mm": list(zone.centre), "a_mm": zone.a, "b_mm": zone.b}
                for zone in self.forecast.zones
            ],
            "mesh": {
                "cell": scene.mesh.cell,
                "order": self.order,
                "patch_size_mm": self.patch_size,
            },
            "solver": {"method": scene.solver.method, "linear": scene.solver.linear},
            "prices": self.price.prices(),
        }

    def summary(self) -> dict[str, Any]:
        """The entry 'plan' of summary.json: effects, predicted unknowns
        and seconds, overruled effects ('chosen'), patch size, slave body, where bodies are held,
        contact angle, wheelset creepage where the wheelset prescribes it, forecast, measured
        profiles and their uncertainty.
        """
        wheelset = {}
        if self.scene.rolling.from_wheelset:
            wheelset["wheelset"] = self.context.wheelset.summary()
        return {
            "effects": {name: effect.summary() for name, effect in self.effects.items()},
            "unknowns": self.unknowns,
            "predicted_seconds": self.price.seconds,
            "chosen": effects.overruled(self.effects),
            "patch_size_mm": self.patch_size,
            "slave": BODY_NAMES[self.slave],
            "held_mm": self.held,
            "contact_angle_rad": self.contact.touch.angle,
            **wheelset,
            "forecast": {"hertzian": self.forecast.hertzian, "reason": self.forecast.reason},
            "profiles": self.profiles,
            "profile_uncertainty": self.uncertainty,
        }


def make(scene: Scene) -> Plan:
    """The plan of a scene; nothing is meshed. Its bodies are outlined once as a check.
    Raises SceneError for a pair that cannot be solved as a point or line contact, and, where no
    budget is given, for an accuracy that no mesh is expected to meet. So it does for effects that a
    person cannot choose, for bodies that cannot be built, and above 1e9 (MOST_UNKNOWNS) unknowns.
    """
    plan = _decided(scene)
    if scene.accuracy is not None and scene.budget is None and plan.family is not None:
        least = plan.family.least + plan.error_without_meshes
        if scene.accuracy < least:
            instead = " or solver.method=nitsche" if scene.solver.method == "penalty" else ""
            raise SceneError(
                "accuracy",
                f"{scene.accuracy:g} is out of reach of the error laws of the family "
                f"{plan.family.name}; give {math.ceil(1e4 * least) / 1e4:g} or more, a "
                f"budget{instead}",
            )
    if plan.unknowns > MOST_UNKNOWNS:
        raise SceneError(
            "mesh.patch_size",
            f"{plan.patch_size:.3g} mm makes about {plan.unknowns:.2g} unknowns, more than "
            f"{MOST_UNKNOWNS:g}; give a larger one",
        )
    plan.parts()
    return plan


def _decided(scene: Scene) -> Plan:
    """The plan of a scene, whether or not its bodies can be built. Raises SceneError for a pair
    without a valid contact, a patch that is too large or too small, and effects that a person
    cannot choose.
    """
    kind = plane_section.choose(scene)
    contact = plane_section.locate(scene, kind)
    predicted = closed_forms.hertz_if_valid(scene, contact)
    contact = torque_free.balanced(contact)
    context = effects.decide(scene, kind, contact, predicted)
    expected = forecast(context)
    order = scene.mesh.order or (2 if scene.mesh.cell == "tetrahedron" else 1)
    size = scene.mesh.patch_size or expected.minor
    plan = Plan(
        context=context,
        order=order,
        patch_size=size,
        reach=body_reach(contact, predicted, expected, friction=context.decided["friction"].on),
        forecast=expected,
        load_steps=material.steps(context) if context.decided["plasticity"].on else 1,
    )
    if scene.mesh.patch_size:
        return plan
    plan = plan.at_resolution(plan.default_resolution)
    return plan if scene.accuracy is None else plan.for_accuracy(scene.accuracy)

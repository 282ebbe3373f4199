"""Which effects a scene calls for, which are simulated, and whether the solution bears it out.

Each effect has a function (scene, contact, ellipse) -> Effect, and where it applies one that
weighs the same indicator on the solution, (scene, contact, effect, findings) -> After | None.
"""

from __future__ import annotations

from railhead.geometry.solid import Contact
from railhead.planning.effects import (
    assumptions,
    deformable,
    far_field,
    friction,
    mean_dilatation,
    plasticity,
    rail_section,
    sections,
    symmetry,
    true_profile,
)
from railhead.planning.effects.base import After, Effect, Hertz
from railhead.postprocess.findings import Findings
from railhead.scene.scene import Scene, SceneError

__all__ = ["After", "Effect", "check", "decide"]

DECISIONS = {
    "plane_strain": sections.plane_strain,
    "axisymmetry": sections.axisymmetry,
    "symmetry_x": symmetry.along,
    "symmetry_y": symmetry.across,
    "deformable_rail": deformable.rail,
    "deformable_wheel": deformable.wheel,
    "rail_section": rail_section.decide,
    "far_field": far_field.decide,
    "true_profile": true_profile.decide,
    "mean_dilatation": mean_dilatation.decide,
    "plasticity": plasticity.decide,
    "friction": friction.decide,
}
CHECKS = {
    "rail_section": rail_section.check,
    "true_profile": true_profile.check,
    "plasticity": plasticity.check,
    "friction": friction.check,
}
ASSUMPTIONS = {
    "small_patch": assumptions.small_patch,
    "inside_the_bodies": assumptions.inside_the_bodies,
    "thick_bodies": assumptions.thick_bodies,
}


def decide(scene: Scene, contact: Contact, ellipse: Hertz) -> dict[str, Effect]:
    """All effects by name; SceneError for a choice that cannot be had."""
    found = {
        name: decision(scene, contact, ellipse).forced(name, scene.effects.state(name))
        for name, decision in DECISIONS.items()
    }
    bodies = ("deformable_rail", "deformable_wheel")
    if not any(found[name].on for name in bodies):
        chosen = next(name for name in bodies if found[name].override)
        raise SceneError(
            f"effects.{chosen}", "'off' is not allowed: the other body is rigid; give auto or on"
        )
    return found


def check(
    scene: Scene, contact: Contact, effects: dict[str, Effect], found: Findings
) -> dict[str, After]:
    """The indicators on the solution, by effect or assumption."""
    after = {name: weigh(scene, contact, effects[name], found) for name, weigh in CHECKS.items()}
    after |= {name: weigh(scene, contact, found) for name, weigh in ASSUMPTIONS.items()}
    return {name: each for name, each in after.items() if each is not None}

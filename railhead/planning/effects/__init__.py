"""Which effects a scene calls for, which are simulated, and whether the solution bears it out.

An effect is a `Feature` of this list, and may ask what was decided before it.
"""

from __future__ import annotations

from collections.abc import Mapping

from railhead.contact.dimension import Dimension
from railhead.contact.solid import Contact
from railhead.planning.effects import assumptions
from railhead.planning.effects.base import After, Context, Effect, Feature
from railhead.planning.effects.interface import friction, heat  # fmt: skip
from railhead.planning.effects.material import deformable, mean_dilatation, plasticity
from railhead.planning.effects.shape import (
    far_field,
    rail_section,
    sections,
    symmetry,
    true_profile,
)
from railhead.postprocess.findings import Findings
from railhead.scene.scene import Scene, SceneError
from railhead.theory.elastic.contacts import Hertz

__all__ = ["EFFECTS", "After", "Context", "Effect", "check", "chosen", "decide"]

EFFECTS = {
    "plane_strain": Feature(sections.plane_strain),
    "axisymmetry": Feature(sections.axisymmetry, alike=True),
    "symmetry_x": Feature(symmetry.along, alike=True),
    "symmetry_y": Feature(symmetry.across, alike=True),
    "deformable_rail": Feature(deformable.rail),
    "deformable_wheel": Feature(deformable.wheel),
    "true_profile": Feature(true_profile.decide, true_profile.check),
    "rail_section": Feature(rail_section.decide, rail_section.check),
    "far_field": Feature(far_field.decide, apply=far_field.apply),
    "mean_dilatation": Feature(mean_dilatation.decide, apply=mean_dilatation.apply, alike=True),
    "friction": Feature(friction.decide, friction.check, friction.apply, beyond=True),
    "plasticity": Feature(plasticity.decide, plasticity.check, plasticity.apply, beyond=True),
    "heat": Feature(heat.decide, heat.check, beyond=True),
}
ASSUMPTIONS = {
    "small_patch": assumptions.small_patch,
    "inside_the_bodies": assumptions.inside_the_bodies,
    "thick_bodies": assumptions.thick_bodies,
}


def decide(
    scene: Scene, dimension: Dimension, contact: Contact, hertz: Hertz
) -> tuple[Context, dict[str, Effect]]:
    """All effects by name, and what they were decided by; SceneError for a choice that cannot be
    had."""
    found: dict[str, Effect] = {}
    context = Context(scene, dimension, contact, hertz, found)
    for name, effect in EFFECTS.items():
        found[name] = effect.decide(context).forced(name, scene.effects.state(name))
    bodies = ("deformable_rail", "deformable_wheel")
    if not any(found[name].on for name in bodies):
        chosen = next(name for name in bodies if found[name].override)
        raise SceneError(
            f"effects.{chosen}", "'off' is not allowed: the other body is rigid; give auto or on"
        )
    return context, found


def chosen(effects: Mapping[str, Effect]) -> list[str]:
    """Names of those by which a person chose another problem than the scene calls for."""
    return [
        name
        for name, each in effects.items()
        if each.override and each.called_for != each.on and not EFFECTS[name].alike
    ]


def left_out(effects: Mapping[str, Effect], after: Mapping[str, After]) -> dict[str, str]:
    """Why effects are called for that are not simulated, by name, except those that a person has
    overruled and those without which the exact answer is the same."""
    out = {}
    for name, each in effects.items():
        weighed = after.get(name, After(each.called_for, each.why))
        if weighed.needed and not (each.on or each.override or EFFECTS[name].alike):
            out[name] = weighed.why
    return out


def check(made: Context, effects: Mapping[str, Effect], found: Findings) -> dict[str, After]:
    """The indicators on the solution, by effect or assumption."""
    after = {name: each.check(made, effects[name], found) for name, each in EFFECTS.items()}
    after |= {name: weigh(made, found) for name, weigh in ASSUMPTIONS.items()}
    return {name: each for name, each in after.items() if each is not None}

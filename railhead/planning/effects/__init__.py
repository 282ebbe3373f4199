"""Which effects a scene calls for, which are simulated, and whether the solution bears it out."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

from railhead.contact.plane_section import Dimension
from railhead.contact.solid import Contact
from railhead.planning.context import Context, Effect, PostSolveVerdict
from railhead.planning.effects import interface, material, passes, shape
from railhead.postprocess.findings import Findings
from railhead.scene.scene import Scene, SceneError
from railhead.scene.sections import refuse_first
from railhead.theory.elastic.line import Hertz


@dataclass(frozen=True, kw_only=True)
class EffectRules:
    """How an effect is decided, and evaluated on the solution.
    words: the effect in a report.
    decide: function of the context (scene, contact and the effects before it in `EFFECTS`) that
        gives the decision.
    check: function of context, decision and findings that evaluates the indicator of the effect on
        the solution; gives None where it does not apply.
    numerical_only: the exact answer is the same with and without the effect.
    absent_in_half_spaces: half-spaces beside finite bodies never have the effect, so both are
        compared also where a person switched it against the plan.
    of_bodies: only meshed bodies have the effect. Where half-spaces answer it is off, and their
        error estimate has what it would change.
    in_half_spaces: half-spaces always have the effect; where they answer it cannot be off.
    """

    words: str
    decide: Callable[[Context], Effect]
    check: Callable[[Context, Effect, Findings], PostSolveVerdict | None] = lambda *_: None
    numerical_only: bool = False
    absent_in_half_spaces: bool = False
    of_bodies: bool = False
    in_half_spaces: bool = False


def check_left_out(_: Context, effect: Effect, __: Findings) -> PostSolveVerdict | None:
    """Verdict that an effect is called for and not simulated; None where this is not so."""
    return PostSolveVerdict(True, effect.why) if effect.called_for and not effect.on else None


EFFECTS = {
    "plane_strain": EffectRules(
        words="line contact, solved in a section", decide=shape.decide_plane_strain
    ),
    "axisymmetry": EffectRules(
        words="body of revolution, solved in a meridian section",
        decide=shape.decide_axisymmetry,
        numerical_only=True,
    ),
    "surface_shape": EffectRules(
        words="surfaces that vary along the rail",
        decide=shape.decide_surface_shape,
        check=shape.check_surface_shape,
    ),
    "symmetry_x": EffectRules(
        words="symmetry along the rail (half is solved)",
        decide=shape.decide_symmetry_x,
        numerical_only=True,
        of_bodies=True,
    ),
    "symmetry_y": EffectRules(
        words="symmetry across the rail (half is solved)",
        decide=shape.decide_symmetry_y,
        numerical_only=True,
        of_bodies=True,
    ),
    "deformable_rail": EffectRules(
        words="the rail deforms",
        decide=partial(material.decide_deformable, "rail"),
        in_half_spaces=True,
    ),
    "deformable_wheel": EffectRules(
        words="the wheel deforms",
        decide=partial(material.decide_deformable, "wheel"),
        in_half_spaces=True,
    ),
    "rail_section": EffectRules(
        words="whole rail with web and foot",
        decide=shape.decide_rail_section,
        check=check_left_out,
        of_bodies=True,
    ),
    "far_field": EffectRules(
        words="half-spaces around the bodies", decide=shape.decide_far_field, of_bodies=True
    ),
    "finite_bodies": EffectRules(
        words="bodies that end, by finite elements",
        decide=shape.decide_finite_bodies,
        of_bodies=True,
    ),
    "mean_dilatation": EffectRules(
        words="nearly incompressible material",
        decide=material.decide_mean_dilatation,
        numerical_only=True,
        of_bodies=True,
    ),
    "friction": EffectRules(
        words="friction, traction and creepage",
        decide=interface.decide_friction,
        check=check_left_out,
        absent_in_half_spaces=True,
    ),
    "plasticity": EffectRules(
        words="steel that yields",
        decide=material.decide_plasticity,
        check=material.check_plasticity,
        absent_in_half_spaces=True,
    ),
    "passes": EffectRules(
        words="a wheel that rolls again and again over a rail that yields",
        decide=passes.decide_passes,
        absent_in_half_spaces=True,
    ),
    "plasticity_wheel": EffectRules(
        words="yield of the wheel in passes",
        decide=passes.decide_plasticity_wheel,
        absent_in_half_spaces=True,
    ),
    "heat": EffectRules(
        words="heat of friction: temperatures of the surfaces",
        decide=interface.decide_heat,
        check=interface.check_heat,
        absent_in_half_spaces=True,
    ),
    "falling_friction": EffectRules(
        words="friction that falls with slip or temperature",
        decide=interface.decide_falling_friction,
    ),
    "layer": EffectRules(
        words="an elastic layer between the surfaces", decide=interface.decide_layer
    ),
}
AT_EDGES = "inside_the_bodies"
"""Name of the assumption of every model that the patch lies away from the edges of the bodies."""


def decide(scene: Scene, dimension: Dimension, contact: Contact, hertz: Hertz) -> Context:
    """The context of a scene in which all effects are decided, in the order of `EFFECTS`. Raises
    SceneError for a state that a person chose and cannot have, and where no body deforms.
    """
    found: dict[str, Effect] = {}
    context = Context(scene=scene, dimension=dimension, contact=contact, hertz=hertz, decided=found)
    for name, effect in EFFECTS.items():
        decided = effect.decide(context).forced(name, scene.effects.state(name))
        if name == "friction" and not scene.asks("forces"):
            why = f"{decided.why}; off: forces are not among the quantities"
            decided = replace(decided, on=False, override=True, why=why)
        found[name] = decided
        if name == "surface_shape" and not found[name].on and contact.shape is not None:
            context = replace(context, contact=contact.smooth)
    if not found["finite_bodies"].on:
        found |= {name: _without_bodies(name, found[name]) for name in EFFECTS}
    bodies = ("deformable_rail", "deformable_wheel")
    if not any(found[name].on for name in bodies):
        rigid = next(name for name in bodies if found[name].override)
        raise SceneError(
            f"effects.{rigid}", "'off' is not allowed: the other body is rigid; give auto or on"
        )
    return context


def _without_bodies(name: str, effect: Effect) -> Effect:
    """The named effect where finite bodies are off: off if only meshed bodies have it, else
    unchanged. Raises SceneError for an effect of bodies that a person switched on, and for one that
    half-spaces always have where it is switched off.
    """
    rules, key = EFFECTS[name], f"effects.{name}"
    said = "is not allowed: finite_bodies is off"
    refuse_first(
        (
            rules.in_half_spaces and effect.override and not effect.on,
            key,
            f"'off' {said}, half-spaces have it; give auto or on",
        ),
        (
            rules.of_bodies and effect.override and effect.on,
            key,
            f"'on' {said}; give auto or off",
        ),
    )
    if not (rules.of_bodies and effect.on):
        return effect
    why = f"{effect.why}; off by effects.finite_bodies"
    return replace(effect, on=False, override=True, why=why)


def in_words(name: str) -> str:
    """The effect or the assumption of this name as a report calls it."""
    assumptions = {AT_EDGES: "patch away from the edges (after)"}
    return EFFECTS[name].words if name in EFFECTS else assumptions.get(name, "jump of contact")


def overruled(effects: Mapping[str, Effect]) -> list[str]:
    """Names of the effects by which a person chose another problem than the scene calls for;
    numerical effects, and those that the estimate of half-spaces covers, do not count.
    """
    covered = not effects["finite_bodies"].on
    return [
        name
        for name, each in effects.items()
        if each.override
        and each.called_for != each.on
        and not EFFECTS[name].numerical_only
        and not (covered and EFFECTS[name].of_bodies)
    ]


def left_out(
    effects: Mapping[str, Effect], after: Mapping[str, PostSolveVerdict]
) -> dict[str, str]:
    """Reason by name for each effect that is needed but not simulated.
    effects: decisions by name; after: verdicts on the solution, which count in place of the plan's
        where present.
    Effects that a person overruled, and those that do not change the exact answer, do not count.
    Where passes are simulated, so is yield.
    """
    out = {}
    rolled = "passes" in effects and effects["passes"].on
    for name, each in effects.items():
        if name == "plasticity" and rolled:
            continue
        weighed = after.get(name, PostSolveVerdict(each.called_for, each.why))
        if weighed.needed and not (each.on or each.override or EFFECTS[name].numerical_only):
            out[name] = weighed.why
    return out


def check(context: Context, findings: Findings | None) -> dict[str, PostSolveVerdict]:
    """Verdicts of a solution by name of the effect or assumption: whether an effect is needed or an
    assumption does not hold, and why. Those that do not apply are missing, effects without a rule
    for the solution among them; all of them without findings.
    """
    if findings is None:
        return {}
    decided = context.decided
    after = {name: each.check(context, decided[name], findings) for name, each in EFFECTS.items()}
    after[AT_EDGES] = shape.inside_the_bodies(context, findings)
    after["beside_a_jump"] = shape.beside_a_jump(context)
    return {name: each for name, each in after.items() if each is not None}

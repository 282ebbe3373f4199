"""Effects of the bodies' material: which body deforms, nearly incompressible cells, yield.

A half-space much stiffer than the other is rigid: it is not meshed, and its stresses are those
under the pressure. Bodies that yield are loaded in steps.
"""

import math
from collections.abc import Mapping

from railhead.planning.context import STIFFEST, Context, Effect, PostSolveVerdict
from railhead.planning.effects import interface
from railhead.postprocess.findings import Findings
from railhead.scene import bodies
from railhead.scene.sections import refuse_first
from railhead.theory.friction import sliding

SHARE = 0.1  # share of the accuracy: compliance of a body that is taken as rigid
#: Poisson's ratio above which ordinary cells begin to lock; True: those of a meridian section.
#: There the largest of the rms errors of pressure, area and shear stress at default settings is
#: 0.11 % without constant volume change and 0.14 % with it at 0.48, 0.18 and 0.15 % at 0.49, 2.1
#: and 0.16 % at 0.499 (13 meshes of 6 to 24 elements per radius, of them 10 to 14).
LARGEST_RATIO = {False: 0.45, True: 0.49}
# Largest number of load steps after first yield. With one for each multiple of the load of first
# yield the centre pressure of a sphere is within 1 % of many steps at up to 10 times that load, and
# within 0.3 % at up to twice.
STEPS = 4
LARGEST_OVERLOAD = 1000.0  # load over that of first yield: nine times what is signed
LINE_STEPS = 16  # the same for a line, where four steps make the strain 20 % too large
HALF_SPACES = "half-spaces are solved elastically; effects.plasticity=off accepts that"
IN_PASSES = "it is simulated in the passes of rolling.passes, before them the bodies are elastic"
WOULD_YIELD = (
    "the steel would yield; this is the elastic answer, which overstates pressure and stresses"
)
DEFAULT_STEEL = "R260"  # rail steel whose yield a scene without a steel is compared with


def decide_deformable(body: str, context: Context) -> Effect:
    """Whether a body ('rail' or 'wheel') deforms: called for where its share s of the compliance
    1/E* = sum of (1 - nu^2)/E is a tenth (SHARE) of the accuracy or more, where its stresses are
    not those of a half-space under Hertz's pressure, and where it yields. An infinite modulus
    refuses 'on'. Without that share, approach, pressure and stresses are off by 2/3 s and the
    semi-axes by s/3 (Johnson, Contact Mechanics, 4.22 to 4.24). A body whose modulus
    `Context.young_moduli` limits to 1e5 (STIFFEST) times the other one adds such errors with s =
    1e-5.
    """
    scene, part = context.scene, context.scene.bodies[body]
    if math.isinf(part.young_modulus):
        return Effect.absent("E is infinite: only its surface takes part")
    compliance = (1 - part.poisson_ratio**2) / part.young_modulus
    share = compliance * context.hertz.contact_modulus
    limit = SHARE * context.accuracy
    text = f"it holds {share:.3g} of the compliance (1 - nu^2)/E"
    yields = part.yields and context.von_mises[body] > part.first_yield
    hertzian = context.contact.solid_half_space and not (scene.friction.acts or yields)
    if share < limit and hertzian:
        return Effect(False, False, f"{text}, below {limit:.1g}: rigid", error=share)
    why = f"above {limit:.1g}" if share >= limit else "but its stresses are not Hertz's"
    return Effect(True, True, f"{text}, {why}", error=(share < 1 / STIFFEST) / STIFFEST)


def decide_mean_dilatation(context: Context) -> Effect:
    """Constant volume change in each cell is called for where a deformable body has nu above 0.45
    (0.49 in a meridian section); linear and hexahedral cells cannot have it, and refuse 'on'.
    """
    mesh, limit = context.scene.mesh, LARGEST_RATIO[context.contact.revolved]
    ratio = max((part.poisson_ratio for part in context.deformable.values()), default=0.0)
    above = ratio > limit
    why = f"Poisson's ratio {ratio:g}, {'above' if above else 'below'} {limit}"
    if mesh.cell == "hexahedron" or mesh.linear:
        quadratic = "it needs quadratic tetrahedra"
        return Effect(above, False, f"{why}; {quadratic}", {"on": quadratic})
    return Effect(above, above, why)


def decide_plasticity(context: Context) -> Effect:
    """Whether yield is simulated: called for where the largest elastic, frictionless von Mises
    stress passes the yield stress of a body (`Context.stressed`). 'on' is refused where yield
    cannot be simulated (`_elastic_only`). SceneError: linear cells where a body yields and
    plasticity is not 'off', and a load far beyond that of first yield.
    """
    scene = context.scene
    ratio, why, _ = _over_yield(context, _stresses(context))
    yields, refused = ratio > 1, _elastic_only(context)
    over = context.overload if yields and not refused else 0.0
    locks = scene.mesh.linear and context.decided["finite_bodies"].on
    refuse_first(
        (
            yields and locks and scene.effects.plasticity != "off",
            "mesh.order",
            "1 is not allowed where a body yields: linear tetrahedra and triangles lock; give 2",
        ),
        (
            over > LARGEST_OVERLOAD,
            "load",
            f"{over:.3g} times the load of first yield is not allowed; give a load, or an "
            f"approach, of at most {LARGEST_OVERLOAD:g} times",
        ),
    )
    if refused:
        return Effect(yields, False, f"{why}; {refused}" if yields else why, {"on": refused})
    if yields:
        why += f", {over:.3g} times the load of first yield; {steps(context)} load steps"
    return Effect(yields, yields, why)


def _elastic_only(context: Context) -> str:
    """Why yield cannot be simulated: no deformable body with a yield stress, passes, no finite
    bodies, or friction of bodies that roll or differ in material. Empty where it can.
    """
    scene, decided = context.scene, context.decided
    if context.yielding:
        if scene.rolling.passes is not None and scene.effects.passes != "off":
            return IN_PASSES
        if not decided["finite_bodies"].on:
            return HALF_SPACES
        grows = interface.grows(context)
        if decided["friction"].on and (scene.rolling.prescribed or grows):
            what = "unlike bodies are pressed" if grows else "rolling is solved"
            return f"{what} elastically with friction; effects.friction=off leaves it out"
    if any(part.yields for part in context.deformable.values()):
        return ""
    return "no body that deforms has a yield stress"


def check_plasticity(context: Context, effect: Effect, found: Findings) -> PostSolveVerdict | None:
    """Verdict whether the largest von Mises stress of the solution passes the yield stress of a
    body that was taken as elastic. Where the solution was read without stresses, they are those of
    the plan; with friction those where the whole patch slips.
    Without any yield stress nothing is needed, and the verdict is notable where the usual rail
    steel would yield.
    """
    largest = {name: each.von_mises.value for name, each in found.largest.items()}
    ratio, why, notable = _over_yield(context, largest or _stresses(context))
    if not ratio:
        return PostSolveVerdict(False, why, notable)
    if effect.on or context.decided["passes"].on:
        return PostSolveVerdict(False, "simulated")
    if ratio > 1:
        return PostSolveVerdict(True, f"{WOULD_YIELD}: {why}")
    if largest or not context.decided["friction"].on:
        return PostSolveVerdict(False, why)
    most, text = _slipping(context)
    tell = ": it may yield, friction_stresses tell" if most > 1 else ""
    return PostSolveVerdict(most > 1, f"{why} without friction; {text}{tell}")


def shear_yield(context: Context) -> float | None:
    """Yield stress in shear, yield / sqrt(3), of the weaker body, MPa; None where no body has a
    yield stress.
    """
    limits = [part.first_yield / math.sqrt(3) for part in context.yielding.values()]
    return min(limits, default=None)


def _stresses(context: Context) -> dict[str, float]:
    """Largest elastic, frictionless von Mises stress of the stressed bodies, MPa, by name."""
    return {name: context.von_mises[name] for name in context.stressed}


def _slipping(context: Context) -> tuple[float, str]:
    """Largest von Mises stress under Hertz's pressure and tractions where the whole patch slips,
    over the yield stress of the weaker body, and a text with that stress, MPa.
    """
    friction, parts = interface.friction_coefficient(context), context.yielding.values()
    most = max(
        each.von_mises
        for ratio in {part.poisson_ratio for part in parts}
        for each in sliding.peaks(context.hertz, friction, ratio).values()
    )
    weakest = min(part.first_yield for part in parts)
    return most / weakest, f"up to {most:.4g} MPa where all slips"


def steps(context: Context) -> int:
    """Number of load steps from first yield to the load at default settings: the load over that of
    first yield, rounded, up to 4 (STEPS); 16 (LINE_STEPS) for a line contact.
    """
    return LINE_STEPS if context.contact.line else min(max(round(context.overload), 1), STEPS)


def _over_yield(context: Context, stresses: Mapping[str, float]) -> tuple[float, str, bool]:
    """Largest ratio of von Mises stress to initial yield stress, a sentence that says whether the
    stress passes it, and whether the usual rail steel (R260) would yield in a scene without a yield
    stress. There the ratio is 0, and the sentence is about that steel.
    stresses: von Mises stress, MPa, by body ('rail', 'wheel').
    """
    parts = context.scene.bodies
    limits = {name: part.first_yield for name, part in context.yielding.items()}
    ratios = {name: stresses[name] / limits[name] for name in stresses.keys() & limits.keys()}
    if ratios:
        worst = max(sorted(ratios), key=ratios.__getitem__)
        limit, steel = limits[worst], parts[worst].steel
        verb = "passes" if ratios[worst] > 1 else "stays below"
        kind = f" ({steel}: {bodies.steels()[steel].kind})" if steel else ""
        text = f"von Mises {stresses[worst]:.4g} MPa {verb} the yield {limit:.4g} MPa of the"
        return float(ratios[worst]), f"{text} {worst}{kind}", False
    # A body without the modulus of a steel is none.
    steels = [name for name in stresses if bodies.is_steel(parts[name].young_modulus)]
    if not steels:
        return 0.0, "no yield stress is given", False
    name = max(steels, key=stresses.__getitem__)
    limit = bodies.steels()[DEFAULT_STEEL].yield_stress
    yields = bool(stresses[name] > limit)
    verb = "would yield here" if yields else "would not yield"
    text = f"von Mises {stresses[name]:.4g} MPa in the {name}, its yield {limit:g}"
    return 0.0, f"no steel is given; {DEFAULT_STEEL} {verb}: {text}", yields

"""Effects of the bodies' shape: what is modelled of them, and which simplification holds.

A section or one side of a plane of symmetry; blocks cut out of half-spaces; bodies of finite size
or half-spaces; the whole rail or its head. And what every model assumes, compared with the
solution: that the patch lies away from the edges.
"""

import math
from contextlib import suppress

import numpy as np

from railhead.contact import closed_forms, plane_section, solid
from railhead.contact.crossing import CrossingContact
from railhead.geometry import wheelset
from railhead.geometry.outlines import head_depth
from railhead.geometry.profiles import STANDARD_RAILS
from railhead.half_spaces.pressing import HalfSpacePair
from railhead.half_spaces.surface import develop
from railhead.planning.context import DEFAULT_ACCURACY, Context, Effect, PostSolveVerdict
from railhead.postprocess.findings import Findings
from railhead.scene.scene import SceneError
from railhead.scene.sections import refuse_first

SECTION = "half-spaces know no section of bodies that end"
APPROACH = "the approach of bodies that end depends on where they are held; with a load they answer"
BUDGET = "half-spaces are solved once, whatever the budget"
# Relative change of the largest shear stress over the stress at the cut over p0 (measured).
STRESS_CHANGE = 0.25
EDGE = 1.1  # factor on the semi-axis across that must lie within both profiles
LEFT_OUT = 0.5  # of the accuracy, that heights may take; the mesh has the other half
ROUNDING = 1e-9  # of the approach, of heights
NOT_MET = "the patch does not meet what is added: the same height wherever they may touch"
STEEPEST = 0.1  # slope of what is added to a surface: its cosine is 0.5 % below 1
CLOSING = 1.5  # slope of a gap over the shift at most, over the difference of both slopes
NEAR = 0.1  # mm of shift: as exactly as a wheelset's place is known; a choice
SHARES = np.linspace(0.0, 1.0, 9)  # of the way from the middle of a patch to its outline
QUASI_STATIC = "each place is at rest: the dynamics of rolling over it is not simulated"
FRESH = (
    "a fresh flat has sharp edges, where the pressure grows with every finer mesh or grid; give "
    "its depth, surface.depth, for a rounded one"
)
HOLLOW = "the undeformed bodies do not touch in its middle"
HEADS = "each head is its section at its contact, swept straight; the gap is that of the true heads"
SMOOTH = "nothing that varies is added to the surfaces"


def decide_plane_strain(context: Context) -> Effect:
    """Plane strain is called for, and simulated, where the contact was found to be a line
    (`plane_section.choose`, which heeds effects.plane_strain of the scene).
    """
    kind = context.dimension
    refused = {} if kind.line else {"on": kind.plane_strain}
    return Effect(kind.line, kind.line, kind.plane_strain, refused)


def decide_axisymmetry(context: Context) -> Effect:
    """A meridian section is called for where both bodies, and their loads, are of revolution about
    the contact normal; it is on where such a section was located, which a person's 'off' prevents.
    """
    called, why = plane_section.circular(context.scene)
    return Effect(called, context.contact.revolved, why)


def decide_symmetry_x(context: Context) -> Effect:
    """Only x >= 0 is modelled where x = 0 is a plane of symmetry of the bodies and of the load;
    friction along the rail prevents this.
    """
    why, slips = context.contact.why_asymmetric_in_x(), context.scene.asymmetric_friction[0]
    straight = "the wheel stands straight: x = 0 mirrors bodies, materials and load"
    return _symmetry(why or ("friction along the rail" if slips else ""), straight)


def decide_symmetry_y(context: Context) -> Effect:
    """Only y >= 0 is modelled where the bodies are symmetric in y (`Contact.why_asymmetric_in_y`
    has the reasons against it), no friction acts across the rail, and its coefficient is one
    number. Spin and a motion that follows from the wheelset count as friction across.
    """
    why, slips = context.contact.why_asymmetric_in_y(), context.scene.asymmetric_friction[1]
    if context.scene.friction.uneven and context.contact.curved_solid:
        why = why or "friction differs with the angle of the surface"
    mirrored = "profiles, materials and load mirror at y = 0"
    return _symmetry(why or ("friction across the rail" if slips else ""), mirrored)


def _symmetry(asymmetric: str, symmetric: str) -> Effect:
    """Symmetry is used where the reason against it (`asymmetric`) is empty. symmetric: the reason
    for it.
    """
    return Effect.absent(asymmetric) if asymmetric else Effect(True, True, symmetric)


def decide_far_field(context: Context) -> Effect:
    """Half-spaces that continue beyond their meshed blocks are simulated where rail.extent is half-
    space; for bodies that end the effect is refused.
    """
    half, why = context.contact.half_space, f"rail.extent is {context.scene.rail.extent}"
    return Effect(half, half, why, {} if half else {"on": why})


def decide_finite_bodies(context: Context) -> Effect:
    """Finite bodies are always called for and on; a person may switch them off. The reason says by
    how much half-spaces would be off.

    'off' is refused for sections of bodies that end, for a given approach of bodies that end, and
    with a budget.
    """
    scene, contact = context.scene, context.contact
    refused = {} if scene.budget is None else {"off": BUDGET}
    if contact.half_space:
        return Effect(
            True, True, "the bodies are half-spaces: half-spaces would miss nothing", refused
        )
    if contact.plane:
        return Effect(True, True, SECTION, {"off": SECTION})
    if scene.load is None:
        refused = {"off": APPROACH}
    try:
        pressure, area = (100 * each["total"] for each in context.half_space_errors.values())
        why = f"half-spaces would be {pressure:.2g} % off in pressure, {area:.2g} % in area"
    except ValueError as error:
        why = f"by how much half-spaces would be off is not known ({error})"
    return Effect(True, True, why, refused)


def decide_rail_section(context: Context) -> Effect:
    """A rail with web, held at its foot, is called for by rail.extent = section. It is also called
    for where the cut of the head changes the stress, or where the twist of the rail brings another
    part of the profiles into contact. Raises SceneError for extent section without a standard rail,
    and in a section along the rail.
    """
    extent, name = context.scene.rail.extent, context.scene.rail.profile
    reasons = (
        (context.contact.half_space, "a half-space"),
        (name not in STANDARD_RAILS, f"rail.profile {name}"),
        (context.scene.rail.varies, "a rail of sections"),
        (context.contact.plane == "xz", "a section along the rail"),
    )
    without = next((reason for applies, reason in reasons if applies), "")
    if without:
        why = f"{without} has neither web nor foot"
        text = f"section needs a whole rail 54E1 or 60E1, but {why}; give head"
        refuse_first((extent == "section", "rail.extent", text))
        return Effect.absent(why)
    if extent == "section":
        return Effect(True, True, "rail.extent = section")
    accuracy = min(context.accuracy, DEFAULT_ACCURACY)  # coarser ones have the default's supports
    cut, why = _cut_matters(context, accuracy)
    change, twist_text = _twists(context, LEFT_OUT * accuracy)
    called = cut or change > LEFT_OUT * accuracy
    return Effect(called, called, f"{why}; {twist_text}", error=0.0 if called else change)


def _cut_matters(context: Context, accuracy: float) -> tuple[bool, str]:
    """Whether the stress at the cut of a rail head, over p0, exceeds what the accuracy allows, and
    a sentence that says so. a and b are Hertz's semi-axes; of a line b is its half width.
    It allows a ratio of the accuracy over 0.25 (STRESS_CHANGE).
    The stress is Boussinesq's 3F/(2 pi H^2) below a point load over p0 = 3F/(2 pi a b), or
    Flamant's 2F'/(pi H) below a line load over p0 = 2F'/(pi b), with H the depth of the cut
    (Johnson, Contact Mechanics, 3.19, 4.26, 2.19 and 4.43).
    """
    depth, limit = head_depth(context.scene.rail.profile), accuracy / STRESS_CHANGE
    a, b = context.hertz.a, context.hertz.b
    ratio, name = (b / depth, "b/H") if context.contact.line else (a * b / depth**2, "ab/H^2")
    side = "above" if ratio > limit else "below"
    text = f"stress at the cut {depth:.1f} mm deep over p0: {name} = {ratio:.2g}"
    return bool(ratio > limit), f"{text}, {side} {limit:.2g}"


def _twists(context: Context, limit: float) -> tuple[float, str]:
    """Relative change of pressure or area as the load twists the rail and moves its head aside,
    infinite where it cannot be judged, and a sentence that holds it against the limit.
    """
    try:
        twist, aside = context.twist_change, context.sideways_change
    except ValueError as error:
        return math.inf, f"what its twist changes cannot be judged ({error})"
    side = "above" if twist + aside > limit else "below"
    said = f", and its way aside by {aside:.2g}" if aside else ""
    why = f"its twist changes pressure or area by {twist:.2g}{said}, {side} {limit:g}"
    return twist + aside, why


def decide_surface_shape(context: Context) -> Effect:
    """Heights that are added to the surfaces (flats, waves, maps) are called for where they vary by
    more than half (LEFT_OUT) of the accuracy times Hertz's approach of the smooth bodies. Counted
    are all places that touch after this approach, with the added heights or without them. Where
    they are on, their error is 1 - cos of the largest slope. Raises SceneError for a slope above
    0.1 (STEEPEST) there.
    """
    contact, hertz = context.contact, context.hertz
    pair, shape = contact.pair, contact.shape
    if isinstance(contact, CrossingContact) and context.scene.effects.finite_bodies != "off":
        leans = [each.lean for each in contact.touches(math.inf)]
        return Effect(True, True, HEADS, {"off": HEADS}, error=1 - math.cos(max(map(abs, leans))))
    if shape is None or pair is None:
        return Effect.absent(SMOOTH)
    rigid = hertz.approach / math.cos(contact.touch.angle)
    surface, plain = context.half_spaces.developed, develop(contact.smooth)
    x, s, above = (each.ravel() for each in surface.locus(rigid))
    near = above - above.min() < rigid
    near |= plain.gap(x, s) < rigid
    turn, radius = np.meshgrid(np.linspace(0, 2 * np.pi, 25), [0.0, 0.5, 1.0])
    a, b = hertz.half_lengths  # small patches may lie between the places of the grid
    u, v = (a * radius * np.cos(turn)).ravel(), (b * radius * np.sin(turn)).ravel()
    ahead, beside = shape.first[0], float(np.interp(shape.first[1], surface.y, surface.s))
    x, s = np.concatenate([x[near], u, ahead + u]), np.concatenate([s[near], v, beside + v])
    points = surface.points(x, s)
    height, slopes = shape.at(pair, points[np.isfinite(points).all(axis=1)])
    steep = f"where the bodies touch, beyond small sliding on a kept body; give {STEEPEST} at most"
    key, text = "{}.surface", f"its slope is up to {{:.3g}} {steep}"
    if context.scene.rail.varies:
        key, text = "rail.position", f"the head leaves its section by a slope of {{:.3g}} {steep}"
        text += ", by a place farther from the corner of the head, or --fast"
    refuse_first(
        *(
            (slope.max() > STEEPEST, key.format(body), text.format(slope.max()))
            for body, slope in slopes.items()
        )
    )
    change, limit = float(np.ptp(height)) / rigid, LEFT_OUT * context.accuracy
    varies = f"where they may touch the height varies by {change:.2g} of the approach"
    if change < ROUNDING:
        return Effect(False, False, NOT_MET)
    if change <= limit:
        return Effect(False, False, f"{varies}, below {limit:g}", error=change)
    tilted = max(1 - math.cos(math.atan(slope.max())) for slope in slopes.values())
    return Effect(True, True, f"{varies}, above {limit:g}; {QUASI_STATIC}", error=tilted)


def check_surface_shape(
    context: Context, effect: Effect, found: Findings
) -> PostSolveVerdict | None:
    """Notable verdict that the patch does not meet what is added to the surfaces. Of a flat: that
    its middle is a hollow, in which the undeformed bodies do not touch, where its curvature 2 pi^2
    depth / length^2 exceeds that of the wheel; or that a fresh one has sharp edges. Else None.
    """
    if effect.why == NOT_MET:
        return PostSolveVerdict(False, NOT_MET, notable=True)
    for part in context.scene.bodies.values():
        if effect.on and part.surface is not None and part.surface.kind == "flat":
            length, depth = float(part.surface.length or 0.0), part.surface.depth
            limit = length**2 / (2 * math.pi**2 * context.scene.wheel.rolling_radius)
            deepest = f"L^2/(2 pi^2 R) = {limit:.4g} mm"
            why = f"{FRESH}; up to {deepest} that is no hollow"
            if depth is not None:
                why = f"a flat {depth:.4g} mm deep, beyond {deepest}, is a hollow: {HOLLOW}"
            if depth is None or depth > limit:
                return PostSolveVerdict(False, why, notable=True)
    return None


def height_in_patch(contact: solid.Contact, found: Findings) -> float | None:
    """Largest less smallest height that is added to both surfaces in the patches of a solution, mm;
    None where nothing is added.
    """
    if contact.shape is None or contact.pair is None:
        return None
    rings = [np.asarray(line) for line in found.patch.outlines]
    inside = [line.mean(axis=0) + t * (line - line.mean(axis=0)) for line in rings for t in SHARES]
    points = np.array([found.frame.place(*at) for at in np.concatenate(inside)])
    return float(np.ptp(contact.shape.at(contact.pair, points)[0]))


def inside_the_bodies(context: Context, found: Findings) -> PostSolveVerdict | None:
    """Verdict on the distance in y from the centre of the patch to the nearest edge of a tread or
    head, compared with 1.1 (EDGE) of its half length across. At an edge a stress peak arises that
    no profile shows. None without profiles across the rail.
    """
    if not context.contact.cross_profiles:
        return None
    cosine, patch = math.cos(found.frame.angle), found.patch
    middle, reach = found.frame.origin[1] + patch.centre[1] * cosine, EDGE * patch.b * cosine
    room = min(abs(end - middle) for end in context.contact.edges)
    near = bool(room < reach)
    text = f"{room:.1f} mm from the middle of the patch to the nearest edge, b = {patch.b:.2f} mm"
    return PostSolveVerdict(near, f"{text}: the edge carries load" if near else text)


def beside_a_jump(context: Context) -> PostSolveVerdict | None:
    """Notable verdict where the first contact jumps to another place within 0.1 mm (NEAR) of the
    shift: the shift of the jump, and the largest pressure and the first contact 0.1 mm to either
    side of the scene's shift, by half-spaces. None elsewhere. Per mm of shift the gap at a second
    place closes by about the difference of the slopes of both places. A jump is looked for where
    1.5 (CLOSING) times as much closes it.
    """
    contact, shift = context.contact, context.scene.wheelset.shift
    if contact.placed is None:
        return None
    first, *others = contact.touches(3 * NEAR)
    slopes = [abs(math.tan(each.angle) - math.tan(first.angle)) for each in others]
    if all(each.gap > CLOSING * NEAR * k for each, k in zip(others, slopes, strict=True)):
        return None
    radii = wheelset.rolling_radii(solid.on_track(context.scene), abs(shift) + wheelset.SHIFT_STEP)
    jump = min(radii.jumps, key=lambda each: abs(each - shift), default=math.inf)
    if abs(jump - shift) > NEAR:
        return None
    said = []
    for at in (shift - NEAR, shift + NEAR):
        scene = context.scene.replace([f"wheelset.shift={at}"])
        with suppress(SceneError):  # the wheelset cannot stand there
            other = solid.on_side(scene, solid.place(scene))
            hertz = closed_forms.hertz_contact(scene, other)
            under = HalfSpacePair(other, hertz).elastic
            p0 = hertz.p0 if isinstance(under, str) else under.max_pressure
            said.append(f"{p0:.4g} MPa at {at:.4g} mm (first contact y = {other.touch.y:.4g} mm)")
    text = f"the contact jumps at a shift of {jump:.5g} mm, {abs(jump - shift):.2g} mm away; "
    text += f"half-spaces have {' and '.join(said)}. Other profiles or yaw move the jump"
    return PostSolveVerdict(False, text, notable=True)

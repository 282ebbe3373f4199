"""Effects of the bodies' shape: what is modelled of them, and which simplification holds.

A section or one side of a plane of symmetry; blocks cut out of half-spaces; bodies of finite size
or half-spaces; the whole rail or its head; the real profiles or one radius each. And what every
model assumes of the shape, held against the solution: a small patch, inside of thick bodies.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from railhead.contact import placed_bodies, plane_section
from railhead.contact.solid import Contact
from railhead.geometry.outlines import head_depth
from railhead.geometry.profiles import STANDARD_RAILS, Arc, Polynomial, osculating
from railhead.meshing.bodies import BODY_NAMES
from railhead.planning.context import Context, Effect, PostSolveVerdict
from railhead.planning.references import boundary_elements, closed_forms
from railhead.planning.references.allowance import Allowance, allowance, twist
from railhead.postprocess.findings import Findings
from railhead.scene.scene import SceneError
from railhead.theory.elastic import halfspace
from railhead.theory.elastic.line import LineContact

SECTION = "half-spaces know no section of bodies that end"
APPROACH = "the approach of bodies that end depends on where they are held; with a load they answer"
BUDGET = "half-spaces are solved once, whatever the budget"
# Relative change of the largest shear stress over the stress at the cut over p0 (measured).
STRESS_CHANGE = 0.25
MARGIN = 1.1  # factor on the patch that must lie within one arc
SMALL = 0.1  # largest semi-axis over relative radius of a small patch
DOUBTFUL = ": the comparison with Hertz is doubtful"
EDGE = 1.1  # factor on the semi-axis across that must lie within both profiles
LEFT_OUT = 0.5  # of the accuracy, that heights may take; the mesh has the other half
STEEPEST = 0.1  # slope of what is added to a surface: its cosine is 0.5 % below 1
SHARES = np.linspace(0.0, 1.0, 9)  # of the way from the middle of a patch to its outline
QUASI_STATIC = "each place is at rest: the dynamics of rolling over it is not simulated"
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
    if asymmetric:
        return Effect(False, False, asymmetric, {"on": asymmetric})
    return Effect(True, True, symmetric)


def decide_far_field(context: Context) -> Effect:
    """Half-spaces that continue beyond their meshed blocks are simulated where rail.extent is half-
    space; for bodies that end the effect is refused.
    """
    if context.contact.half_space:
        return Effect(True, True, "rail.extent = half-space: what lies beyond the blocks deforms")
    why = "the bodies end where they really end"
    return Effect(False, False, why, {"on": f"rail.extent is {context.scene.rail.extent}"})


def decide_finite_bodies(context: Context) -> Effect:
    """Finite bodies are always called for and on; a person may switch them off. The reason says by
    how much half-spaces would be off.

    'off' is refused for sections of bodies that end, for a given approach of bodies that end, and
    with a budget.
    """
    scene, contact = context.scene, context.contact
    refused = {} if scene.budget is None else {"off": BUDGET}
    if contact.half_space:
        why = "the bodies are half-spaces: by their shape, half-spaces would miss nothing"
        return Effect(True, True, why, refused)
    if contact.plane:
        return Effect(True, True, SECTION, {"off": SECTION})
    if scene.load is None:
        refused = {"off": APPROACH}
    try:
        pressure, area = (100 * each["total"] for each in half_space_errors(context).values())
        why = f"half-spaces would be {pressure:.2g} % off in pressure, {area:.2g} % in area"
    except ValueError as error:
        why = f"by how much half-spaces would be off is not known ({error})"
    return Effect(True, True, why, refused)


def half_space_errors(context: Context) -> dict[str, Allowance]:
    """Differences between half-spaces and finite bodies by "max_MPa" and "area_mm2", relative,
    before anything is meshed: of exact Hertz where it gives the patch, else of boundary elements.
    For solids that end only. Raises ValueError where boundary elements find no closed patch, also
    after the twist of the rail.
    """
    tags = [tag for tag, name in BODY_NAMES.items() if context.decided[f"deformable_{name}"].on]
    solved = context.hertz if context.hertzian else context.boundary_elements
    assert not isinstance(solved, LineContact)
    return allowance(context.contact, tags, solved, _twist(context))


def _twist(context: Context) -> float:
    """Relative change of the largest pressure or of the area, the larger one, by the twist of the
    rail. It is 0 for a block, a rigid rail, a contact in the plane of symmetry, and where both
    bodies have one radius.
    """
    rail = context.scene.rail
    still = rail.profile == "arc" or math.isinf(rail.young_modulus)
    still |= context.contact.why_asymmetric_in_y() is None
    still |= not context.decided["true_profile"].called_for
    return 0.0 if still else context.twist_change


def decide_rail_section(context: Context) -> Effect:
    """A rail with web, held at its foot, is called for by rail.extent = section. It is also called
    for where the cut of the head changes the stress, or where the twist of the rail brings another
    part of the profiles into contact. Raises SceneError for extent section without a standard rail,
    and in a section along the rail.
    """
    rail, hertz = context.scene.rail, context.hertz
    extent, name = rail.extent, rail.profile
    without = ""
    if context.contact.half_space:
        without = "a half-space"
    elif name not in STANDARD_RAILS:
        without = f"rail.profile {name}"
    elif context.contact.plane == "xz":
        without = "a section along the rail"
    if without:
        why = f"{without} has neither web nor foot"
        if extent == "section":
            raise SceneError(
                "rail.extent", f"section needs a whole rail 54E1 or 60E1, but {why}; give head"
            )
        return Effect(False, False, why, {"on": why})
    if extent == "section":
        return Effect(True, True, "rail.extent = section")
    cut, why = _cut_matters(context, hertz.a, hertz.b)
    twists, twist_text = _twists(context)
    called = cut or twists
    return Effect(called, called, f"{why}; {twist_text}")


def check_rail_section(
    context: Context, effect: Effect, found: Findings
) -> PostSolveVerdict | None:
    """Verdict whether the rail needs its web and foot though only its head was meshed: by the
    stress at the cut below the head, with the patch of the solution, or by the twist of the rail.
    None where no whole section can be had.
    """
    if "on" in effect.refused:
        return None
    cut, why = _cut_matters(context, found.patch.a, found.patch.b)
    if effect.on or cut or not effect.called_for:
        return PostSolveVerdict(cut and not effect.on, why)
    twists, twist_text = _twists(context)
    return PostSolveVerdict(twists, twist_text if twists else why)


def _cut_matters(context: Context, a: float, b: float) -> tuple[bool, str]:
    """Whether the stress at the cut of a rail head, over p0, exceeds what the accuracy allows, and
    a sentence that says so.
    a, b: semi-axes of the patch, mm; of a line b is its half width.
    It allows a ratio of the accuracy over 0.25 (STRESS_CHANGE).
    The stress is Boussinesq's 3F/(2 pi H^2) below a point load over p0 = 3F/(2 pi a b), or
    Flamant's 2F'/(pi H) below a line load over p0 = 2F'/(pi b), with H the depth of the cut
    (Johnson, Contact Mechanics, 3.19, 4.26, 2.19 and 4.43).
    """
    depth, limit = head_depth(context.scene.rail.profile), context.accuracy / STRESS_CHANGE
    ratio, name = (b / depth, "b/H") if context.contact.line else (a * b / depth**2, "ab/H^2")
    side = "above" if ratio > limit else "below"
    text = f"stress at the cut {depth:.1f} mm deep over p0: {name} = {ratio:.2g}"
    return bool(ratio > limit), f"{text}, {side} {limit:.2g}"


def _twists(context: Context) -> tuple[bool, str]:
    """Whether pressure or area change by more than the accuracy as the load twists the rail, or may
    do so, and a sentence that says so.
    """
    contact = context.contact
    if contact.plane:
        return False, "nothing twists in a section"
    if not math.isfinite(context.scene.rail.young_modulus):
        return False, "a rigid rail does not twist"
    if not context.decided["true_profile"].called_for:
        return False, "a twist changes nothing where both bodies have one radius"
    angle, limit = twist(contact, context.hertz), context.accuracy
    text = f"the load twists it by {1e3 * angle:.2g} mrad"
    try:
        change = context.twist_change
    except ValueError as error:
        return True, f"{text}: what that changes cannot be judged ({error})"
    side = "above" if change > limit else "below"
    return change > limit, f"{text}: pressure or area change by {change:.2g}, {side} {limit:g}"


def decide_true_profile(context: Context) -> Effect:
    """Real profiles are called for where the predicted patch, times 1.1 (MARGIN), reaches across a
    joint of two arcs of a profile, or the profile is no arc there. Otherwise one radius each is
    enough.
    """
    contact = context.contact
    if not contact.cross_profiles:
        why = "the section runs along the rail"
        if contact.half_space and contact.plane != "xz":
            why = "half-spaces have one radius each"
        return Effect(False, False, why, {"on": why})
    reach = MARGIN * context.hertz.b * math.cos(contact.touch.angle)
    called, why = _leaves(contact, contact.touch.y - reach, contact.touch.y + reach)
    return Effect(called, called, f"{MARGIN} times the predicted patch, {why}")


def check_true_profile(
    context: Context, effect: Effect, found: Findings
) -> PostSolveVerdict | None:
    """Verdict whether the patch of the solution leaves one arc of either body though its profile
    was one radius; None where the effect cannot be on. Where it is on, nothing is needed.
    """
    if "on" in effect.refused:
        return None
    centre, reach = found.patch.centre[1], found.patch.b
    if found.patch.outlines:
        across = np.concatenate(found.patch.outlines)[:, 1]
        low, high = float(across.min()), float(across.max())
    else:
        low, high = centre - reach, centre + reach
    cosine, y = math.cos(found.frame.angle), found.frame.origin[1]
    leaves, why = _leaves(context.contact, y + low * cosine, y + high * cosine)
    return PostSolveVerdict(leaves and not effect.on, f"the patch, {why}")


def decide_surface_shape(context: Context) -> Effect:
    """Surfaces with what is added to them are called for where their height, in all places that
    touch after Hertz's approach of the smooth bodies with it or without it, varies by more than
    half (LEFT_OUT) of the accuracy times that approach. What a slope neglects, 1 - cos, is an error
    where they are on.
    Raises SceneError for a slope above 0.1 (STEEPEST) there.
    """
    contact, hertz = context.contact, context.hertz
    pair, shape = contact.pair, contact.shape
    if shape is None or pair is None:
        return Effect(False, False, SMOOTH, {"on": SMOOTH})
    rigid = hertz.approach / math.cos(contact.touch.angle)
    surface, plain = boundary_elements.develop(contact), boundary_elements.develop(contact.smooth)
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
    for body, slope in slopes.items():
        if (steepest := float(slope.max())) > STEEPEST:
            text = f"its slope is up to {steepest:.3g} where the bodies touch, beyond small sliding"
            raise SceneError(f"{body}.surface", f"{text} on a kept body; give {STEEPEST} at most")
    change, limit = float(np.ptp(height)) / rigid, LEFT_OUT * context.accuracy
    called = change > limit
    why = f"where they may touch the height varies by {change:.2g} of the approach"
    why = f"{why}, {'above' if called else 'below'} {limit:g}"
    tilted = max(1 - math.cos(math.atan(slope.max())) for slope in slopes.values())
    if not called:
        return Effect(False, False, why, error=change)
    return Effect(True, True, f"{why}; {QUASI_STATIC}", error=tilted)


def height_in_patch(contact: Contact, found: Findings) -> float | None:
    """Largest less smallest height that is added to both surfaces in the patches of a solution, mm;
    None where nothing is added.
    """
    if contact.shape is None or contact.pair is None:
        return None
    rings = [np.asarray(line) for line in found.patch.outlines]
    inside = [line.mean(axis=0) + t * (line - line.mean(axis=0)) for line in rings for t in SHARES]
    points = np.array([found.frame.place(*at) for at in np.concatenate(inside)])
    return float(np.ptp(contact.shape.at(contact.pair, points)[0]))


def one_radius(contact: Contact) -> Contact:
    """The contact with each profile replaced by its circle of curvature at the contact, pose and
    contact point kept; half-spaces and sections along the rail are unchanged.
    """
    if contact.pair is None or not contact.cross_profiles:
        return contact
    y = contact.touch.y
    rail, wheel = (osculating(profile, y - shift) for _, profile, shift in contact.cross_profiles)
    return replace(contact, pair=replace(contact.pair, rail=rail, wheel=wheel))


def _leaves(contact: Contact, low: float, high: float) -> tuple[bool, str]:
    """Whether a patch from y = low to high (mm, in space) leaves one arc of either body, and a
    sentence that says so: a joint lies between, or a profile is neither an arc nor straight at the
    first contact. Of several joints the sentence names one that is crossed, else the nearest.
    """
    joints = []
    for body, profile, shift in contact.cross_profiles:
        piece = next(p for p in profile.pieces if p.end >= contact.touch.y - shift)
        straight = isinstance(piece, Polynomial) and len(piece.coefficients) <= 2
        if not (isinstance(piece, Arc) or straight):
            return True, f"on the {body}'s {profile.name} where it is no arc"
        joints += [(joint + shift, body) for joint in profile.joints]
    span = f"y = {low:.1f} to {high:.1f} mm"
    if not joints:
        return False, f"{span}, lies on one arc each"
    crossed = [each for each in joints if low < each[0] < high]
    crosses = bool(crossed)
    nearest, owner = min(crossed or joints, key=lambda joint: abs(joint[0] - contact.touch.y))
    verb = "crosses" if crosses else "ends before"
    return crosses, f"{span}, {verb} the {owner}'s joint at y = {nearest:.1f} mm"


def small_patch(context: Context, found: Findings) -> PostSolveVerdict:
    """Verdict on the size of the (most loaded) patch: Hertz's parabolas and half-spaces need
    semi-axes far below the relative radii (Johnson, Contact Mechanics, 4.1).
    The larger of a times curvature_x and b times curvature_y is compared with 0.1 (SMALL).
    """
    touch, patch = context.contact.touch, found.patch
    a, b = patch.a * touch.curvature_x, patch.b * touch.curvature_y
    side, ratio = ("a", a) if a > b else ("b", b)
    large = bool(ratio > SMALL)
    text = f"{side}/R = {ratio:.2g}, {'above' if large else 'below'} {SMALL}"
    return PostSolveVerdict(large, text + (DOUBTFUL if large else ""))


def inside_the_bodies(context: Context, found: Findings) -> PostSolveVerdict | None:
    """Verdict on the distance in y from the centre of the patch to the nearest edge of a tread or
    head, compared with 1.1 (EDGE) of its half length across. At an edge a stress peak arises that
    no profile shows. None without profiles across the rail.
    """
    if not context.contact.cross_profiles:
        return None
    cosine, patch = math.cos(found.frame.angle), found.patch
    middle, reach = found.frame.origin[1] + patch.centre[1] * cosine, EDGE * patch.b * cosine
    room = min(abs(end - middle) for end in edges(context))
    near = bool(room < reach)
    text = f"{room:.1f} mm from the middle of the patch to the nearest edge, b = {patch.b:.2f} mm"
    return PostSolveVerdict(near, f"{text}: the edge carries load" if near else text)


def edges(context: Context) -> list[float]:
    """Places y in space (mm) at which a body ends: the ends of both profiles, and of the tread's
    width around the first contact, at plus and minus infinity where the wheel has no width.
    """
    contact, width = context.contact, context.scene.wheel.width or math.inf
    ends = [end + shift for _, profile, shift in contact.cross_profiles for end in profile.domain]
    return [*ends, contact.touch.y - width / 2, contact.touch.y + width / 2]


def thick_bodies(context: Context, found: Findings) -> PostSolveVerdict | None:
    """Verdict on the rise of the pressure because a body is held at a finite depth, against the
    accuracy (`theory.elastic.halfspace.held_below`). A standard rail is left to the effect
    rail_section. None without profiles across the rail.
    """
    scene, contact = context.scene, context.contact
    if not contact.cross_profiles:
        return None
    modulus, patch, limit = closed_forms.contact_modulus(scene), found.patch, context.accuracy
    changes = {}
    for tag, body in BODY_NAMES.items():
        if body == "rail" and scene.rail.profile in STANDARD_RAILS:
            continue
        weight = modulus / closed_forms.plane_strain_modulus(scene, tag)
        deep = placed_bodies.depth(scene, tag)
        curvature = weight * halfspace.held_below(deep, scene.bodies[body].poisson_ratio)
        changes[body, deep] = halfspace.pressure_rise(curvature, patch.a, patch.b)
    (body, deep), change = max(changes.items(), key=lambda each: each[1])
    thin = bool(change > limit)
    side = "above" if thin else "below"
    rise = f"pressure rises by {change:.2g}, {side} {limit:g}"
    text = f"the {body} is held {deep:.3g} mm deep: {rise}"
    return PostSolveVerdict(thin, text + (DOUBTFUL if thin else ""))

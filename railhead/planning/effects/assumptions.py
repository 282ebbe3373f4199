"""What every model here assumes, held against the solution."""

from __future__ import annotations

import math

from railhead.contact import placed_bodies
from railhead.geometry.profiles import STANDARD_RAILS
from railhead.meshing.bodies import BODY_NAMES
from railhead.planning.context import Context, PostSolveVerdict
from railhead.planning.references import closed_forms
from railhead.postprocess.findings import Findings
from railhead.theory.elastic import halfspace

SMALL = 0.1  # largest semi-axis over relative radius of a small patch
DOUBTFUL = ": the comparison with Hertz is doubtful"
EDGE = 1.1  # factor on the semi-axis across that must lie within both profiles


def small_patch(context: Context, found: Findings) -> PostSolveVerdict:
    """Verdict on the size of the (most loaded) patch: Hertz's parabolas and half-spaces need
    semi-axes far below the relative radii (Johnson, Contact Mechanics, 4.1).
    The larger of a times curvature_x and b times curvature_y is held against 0.1 (SMALL).
    """
    touch, patch = context.contact.touch, found.patch
    a, b = patch.a * touch.curvature_x, patch.b * touch.curvature_y
    side, ratio = ("a", a) if a > b else ("b", b)
    large = bool(ratio > SMALL)
    text = f"{side}/R = {ratio:.2g}, {'above' if large else 'below'} {SMALL}"
    return PostSolveVerdict(large, text + (DOUBTFUL if large else ""))


def inside_the_bodies(context: Context, found: Findings) -> PostSolveVerdict | None:
    """Verdict on the distance in y from the centre of the patch to the nearest edge of a tread or
    head, held against 1.1 (EDGE) of its half length across. At an edge a stress peak arises that no
    profile shows. None without profiles across the rail.
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
    """Verdict on the rise of the pressure by a body that is held just below the patch, against the
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
        changes[body, deep] = halfspace.change(curvature, patch.a, patch.b)
    (body, deep), change = max(changes.items(), key=lambda each: each[1])
    thin = bool(change > limit)
    side = "above" if thin else "below"
    rise = f"pressure rises by {change:.2g}, {side} {limit:g}"
    text = f"the {body} is held {deep:.3g} mm deep: {rise}"
    return PostSolveVerdict(thin, text + (DOUBTFUL if thin else ""))

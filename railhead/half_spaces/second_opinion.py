"""Friction of half-spaces under the motion that finite elements found: by boundary elements on the
real profiles, and by closed forms.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from railhead.contact import closed_forms
from railhead.half_spaces import shearing
from railhead.half_spaces.pressing import HalfSpacePair, Pressed
from railhead.half_spaces.shearing import Motion
from railhead.postprocess.friction import AT_BORDER, LOADS, MOTION, quantities
from railhead.theory.elastic.hertz import Ellipse
from railhead.theory.elastic.line import Hertz, LineContact
from railhead.theory.friction import partial_slip
from railhead.theory.friction.rolling import CELLS, Creepage
from railhead.theory.friction.solution import FrictionSolution

GROWING_PATCH = "unlike bodies slip while the patch grows, which is not followed there"
STRIP_ACROSS = "a strip of unlike bodies across the rail"
UNEVEN = "the formula has one coefficient of friction"

Numbers = dict[str, float]
"""Keys of "friction" in summary.json with their values."""
NumbersByMethod = dict[str, dict[str, Any]]
"""The same, or a "reason", by the name of a method."""


def friction(
    pair: HalfSpacePair,
    found: FrictionSolution,
    pressed: Pressed,
    ellipse: Hertz,
    *,
    hertzian: bool,
) -> NumbersByMethod:
    """By method, the quantities of friction under the motion (rolling) or the forces (a shift) of
    finite elements, or {"reason": ...}. As for the pressure, both half-spaces have the scene's
    moduli, also where a body is rigid by choice.

    found: solution by finite elements. pressed: the pressure between half-spaces.
    ellipse: exact Hertz under the load of finite elements. hertzian: whether their patch is its.
    """
    scene, materials = pair.contact.scene, pair.materials
    rolling = scene.rolling.prescribed
    if not (materials.like or rolling):
        return {"boundary elements": {"reason": GROWING_PATCH}}
    simple = materials.like and closed_forms.coulomb(scene)
    uneven = {"reason": UNEVEN} if scene.friction.uneven else None
    if isinstance(ellipse, LineContact):
        if simple and rolling:
            return {} if ellipse.across else {"Carter": _carter(pair, found, ellipse)}
        if simple:
            return {"Cattaneo": (ellipse.across and uneven) or _mindlin(pair, found, ellipse)}
        if ellipse.across:
            return {"boundary elements": {"reason": STRIP_ACROSS}}
    numbers: dict[str, Any]
    try:
        numbers = boundary_elements(pair, found, pressed)
    except ValueError as error:
        numbers = {"reason": str(error)}
    out: NumbersByMethod = {"boundary elements": numbers}
    if simple and hertzian and not rolling:
        out["Cattaneo, Mindlin"] = uneven or _mindlin(pair, found, ellipse)
    return out


def _carter(pair: HalfSpacePair, found: FrictionSolution, line: LineContact) -> Numbers:
    """Force along the rail, stick share and dissipation of a line contact that rolls, by Carter, by
    the keys of summary.json.
    """
    coefficient = float(pair.surface.friction_coefficient(np.zeros(1))[0])
    share = partial_slip.carter_share(line, coefficient, found.rigid_motion[0])
    stick, force = partial_slip.strip_stick_ratio(abs(share)), share * found.friction_limit
    wear = force * found.rigid_motion[0]
    return {"force_along_N": force, "stick_share": stick, "t_gamma_N": wear}


def _mindlin(pair: HalfSpacePair, found: FrictionSolution, hertz: Hertz) -> Numbers:
    """Stick share (of the area) and, of solid half-spaces under a force, shifts (mm) by Cattaneo
    and Mindlin, by the keys of summary.json.
    """
    limit = found.friction_limit
    force = min(float(np.hypot(*found.force)), limit)
    if not isinstance(hertz, Ellipse):
        return {"stick_share": partial_slip.strip_stick_ratio(force / limit)}
    out = {"stick_share": partial_slip.ellipse_stick_ratio(force / limit) ** 2}
    if pair.contact.solid_half_space and force:
        materials = pair.materials
        compliances = partial_slip.initial_compliance(
            hertz.a, hertz.b, materials.shear_modulus, materials.poisson
        )
        ways = zip(("along", "across"), found.force, compliances, strict=True)
        for way, part, compliance in ways:
            shift = partial_slip.ellipse_shift(compliance, limit, force / limit)
            out[f"shift_{way}_mm"] = shift * part / force
    return out


def boundary_elements(
    pair: HalfSpacePair, found: FrictionSolution, pressed: Pressed, cells: Sequence[int] = CELLS
) -> Numbers:
    """Friction quantities of half-spaces by boundary elements, by their keys in summary.json, of
    rolling scaled to the limit mu N of `found`. Raises ValueError as `shearing.sheared`.

    found: solution by finite elements, of which the friction limit and the motion (rolling:
        creepages and spin) or the forces (a shift) count.
    pressed: the pressure.
    cells: numbers along each axis, the coarsest first. Numbers are extrapolated from them as those
        of finite elements; "grid_error" is the larger error of the forces by that, over mu N.
    """
    contact, rolling = pair.contact, pair.contact.scene.rolling.prescribed
    along, across = found.force
    moves = Motion(along=along, across=across, rolling=False)
    if rolling:
        moves = Motion(creepage=Creepage(*found.rigid_motion))
    sheared = shearing.sheared(pair, pressed, moves, cells)
    like = pair.materials.like
    numbers = quantities(sheared.solution, rolling=rolling, like=like, speed=None)
    keys = [LOADS[0], *AT_BORDER] if contact.line else [*LOADS, *AT_BORDER]
    keys += ["t_gamma_N"] * (rolling and like)
    if not rolling and contact.solid_half_space:
        keys += MOTION[False][:2]
    scale = found.friction_limit / sheared.limit if rolling else 1.0  # finite bodies' normal force
    out = {key: numbers[key] * (1.0 if key in AT_BORDER else scale) for key in keys}
    error = max(numbers["grid_error"][way] for way in LOADS[:2])
    return {**out, "grid_error": error / sheared.limit}

"""Friction of half-spaces under the motion that finite elements found: by boundary elements, by
FASTSIM, linear theory and closed forms.

Boundary elements find pressure and tractions on the real profiles. FASTSIM and the linear theory
know ellipses alone: each connected patch rolls as the ellipse that has its second moments and its
force.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from railhead.contact import closed_forms
from railhead.half_spaces import shearing
from railhead.half_spaces.pressing import HalfSpacePair, Pressed
from railhead.half_spaces.shearing import Motion, PressedPatch
from railhead.postprocess.friction import AT_BORDER, LOADS, MOTION, quantities
from railhead.theory.array_types import Array
from railhead.theory.elastic.hertz import Ellipse
from railhead.theory.elastic.line import Hertz, LineContact
from railhead.theory.friction import kalker, partial_slip
from railhead.theory.friction.kalker import Coefficients
from railhead.theory.friction.rolling import CELLS, Creepage
from railhead.theory.friction.solution import FrictionSolution
from railhead.theory.friction.tangential import MaterialPair

SLENDER = 20.0  # largest axis ratio in the tables of the linear theory
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
    out: NumbersByMethod = {
        "boundary elements": or_reason(lambda: boundary_elements(pair, found, pressed))
    }
    if simple and rolling:
        patches = shearing.patches(pair, pressed, CELLS[1])
        out["FASTSIM" if hertzian else "FASTSIM (equal ellipses)"] = or_reason(
            lambda: fastsim(patches, found.friction_limit, materials, found.rigid_motion)
        )
    elif simple and hertzian:
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


def or_reason(method: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """Result of a method, or {"reason": text} where it raises ValueError."""
    try:
        return method()
    except ValueError as error:
        return {"reason": str(error)}


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


def fastsim(
    patches: Sequence[PressedPatch], limit: float, pair: MaterialPair, motion: Sequence[float]
) -> Numbers:
    """Forces of the wheel on the rail, stick share and T-gamma of rolling patches by FASTSIM on
    ellipses with equal second moments and forces, by the keys of summary.json.

    limit: largest tangential force that friction allows, of all patches, N.
    pair: materials.
    motion: creepage along, across and spin (1/mm), at the first contact.
    Raises ValueError for an ellipse too slender.
    """
    sticks, touches = 0.0, 0.0
    total: Array = np.zeros(4)
    whole = sum(each.limit for each in patches)
    for patch, a, b, linear, local in _ellipses(patches, pair, motion):
        carried = limit * patch.limit / whole
        *forces, stick = kalker.fastsim(a, b, carried, pair.shear_modulus, linear, local)
        total = total + _work(patch, forces)
        sticks, touches = sticks + stick * a * b, touches + a * b
    known = *total[:3], sticks / touches, total @ [*motion, 1.0]
    return dict(zip((*LOADS, AT_BORDER[0], "t_gamma_N"), map(float, known), strict=True))


def linear(patches: Sequence[PressedPatch], pair: MaterialPair, motion: Sequence[float]) -> Array:
    """Forces of the wheel on the rail along, across (N) and moment about the normal at the first
    contact (N mm), (3,), of patches, by Kalker's linear theory. Each connected patch is the ellipse
    with its second moments and its force. Forces are the work of each patch's forces on the modes
    of rigid slip, summed. motion: creepage along, across and spin (1/mm). Raises ValueError for an
    ellipse too slender.
    """
    return np.sum(
        [
            _work(patch, known.forces(a, b, pair.shear_modulus, local))[:3]
            for patch, a, b, known, local in _ellipses(patches, pair, motion)
        ],
        axis=0,
    )


def _ellipses(
    patches: Sequence[PressedPatch], pair: MaterialPair, motion: Sequence[float]
) -> Iterator[tuple[PressedPatch, float, float, Coefficients, Creepage]]:
    """For each connected patch: the patch, its semi-axes a and b (mm), Kalker's coefficients, and
    the mean creepage and the spin in its own tangent plane. Raises ValueError for an axis ratio
    above 20 (SLENDER) or below 1/20.
    """
    moved = np.array([*motion, 1.0])
    for patch in (part for each in patches for part in each.parts()):
        a, b = patch.pressed.semi_axes
        if not 1 / SLENDER < a / b < SLENDER:
            raise ValueError(f"the linear theory's tables end before an axis ratio of {a / b:.3g}")
        along, across = moved @ patch.mean_modes
        local = Creepage(along, across, float(moved @ patch.spin))
        yield patch, a, b, kalker.coefficients(a / b, pair.poisson), local


def _work(patch: PressedPatch, forces: Sequence[float]) -> Array:
    """Work (4,) of a patch's forces along, across (N) and moment about its own normal (N mm) on
    each mode of rigid slip: N, N, N mm for the spin, and N for the wheel's own rotation.
    """
    along, across, moment = forces
    return np.asarray(patch.mean_modes @ [along, across] + moment * patch.spin)

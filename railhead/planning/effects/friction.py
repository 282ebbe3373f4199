"""Tangential traction: a shift from rest, or steady rolling."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from numpy.typing import NDArray

from railhead.meshing.tags import RAIL
from railhead.planning import exact
from railhead.planning.effects.base import After, Context, Effect
from railhead.postprocess.findings import Findings, Frame
from railhead.scene.scene import Scene, SceneError
from railhead.solver.setup import Rub, Setup
from railhead.theory import halfspace, hertz, kalker
from railhead.theory.hertz import Ellipse
from railhead.theory.rolling import Creepage

if TYPE_CHECKING:
    from railhead.planning.plan import Plan

NO_MISMATCH = 1e-9  # |beta| that is rounding
WORK, AT = 6.0, 46_000  # times an elastic run of so many unknowns; it grows with their square root:
# 3.5 to 10 times were measured from 28 000 to 98 000
PRESSED = "slip while a patch grows depends on the way of the load, which is not simulated"


def decide(context: Context) -> Effect:
    """Called for by a tangential force, by creepage or spin, or by friction between bodies whose
    surfaces slip when they are pressed together: Dundurs' beta != 0 (Johnson, Contact Mechanics,
    5.1 and 5.4)."""
    scene = context.scene
    rail, wheel, asked = scene.rail, scene.wheel, scene.friction
    limit = asked.coefficient * context.hertz.load
    table, along, across = scene.tangential
    force = math.hypot(along, across)
    if force and force >= limit:
        raise SceneError(
            f"{table}.force_{'along' if along else 'across'}",
            f"{force:g} N would slide; give less than friction.coefficient times the normal force, "
            f"{limit:g} N",
        )
    _fits_the_section(context)
    beta = hertz.dundurs_beta(
        rail.young_modulus, rail.poisson_ratio, wheel.young_modulus, wheel.poisson_ratio
    )
    untouched = "no tangential force and no creepage"
    if not asked.coefficient and scene.rolling.given:
        called, why = False, "friction.coefficient = 0: it rolls freely"
    elif scene.rolling.given:
        called, why = True, f"the wheel rolls{_expected(context, limit)}"
    elif force:
        stick = (1 - force / limit) ** (1 / 2 if context.contact.line else 1 / 3)
        why = (
            f"a tangential force of {force:g} N, {force / limit:.3g} of mu N: Cattaneo and Mindlin"
        )
        called, why = (
            True,
            f"{why}'s stick patch is {stick:.3g} times as long and wide as the patch",
        )
    elif abs(beta) < NO_MISMATCH:
        called, why = False, f"{untouched}, and Dundurs' beta = 0 leaves the surfaces unsheared"
    elif not asked.coefficient:
        called, why = False, f"{untouched}, and friction.coefficient = 0"
    else:
        why = f"it resists the slip of unlike materials, Dundurs' beta = {beta:.3g}"
        return Effect(True, False, why, {"on": PRESSED})
    refused = {} if asked.coefficient else {"on": "friction.coefficient is 0"}
    return Effect(called, called, why, refused)


def apply(setup: Setup, plan: Plan) -> Setup:
    """The coefficient and the wheel's motion."""
    scene, contact = plan.scene, plan.contact
    frame = Frame(contact.origin, contact.touch.angle)
    rolling, friction = scene.rolling, scene.friction
    given = rolling if rolling.given else friction
    known = [0.0, 0.0, rolling.spin]
    free = []
    for index, way in enumerate(("along", "across")):
        if rolling.given and getattr(rolling, f"force_{way}") is None:
            known[index] = getattr(rolling, f"creepage_{way}") or 0.0
        elif not (plan.half_x, plan.half_y or contact.plane == "xz")[index]:
            free.append((index, float(getattr(given, f"force_{way}") or 0.0)))
    far = CerrutiFarField(plan) if contact.half_space and not contact.plane else None
    motion = known[0], known[1], known[2]
    rub = Rub(
        friction.coefficient, rolling.given, frame.axes, frame.origin, motion, tuple(free), far
    )
    return replace(setup, rub=rub)


@dataclass(frozen=True)
class CerrutiFarField:
    """Displacement of both half-spaces under a tangential point force of 1 N of the wheel on the
    rail, in the place of the tractions."""

    plan: Plan

    def __call__(self, way: int, body: int, points: NDArray) -> NDArray:
        """(0 along or 1 across, RAIL or WHEEL, points (n, 3) mm) -> (n, 3) mm."""
        part, sign = self.plan.material(body), 1.0 if body == RAIL else -1.0
        lower = points * [1.0, 1.0, sign]
        lower[:, 2] = lower[:, 2].clip(max=0.0)
        constants = part.young_modulus, part.poisson_ratio
        moved = halfspace.cerruti_displacement(lower, sign, *constants, across=way == 1)
        return moved * [1.0, 1.0, sign]


def check(context: Context, effect: Effect, found: Findings) -> After | None:
    """Whether it was left out."""
    if not effect.called_for:
        return None
    return After(
        not effect.on, "simulated" if effect.on else f"{effect.why}: the answer is frictionless"
    )


def creepage(scene: Scene) -> Creepage:
    """What is given; 0 where a force is to be met."""
    rolling = scene.rolling
    return Creepage(rolling.creepage_along or 0.0, rolling.creepage_across or 0.0, rolling.spin)


def _expected(context: Context, limit: float) -> str:
    """Kalker's linear theory, of an ellipse."""
    scene, ellipse = context.scene, context.hertz
    if not isinstance(ellipse, Ellipse) or scene.rolling.force_along or scene.rolling.force_across:
        return ""
    if not 0.05 <= ellipse.a / ellipse.b <= 20:
        return ""
    pair = exact.tangential_pair(scene)
    linear = kalker.coefficients(ellipse.a / ellipse.b, pair.poisson)
    forces = linear.forces(ellipse.a, ellipse.b, pair.shear_modulus, creepage(scene))
    share = math.hypot(*forces[:2]) / limit
    return f": Kalker's linear force is {share:.3g} mu N" + (
        ", most of the patch slips" if share > 1 else ""
    )


def _fits_the_section(context: Context) -> None:
    """SceneError for a tangential motion that a section does not have."""
    scene, plane = context.scene, context.contact.plane
    along, across = scene.sheared
    table = "rolling" if scene.rolling.given else "friction"
    if plane == "yz" and along:
        raise SceneError(
            f"{table}", "along the rail is not allowed: the scene is a section across it"
        )
    if plane == "xz" and across:
        raise SceneError(
            f"{table}", "across the rail is not allowed: the scene is a section along it"
        )

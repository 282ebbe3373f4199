"""Half-spaces with friction beside the result: boundary elements, FASTSIM, closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np

from railhead.level import Level
from railhead.planning import developed, exact
from railhead.solver.solution import Rubbing
from railhead.theory import carter, cattaneo, kalker, tangential
from railhead.theory.fastsim import fastsim
from railhead.theory.hertz import Ellipse
from railhead.theory.rolling import Creepage, HalfSpaceFriction

LIKE = 1e-9  # |K/G| that is rounding
SLENDER = 20.0  # axis ratio up to which the linear theory is known

Opinions = dict[str, dict[str, Any]]


def opinions(level: Level) -> Opinions | None:
    """ "half_space_friction" of summary.json: by method, the forces at the motion that was found,
    where the method knows an answer: under the pressure of half-spaces, of a single patch. None
    without friction."""
    found, plan = level.solution.rubbing, level.plan
    if found is None or level.findings is None:
        return None
    scene, ellipse = plan.scene, level.ellipse
    pair = exact.tangential_pair(scene)
    like = abs(pair.mismatch) < LIKE
    single = len(level.findings.patch.each) < 2
    out: Opinions = {}
    if not single or (not isinstance(ellipse, Ellipse) and not like):
        return out
    if not scene.rolling.given:
        if like and any(found.force):
            share = float(np.hypot(*found.force) / found.limit)
            if isinstance(ellipse, Ellipse):
                stick = (1 - share) ** (2 / 3)
            else:
                stick = cattaneo.strip_stick_ratio(share)
            out["Cattaneo, Mindlin"] = {"stick_share": stick}
        return out
    if not isinstance(ellipse, Ellipse):
        strip = carter.from_creepage(ellipse.strip, scene.friction.coefficient, found.motion[0])
        out["Carter"] = {
            "force_along_N": strip.share * found.limit,
            "stick_share": strip.stick_half_width / ellipse.strip.b,
        }
        return out
    out["boundary elements"] = _boundary_elements(level, found, pair)
    if level.findings.hertzian and 1 / SLENDER < ellipse.a / ellipse.b < SLENDER and like:
        linear = kalker.coefficients(ellipse.a / ellipse.b, pair.poisson)
        along, across, moment, stick = fastsim(
            ellipse.a, ellipse.b, found.limit, pair.shear_modulus, linear, Creepage(*found.motion)
        )
        out["FASTSIM"] = _named(along, across, moment, stick)
    return out


def _boundary_elements(level: Level, found: Rubbing, pair: tangential.Pair) -> dict[str, Any]:
    """Under Hertz's pressure where the patch is his, else under that of the profiles."""
    ellipse, friction = level.ellipse, level.plan.scene.friction.coefficient
    assert isinstance(ellipse, Ellipse) and level.findings is not None
    if level.findings.hertzian:
        body = HalfSpaceFriction.hertz(ellipse, friction, pair, rolling=True)
    else:
        try:
            patch = developed.solve(level.plan.contact, ellipse, level.solution.load).patches[0]
        except ValueError:
            return {}
        body = HalfSpaceFriction(patch.x, patch.s, patch.pressure, friction, pair, rolling=True)
    rolled = body.at(Creepage(*found.motion))
    scale = found.limit / rolled.limit  # cells at the edge are in or out
    along, across, moment = (scale * force for force in rolled.forces)
    return _named(along, across, moment, rolled.stick_share)


def _named(along: float, across: float, moment: float, stick: float) -> dict[str, Any]:
    return {
        "force_along_N": along, "force_across_N": across, "moment_Nmm": moment,
        "stick_share": stick,
    }  # fmt: skip

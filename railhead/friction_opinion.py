"""Half-spaces with friction beside the result: boundary elements, FASTSIM, closed forms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from railhead import equal_ellipses, shearing
from railhead.level import Level
from railhead.planning import exact
from railhead.shearing import Patch
from railhead.solver.rubbing import Rubbed, Rubbing
from railhead.theory import carter, cattaneo, unlike
from railhead.theory.boundary_element import Solution
from railhead.theory.driven import under
from railhead.theory.hertz import Ellipse
from railhead.theory.line import LineContact
from railhead.theory.rolling import Creepage, HalfSpaceFriction, Sheared
from railhead.theory.tangential import Pair

LIKE = 1e-9  # |K/G| that is rounding
CELLS = (32, 64)  # each way in a patch; the error of unlike bodies is of first order
SEVERAL = "how several patches share a force depends on the compliance of the bodies"
UNLIKE = "a strip of unlike bodies, whose tractions change its pressure"

Opinion = dict[str, Any]
Opinions = dict[str, Opinion]


def opinions(level: Level, profiles: Solution | str | None) -> Opinions | None:
    """ "half_space_friction" of summary.json: by method, what it says of the motion (rolling) or of
    the forces (a shift) that were found, or the reason why it knows no answer. None without
    friction. profiles: of `second_opinion.solve`."""
    if not isinstance(level.solution, Rubbed) or level.findings is None:
        return None
    found, ellipse = level.solution.rubbing, level.ellipse
    pair = exact.tangential_pair(level.plan.scene)
    like = abs(pair.mismatch) < LIKE
    if isinstance(ellipse, LineContact):
        return _strip(level, found, ellipse) if like else {"boundary elements": {"reason": UNLIKE}}
    out: Opinions = {}
    try:
        patches = _patches(level, profiles, CELLS[1])
        out["boundary elements"] = _boundary_elements(level, found, pair, patches)
        if like and level.plan.scene.rolling.given:
            name = "FASTSIM" if level.findings.hertzian else "FASTSIM (equal ellipses)"
            forces, stick = equal_ellipses.fastsim(patches, found.limit, pair, found.motion)
            wear = float(forces @ found.motion)
            out[name] = _named(*forces, stick) | {"t_gamma_N": wear}
    except ValueError as error:
        out["boundary elements"] = {"reason": str(error)}
    if like and level.findings.hertzian and not level.plan.scene.rolling.given:
        out["Cattaneo, Mindlin"] = _mindlin(level, found, pair, ellipse)
    return out


def _strip(level: Level, found: Rubbing, line: LineContact) -> Opinions:
    strip, friction = line.strip, level.plan.scene.friction.coefficient
    if not level.plan.scene.rolling.given:
        share = float(np.hypot(*found.force) / found.limit)
        return {"Cattaneo": {"stick_share": cattaneo.strip_stick_ratio(min(share, 1.0))}}
    if line.across:
        return {}
    rolled = carter.from_creepage(strip, friction, found.motion[0])
    stick, force = rolled.stick_half_width / strip.b, rolled.share * found.limit
    wear = force * found.motion[0]
    return {"Carter": {"force_along_N": force, "stick_share": stick, "t_gamma_N": wear}}


def _patches(level: Level, profiles: Solution | str | None, cells: int) -> list[Patch]:
    ellipse, found = level.ellipse, level.findings
    assert isinstance(ellipse, Ellipse) and found is not None
    return shearing.patches(
        level.plan.contact, ellipse, hertzian=found.hertzian, load=level.solution.load,
        cells=cells, profiles=profiles,
    )  # fmt: skip


def _boundary_elements(level: Level, found: Rubbing, pair: Pair, patches: list[Patch]) -> Opinion:
    """Of unlike bodies extrapolated from two grids, with the change that makes ("grid_error", over
    mu N)."""
    fine = _on_grid(level, found, pair, patches)
    if abs(pair.mismatch) < LIKE:
        return fine
    coarse = _on_grid(level, found, pair, _patches(level, None, CELLS[0]))
    better = {name: 2 * value - coarse[name] for name, value in fine.items()}
    better["stick_share"] = min(max(better["stick_share"], 0.0), 1.0)
    forces = ("force_along_N", "force_across_N")
    change = max(abs(better[name] - fine[name]) for name in forces) / found.limit
    return {**better, "grid_error": change}


def _on_grid(level: Level, found: Rubbing, pair: Pair, patches: list[Patch]) -> Opinion:
    scene = level.plan.scene
    rolling, friction = scene.rolling.given, scene.friction.coefficient
    if len(patches) > 1 and not rolling:
        raise ValueError(SEVERAL)
    limit = friction * sum(each.pressed.force for each in patches)
    scale = found.limit / limit  # the normal forces differ by what the finite bodies do
    along, across = (force / scale for force in found.force)
    shear: Callable[[HalfSpaceFriction], Sheared]
    if rolling:
        motion = Creepage(*found.motion)
        shear = lambda body: body.at(motion)  # noqa: E731
    else:
        shear = lambda body: under([body], Creepage(), along=along, across=across)[0]  # noqa: E731
    sheared = [
        unlike.rubbed(each.pressed, pair, friction, shear, rolling=rolling, modes=each.modes)
        for each in patches
    ]
    forces = scale * np.sum([each.forces for each in sheared], axis=0)
    sticks, touches = np.sum([each.areas for each in sheared], axis=0)
    largest = max(float(np.linalg.norm(each.traction, axis=0).max()) for each in sheared)
    out = _named(*forces, sticks / touches) | {"traction_max_MPa": largest}
    if rolling:
        out["t_gamma_N"] = float(forces @ found.motion)
    elif level.plan.contact.half_space:  # other bodies shift with all that holds them
        shift = sheared[0].creepage
        out |= {"shift_along_mm": scale * shift.along, "shift_across_mm": scale * shift.across}
    return out


def _mindlin(level: Level, found: Rubbing, pair: Pair, ellipse: Ellipse) -> Opinion:
    force = float(np.hypot(*found.force))
    out = {"stick_share": (1 - min(force / found.limit, 1.0)) ** (2 / 3)}
    if level.plan.contact.half_space and force:
        compliances = cattaneo.initial_compliance(ellipse.a, ellipse.b, *_like(pair))
        for way, part, compliance in zip(
            ("along", "across"), found.force, compliances, strict=True
        ):
            known = cattaneo.CattaneoMindlin(found.limit, compliance)
            out[f"shift_{way}_mm"] = known.approach(min(force, known.limit)) * part / force
    return out


def _like(pair: Pair) -> tuple[float, float]:
    return pair.shear_modulus, pair.poisson


def _named(along: float, across: float, moment: float, stick: float) -> Opinion:
    return {
        "force_along_N": float(along), "force_across_N": float(across),
        "moment_Nmm": float(moment), "stick_share": float(stick),
    }  # fmt: skip

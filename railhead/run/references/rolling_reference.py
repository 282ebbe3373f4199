"""Half-spaces with friction beside the result: boundary elements, FASTSIM, closed forms."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from railhead.planning.references import closed_forms
from railhead.run.mesh_solution import MeshSolution
from railhead.run.references import equal_ellipses, rolling_patches
from railhead.run.references.rolling_elements import Asked, named, opinion
from railhead.run.references.rolling_patches import Patch
from railhead.theory.bem.boundary_element import Solution
from railhead.theory.elastic.hertz import Ellipse
from railhead.theory.elastic.line import LineContact
from railhead.theory.friction import carter, cattaneo

CELLS, STRIP_CELLS = (32, 64), (128, 256)  # of boundary elements, coarse and fine
STRIP = ("force_along_N", "stick_share", "traction_max_MPa", "t_gamma_N", "grid_error")
GROWN = "unlike bodies slip while the patch grows, which is not followed there"
TURNED = "a strip of unlike bodies across the rail"

Opinions = dict[str, dict[str, Any]]


def opinions(solved: MeshSolution, profiles: Solution | str | None) -> Opinions | None:
    """ "half_space_friction" of summary.json: by method, what it says of the motion (rolling) or of
    the forces (a shift) that were found, or the reason why it knows no answer. None without
    friction. profiles: of `half_space_reference.solve`."""
    found = solved.solution.friction
    if found is None or solved.findings is None:
        return None
    scene, contact = solved.plan.scene, solved.plan.contact
    asked = Asked(
        found, scene.friction.coefficient, closed_forms.tangential_pair(scene),
        scene.rolling.prescribed, contact.half_space and not solved.plan.section,
    )  # fmt: skip
    if not (asked.like or asked.rolling):
        return {"boundary elements": {"reason": GROWN}}
    if isinstance(solved.ellipse, LineContact):
        return _strip(asked, solved.ellipse)
    return _solid(asked, solved, solved.ellipse, profiles)


def _strip(asked: Asked, line: LineContact) -> Opinions:
    found, strip = asked.found, line.strip
    if not asked.like and line.across:
        return {"boundary elements": {"reason": TURNED}}
    if not asked.like:
        rubbed = opinion(asked, lambda cells: rolling_patches.strip(strip, cells), STRIP_CELLS)
        return {"boundary elements": {key: rubbed[key] for key in STRIP if key in rubbed}}
    if not asked.rolling:
        share = float(np.hypot(*found.force) / found.friction_limit)
        return {"Cattaneo": {"stick_share": cattaneo.strip_stick_ratio(min(share, 1.0))}}
    if line.across:
        return {}
    rolled = carter.from_creepage(strip, asked.friction, found.rigid_motion[0])
    stick, force = rolled.stick_half_width / strip.b, rolled.share * found.friction_limit
    wear = force * found.rigid_motion[0]
    return {"Carter": {"force_along_N": force, "stick_share": stick, "t_gamma_N": wear}}


def _solid(
    asked: Asked, solved: MeshSolution, ellipse: Ellipse, profiles: Solution | str | None
) -> Opinions:
    assert solved.findings is not None
    hertzian, load = solved.findings.hertzian, solved.solution.load

    def patches(cells: int) -> Sequence[Patch]:
        return rolling_patches.patches(
            solved.plan.contact, ellipse, hertzian=hertzian, load=load, cells=cells,
            profiles=profiles,
        )  # fmt: skip

    out: Opinions = {"boundary elements": _known(lambda: opinion(asked, patches, CELLS))}
    if asked.like and asked.rolling:
        name = "FASTSIM" if hertzian else "FASTSIM (equal ellipses)"
        out[name] = _known(lambda: _fastsim(asked, patches(CELLS[1])))
    elif asked.like and hertzian:
        out["Cattaneo, Mindlin"] = _mindlin(asked, ellipse)
    return out


def _known(method: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    try:
        return method()
    except ValueError as error:
        return {"reason": str(error)}


def _fastsim(asked: Asked, patches: Sequence[Patch]) -> dict[str, Any]:
    found = asked.found
    rolled = equal_ellipses.fastsim(patches, found.friction_limit, asked.pair, found.rigid_motion)
    return {**named(rolled.forces, rolled.stick_share), "t_gamma_N": rolled.t_gamma}


def _mindlin(asked: Asked, ellipse: Ellipse) -> dict[str, Any]:
    found, pair = asked.found, asked.pair
    force = min(float(np.hypot(*found.force)), found.friction_limit)
    compliances = cattaneo.initial_compliance(
        ellipse.a, ellipse.b, pair.shear_modulus, pair.poisson
    )
    ways = [cattaneo.CattaneoMindlin(found.friction_limit, each) for each in compliances]
    out = {"stick_share": ways[0].stick_ratio(force) ** 2}
    if asked.shifts and force:
        for way, part, known in zip(("along", "across"), found.force, ways, strict=True):
            out[f"shift_{way}_mm"] = known.approach(force) * part / force
    return out

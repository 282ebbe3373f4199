"""Results of friction: forces, creepages or shifts, zone of stick, dissipated energy; and what it
does to the steel: wear regime, point in the shakedown map.
"""

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhead.postprocess.findings import Array, Findings
from railhead.theory import damage
from railhead.theory.friction.rolling import TangentialSolution
from railhead.theory.friction.solution import FrictionSolution

MOTION = {
    True: ("creepage_along", "creepage_across", "spin_per_mm"),
    False: ("shift_along_mm", "shift_across_mm", "turn_rad"),
}
LOADS = "force_along_N", "force_across_N", "moment_Nmm"
GIVEN = 1e-6  # of mu N: a force that changes less with the grid is given, or all slips
RAGGED = {False: 5e-5, True: 4e-4}
"""Of mu N, by whether it spins: error of a force that does not change with the grid. Of 60 ellipses
with creepages 3 % had more; of 15 that spin, against 128 cells, one had 4.1e-4."""
SLOWEST = 0.8  # of a change, that of the next grid; half is the first order
RESOLVED = 0.05  # relative: a quantity of friction that may be off by more is not signed
AT_NODES = "traction_max_MPa", "surface_fatigue_index"  # of condensed solids that of one
# contact point, whose pressure is noisy: 8 to 14 % above Cattaneo's and Mindlin's
BORDER = 3.0  # over n^(-3/4): error of the stick share on a grid with n points in the patch; 0.8 to
# 2.8 were measured beside grids of 128 and 192 cells, with and without finite bodies
AT_BORDER = "stick_share", "traction_max_MPa"
WEAR = "t_gamma_N", "wear_number_N", "power_W", "t_gamma_over_area_MPa", "wear_regime"
RISE = "temperature_rise_rail_K", "temperature_rise_wheel_K"
EVEN = 1e-9  # relative difference of coefficients that are taken for the same
AT_SURFACE = 0.1  # of the smaller half length of the patch: what lies less deep is at the surface


def at_cells(
    found: Sequence[TangentialSolution],
    places: Sequence[Array],
    tangents: Sequence[Array],
    used: Sequence[NDArray[np.bool_]],
    parts: float = 1.0,
    *,
    drawn: Sequence[Array] | None = None,
    centred: bool = False,
) -> FrictionSolution:
    """Tractions of patches that share one rigid motion as a solution with vectors in space, at the
    cells that are used; nothing is solved. Forces and moment are left zero.

    found: tractions of each patch on a grid.
    places (nx, ny, 3), tangents (nx, ny, 2, 3): of each patch, cell centres in space, mm, and unit
        vectors along and across. used (nx, ny): whether a cell is used.
    drawn: reduction (2, nx, ny) of the rigid slip of each patch by other causes; None: zero.
    centred: whether slip is taken at the cell centres (`TangentialSolution.central_slip`).
    parts: factor on the areas of the cells: number of symmetric parts of the model, where only the
        cells of one are used.
    """

    def joined(values: Sequence[NDArray[Any]]) -> NDArray[Any]:
        """Values (n, ...) at the cells that are used, of an array (nx, ny, ...) a patch."""
        return np.concatenate([each[inside] for each, inside in zip(values, used, strict=True)])

    def in_space(values: Sequence[Array]) -> Array:
        """Vectors in space (n, 3) of components (2, nx, ny) along the tangents, of each patch."""
        pairs = zip(values, tangents, strict=True)
        return joined([np.einsum("kab,abkc->abc", value, each) for value, each in pairs])

    less = drawn or [np.zeros_like(each.traction) for each in found]
    motion, rises = found[0].creepage, [each.rise for each in found if each.rise is not None]
    hot = [joined(body) for body in zip(*rises, strict=True)] if rises else (None, None)
    return FrictionSolution(
        points=joined(places),
        weights=joined([np.full_like(each.bound, parts * each.cell) for each in found]),
        pressure=joined([each.pressure for each in found]),
        bound=joined([each.bound for each in found]),
        traction=in_space([each.traction for each in found]),
        slip=in_space([each.central_slip if centred else each.slip for each in found]),
        sticks=joined([each.sticks for each in found]),
        inside=joined([each.covered for each in found]),
        rigid_motion=(motion.along, motion.across, motion.spin),
        force=(0.0, 0.0),
        moment=0.0,
        rigid_slip=in_space(
            [
                np.einsum("m,mdij->dij", motion.motion, each.modes) - own
                for each, own in zip(found, less, strict=True)
            ]
        ),
        rise_rail=hot[0],
        rise_wheel=hot[1],
    )


def wear_number(found: FrictionSolution, centres: Array) -> float:
    """Largest British Rail wear number of all patches, N, at least 0: the scalar product of
    tangential force and mean creepage.

    found: solution of rolling contact. centres (k, 3): of the patches in space, mm; each contact
        point belongs to the nearest one. The mean creepage of a patch is its rigid slip, weighted
        by pressure, so that spin about the centre of the patch cancels.
    """
    away = np.linalg.norm(found.points[:, None] - centres, axis=2)
    owner, numbers = np.argmin(away, axis=1), [0.0]
    for patch in range(len(centres)):
        own = (owner == patch) & (found.pressure > 0)
        weights = found.weights[own]
        if own.any():
            load = weights * found.pressure[own]
            creepage = load @ found.rigid_slip[own] / load.sum()
            numbers.append(float(weights @ found.traction[own] @ creepage))
    return max(numbers)


def quantities(
    found: FrictionSolution,
    *,
    rolling: bool,
    like: bool,
    speed: float | None,
    patches: Array | None = None,
) -> dict[str, Any]:
    """Entries of "friction" in summary.json, by name with the unit at the end of the name. Forces
    are those of the whole model.

    found: the solution. rolling: whether the wheel rolls. like: whether a pressure moves the
        surfaces of both bodies alike, as with equal elastic constants. speed: m/s, or None.
        patches (k, 3): centres of the patches in space, mm, or None.
    Always: forces along and across and the moment of the wheel on the rail; the limit mu N, and
        over the normal force: the mean coefficient; the rigid motion of the wheel; the share of
        the area that sticks; and the largest traction.
    Rolling: T-gamma, the energy dissipated per rolled length, N. It is the integral of traction
        times rigid slip, of solids with the strain of their pressed surfaces. Of unlike bodies,
        which creep without a force, it is that of traction times slip.
    Where the coefficient differs from place to place: the least one, and the mean one where the
        surfaces slip, weighted by pressure. With temperatures: the largest rise of each surface
        above the bulk of its body, K.
    Rolling with a speed: the power, W. Rolling of like bodies with centres: the wear number, N.
        Rolling of like bodies with a solution without creepage: its numbers, and the resolution of
        each quantity.
    With solutions on coarser grids each number is extrapolated (`_extrapolated`). "grid_error": by
        key the larger change, from the finest grid and from what both coarser ones give.
    Always "below_resolution": names of the quantities that mesh or grid do not resolve; without the
        resolution of each those that the border of stick hides (`_hidden_by_border`).
    """
    grids, grid = [], found
    while True:
        grids.append(_values(grid, rolling=rolling, like=like, patches=patches))
        if grid.coarse is None:
            break
        grid = grid.coarse
    out: dict[str, Any] = grids[0]
    errors: dict[str, float] = {}
    if len(grids) > 1:
        out, *before = (_extrapolated(*pair, rolling=rolling) for pair in pairwise(grids))
        errors = _errors(found, out, grids, before)
        out["grid_error"] = errors
    if rolling and speed is not None:
        out["power_W"] = speed * out["t_gamma_N"]
        if errors:
            errors["power_W"] = speed * errors["t_gamma_N"]
    error = errors.get("stick_share", _border_error(found))
    below = _hidden_by_border(out["stick_share"], error, WEAR if rolling and not like else ())
    unsure = errors.keys() & {LOADS[2], *WEAR}
    below |= {key for key in unsure if errors[key] > RESOLVED * abs(out[key])}
    below |= {*WEAR} if "t_gamma_N" in below else set()
    out["below_resolution"] = sorted(below)
    if like and found.without_creepage is not None:
        known = _resolution(grids[0], found)
        below |= {*known["below_resolution"]}
        out |= known | {"below_resolution": sorted(below)}
    return out


def _extrapolated(
    fine: Mapping[str, float], coarse: Mapping[str, float], *, rolling: bool
) -> dict[str, Any]:
    """Numbers of cells of size zero, by key, from those of two grids, the coarse one with cells
    twice as long: of rolling, and at the border of stick (AT_BORDER), by the first order, else by
    the second. The stick share is kept within 0 to 1.
    """
    out = {}
    for key, value in fine.items():
        change = value - coarse.get(key, value)
        out[key] = value + change / (1 if rolling or key in AT_BORDER else 3)
    out["stick_share"] = min(max(out["stick_share"], 0.0), 1.0)
    return out


def _errors(
    found: FrictionSolution,
    out: Mapping[str, float],
    grids: Sequence[Mapping[str, float]],
    before: Sequence[Mapping[str, float]],
) -> dict[str, float]:
    """Errors of extrapolated numbers `out` by key, in their units: the largest distance to the
    finest of the `grids` and to what coarser ones extrapolate to (`before`). It is at least what a
    geometric sequence still has to go, where the last change is a large share of the one before;
    0.8 (SLOWEST) is the largest. Not so what is read at the border of stick (AT_BORDER), which
    changes without order. That of the largest traction counts twice: at the border of stick
    it is of the order 1/2. Forces and moment that change, and the stick share, have what the ragged
    edges of cells leave at least (RAGGED; `_border_error`), and T-gamma what these forces make of
    it.
    """
    errors = {
        key: max(abs(value - of.get(key, value)) for of in (grids[0], *before))
        for key, value in out.items()
    }
    for key in set.intersection(*map(set, grids)).difference(AT_BORDER) if before else ():
        last, earlier = (abs(fine[key] - coarse[key]) for fine, coarse in pairwise(grids[:3]))
        share = min(last / earlier, SLOWEST) if earlier else 0.0
        errors[key] = max(errors[key], last * share / (1 - share))
    least, arm = RAGGED[found.rigid_motion[2] != 0] * out["limit_N"], found.arm
    for key, floor in zip(LOADS, (least, least, arm * least), strict=True):
        if errors[key] > GIVEN * out["limit_N"]:
            errors[key] = max(errors[key], floor)
    work = sum(errors[key] * abs(each) for key, each in zip(LOADS, found.rigid_motion, strict=True))
    for key in errors.keys() & {"t_gamma_N", "wear_number_N"}:
        errors[key] = max(errors[key], work)
    errors["stick_share"] = max(errors["stick_share"], _border_error(found))
    errors["traction_max_MPa"] *= 2
    return errors


def _values(
    found: FrictionSolution,
    *,
    rolling: bool,
    like: bool,
    patches: Array | None,
) -> dict[str, float]:
    """Numbers of "friction" in summary.json of one grid or mesh, by key; arguments as of
    `quantities`.
    """
    touches = found.pressure > 0
    areas = found.weights if found.inside is None else found.weights * found.inside
    share = areas[found.sticks].sum() / areas[touches].sum()
    out = {
        "force_along_N": found.force[0],
        "force_across_N": found.force[1],
        "moment_Nmm": found.moment,
        "limit_N": found.friction_limit,
        "coefficient": found.friction_limit / float(found.weights @ found.pressure),
        **dict(zip(MOTION[rolling], found.rigid_motion, strict=True)),
        "stick_share": float(share),
        "traction_max_MPa": float(np.linalg.norm(found.traction, axis=1).max()),
    }
    least = float((found.bound[touches] / found.pressure[touches]).min())
    if least < (1 - EVEN) * out["coefficient"]:
        out["coefficient_least"] = least
        slipping = found.weights * ~found.sticks
        if (load := slipping @ found.pressure) > 0:
            out["coefficient_slipping"] = float(slipping @ found.bound / load)
    for key, rise in zip(RISE, (found.rise_rail, found.rise_wheel), strict=True):
        if rise is not None:
            out[key] = float(rise.max())
    if rolling:
        slip = found.rigid_slip if like else found.slip
        wear = float(found.weights @ np.einsum("nc,nc->n", found.traction, slip))
        out["t_gamma_N"] = wear
        if like and patches is not None:
            out["wear_number_N"] = wear_number(found, patches)
    return out


def _resolution(out: Mapping[str, Any], found: FrictionSolution) -> dict[str, Any]:
    """Errors that the mesh makes in the quantities of friction of like bodies that roll, and names
    of those that are too small for it.

    out: numbers of `found`, by key.
    "without_creepage": numbers of the solution without creepage, in which like half-spaces have no
        traction and stick everywhere: what bodies of unlike shape do when they are pressed.
    "resolution": errors by quantity, in its unit, of solids with half-spaces for their tractions
        from what is misread of the bodies, of both forces together. Of sections all that is found
        without creepage; of T-gamma its forces times the creepages. That of the stick share
        includes that of the border of stick (`_border_error`).
    "below_resolution": names of forces, moment and T-gamma whose error exceeds 5 % (RESOLVED),
    and of what is computed from them; what the border of stick hides (`_hidden_by_border`).
    """
    assert found.without_creepage is not None
    still = _values(found.without_creepage, rolling=True, like=True, patches=None)
    shown = (*LOADS, "traction_max_MPa", "t_gamma_N", "stick_share")
    still = {name: still[name] for name in shown}
    if found.misread is not None:
        other = _values(found.misread, rolling=True, like=True, patches=None)
        limits = {name: abs(other[name] - out[name]) for name in still}
        # A mesh errs in no direction of its own: each has the size of both, about half an arm.
        size = math.hypot(limits[LOADS[0]], limits[LOADS[1]])
        arms = zip(LOADS, (1.0, 1.0, found.arm / 2), strict=True)
        limits |= {name: max(limits[name], size * arm) for name, arm in arms if limits[name]}
    else:
        motion = zip(LOADS, found.rigid_motion, strict=True)
        limits = {name: abs(each) for name, each in still.items()}
        limits["t_gamma_N"] = abs(sum(still[name] * each for name, each in motion))
        limits["stick_share"] = 1 - still["stick_share"]
    limits["stick_share"] += _border_error(found)
    below = {name for name in (*LOADS, "t_gamma_N") if limits[name] > RESOLVED * abs(out[name])}
    if "t_gamma_N" in below:
        below |= set(WEAR)
    force, drift = (np.hypot(*(each[name] for name in LOADS[:2])) for each in (out, limits))
    if drift > RESOLVED * force:
        below.add("traction_coefficient")
    below |= _hidden_by_border(out["stick_share"], limits["stick_share"])
    return {"without_creepage": still, "resolution": limits, "below_resolution": sorted(below)}


def _border_error(found: FrictionSolution) -> float:
    """Share of the area around the border of stick that is not known: 3 n^(-3/4) with n contact
    points (BORDER), in a section one point.
    """
    touches = found.pressure > 0
    point = float(found.weights.max() / found.weights[touches].sum())
    section = not np.ptp(found.points[touches][:, :2], axis=0).all()
    return point if section else BORDER * point**0.75


def _hidden_by_border(stick_share: float, error: float, energy: Sequence[str] = ()) -> set[str]:
    """Names of what a stick share with this error hides: the share itself where what slips is no
    larger than the error; where the error exceeds a tenth of what slips, the largest traction,
    which grows as the square root of what slips, and `energy`, what is computed from true slip.
    """
    slips = 1 - stick_share
    below = {"stick_share"} if slips <= error else set()
    return below | {*AT_NODES, *energy} if error > 2 * RESOLVED * slips else below


def wear_and_shakedown(
    found: Findings,
    forces: Mapping[str, Any],
    shear_yield: float | None,
    *,
    poisson: float,
    rolling: bool,
    line: bool,
) -> dict[str, Any]:
    """Wear regime and state in the shakedown map, as entries of "friction" in summary.json. Of
    several patches forces and area are added up, and each peak is the largest of any.

    found: patch, pressure and stresses. forces: as of `quantities`. shear_yield: yield stress in
        shear k, MPa, or None. poisson: Poisson's ratio. rolling: whether the wheel rolls. line:
        whether the contact is a line.

    Without stresses none of what follows from them. Else always: the largest von Mises stress, its
        depth, and whether its place is at the 'surface' or 'below', that is deeper than 0.1
        (AT_SURFACE) of the smaller half length.
    Rolling: T-gamma, the energy dissipated per rolled length, over the area, with its wear regime
        at a coefficient of 0.2 (DRY) or more, that is of dry surfaces;
        traction_coefficient, tangential over normal force; first_yield_p0_over_k, the largest
        pressure p0 over k at which this patch begins to yield; shakedown_limit_p0_over_k. The limit
        is the smaller of two: that of a line that rolls with this traction coefficient and the
        coefficient of friction where the patch slips, and that of
        a surface that slips everywhere at the largest traction over p0. For a line the second is
        the p0/k at which the largest traction is k.
    With k: p0_over_k; surface_fatigue_index, (largest traction - k) / p0; and the state of
        `damage.state`. A patch that is no line is 'open' instead of 'ratchets' where its index is
        not positive and p0/k at most `damage.CIRCLE`.
    """
    patch, out = found.patch, dict[str, Any]()
    peaks = [each.von_mises for each in found.largest.values()]
    hardest = max(peaks, key=lambda peak: peak.value, default=None)
    if hardest is not None:
        near = abs(hardest.depth) < AT_SURFACE * min(patch.a, patch.b)
        out["von_mises_max_MPa"], out["von_mises_max_depth_mm"] = hardest.value, abs(hardest.depth)
        out["von_mises_max_at"] = "surface" if near else "below"
    if not rolling:
        return out
    coefficient, pressure = forces["coefficient"], patch.max_pressure
    normal, density = forces["limit_N"] / coefficient, forces["t_gamma_N"] / patch.area
    used = math.hypot(forces["force_along_N"], forces["force_across_N"]) / normal
    out |= {"t_gamma_over_area_MPa": density, "traction_coefficient": used}
    if coefficient >= damage.DRY:
        out["wear_regime"] = damage.wear_regime(density, damage.TWIN_DISC)
    if hardest is None:
        return out
    first, local = math.sqrt(3) * pressure / hardest.value, forces["traction_max_MPa"] / pressure
    surface = 1 / local if line else damage.surface_limit(local, poisson)
    slipping = forces.get("coefficient_slipping", coefficient)
    limit = min(damage.shakedown_limit(slipping, poisson, used), surface)
    out |= {"first_yield_p0_over_k": first, "shakedown_limit_p0_over_k": limit}
    if shear_yield is None:
        return out
    ratio = pressure / shear_yield
    index = damage.surface_fatigue_index(forces["traction_max_MPa"], pressure, shear_yield)
    known = line or index > 0 or ratio > damage.CIRCLE
    return out | {
        "shear_yield_MPa": shear_yield,
        "p0_over_k": ratio,
        "surface_fatigue_index": index,
        "shakedown": damage.state(ratio, first, limit, "ratchets" if known else "open"),
    }

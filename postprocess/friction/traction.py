"""What friction does: forces, creepages or shifts, where the patch sticks, what is dissipated."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from railhead.postprocess.findings import Array

if TYPE_CHECKING:
    from railhead.solver.solution import FrictionSolution


MOTION = {True: ("creepage_along", "creepage_across", "spin_per_mm"),
          False: ("shift_along_mm", "shift_across_mm", "turn_rad")}  # fmt: skip
LOADS = "force_along_N", "force_across_N", "moment_Nmm", "traction_max_MPa"


def wear_number(found: FrictionSolution, centres: Array) -> float:
    """The largest of all patches, N: the force on its points, those nearest to its centre, times
    the rigid slip there on the average of the pressure, which spin about the patch leaves out."""
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
    cycle: bool,
    patches: Array | None = None,
) -> dict[str, Any]:
    """As "friction" in summary.json: forces and moment of the wheel on the rail, N and N mm, with
    mu N; the wheel's motion over the rail; the share of the patch's area that sticks; the largest
    traction, MPa. Rolling, T-gamma: the energy dissipated per rolled length, N, as tractions
    times rigid slip, of unlike bodies, which creep without a force, times slip; with a speed
    in m/s the power in W; British Rail's wear number, T-gamma without spin: force times mean
    creepage of the patch with the largest, of those with centres (k, 3), mm. Of a cycle, the
    energy that slip dissipates in it, N mm."""
    touches = found.pressure > 0
    share = found.weights[found.sticks].sum() / found.weights[touches].sum()
    out: dict[str, Any] = {
        "force_along_N": found.force[0],
        "force_across_N": found.force[1],
        "moment_Nmm": found.moment,
        "limit_N": found.friction_limit,
        **dict(zip(MOTION[rolling], found.rigid_motion, strict=True)),
        "stick_share": float(share),
        "traction_max_MPa": float(np.linalg.norm(found.traction, axis=1).max()),
        "newton_steps": len(found.newton_history),
        "passes": found.coupling_iterations,
    }
    if cycle:
        out["energy_per_cycle_Nmm"] = found.dissipated_energy
    if rolling:
        slip = found.rigid_slip if like else found.slip
        wear = float(found.weights @ np.einsum("nc,nc->n", found.traction, slip))
        out["t_gamma_N"] = wear
        if like and found.without_creepage is not None:
            out |= _resolution(out, found.without_creepage, found.rigid_motion)
        if patches is not None:
            out["wear_number_N"] = wear_number(found, patches)
        if speed is not None:
            out["power_W"] = wear * speed
    return out


def _resolution(
    out: Mapping[str, Any], still: FrictionSolution, motion: tuple[float, float, float]
) -> dict[str, Any]:
    """ "resolution": by quantity what bodies and mesh have without creepage, where like
    half-spaces have no traction and stick everywhere; of the stick share also the largest share of
    a contact point. "below_resolution": names of those to which the motion adds no more than that;
    where what slips is not resolved, neither is the largest traction, which lies at its border."""
    rest = quantities(still, rolling=False, like=True, speed=None, cycle=False)
    rest["t_gamma_N"] = sum(rest[name] * each for name, each in zip(LOADS, motion, strict=False))
    limits = {name: abs(rest[name]) for name in (*LOADS, "t_gamma_N")}
    point = still.weights.max() / still.weights[still.pressure > 0].sum()
    limits["stick_share"] = float(1 - rest["stick_share"] + point)
    below = {name for name in LOADS if 0 < abs(out[name] - rest[name]) <= limits[name]}
    if 0 < abs(out["t_gamma_N"] - rest["t_gamma_N"]) <= limits["t_gamma_N"]:
        below.add("t_gamma_N")
    if 1 - out["stick_share"] <= limits["stick_share"]:
        below |= {"stick_share", "traction_max_MPa"}
    return {"resolution": limits, "below_resolution": sorted(below)}

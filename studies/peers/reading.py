"""What a code found, against exact Hertz at the force that it carries itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from railhead.theory.elastic import hertz, subsurface
from studies.peers.process.running import Cost

LEAST = 0.15  # of the largest pressure: below it, pressures are no part of the fit


@dataclass(frozen=True)
class Run:
    """One solve. Errors are relative, None where the code does not give the quantity or failed;
    p_max is what the code gives, p_fit, a and b are of the ellipse fitted to its pressures (ours:
    what the result says)."""

    code: str
    method: str
    setting: str
    seconds: float | None = None
    cpu_seconds: float | None = None
    peak_bytes: int | None = None
    unknowns: int | None = None
    iterations: int | None = None
    force: float | None = None
    error_p_max: float | None = None
    error_p_fit: float | None = None
    error_a: float | None = None
    error_b: float | None = None
    error_area: float | None = None
    error_approach: float | None = None
    error_tau_max: float | None = None
    failure: str = ""


UNITS = {"force": "N"}


def fitted(x: ArrayLike, y: ArrayLike, pressure: ArrayLike) -> tuple[float, float, float]:
    """p0 (MPa), a and b (mm) of p^2 = p0^2 (1 - (x/a)^2 - (y/b)^2), by least squares over points
    with more than LEAST of the largest pressure. ValueError: they lie on no ellipse."""
    x, y, p = (np.asarray(each, float) for each in (x, y, pressure))
    high = p > LEAST * p.max(initial=0.0)
    terms = np.column_stack([np.ones(high.sum()), -(x[high] ** 2), -(y[high] ** 2)])
    (c, along, across), _, rank, _ = np.linalg.lstsq(terms, p[high] ** 2, rcond=None)
    flat = 1e-9 * c  # rounding, where the pressure does not fall along an axis
    if rank < 3 or c <= 0 or min(along * np.ptp(x) ** 2, across * np.ptp(y) ** 2) <= flat:
        raise ValueError("its pressures lie on no ellipse")
    return float(np.sqrt(c)), float(np.sqrt(c / along)), float(np.sqrt(c / across))


def fitted_run(run: Run, cost: Cost, case: Mapping[str, float], found: Mapping[str, Any]) -> Run:
    """The run with its cost and errors, from what `solve` gave."""
    modulus = hertz.contact_modulus(case["young"], case["poisson"], case["young"], case["poisson"])
    exact = hertz.point_contact(
        1 / case["wheel_radius"], 1 / case["rail_radius"], modulus, found["force"]
    )
    p_fit, a, b = fitted(found["x"], found["y"], found["pressure"])
    shear = subsurface.axis_extrema(exact, case["poisson"]).tau_max
    approach, tau_max = found.get("approach"), found.get("tau_max")
    return replace(
        run,
        **vars(cost),
        unknowns=found["unknowns"],
        iterations=found.get("iterations"),
        force=found["force"],
        error_p_max=found["pressure_max"] / exact.p0 - 1,
        error_p_fit=p_fit / exact.p0 - 1,
        error_a=a / exact.a - 1,
        error_b=b / exact.b - 1,
        error_area=a * b / (exact.a * exact.b) - 1,
        error_approach=None if approach is None else approach / exact.approach - 1,
        error_tau_max=None if tau_max is None else tau_max / shear - 1,
    )


def own_run(run: Run, cost: Cost, summary: Mapping[str, Any]) -> Run:
    """The run with its cost and errors, from summary.json."""
    result, exact, price = summary["result"], summary["hertz"], summary["cost"]

    def error(*path: str) -> float:
        value, right = result, exact
        for key in path:
            value, right = value[key], right[key]
        return float(value / right - 1)

    return replace(
        run,
        **vars(cost),
        unknowns=price["dofs"],
        iterations=price["newton_iterations"],
        force=result["load_N"],
        error_p_max=error("pressure", "max_MPa"),
        error_a=error("patch", "a_mm"),
        error_b=error("patch", "b_mm"),
        error_area=error("patch", "area_mm2"),
        error_approach=error("approach_mm"),
        error_tau_max=error("stress", "tau_max_MPa"),
    )

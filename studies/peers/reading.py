"""What a code found, against exact Hertz at the force that it carries itself."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from railhead.run.quantities import numeric_values
from railhead.theory.elastic import hertz, subsurface
from studies.tables import Row

LEAST = 0.15  # of the largest pressure: below it, pressures are no part of the fit
ERRORS = ("p_max", "p_fit", "a", "b", "area", "approach", "tau_max")
OWN = ("max_MPa", None, "a_mm", "b_mm", "area_mm2", "approach_mm", "tau_max_MPa")
"""What ERRORS are in our own summary."""
COSTS = ("seconds", "cpu_seconds", "peak_bytes")
COLUMNS = (*COSTS, "unknowns", "iterations", "force", *(f"error_{name}" for name in ERRORS))
UNITS = {"force": "N"}


def row(code: str, method: str, setting: str, found: Mapping[str, Any], failure: str = "") -> Row:
    """One solve. Errors are relative, None where the code does not give the quantity or failed;
    p_max is what the code gives, p_fit, a and b are of the ellipse fitted to its pressures (ours:
    what the result says)."""
    head = {"code": code, "method": method, "setting": setting}
    return {**head, **{key: found.get(key) for key in COLUMNS}, "failure": failure}


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


def read(case: Mapping[str, float], found: Mapping[str, Any]) -> dict[str, Any]:
    """Unknowns, iterations, force and errors, from what `solve` gave."""
    modulus = hertz.contact_modulus(case["young"], case["poisson"], case["young"], case["poisson"])
    curvatures = 1 / case["wheel_radius"], 1 / case["rail_radius"]
    exact = hertz.point_contact(*curvatures, modulus, found["force"])
    p_fit, a, b = fitted(found["x"], found["y"], found["pressure"])
    shear = subsurface.axis_extrema(exact, case["poisson"]).tau_max
    pairs = {
        "p_max": (found["pressure_max"], exact.p0),
        "p_fit": (p_fit, exact.p0),
        "a": (a, exact.a),
        "b": (b, exact.b),
        "area": (a * b, exact.a * exact.b),
        "approach": (found.get("approach"), exact.approach),
        "tau_max": (found.get("tau_max"), shear),
    }
    return {key: found.get(key) for key in ("unknowns", "iterations", "force")} | {
        f"error_{name}": None if value is None else value / right - 1
        for name, (value, right) in pairs.items()
    }


def read_own(summary: Mapping[str, Any]) -> dict[str, Any]:
    """The same from summary.json."""
    result, exact = (numeric_values(summary[key]) for key in ("result", "hertz"))
    return {
        "unknowns": summary["cost"]["dofs"],
        "iterations": summary["cost"]["newton_iterations"],
        "force": summary["result"]["load_N"],
        **{
            f"error_{name}": result[key] / exact[key] - 1
            for name, key in zip(ERRORS, OWN, strict=True)
            if key
        },
    }

"""Finite-element runs of the thesis's case: its loads, and elements like the thesis's own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from railhead.postprocess.findings import Findings
from railhead.results.pipeline import Result, run
from railhead.run.progress import Progress
from railhead.theory.elastic import subsurface
from railhead.theory.elastic.hertz import Ellipse
from studies.thesis import plots as thesis_plots
from studies.thesis.rules.hertz import AXLE_LOAD

if TYPE_CHECKING:
    from railhead.scene.scene import Scene

WHEEL = AXLE_LOAD / 2
LOADS = (1e3, 5e3, 12.5e3, 25e3, 50e3, WHEEL, 150e3)
DEFAULT, HEXAHEDRA = "quadratic tetrahedra, Nitsche", "linear hexahedra, penalty"
SOLID185 = ("mesh.cell=hexahedron", "mesh.order=1", "solver.method=penalty")
ELEMENTS = (2, 3, 4, 6)  # hexahedra per smaller semi-axis
UNITS = {
    "load": "N",
    "a": "mm",
    "b": "mm",
    "p0": "MPa",
    "tau_max": "MPa",
    "tau_depth": "mm",
    "mises_max": "MPa",
}


@dataclass(frozen=True)
class Run:
    """One finite-element run of the thesis's case. error_*: relative to exact Hertz;
    error_tau_surface: of the shear at the centre of the patch; surface_ratio: s_x over s_y there;
    shape_error: see `Findings`."""

    elements: str
    per_semi_axis: float
    load: float
    unknowns: int
    seconds: float
    a: float
    b: float
    p0: float
    tau_max: float
    tau_depth: float
    mises_max: float
    error_a: float
    error_b: float
    error_p0: float
    error_tau_max: float
    error_tau_depth: float
    error_tau_surface: float
    surface_ratio: float
    shape_error: float


def measure(
    scene: Scene, exact: Ellipse
) -> tuple[list[Run], dict[str, float], thesis_plots.Sampled | None]:
    """Solve the case under all loads, and with linear hexahedra; also what the rules and the
    pictures need of the case itself."""
    runs: list[Run] = []
    fe: dict[str, float] = {}
    sampled = None
    with Progress(quiet=False) as progress:
        for load in LOADS:
            progress.stage(f"{scene.name}: {load:.0f} N")
            result = run(scene.replace([f"load={load!r}"]))
            runs.append(_run(DEFAULT, result))
            if load == scene.load and result.fields and result.findings:
                sampled = thesis_plots.sample(result.fields, result.findings)
                fe |= fe_facts(result.findings, runs[-1], exact)
            if load == WHEEL:
                fe |= {"p0_axle": runs[-1].p0, "mises_axle": runs[-1].mises_max}
        for n in ELEMENTS:
            progress.stage(f"{scene.name}: linear hexahedra, penalty, b/{n}")
            size = f"mesh.patch_size={exact.b / n!r}"
            runs.append(_run(HEXAHEDRA, run(scene.replace([*SOLID185, size]))))
    return runs, fe, sampled


def fe_facts(found: Findings, base: Run, exact: Ellipse) -> dict[str, float]:
    """Finite-element values by the names under which the rules look for them."""
    axis, along = found.axis, found.along
    top = axis.stress[:1]
    values = {
        "a": base.a,
        "b": base.b,
        "p0": base.p0,
        "p0_error": abs(base.error_p0),
        "p_mean": found.patch.mean_pressure,
        "tau_max": base.tau_max,
        "tau_depth": base.tau_depth,
        "tau_surface": float(subsurface.max_shear(top)[0]),
        "mises_max": base.mises_max,
        "mises_depth": axis.peak(subsurface.von_mises(axis.stress))[0],
    }
    for i, name in enumerate(("s_x", "s_y", "s_z")):
        values[name] = float(top[0, i])
        for share in (0.5, 1.0):
            depth = share * exact.a
            values[f"{name} at {share:g} a"] = float(
                np.interp(depth, axis.depth, axis.stress[:, i])
            )
    for share in (0.5, 1.0):
        at = share * base.a  # of the patch that was found: the edge is an edge of a square root
        values[f"p at {share:g} a"] = float(np.interp(at, along.coordinate, along.pressure))
    return values


def _run(elements: str, result: Result) -> Run:
    summary = result.summary
    found, error, hertz = summary["result"], summary["difference"], summary["hertz"]
    stress, surface = found["stress"]["axis"], np.array(found["stress"]["surface_centre_MPa"])
    shear = np.ptp(surface) / np.ptp(hertz["stress"]["surface_centre_MPa"])
    grading = result.mesh_solution.grading
    return Run(
        elements=elements,
        per_semi_axis=result.ellipse.b / grading.size,
        load=found["load_N"],
        unknowns=result.mesh_solution.unknowns,
        seconds=sum(result.mesh_solution.seconds.values()),
        a=found["patch"]["a_mm"],
        b=found["patch"]["b_mm"],
        p0=found["pressure"]["max_MPa"],
        tau_max=stress["tau_max_MPa"],
        tau_depth=stress["tau_max_depth_mm"],
        mises_max=stress["von_mises_max_MPa"],
        error_a=error["patch"]["a_mm"],
        error_b=error["patch"]["b_mm"],
        error_p0=error["pressure"]["max_MPa"],
        error_tau_max=error["stress"]["axis"]["tau_max_MPa"],
        error_tau_depth=error["stress"]["axis"]["tau_max_depth_mm"],
        error_tau_surface=float(shear) - 1,
        surface_ratio=float(surface[0] / surface[1]),
        shape_error=summary["checks"]["shape_error"],
    )

"""What yield changes, what it costs, and how far formulas of spheres can be trusted."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import railhead as rh
from railhead.cli import study
from railhead.postprocess.plots.diagrams import FE, GREY, HERTZ, new_figure
from railhead.scene import catalogue
from railhead.theory.elastic import indentation
from studies import tables

LOADS = (5.0, 10.0, 25.0, 50.0, 100.0, 200.0)  # kN
MULTIPLES = (0.5, 2.0, 5.0, 20.0, 100.0)  # of the load of first yield
STEELS = {"rail": {"steel": "R260"}, "wheel": {"steel": "ER7"}}
USEFUL = 0.05  # of the pressure: beyond it the elastic answer misleads
UNITS = {
    "load": "kN",
    "hertz": "MPa",
    "elastic": "MPa",
    "elastic_area": "mm2",
    "elastic_tau": "MPa",
    "elastic_seconds": "s",
    "p_max": "MPa",
    "area": "mm2",
    "tau": "MPa",
    "residual_stress": "MPa",
    "depth": "um",
    "seconds": "s",
}
RADIUS, YIELD, YOUNG, POISSON = 100.0, 480.0, 207e3, 0.3  # of the sphere: mm, MPa, MPa


@dataclass(frozen=True)
class Load:
    """The thesis's pair under one load: exact Hertz, the elastic solution and that with yield.
    multiple: load over that of first yield, 0 where nothing yields; strain: largest equivalent
    plastic one; depth: how far the rail stays pushed in; seconds: of the run that ended there."""

    load: float
    hertz: float
    elastic: float
    elastic_area: float
    elastic_tau: float
    elastic_seconds: float
    multiple: float
    p_max: float
    area: float
    tau: float
    strain: float
    residual_stress: float
    depth: float
    seconds: float
    passed: bool


@dataclass(frozen=True)
class Sphere:
    """A rigid sphere in a half-space that yields; approach, radius and residual depth over those
    of first yield, mean pressure over the yield stress. by: who says so."""

    multiple: float
    by: str
    approach: float
    radius: float
    pressure: float
    residual: float | None
    passed: bool = True


def pressed(load: float) -> Load:
    """Solve the thesis's pair (kN) with R260 and ER7, and elastic."""
    scene = catalogue.find("uic54_thesis").replace(load=1e3 * load, **STEELS)
    found = rh.solve(scene, quiet=True).as_dict()
    plain = rh.solve(scene.replace(effects={"plasticity": "off"}), quiet=True).as_dict()
    result, elastic = found["result"], plain["result"]
    left = result.get("plastic") or {}
    return Load(
        load,
        found["hertz"]["pressure"]["max_MPa"],
        elastic["pressure"]["max_MPa"],
        elastic["patch"]["area_mm2"],
        elastic["stress"]["tau_max_MPa"],
        plain["cost"]["seconds"]["total"],
        left.get("load_over_first_yield", 0.0),
        result["pressure"]["max_MPa"],
        result["patch"]["area_mm2"],
        result["stress"]["tau_max_MPa"],
        left.get("strain_max", 0.0),
        left.get("residual_von_mises_max_MPa", 0.0),
        1e3 * left.get("residual_depth_rail_mm", 0.0),
        found["cost"]["seconds"]["total"],
        found["checks"]["passed"],
    )


def indented(multiple: float) -> list[Sphere]:
    """Finite elements and the formulas of others at a multiple of the first-yield load."""
    modulus = YOUNG / (1 - POISSON**2)
    peak = 1.6128 * YIELD  # largest pressure at first yield (Johnson 1985, section 6.1)
    load = math.pi**3 * RADIUS**2 * peak**3 / (6 * modulus**2)
    radius = math.pi * peak * RADIUS / (2 * modulus)
    rail = rh.Rail(
        profile="arc",
        crown_radius=RADIUS,
        extent="half-space",
        young_modulus=YOUNG,
        poisson_ratio=POISSON,
        yield_stress=YIELD,
    )
    wheel = rh.Wheel(rolling_radius=RADIUS, young_modulus=math.inf)
    found = rh.solve(rh.Scene(load=multiple * load, rail=rail, wheel=wheel), quiet=True).as_dict()
    result, closer = found["result"], radius**2 / RADIUS
    area = result["patch"]["area_mm2"]
    left = (result.get("plastic") or {}).get("residual_depth_rail_mm")
    rows = [
        Sphere(
            multiple,
            "railhead",
            result["approach_mm"] / closer,
            math.sqrt(area / math.pi) / radius,
            multiple * load / area / YIELD,
            None if left is None else left / closer,
            found["checks"]["passed"],
        )
    ]
    if multiple <= 1:
        return rows
    jackson = indentation.jackson_green(multiple, POISSON, YIELD / modulus)
    kogut = indentation.kogut_etsion(multiple, POISSON)
    for by, other in (("Jackson, Green", jackson), ("Kogut, Etsion", kogut)):
        depth = indentation.residual_depth(other.approach) if other is kogut else None
        rows.append(Sphere(multiple, by, other.approach, other.radius, other.pressure, depth))
    return rows


def main(out: Path, *, quick: bool) -> None:
    """Write plasticity_loads.csv, plasticity_spheres.csv, plasticity.png and page.md; quick: two
    loads and one sphere."""
    loads = []
    for load in LOADS[1:3] if quick else LOADS:
        print(f"{load:g} kN", file=sys.stderr)
        loads.append(pressed(load))
    spheres: list[Sphere] = []
    for multiple in MULTIPLES[1:2] if quick else MULTIPLES:
        print(f"sphere at {multiple:g} times first yield", file=sys.stderr)
        spheres += indented(multiple)
    tables.write_csv(out / "plasticity_loads.csv", loads, UNITS)
    tables.write_csv(out / "plasticity_spheres.csv", spheres)
    draw(loads, spheres, out / "plasticity.png")
    (out / study.PAGE).write_text(page(loads, spheres), encoding="utf-8")


def page(loads: Sequence[Load], spheres: Sequence[Sphere]) -> str:
    """Tables, and from which load on the elastic answer misleads."""
    misled = [each for each in loads if each.elastic > (1 + USEFUL) * each.p_max]
    fine = [each for each in loads if each not in misled]
    rows = [
        (
            f"{r.load:g}",
            f"{r.multiple:.2f}" if r.multiple else "-",
            f"{r.hertz:.0f}",
            f"{r.elastic:.0f}",
            f"{r.p_max:.0f}",
            f"{r.elastic_area:.1f}",
            f"{r.area:.1f}",
            f"{r.elastic_tau:.0f}",
            f"{r.tau:.0f}",
            f"{100 * r.strain:.3f} %",
            f"{r.residual_stress:.0f}",
            f"{r.depth:.2f}",
            f"{r.elastic_seconds:.1f}",
            f"{r.seconds:.1f}",
            "" if r.passed else "not passed",
        )
        for r in loads
    ]
    others = [
        (
            f"{s.multiple:g}",
            s.by,
            f"{s.approach:.3f}",
            f"{s.radius:.3f}",
            f"{s.pressure:.3f}",
            "-" if s.residual is None else f"{s.residual:.3f}",
            "" if s.passed else "not passed",
        )
        for s in spheres
    ]
    ratios = [r.seconds / r.elastic_seconds for r in loads if r.multiple]
    return tables.render(
        "plasticity",
        loads=rows,
        spheres=others,
        useful=USEFUL,
        ratios=ratios,
        fine=max((each.load for each in fine), default=None),
        misled=min((each.load for each in misled), default=None),
    )


def draw(loads: Sequence[Load], spheres: Sequence[Sphere], path: Path) -> None:
    """Largest pressure over the load, and the sphere's mean pressure over its load."""
    with new_figure(path, 10.5, 4.2) as figure:
        left, right = figure.subplots(1, 2)
        x = [each.load for each in loads]
        lines: tuple[tuple[str, str, dict[str, Any]], ...] = (
            ("hertz", "exact Hertz", {"color": HERTZ}),
            ("elastic", "elastic", {"color": FE, "ls": "--", "marker": "o", "mfc": "none"}),
            ("p_max", "R260 and ER7", {"color": FE, "marker": "o"}),
        )
        for key, label, look in lines:
            left.plot(x, [getattr(each, key) for each in loads], label=label, **look)
        left.set(xscale="log", xlabel="load, kN", ylabel="largest pressure, MPa")
        looks: dict[str, dict[str, Any]] = {
            "railhead": {"color": FE, "marker": "o"},
            "Jackson, Green": {"color": HERTZ, "ls": "--"},
            "Kogut, Etsion": {"color": GREY, "ls": ":"},
        }
        for by, look in looks.items():
            own = [each for each in spheres if each.by == by]
            right.plot([s.multiple for s in own], [s.pressure for s in own], label=by, **look)
        right.set(
            xscale="log",
            xlabel="load of a sphere over first yield",
            ylabel="mean pressure over yield stress",
        )
        for axes in (left, right):
            axes.legend()

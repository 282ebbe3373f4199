"""What yield changes, what it costs, and how far formulas of spheres can be trusted."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from scipy.optimize import brentq

import railhead as rh
from railhead.postprocess.pictures.diagrams import FE, GREY, HERTZ, new_figure
from railhead.scene import catalogue
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
LINES: tuple[tuple[str, str, dict[str, Any]], ...] = (
    ("hertz", "exact Hertz", {"color": HERTZ}),
    ("elastic", "elastic", {"color": FE, "ls": "--", "marker": "o", "mfc": "none"}),
    ("p_max", "R260 and ER7", {"color": FE, "marker": "o"}),
)
LOOKS: dict[str, dict[str, Any]] = {
    "railhead": {"color": FE, "marker": "o"},
    "Jackson, Green": {"color": HERTZ, "ls": "--"},
    "Kogut, Etsion": {"color": GREY, "ls": ":"},
}
RADIUS, YIELD, YOUNG, POISSON = 100.0, 480.0, 207e3, 0.3  # of the sphere: mm, MPa, MPa


Load = dict[str, Any]
"""The thesis's pair under one load: exact Hertz, the elastic solution and that with yield.
multiple: load over that of first yield, 0 where nothing yields; strain: largest equivalent plastic
strain; depth: largest residual depth of the rail; seconds: of the run with yield."""
Sphere = dict[str, Any]
"""A rigid sphere in a half-space that yields: approach and residual depth over the approach of
first yield, radius of the patch over that of first yield, mean pressure over the yield stress. by:
'railhead' or the authors of a formula."""


def pressed(load: float) -> Load:
    """Solve the thesis's pair with R260 and ER7, and elastic; load: kN."""
    scene = catalogue.find("uic54_thesis").replace(load=1e3 * load, **STEELS)
    found = rh.solve(scene, quiet=True).as_dict()
    plain = rh.solve(scene.replace(effects={"plasticity": "off"}), quiet=True).as_dict()
    result, elastic = found["result"], plain["result"]
    left = result.get("plastic") or {}
    return {
        "load": load,
        "hertz": found["hertz"]["pressure"]["max_MPa"],
        "elastic": elastic["pressure"]["max_MPa"],
        "elastic_area": elastic["patch"]["area_mm2"],
        "elastic_tau": elastic["stress"]["tau_max_MPa"],
        "elastic_seconds": plain["cost"]["seconds"]["total"],
        "multiple": left.get("load_over_first_yield", 0.0),
        "p_max": result["pressure"]["max_MPa"],
        "area": result["patch"]["area_mm2"],
        "tau": result["stress"]["tau_max_MPa"],
        "strain": left.get("strain_max", 0.0),
        "residual_stress": left.get("residual_von_mises_max_MPa", 0.0),
        "depth": 1e3 * left.get("residual_depth_rail_mm", 0.0),
        "seconds": found["cost"]["seconds"]["total"],
        "passed": found["checks"]["passed"],
    }


def first_yield() -> tuple[float, float]:
    """Load (N) and radius of the patch (mm) at first yield of the sphere (Johnson 1985, section
    6.1)."""
    modulus, peak = YOUNG / (1 - POISSON**2), 1.6128 * YIELD
    load = math.pi**3 * RADIUS**2 * peak**3 / (6 * modulus**2)
    return load, math.pi * peak * RADIUS / (2 * modulus)


def sphere(multiple: float) -> rh.Scene:
    """A rigid sphere on a half-space that yields, at a multiple of the load of first yield."""
    rail = rh.Rail(
        profile="arc",
        crown_radius=RADIUS,
        extent="half-space",
        young_modulus=YOUNG,
        poisson_ratio=POISSON,
        yield_stress=YIELD,
    )
    wheel = rh.Wheel(rolling_radius=RADIUS, young_modulus=math.inf)
    return rh.Scene(load=multiple * first_yield()[0], rail=rail, wheel=wheel)


def indented_under(
    load: float,
    force: Callable[[float], float],
    area: Callable[[float], float],
    yield_pressure: float,
) -> tuple[float, float, float]:
    """Approach of a sphere under a load, radius of the patch, both over those at first yield, and
    mean pressure over the yield stress. Load, force and area are over those of first yield.

    force, area: by the approach over that of first yield.
    yield_pressure: largest pressure at first yield over the yield stress.
    """
    w = float(brentq(lambda w: force(w) - load, 0.0, 10.0 + 2.0 * load))
    return w, math.sqrt(area(w)), 2 / 3 * yield_pressure * load / area(w)


def jackson_green(load: float, nu: float, strain: float) -> tuple[float, float, float]:
    """As of `indented_under` of an elastic-plastic sphere; Hertz's up to an approach of 1.9 times
    that of first yield.

    load: over that of first yield; nu: Poisson's ratio; strain: yield stress over E/(1 - nu^2).

    Jackson and Green, J. Tribology 127 (2005) 343, eqs. 3, 9, 10, 13 to 16.
    """
    c, b = yield_pressure(nu), 0.14 * math.exp(23 * strain)

    def area(w: float) -> float:
        """Area of the patch."""
        return w * max(w / 1.9, 1.0) ** b

    def force(w: float) -> float:
        """Load."""
        if w <= 1.9:
            return w**1.5
        a_over_r = math.pi * c * strain / 2 * math.sqrt(area(w))
        hardness = 2.84 * (1 - math.exp(-0.82 * a_over_r**-0.7))
        elastic = math.exp(-(w ** (5 / 12)) / 4) * w**1.5
        return elastic + 4 * hardness / c * (1 - math.exp(-(w ** (5 / 9)) / 25)) * w

    return indented_under(load, force, area, c)


def yield_pressure(nu: float) -> float:
    """Largest pressure of a sphere at first yield over the yield stress, a fit (Jackson and Green
    2005, eq. 3). nu: Poisson's ratio."""
    return 1.295 * math.exp(0.736 * nu)


def kogut_etsion(load: float, nu: float) -> tuple[float, float, float]:
    """As of `indented_under` of an elastic-plastic sphere; Hertz's up to first yield.

    load: over the load of first yield; nu: Poisson's ratio.

    Kogut and Etsion, J. Appl. Mech. 69 (2002) 657, table 1; their yield pressure is K H with K =
    0.454 + 0.41 nu and H = 2.8 times the yield stress. Valid up to 110 times the approach of first
    yield, which is not checked.
    """

    def force(w: float) -> float:
        """Load."""
        return w**1.5 if w <= 1 else 1.03 * w**1.425 if w <= 6 else 1.40 * w**1.263

    def area(w: float) -> float:
        """Area of the patch."""
        return w if w <= 1 else 0.93 * w**1.136 if w <= 6 else 0.94 * w**1.146

    return indented_under(load, force, area, 2.8 * (0.454 + 0.41 * nu))


def residual_depth(approach: float) -> float:
    """Depth of the imprint after unloading from an approach; both over the approach of first yield.
    Zero up to first yield (Etsion, Kligerman and Kadin, Int. J. Solids Struct. 42 (2005) 3716).
    """
    beyond = max(approach, 1.0)
    return beyond * (1 - beyond**-0.28) * (1 - beyond**-0.69)


def indented(multiple: float) -> list[Sphere]:
    """Rows of finite elements and, above first yield, of formulas at a multiple of the load of
    first yield."""
    modulus, (first, radius) = YOUNG / (1 - POISSON**2), first_yield()
    found = rh.solve(sphere(multiple), quiet=True).as_dict()
    result, load, closer = found["result"], multiple * first, radius**2 / RADIUS
    area = result["patch"]["area_mm2"]
    left = (result.get("plastic") or {}).get("residual_depth_rail_mm")
    said = {
        "railhead": (
            result["approach_mm"] / closer,
            math.sqrt(area / math.pi) / radius,
            load / area / YIELD,
            None if left is None else left / closer,
        )
    }
    if multiple > 1:
        kogut = kogut_etsion(multiple, POISSON)
        said["Jackson, Green"] = (*jackson_green(multiple, POISSON, YIELD / modulus), None)
        said["Kogut, Etsion"] = (*kogut, residual_depth(kogut[0]))
    return [
        {
            "multiple": multiple,
            "by": by,
            **dict(zip(("approach", "radius", "pressure", "residual"), values, strict=True)),
            "passed": found["checks"]["passed"] or by != "railhead",
        }
        for by, values in said.items()
    ]


def main(out: Path, *, quick: bool) -> None:
    """Write plasticity_loads.csv, plasticity_spheres.csv, plasticity.png and page.md; quick: two
    loads and one sphere."""
    loads = [*map(pressed, tables.told(LOADS[1:3] if quick else LOADS, "{:g} kN".format))]
    multiples = tables.told(MULTIPLES[1:2] if quick else MULTIPLES, "sphere, {:g} times".format)
    spheres = [row for multiple in multiples for row in indented(multiple)]
    draw(loads, spheres, out / "plasticity.png")
    text = page(loads, spheres)
    tables.publish(out, text, UNITS, plasticity_loads=loads, plasticity_spheres=spheres)


def page(loads: Sequence[Load], spheres: Sequence[Sphere]) -> str:
    """Text of the page: tables, and from which load on the elastic answer misleads."""
    misled = [r["load"] for r in loads if r["elastic"] > (1 + USEFUL) * r["p_max"]]
    fine = [r["load"] for r in loads if r["load"] not in misled]
    return tables.render(
        "plasticity",
        loads=tables.cells(
            [
                {
                    **r,
                    "yields": f"{r['multiple']:.2f}" if r["multiple"] else "-",
                    "percent": 100 * r["strain"],
                    "end": "" if r["passed"] else "not passed",
                }
                for r in loads
            ],
            *("{load:g}", "{yields}", "{hertz:.0f}", "{elastic:.0f}", "{p_max:.0f}"),
            *("{elastic_area:.1f}", "{area:.1f}", "{elastic_tau:.0f}", "{tau:.0f}"),
            *("{percent:.3f} %", "{residual_stress:.0f}", "{depth:.2f}"),
            *("{elastic_seconds:.1f}", "{seconds:.1f}", "{end}"),
        ),
        spheres=tables.cells(
            [
                {
                    **s,
                    "left": "-" if s["residual"] is None else f"{s['residual']:.3f}",
                    "end": "" if s["passed"] else "not passed",
                }
                for s in spheres
            ],
            *("{multiple:g}", "{by}", "{approach:.3f}", "{radius:.3f}", "{pressure:.3f}"),
            *("{left}", "{end}"),
        ),
        useful=USEFUL,
        yields=next((r["load"] / r["multiple"] for r in loads if r["multiple"]), None),
        ratios=[r["seconds"] / r["elastic_seconds"] for r in loads if r["multiple"]],
        fine=max(fine, default=None),
        misled=min(misled, default=None),
    )


def draw(loads: Sequence[Load], spheres: Sequence[Sphere], path: Path) -> None:
    """Draw the largest pressure over the load, and the sphere's mean pressure over its load."""
    with new_figure(path, 10.5, 4.2) as figure:
        left, right = figure.subplots(1, 2)
        for key, label, look in LINES:
            left.plot([r["load"] for r in loads], [r[key] for r in loads], label=label, **look)
        for by, look in LOOKS.items():
            own = [s for s in spheres if s["by"] == by]
            right.plot([s["multiple"] for s in own], [s["pressure"] for s in own], label=by, **look)
        left.set(xscale="log", xlabel="load, kN", ylabel="largest pressure, MPa")
        right.set(
            xscale="log",
            xlabel="load of a sphere over first yield",
            ylabel="mean pressure over yield stress",
        )
        left.legend()
        right.legend()

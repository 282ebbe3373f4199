"""Tables for the terminal."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from railhead.display import Units
from railhead.planning import machine
from railhead.planning.effects import Effect
from railhead.planning.plan import Plan
from railhead.planning.price import price

DEFAULT = Units()
ROWS = (
    ("semi-axis a, along the rail", "mm", ("patch", "a_mm")),
    ("semi-axis b, across", "mm", ("patch", "b_mm")),
    ("patch area", "mm2", ("patch", "area_mm2")),
    ("largest pressure", "MPa", ("pressure", "max_MPa")),
    ("mean pressure", "MPa", ("pressure", "mean_MPa")),
    ("approach", "mm", ("approach_mm",)),
    ("largest shear stress", "MPa", ("stress", "tau_max_MPa")),
    ("   its depth", "mm", ("stress", "tau_max_depth_mm")),
    ("   its body", "", ("stress", "tau_max_body")),
    ("largest von Mises stress", "MPa", ("stress", "von_mises_max_MPa")),
    ("   its depth", "mm", ("stress", "von_mises_max_depth_mm")),
    ("   its body", "", ("stress", "von_mises_max_body")),
)


FRICTION = (
    ("force along the rail", "N", "force_along_N"),
    ("force across", "N", "force_across_N"),
    ("moment about the normal", "N mm", "moment_Nmm"),
    ("creepage along", "", "creepage_along"),
    ("creepage across", "", "creepage_across"),
    ("spin", "1/mm", "spin_per_mm"),
    ("shift along", "mm", "shift_along_mm"),
    ("shift across", "mm", "shift_across_mm"),
    ("share of the patch that sticks", "", "stick_share"),
    ("largest traction", "MPa", "traction_max_MPa"),
    ("T-gamma: energy per rolled length", "N", "t_gamma_N"),
    ("power", "W", "power_W"),
)
COLUMNS = (
    "quantity",
    "unit",
    "FE",
    "estimate",
    "half-space",
    "Hertz",
    "FE - Hertz",
    "thesis",
    "thesis - Hertz",
)
PAIRED = 30.0  # times first yield beyond which the pairing of the surfaces is felt
PRICES = (0.05, 0.01, 0.002)


def show_plan(plan: Plan, console: Console) -> None:
    """Effects, resolution and price."""
    scene, touch = plan.scene, plan.contact.touch
    table = Table(title=f"plan of {scene.name}", title_justify="left")
    for column in ("effect", "state", "why", "predicted"):
        table.add_column(column, overflow="fold")
    for name, effect in plan.effects.items():
        table.add_row(name, _state(effect), effect.why, _cost(*plan.price(name)))
    console.print(table)
    ellipse = plan.estimate
    radii = [1 / c if c else math.inf for c in (touch.curvature_x, touch.curvature_y)]
    lines = (
        f"contact    y = {touch.y:.3f} mm, z = {touch.z:.3f} mm, angle {touch.angle:.4f} rad, "
        f"relative radii {radii[0]:.4g} x {radii[1]:.4g} mm",
        f"Hertz      a = {ellipse.a:.4g} mm, b = {ellipse.b:.4g} mm, p0 = {ellipse.p0:.4g} MPa",
        f"mesh       {scene.mesh.cell}, order {plan.order}, {plan.patch_size:.3g} mm in the patch",
        f"solver     {scene.solver.method}, linear {scene.solver.linear}",
        f"predicted  {plan.unknowns} unknowns, {plan.seconds:.1f} s",
    )
    for line in (*lines, *profile_lines(plan.profiles)):
        console.print(line, markup=False)
    if plan.uncertainty:
        console.print(_uncertainty_line(vars(plan.uncertainty)), markup=False)
    if plan.forecast.reason:
        console.print(f"The patch is forecast as Hertz's: {plan.forecast.reason}.", markup=False)
    _show_prices(plan, console)


def profile_lines(profiles: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    """How profiles from files were read and smoothed ("profiles" of "plan" in summary.json)."""
    for body, found in profiles.items():
        yield f"{body:10s} {Path(found['file']).name}: {', '.join(found['read'])}"
        shortest, longest = found["smoothing_mm"]
        smoothing = f"{shortest:.2g} to {longest:.2g} mm"
        if here := found.get("smoothing_at_contact_mm"):
            smoothing += f", {here:.3g} at the contact"
        before, after = (found[f"largest_curvature_{when}_per_mm"] for when in ("before", "after"))
        yield (
            f"           noise {1e3 * found['noise_mm']:.2g} um; smoothing length {smoothing}; "
            f"largest curvature {before:.3g} before, {after:.3g} 1/mm after"
        )


def _uncertainty_line(found: Mapping[str, Any]) -> str:
    if found["reason"]:
        return f"profile    leaves unknown what it does to the answer: {found['reason']}"
    return (
        f"profile    leaves {found['relative']:.1%} of the largest pressure and of the area open "
        "(half-spaces with one, two and half a smoothing length)"
    )


def _state(effect: Effect) -> str:
    if effect.called_for and "on" in effect.refused:
        return "off, though called for"
    return "on" if effect.on else "off"


def _cost(unknowns: int, seconds: float) -> str:
    if not unknowns and not seconds:
        return "no unknowns"
    what = f"{abs(unknowns)} unknowns, " if unknowns else ""
    return f"{'costs' if seconds > 0 else 'saves'} {what}{abs(seconds):.1f} s"


def _show_prices(plan: Plan, console: Console) -> None:
    """What accuracies cost for this scene on this machine."""
    table = Table(title="price on this machine", title_justify="left")
    for column in ("accuracy", "patch size, mm", "unknowns", "seconds", "memory, MB"):
        table.add_column(column, justify="right")
    asked, family = plan.scene.accuracy, plan.family
    if family is None:
        console.print(
            "price      unknown: no calibrated family; an accuracy takes three meshes or more"
        )
        return
    for value in sorted({*PRICES, *([asked] if asked else [])}, reverse=True):
        if plan.hidden >= value or not family.reaches(value - plan.left_out):
            table.add_row(f"{value:.3g}", *["out of reach"] * 4)
            continue
        n = family.finest(value - plan.left_out)
        unknowns, seconds = price(plan, n)
        size = plan.at_resolution(n).patch_size
        cells = (f"{value:.3g}", f"{size:.3g}", f"{unknowns}", f"{seconds:.1f}")
        table.add_row(*cells, f"{machine.memory(unknowns) / 1e6:.0f}")
    console.print(table)


def show_result(summary: dict[str, Any], console: Console, units: Units = DEFAULT) -> None:
    """Finite elements, exact Hertz and the thesis side by side."""
    if summary["result"] is not None:
        table = Table(
            title=f"{summary['case']}: {units.value(summary['result']['load_N'], 'N'):.6g} "
            f"{units.unit('N')}",
            title_justify="left",
        )
        bound = summary["accuracy"]["bound"]
        kind = next((each for each in ("elastic", "frictionless") if each in summary), "")
        elastic = summary.get(kind)
        if kind:
            effect = {"elastic": "yield", "frictionless": "friction"}[kind]
            table.title = f"{table.title}, with {effect}"
        for column in COLUMNS:
            table.add_column(column, justify="left" if column in ("quantity", "unit") else "right")
        if elastic is not None:
            table.add_column(f"{kind} FE", justify="right")
        for label, unit, path in ROWS:
            fe, exact, thesis, half = (
                lookup(summary[key], path) for key in ("result", "hertz", "thesis", "half_space")
            )
            show = partial(shown, units, unit)
            table.add_row(
                label, units.unit(unit), show(fe), _bound(bound.get(path[-1])), show(half),
                show(exact), _percent(fe, exact),
                show(thesis), _percent(thesis, exact),
                *([] if elastic is None else [show(lookup(elastic, path))]),
            )  # fmt: skip
        console.print(table)
        if plastic := summary["result"].get("plastic"):
            _show_plastic(plastic, console)
        if friction := summary["result"].get("friction"):
            _show_friction(friction, summary.get("half_space_friction"), console, units)
        if reason := (summary["half_space"] or {}).get("reason"):
            console.print(f"No half-space column: {reason}.", markup=False, highlight=False)
        if summary["checks"]["passed"] and not summary["checks"]["hertzian"]:
            console.print(
                "The patch is no Hertz ellipse "
                f"(moments off by {summary['checks']['shape_error']:.1%}): "
                "Hertz is what the formula would have said."
            )
        for edge in summary["result"]["stress"]["at_edges"]:
            place = ", ".join(f"{v:.4g}" for v in edge["place_mm"])
            console.print(
                f"Left out: {edge['quantity']} {edge['value_MPa']:.4g} in the {edge['body']} at "
                f"({place}) mm, at a sharp edge or held face, where it depends on the mesh.",
                highlight=False,
            )
    for line in profile_lines(summary["plan"]["profiles"]):
        console.print(line, markup=False, highlight=False)
    if found := summary["plan"]["profile_uncertainty"]:
        console.print(_uncertainty_line(found), markup=False, highlight=False)
    if other := summary["plan"]["chosen"]:
        console.print(
            f"Another problem was chosen ({', '.join(other)}): estimates are about that one, and "
            "no second opinion checks it.", markup=False, highlight=False,
        )  # fmt: skip
    if summary["scene"].get("budget"):
        console.print(f"Budget: {summary['accuracy']['reason']}.", highlight=False)
    for name, after in summary["effects_after"].items():
        if after["needed"]:
            console.print(f"{name}: {after['why']}", markup=False, highlight=False)
    checks, cost = summary["checks"], summary["cost"]
    console.print(
        f"{cost['dofs']} unknowns, {cost['newton_iterations']} Newton steps, "
        f"{cost['linear_iterations']} Krylov iterations, {cost['seconds']['total']:.1f} s, "
        f"force balance {checks['force_balance']:.1e}",
        highlight=False,
    )


def _show_plastic(plastic: Mapping[str, Any], console: Console) -> None:
    place = ", ".join(f"{v:.4g}" for v in plastic["place_mm"])
    lines = [
        f"Yields from {1 / plastic['load_over_first_yield']:.3g} of the load on: plastic strain up "
        f"to {plastic['strain_max']:.3g} in the {plastic['body']} at ({place}) mm, in "
        f"{plastic['volume_mm3']:.4g} mm3 between {plastic['top_mm']:.3g} and "
        f"{plastic['depth_mm']:.3g} mm deep."
    ]
    if plastic["residual_von_mises_max_MPa"] is not None:
        depths = ", ".join(
            f"the {body} {plastic[key] * 1e3:.3g} um"
            for body in ("rail", "wheel")
            if (key := f"residual_depth_{body}_mm") in plastic
        )
        lines.append(
            f"Unloaded: {depths} deep, von Mises stress up to "
            f"{plastic['residual_von_mises_max_MPa']:.4g} MPa."
        )
    if plastic["load_over_first_yield"] > PAIRED:
        lines.append(
            "Surfaces stay paired as they were before the load: the approach is 0.5 % (20 times "
            "first yield) to 3 % (100 times) too large."
        )
    ratio = plastic["elastic_p0_over_k"]
    lines.append(
        f"Elastic p0/k is {ratio:.3g}; rolling without traction shakes down to elastic below 4 "
        "(line) to 4.68 (circle), with traction below less. One spot pressed is not rolling."
    )
    for line in lines:
        console.print(line, markup=False, highlight=False)


def _show_friction(
    friction: Mapping[str, Any], second: Mapping[str, Any] | None, console: Console, units: Units
) -> None:
    """Forces of the wheel on the rail, its motion, stick and wear, beside other methods."""
    limit = friction["limit_N"]
    table = Table(title="friction", title_justify="left")
    columns = {"FE": friction, **(second or {})}
    for name in ("quantity", "unit", *columns):
        table.add_column(name, justify="left" if name in ("quantity", "unit") else "right")
    for label, unit, key in FRICTION:
        if key in friction:
            cells = [shown(units, unit, lookup(values, (key,))) for values in columns.values()]
            table.add_row(label, units.unit(unit), *cells)
    console.print(table)
    console.print(
        f"Forces are those of the wheel on the rail; mu N = {limit:.5g} N.", highlight=False
    )


def show_failure(summary: dict[str, Any], console: Console) -> None:
    """Which checks failed, by how much, and what to change; the history where it did not
    converge."""
    newton, checks = summary["newton"], summary["checks"]
    for name in checks["failed"]:
        if name == "converged":
            text = f"NOT CONVERGED: {newton['reason']}; {checks['advice'][name]}"
            console.print(text, highlight=False, markup=False)
            continue
        (limit, source), value = (
            checks["limits"][name],
            float(checks[name]),
        )  # inf is a word in JSON
        console.print(
            f"CHECK FAILED: {name} = {value:.3g}, limit {float(limit):.3g} ({source}); "
            f"{checks['advice'][name]}",
            highlight=False, markup=False,
        )  # fmt: skip
    if checks["converged"]:
        return
    for number, step in enumerate(newton["history"]):
        residual = step["problem"] or f"residual {step['residual']:.2e}"
        console.print(
            f"  step {number:2d}  {residual}  active points {step['active']}  "
            f"Krylov iterations {step['linear_iterations']}  step length {step['length']:.2f}",
            highlight=False,
        )


def lookup(values: Mapping[str, Any] | None, path: tuple[str, ...]) -> float | str | None:
    """A number or a word of nested quantities; None where there is none."""
    inner: Any = values
    for key in path:
        inner = None if inner is None else inner.get(key)
    return inner if inner is None or isinstance(inner, str) else float(inner)


def _bound(value: float | None) -> str:
    return "" if value is None else f"{value:.2%}"


def _number(value: float | str | None) -> str:
    return "" if value is None else value if isinstance(value, str) else f"{value:.5g}"


def shown(units: Units, unit: str, value: float | str | None) -> str:
    """A cell, in the reader's units."""
    return _number(units.value(value, unit) if isinstance(value, float) else value)


def _percent(value: float | str | None, exact: float | str | None) -> str:
    if isinstance(value, str) or isinstance(exact, str) or value is None or not exact:
        return ""
    return f"{(value - exact) / exact:+.2%}"

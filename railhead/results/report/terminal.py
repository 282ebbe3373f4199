"""Tables of plans and results for the terminal, and where they go: output, text, a notebook."""

from __future__ import annotations

import io
import math
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich import box
from rich.console import Console
from rich.table import Table

from railhead.planning.effects import in_words
from railhead.planning.effects import left_out as not_simulated
from railhead.planning.simulation_plan import Plan
from railhead.postprocess.findings import BASE_UNITS, Drawing, Units, keyed
from railhead.results import quantity_rows
from railhead.results.quantity_rows import Row

if TYPE_CHECKING:
    from matplotlib.figure import Figure


WIDTH = 80  # characters where there is no terminal
WIDEST = 80  # characters of a table of numbers, which are never cut: it goes on below
TABLES = {
    "yield": "yield",
    "friction": "friction",
    "steel": "what pressure and tractions do to the steel",
}
"""Titles of the tables below the one of the contact, by their names in `quantity_rows.rows`."""
STEEP = 0.1  # side force over the load from which it is printed
HERE = 0.005  # mm, distance from the contact of the smooth surfaces that is no distance
NOTHING = 1e-9  # mm, 1/mm or degrees: rounding, printed as 0


def standard() -> Console:
    """Console on standard output, 80 (WIDTH) characters wide where that is no terminal."""
    console = Console()
    return console if console.is_terminal else Console(width=WIDTH)


def labelled(console: Console, line: str) -> None:
    """Print a line that begins with a label; continuation lines are indented by 11 characters."""
    said = textwrap.fill(
        line,
        console.width,
        subsequent_indent=11 * " ",
        break_long_words=False,
        break_on_hyphens=False,
    )
    console.print(said, markup=False, highlight=False, soft_wrap=True)


def recorded(show: Callable[[Console], None]) -> Console:
    """Console with the recorded output of `show`, which it exports as text; nothing is printed."""
    console = Console(file=io.StringIO(), width=WIDTH, record=True)
    show(console)
    return console


class Printed:
    """Base class of what a method `show` prints on a console; a notebook shows the same text."""

    show: Callable[..., None]

    def _repr_html_(self) -> str:
        """What `show` prints as a piece of HTML, without styles for the rest of the page."""
        block = '<pre style="font-family: monospace; line-height: 1.2">{code}</pre>'
        return recorded(self.show).export_html(inline_styles=True, code_format=block)


class Drawn(Printed):
    """Base class of tables with pictures: a method `drawings` returns functions that draw them, by
    name of the PNG file.
    """

    drawings: Callable[..., Mapping[str, Drawing]]

    def plot(self, picture: str) -> Figure:
        """Draw one picture; returns its matplotlib figure.

        picture: name of its PNG file without .png, e.g. "pressure" or "stress_cut" of a result,
            "sweep" of a sweep (none of three or more keys), "profiles",
            "rolling_radius" or "conicity" of what `locate` returns, and "profile" of what `profile`
            returns.
        ValueError: there is no such picture (the message names those that are), nothing touches,
            off rank 0, or a loaded result.
        """
        drawings = self.drawings()
        draw = drawings.get(f"{picture}.png")
        if draw is None:
            names = ", ".join(name.removesuffix(".png") for name in drawings)
            text = f"give {names}" if names else "it has none"
            raise ValueError(f"picture: {picture!r} is none of this result; {text}")
        found: Figure = draw(None).figure  # of a part of a figure the whole
        return found


def show_plan(plan: Plan, console: Console) -> None:
    """Print effects, first contact, exact Hertz, mesh, predicted cost and prices of accuracies of a
    plan.
    """
    said = plan.to_dict()
    contact, hertz, mesh, solver = (said[key] for key in ("contact", "hertz", "mesh", "solver"))
    table = Table(title=f"plan of {said['case']}", title_justify="left")
    for column in ("effect", "state", "why"):
        table.add_column(column, overflow="fold")
    missing = not_simulated(plan.effects, {})
    for name, effect in plan.effects.items():
        off = "off, though called for" if name in missing else "off"
        table.add_row(name, "on" if effect.on else off, effect.why)
    console.print(table)
    drawn = ", pictures included" if plan.scene.asks("pictures") else ""
    seconds = f"{plan.price.seconds:.1f} s of processor time{drawn}"
    lines: tuple[str, ...] = (
        f"contact    y = {rounded(contact['y_mm']):.3f} mm, z = {rounded(contact['z_mm']):.3f} mm, "
        f"angle {rounded(math.degrees(contact['angle_rad'])):.3f} deg, relative radii "
        f"{contact['relative_radius_along_mm']:.4g} x "
        f"{contact['relative_radius_across_mm']:.4g} mm",
        f"Hertz      a = {hertz['a_mm']:.4g} mm, b = {hertz['b_mm']:.4g} mm, "
        f"p0 = {hertz['p0_MPa']:.4g} MPa",
        f"mesh       {mesh['cell']}, order {mesh['order']}, "
        f"{mesh['patch_size_mm']:.3g} mm in the patch",
        f"solver     {solver['method']}, linear {solver['linear']}",
        f"approach   of {places_of_approach(said['plan'])}",
        f"predicted  {plan.unknowns} unknowns, {seconds}",
    )
    if plan.by_half_spaces:
        answer = f"answer     by half-spaces, without a mesh; predicted {seconds}"
        lines = (*lines[:2], answer)
    for line in (*lines, *profile_lines(plan.profiles)):
        labelled(console, line)
    if plan.uncertainty:
        labelled(console, _smoothing_uncertainty(plan.uncertainty))
    if plan.forecast.reason:
        console.print(f"The patch is forecast as Hertz's: {plan.forecast.reason}.", markup=False)
    if not plan.by_half_spaces:
        _show_prices(said["prices"], console)


def profile_lines(
    profiles: Mapping[str, Mapping[str, Any]], units: Units = BASE_UNITS
) -> Iterator[str]:
    """Lines on reading and smoothing of profiles from files. profiles: by body, as in "plan" of
    summary.json. No lines where there are none.
    """
    for body, found in profiles.items():
        yield f"{body:10s} {Path(found['file']).name}: {', '.join(found['read'])}"
        yield f"           in the file's axes: {_places(found['origin'], units)}"
        shortest, longest = found["smoothing_mm"]
        smoothing = f"smoothing length {units.value(shortest, 'mm'):.2g} to "
        smoothing += units.text(longest, "mm", 2)
        if digit := found.get("rounded_to_mm"):
            smoothing = f"taken as drawn (points {units.text(found['apart_mm'], 'mm', 2)} apart, "
            smoothing += f"rounded to {units.text(digit, 'mm', 1)})"
        yield f"           noise {units.text(1e3 * found['noise_mm'], 'um', 2)}; {smoothing}"


def _places(origin: Mapping[str, Any], units: Units) -> str:
    """Words for the reference places of a profile, as in `Measured.origin`."""
    said = []
    for key, place in origin.items():
        name = key.removesuffix("_mm").replace("_", " ")
        if place is None:
            said.append(f"it ends above the {name}")
            continue
        across, *height = place if isinstance(place, list) else [place]
        text = f"{name} at y = {units.text(across, 'mm', 5)}"
        said.append(text + "".join(f", z = {units.text(each, 'mm', 5)}" for each in height))
    return "; ".join(said)


def _smoothing_uncertainty(found: Mapping[str, Any]) -> str:
    """Line on how far the smoothing of measured profiles leaves the largest pressure and the area
    open, in per cent, or why that is unknown. found: "profile_uncertainty" of the plan in
    summary.json.
    """
    if found["reason"]:
        return f"profile    leaves unknown what it does to the answer: {found['reason']}"
    return (
        f"profile    leaves {found['relative']:.1%} of the largest pressure and of the area open "
        "(half-spaces with other smoothing lengths, or every second point)"
    )


def _show_prices(prices: Sequence[Mapping[str, Any]] | None, console: Console) -> None:
    """Print the predicted cost of accuracies; None: unknown."""
    if prices is None:
        console.print(
            "price      unknown: no calibrated family; an accuracy takes three meshes or more"
        )
        return
    header = ["accuracy", "size, mm", "unknowns", "seconds", "MB", "widest"]
    header += ["mesh", "reading", "other"]
    rows = []
    for row in prices:
        cells = ["out of reach"] * 4 + [""] * 4
        if row["unknowns"] is not None:
            other = row["left_out"] + row["load_steps"] + row["profile"]
            cells = [f"{row['patch_size_mm']:.3g}", f"{row['unknowns']}"]
            cells += [f"{row['seconds']:.1f}", f"{row['memory_MB']:.0f}"]
            name = row["widest"]
            cells += ["p_max" if name == "max_MPa" else name.rpartition("_")[0]]
            cells += [f"{each:.2%}" for each in (row["mesh"], row["reading"], other)]
        rows.append([f"{row['accuracy']:.3g}", *cells])
    title = "price on this machine; the widest estimate, and its parts"
    console.print(number_table(title, header, rows))


def show_result(summary: dict[str, Any], console: Console, units: Units = BASE_UNITS) -> None:
    """Print finite elements, or half-spaces, and exact Hertz side by side, yield, friction, remarks
    and cost; failed checks are left to `show_failure`.
    """
    if summary["result"] is not None:
        for why in left_out(summary):
            console.print(f"{why}.", style="bold", markup=False, highlight=False)
        load = units.value(summary["result"]["load_N"], "N")
        title = f"{summary['case']}: {load:.6g} {units.unit('N')}"
        both = ("yield", "plastic"), ("friction", "friction")
        if named := [effect for effect, key in both if key in summary["result"]]:
            title += f", with {' and '.join(named)}"
        _show_rows(title, quantity_rows.rows(summary, "contact"), console, units)
        console.print(f"Approach of {places_of_approach(summary['plan'], units)}.", highlight=False)
        title, cells = quantity_rows.patches(summary, units)
        if cells:
            console.print(number_table(title, cells[0], cells[1:]))
        told = yields(summary["result"]), side_force(summary["result"], units)
        for said in filter(None, told):
            console.print(f"{said}.", highlight=False)
        if varies := summary["result"].get("surface_shape"):
            ahead, height = varies.values()
            place = f"{units.text(abs(ahead), 'mm')} {'ahead of' if ahead > 0 else 'behind'}"
            place = place if abs(ahead) >= HERE else "in the same place as"
            height = units.text(round(height, 4), "mm")
            text = f"They touch {place} the smooth ones; heights there vary by {height}."
            console.print(text, highlight=False)
        for name, title in TABLES.items():
            if rows := quantity_rows.rows(summary, name):
                _show_rows(title, rows, console, units)
        if friction := summary["result"].get("friction"):
            limit = units.text(friction["limit_N"], "N")
            console.print(
                f"Forces are those of the wheel on the rail; mu N = {limit}.", highlight=False
            )
        for title, (header, *cells), words in quantity_rows.passes(summary["result"], units):
            console.print(number_table(title, header, cells))
            console.print(words, markup=False, highlight=False)
        missing = summary["checks"]["not_made"]
        for reason in dict.fromkeys(missing.values()):
            names = ", ".join(name for name in missing if missing[name] == reason)
            console.print(f"Not checked: {names} ({reason}).", markup=False, highlight=False)
        one = len(summary["result"]["patches"]) < 2
        if summary["checks"]["passed"] and one and not summary["checks"]["hertzian"]:
            console.print(
                "The patch is no Hertz ellipse "
                f"(moments of the pressure are off by {summary['checks']['shape_error']:.1%}): "
                "the column Hertz has what the formula says all the same."
            )
        for edge in summary["result"].get("stress", {}).get("at_edges", ()):
            console.print(
                f"Left out: {edge['quantity']} {units.text(edge['value_MPa'], 'MPa')} in the "
                f"{edge['body']} at {units.place(edge['place_mm'])}, at a sharp edge or held face, "
                "where it depends on the mesh.",
                highlight=False,
            )
    for line in profile_lines(summary["plan"]["profiles"], units):
        labelled(console, line)
    if found := summary["plan"]["profile_uncertainty"]:
        labelled(console, _smoothing_uncertainty(found))
    if other := summary["plan"]["chosen"]:
        console.print(
            f"Switched by hand, against the plan: {', '.join(other)}. "
            "Estimates hold for this choice; they do not say what it changes.",
            markup=False,
            highlight=False,
        )
    if summary["scene"].get("budget") or summary["scene"].get("accuracy"):
        console.print(f"Accuracy: {summary['accuracy']['reason']}.", highlight=False)
    for name, after in summary["effects_after"].items():
        if after["notable"]:
            console.print(f"{name}: {after['why']}", markup=False, highlight=False)
    checks, cost = summary["checks"], summary["cost"]
    if summary.get("method") == "half-spaces":
        console.print(
            f"Half-spaces, {cost['seconds']['total']:.1f} s: no bodies, no mesh. "
            "Estimates are what finite bodies would change; other numbers have none.",
            highlight=False,
        )
        return
    if (share := cost.get("mesh_size_share", 1.0)) < 1:
        console.print(f"gmsh failed at the planned size of elements: they have {share} of it.")
    console.print(
        f"{cost['dofs']} unknowns, {cost['newton_iterations']} Newton steps, "
        f"{cost['linear_iterations']} Krylov iterations, {cost['seconds']['total']:.1f} s, "
        f"force balance {checks['force_balance']:.1e}",
        highlight=False,
    )


def yields(result: Mapping[str, Any]) -> str:
    """Sentence, without a full stop, that holds the load against first yield and shakedown; empty
    without a yield stress. result: of summary.json.
    """
    if not (found := result.get("yield")):
        return ""
    of = "with the tractions of this run, " if found["traction_coefficient"] else ""
    return (
        f"Yield: {of}the load is "
        "{load_over_first_yield:.3g} times that of first yield and "
        "{load_over_shakedown:.3g} times that up to which repeated rolling can shake down (p0/k "
        "{p0_over_k:.3g}, limits {first_yield_p0_over_k:.3g} and {shakedown_limit_p0_over_k:.3g}): "
        "{shakedown}"
    ).format(**found)


def side_force(result: Mapping[str, Any], units: Units = BASE_UNITS) -> str:
    """Sentence, without a full stop, on the side force that a steep contact needs, and who carries
    it; empty where it is below a tenth of the load. result: of summary.json.
    """
    force = result.get("side_force_N") or 0.0
    if abs(force) < STEEP * result["load_N"]:
        return ""
    way = "field" if force > 0 else "gauge"
    return (
        f"Steep contact: the pressure pushes the rail with {units.text(abs(force), 'N')} to the "
        f"{way} side. The axle must push the wheel with as much; here its support does"
    )


def left_out(summary: Mapping[str, Any]) -> list[str]:
    """Sentences, without a full stop, on the effects that the solution needs and does not have;
    yield first.
    """
    after = sorted(summary["effects_after"].items(), key=lambda each: each[0] != "plasticity")
    return [f"Left out: {in_words(name)}; {each['why']}" for name, each in after if each["needed"]]


def places_of_approach(plan: Mapping[str, Any], units: Units = BASE_UNITS) -> str:
    """Words for the places whose approach is reported. plan: as in summary.json."""
    if not (held := plan["held_mm"]):
        return (
            "points one relative radius from the contact"
            if plan["effects"]["plane_strain"]["on"]
            else "distant points"
        )
    return " and ".join(
        f"the {body} {units.text(held[body], 'mm')} {side} the contact"
        if body in held
        else f"the rigid {body}"
        for body, side in (("rail", "below"), ("wheel", "above"))
    )


def show_difference(found: Mapping[str, Any], console: Console, units: Units = BASE_UNITS) -> None:
    """Print quantities of two results side by side, and the scene keys that differ. found: as of
    `quantity_rows.difference`.
    """
    rows = []
    for row in found["quantities"]:
        above, _, part = row["quantity"].partition(": ")
        rows.append({**row, "quantity": f"  {part}" if part else above})
    title = "A: {}, {}; B: {}, {}".format(*found["made"][0], *found["made"][1])
    _show_rows(title, rows, console, units)
    for key, (a, b) in found["scene"].items():
        said = ("not given" if value is None else keyed(key, value) for value in (a, b))
        labelled(console, "scene      {}: {} and {}".format(key, *said))
    if not found["scene"]:
        console.print("scene      the same in both", highlight=False)
    if found["beyond"]:
        labelled(console, f"differ by more than their estimates: {', '.join(found['beyond'])}")


def _show_rows(title: str, rows: Sequence[Row], console: Console, units: Units) -> None:
    """Print rows with as many columns as fit, and further columns in tables below. Empty columns
    are left out.
    """

    def table(names: Sequence[str]) -> Table:
        """The rows that have a value in one of these columns."""
        filled = [row for row in rows if any(row[name] is not None for name in names)]
        cells = quantity_rows.texts(filled, names, units)
        lines = [[label, unit, *numbers] for label, unit, numbers in cells]
        return number_table(title, [*quantity_rows.FIRST, *names], lines, len(quantity_rows.FIRST))

    print_in_parts(quantity_rows.filled(rows), table, console, min(console.width, WIDEST))


def print_in_parts(
    names: Sequence[str], table: Callable[[Sequence[str]], Table], console: Console, width: int
) -> None:
    """Print a table of columns, as many as fit into the width (characters), and the further ones
    in tables below, without a title. table: of some of the names.
    """
    whole, left = console.options.update(max_width=10**6), names
    while left:
        count = len(left)
        while count > 1 and table(left[:count]).__rich_measure__(console, whole).maximum > width:
            count -= 1
        part = table(left[:count])
        if left is not names:
            part.title = None
            console.print()
        console.print(part)
        left = left[count:]


def number_table(
    title: str, header: Sequence[str], rows: Sequence[Sequence[str]], words: int = 0
) -> Table:
    """Table of rows of text: `words` columns of words on the left, the others of numbers. Beside
    words numbers are never broken into lines, nor their headers.
    """
    table = Table(
        title=title or None, title_justify="left", box=box.SIMPLE_HEAD, padding=0, show_edge=False
    )
    for name in header[:words]:
        table.add_column(name)
    for name in header[words:]:
        table.add_column(name, justify="right", no_wrap=words > 0)
    for row in rows:
        table.add_row(*row)
    return table


def column_table(
    title: str,
    rows: Sequence[Mapping[str, Any]],
    columns: Mapping[str, tuple[str, int]],
    units: Units,
) -> Table:
    """Table of rows of a file: of each column, by its name with the base unit in brackets, the head
    that is shown and the digits of its numbers. units: of the numbers.
    """

    def cell(value: float | str, name: str, digits: int) -> str:
        """A number as text; words stay."""
        if isinstance(value, str):
            return value
        return f"{units.value(exact(value), name):.{digits}g}"

    shown = {name: units.unit(name.partition("[")[2].removesuffix("]")) for name in columns}
    header = [f"{head}\n{shown[name]}".rstrip() for name, (head, _) in columns.items()]
    cells = [[cell(row[name], name, k) for name, (_, k) in columns.items()] for row in rows]
    return number_table(title, header, cells)


def exact(value: float) -> float:
    """A number of a table, 0 where it is but rounding."""
    return value if abs(value) > NOTHING else 0.0


def show_failure(summary: dict[str, Any], console: Console) -> None:
    """Print each failed check with value, limit and advice, and the history of Newton's method
    where that did not converge.
    """
    newton, checks = summary["newton"], summary["checks"]
    for name in checks["failed"]:
        if name == "converged":
            text = f"NOT CONVERGED: {newton['reason']}; {checks['advice'][name]}"
            console.print(text, highlight=False, markup=False)
            continue
        (limit, source), value = checks["limits"][name], float(checks[name])  # inf is a word
        console.print(
            f"CHECK FAILED: {name} = {value:.3g}, limit {float(limit):.3g} ({source}); "
            f"{checks['advice'][name]}",
            highlight=False,
            markup=False,
        )
    if checks["converged"]:
        return
    for number, step in enumerate(newton["history"]):
        residual = step["problem"] or f"residual {step['residual']:.2e}"
        console.print(
            f"  step {number:2d}  {residual}  active points {step['active']}  "
            f"Krylov iterations {step['linear_iterations']}  step length {step['length']:.2f}",
            highlight=False,
        )


def rounded(value: float, digits: int = 3) -> float:
    """A number rounded to some decimal digits; a negative one that rounds to zero is 0, not -0."""
    return round(value, digits) + 0.0

"""Do hard cases stay right? The battery of cases.toml, each case in a process that may die alone.

The study runs all cases, the tests those marked quick.
"""

import itertools
import math
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.patches import Rectangle
from matplotlib.ticker import FuncFormatter

from railhead.postprocess.pictures.diagrams import new_figure
from railhead.scene import catalogue
from railhead.scene.scene import Scene
from studies.hard import block_cases, references
from studies.hard.case import CaseErrors, Deviation, HardCase
from studies.processes import Timed, attempts
from studies.tables import Row, groups, publish, render

STEEL = 207e3  # MPa, what a stiffness ratio refers to
REFERENCES = {
    "half_space": "boundary elements",
    "positioned": "boundary elements",
    "hertz": "exact Hertz",
    "finer": "own finer mesh",
    "finer_plastic": "own finer mesh",
    "random_plans": "finite numbers",
}
"""Name of the reference of a function, where a row gives none; of others it is an invariance."""


def base(fields: Mapping[str, Any]) -> Scene:
    """A scene of the table [scenes]: a shipped case with changes, or all of its fields."""
    changes = {key: value for key, value in fields.items() if key != "case"}
    if "case" in fields:
        return catalogue.find(fields["case"]).replace(**changes)
    return Scene.from_mapping(changes)


def expand(row: Mapping[str, Any], scenes: Mapping[str, Scene]) -> Iterator[HardCase]:
    """The cases of a row, see the head of cases.toml."""
    for entry in row.get("cases", [{}]):
        fields = {**row, **entry}
        over = fields.get("over", {})
        for chosen in itertools.product(*over.values()):
            values = dict(zip(over, chosen, strict=True))
            values["modulus"] = STEEL * values.get("ratio", 1.0)
            yield one(fields, values, scenes)


def one(
    fields: Mapping[str, Any], values: Mapping[str, Any], scenes: Mapping[str, Scene]
) -> HardCase:
    """The case of a row with values in the places of its templates."""
    name, against = fields["name"].format(**values), fields["against"]
    options = {
        key: values[value[1:-1]] if isinstance(value, str) and value[:1] == "{" else value
        for key, value in fields.get("with", {}).items()
    }
    if "scene" in fields:
        keys = [key.format(**values) for key in fields.get("keys", [])]
        options["scene"] = scenes[fields["scene"]].replace(keys)
    quick = fields.get("quick", False)
    given = ("newton", "krylov", "seconds", "known")
    return HardCase(
        group=fields["group"],
        name=name,
        reason=fields["reason"],
        reference=fields.get("reference", REFERENCES.get(against, "invariance")),
        solve=partial(references.METHODS.get(against) or getattr(block_cases, against), **options),
        quick=name in quick if isinstance(quick, list) else quick,
        refusable=fields.get("refusable", False),
        **{key: fields[key] for key in given if key in fields},
    )


def read() -> Iterator[HardCase]:
    """All cases of cases.toml."""
    with Path(__file__).with_name("cases.toml").open("rb") as file:
        table = tomllib.load(file)
    scenes = {name: base(fields) for name, fields in table["scenes"].items()}
    for row in table["rows"]:
        yield from expand(row, scenes)


CASES: dict[str, HardCase] = {case.key: case for case in read()}
QUICK = [case for case in CASES.values() if case.quick]


def solve(key: str) -> CaseErrors:
    """Solve the case with a key of CASES in this process; returns its errors."""
    return CASES[key].solve()


def row(case: HardCase, end: Timed[CaseErrors]) -> Row:
    """The columns of a case; its numbers are None where it ended without a result. fault: part of
    the rule that is broken, in words; holds: it is empty. quantity: the one with the largest share
    of what is allowed. seconds: by the clock."""
    found = end.value
    fault = case.fault(found) if found else end.fault
    name, worst = found.worst or ("", None) if found else ("", None)
    return {
        "group": case.group,
        "case": case.name,
        "reason": case.reason + (f" ({found.remark})" if found and found.remark else ""),
        "against": case.reference,
        "holds": not fault,
        "fault": fault,
        "known": case.known,
        "refusable": case.refusable,
        "failed": " ".join(found.failed) if found else "",
        "quantity": name,
        "deviation": worst.value if worst else None,
        "allowed": worst.allowed if worst else None,
        "newton_iterations": found.newton if found else None,
        "linear_iterations": found.krylov if found else None,
        "noise": found.noise if found else None,
        "seconds": end.seconds,
    }


def main(out: Path, *, quick: bool) -> None:
    """Write hard_cases.csv, hard_cases.png and page.md; quick: the cases of the tests."""
    cases = QUICK if quick else list(CASES.values())
    ends = attempts(solve, [(case.key,) for case in cases], [case.seconds for case in cases])
    rows = [row(case, end) for case, end in zip(cases, ends, strict=True)]
    draw(rows, out / "hard_cases.png")
    publish(out, page(rows), hard_cases=rows)


LAWS = ("default", "Nitsche, theta 1", "Nitsche, theta 0", "Nitsche, theta -1", "penalty")
FACTORS = [10.0**power for power in range(-3, 7)]
POISSON = (0.0, 0.3, 0.45, 0.49, 0.499, 0.4999)
STIFFNESS = [10.0**power for power in (-4, -2, 0, 2, 4)]
LOW, HIGH = 1e-3, 1.0  # errors at the ends of the colours
DARK = 0.52  # of green: letters on it are white


SAID = {
    "converged": "not\nconverged",
    "pressure_noise": "pressure\ntoo noisy",
    "penetration": "bodies\noverlap",
}
"""What a field of a map says by the first check that failed."""
MAPS = (
    (
        "Contact laws on the thesis ellipse, four elements per semi-axis",
        "factor",
        LAWS,
        FACTORS,
        ("solver.gamma_factor", ""),
    ),
    (
        "Rail of any stiffness under a steel wheel, quadratic tetrahedra",
        "nu x E ratio",
        [f"{value:g}" for value in POISSON],
        STIFFNESS,
        ("E of the rail over E of the wheel", "Poisson's ratio of the rail"),
    ),
)
"""Title, group of the cases, their rows and columns, labels of the columns and of the rows."""


def cell(row: Row | None) -> tuple[float, bool, str]:
    """A point of a map: relative error (nan: no result), whether it converged, a short note."""
    if row is None or row["newton_iterations"] is None:
        return math.nan, False, "no end" if row and "back" in row["fault"] else "x"
    error = math.nan if row["deviation"] is None else row["deviation"]
    if row["failed"]:
        first = row["failed"].split()[0]
        return error, False, SAID.get(first, "fails " + first.replace("_", "\n", 1))
    if not row["quantity"]:
        return error, False, "x"
    return error, True, f"{error:.1%}" + ("\nWRONG" if row["fault"] else "")


def _summary(group: str, rows: Sequence[Row]) -> list[str]:
    """Cells of a group: number of cases, of right, refused and failing ones, largest share of
    what is allowed and its case and most Newton steps, both without refused cases, most seconds."""
    refused, faults = sum(map(_refused, rows)), sum(not row["holds"] for row in rows)
    signed = [row for row in rows if row["newton_iterations"] is not None and not row["failed"]]
    compared = [row for row in signed if row["quantity"]]
    shares = [(Deviation(row["deviation"], row["allowed"]).share, row["case"]) for row in compared]
    share, nearest = max(shares, default=(math.nan, ""))
    return [
        group,
        *map(str, (len(rows), len(rows) - refused - faults, refused, faults)),
        f"{share:.2f}: {nearest}" if nearest else "-",
        str(max((row["newton_iterations"] for row in signed), default=0)),
        f"{max(row['seconds'] for row in rows):.1f}",
    ]


def _refused(row: Row) -> bool:
    """Whether a case counts as right because its result is refused."""
    return bool(row["holds"] and row["failed"])


def page(rows: Sequence[Row]) -> str:
    """Text of docs/hard-cases.md: what fails, and a row for each group of cases."""
    return render(
        "hard_cases",
        count=len(rows),
        failing=[row for row in rows if row["fault"]],
        refused=sum(map(_refused, rows)),
        groups=[_summary(group, own) for group, own in groups(rows, "group").items()],
    )


def draw(runs: Sequence[Row], path: Path) -> None:
    """The two failure maps of a whole run, one panel below the other; colour is the error, a grey
    cell with a cross did not converge."""
    found = {f"{run['group']}: {run['case']}": run for run in runs}
    heights = [len(rows) for _, _, rows, _, _ in MAPS]
    width = 3.0 + 1.05 * max(len(columns) for _, _, _, columns, _ in MAPS)
    with new_figure(path, width, 0.62 * sum(heights) + 1.5 * len(MAPS)) as figure:
        panels = figure.subplots(len(MAPS), 1, squeeze=False, height_ratios=heights)[:, 0]
        for axes, (title, group, rows, columns, labels) in zip(panels, MAPS, strict=True):
            cells = [[cell(found.get(f"{group}: {r}, {c:g}")) for c in columns] for r in rows]
            values = [[error if right else math.nan for error, right, _ in row] for row in cells]
            image = axes.imshow(values, norm=LogNorm(LOW, HIGH), cmap="RdYlGn_r", aspect="auto")
            for y, x in np.ndindex(len(rows), len(columns)):
                _, right, note = cells[y][x]
                if not right:
                    axes.add_patch(Rectangle((x - 0.5, y - 0.5), 1, 1, fc="#c9c9c9", ec="white"))
                dark = right and image.to_rgba(values[y][x])[1] < DARK
                axes.text(
                    x,
                    y,
                    note,
                    ha="center",
                    va="center",
                    fontsize=8,
                    color="white" if dark else "black",
                )
            axes.set_xticks(range(len(columns)), [f"{each:g}" for each in columns])
            axes.set_yticks(range(len(rows)), rows)
            axes.set(xlabel=labels[0], ylabel=labels[1], title=title)
            axes.grid(visible=False)
        shares = FuncFormatter(lambda value, _: f"{100 * value:g}%")
        bar = figure.colorbar(image, ax=list(panels), shrink=0.6, extend="both", format=shares)
        bar.set_label("error of the quantity nearest to what is allowed")

"""A rail that is run in: passes of the thesis's wheel, the map of shakedown, and what both cost."""

import itertools
import math
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import railhead as rh
from railhead.half_spaces import pass_contact
from railhead.postprocess.pictures.diagrams import FE, GREY, HERTZ, new_figure
from railhead.run import passes_of_scene
from railhead.scene import catalogue
from railhead.solver.material import Hardening, Material
from railhead.theory import damage
from railhead.theory.elastic.subsurface import von_mises
from studies import tables

COUNT, QUICK = 20, 2  # passes of the axle
SHOWN = 1, 2, 3, 5, 10, 20
# A cone of 1:20 on a rail that leans 1:20 is a cylinder on an upright rail: half of it is solved.
UPRIGHT = "rail.inclination=0", "wheel.profile=cylinder", "wheel.steel=none"
AXLE = catalogue.find("uic54_22t5_axle").replace(UPRIGHT)
FAST = ("effects.finite_bodies=off",)  # half-spaces answer before the passes, which know no others
DRIVES = ("friction.coefficient=0.3", "rolling.force_along=16.5kN")  # Q/N 0.15
YOUNG, POISSON, YIELD = 207e3, 0.3, 480.0  # of the map: MPa
SHEAR = YIELD / math.sqrt(3)
LAWS = {
    "perfect": Hardening.linear(YIELD),
    "kinematic": Hardening.linear(YIELD, 0.03 * YOUNG, 1.0),
}
TRACTIONS = 0.0, 0.1, 0.2, 0.3
SHARES = 0.8, 0.9, 0.97, 1.03, 1.1, 1.2  # of the limit
MAPPED, PER_LENGTH, REACH = 10, 4.0, 20.0  # passes, elements on a half width, reach of the block
MARKS = {
    "elastic": "^",
    "shakes down": "o",
    "at the limit": "s",
    "closed cycles": "D",
    "ratchets": "X",
    "undecided": "$?$",
}
UNITS = {
    "forward": "um",
    "groove": "um",
    "pressure": "MPa",
    "along": "MPa",
    "across": "MPa",
    "von_mises": "MPa",
    "seconds": "s",
}
Row = dict[str, Any]


def run_in(*keys: str, traction: str) -> tuple[list[Row], Row]:
    """Rows of the passes of the axle, and one row of what stays after them, with the processor
    seconds.

    keys: assignments to keys of the scene. traction: its name in tables.
    """
    found, spent = tables.timed(partial(rh.solve, AXLE.replace([*FAST, *keys]), quiet=True))
    result = found.summary["result"]
    rows = [
        {
            "traction": traction,
            "pass": number,
            "strain": each["strain_increment_max"],
            "strain_max": each["strain_max"],
            "forward": 1e3 * each["forward_mm"],
            "groove": 1e3 * each["groove_mm"],
            "pressure": each["pressure_max_MPa"],
            "along": each["residual_along_MPa"],
            "across": each["residual_across_MPa"],
        }
        for number, each in enumerate(result["passes"], 1)
    ]
    assert found.solved is not None and found.solved.passes is not None
    after = found.solved.passes.sections[-1].stress.reshape(-1, 6)
    told = {
        "what": f"{len(rows)} passes, {traction}",
        "pressure": rows[-1]["pressure"],
        "strain": rows[-1]["strain_max"],
        "groove": rows[-1]["groove"],
        "von_mises": float(von_mises(after).max()),
        "seconds": spent,
        "verdict": result["passes_verdict"],
        "words": result["passes_words"],
        "unknowns": result["passes_after"]["unknowns"],
        "passed": found.summary["checks"]["passed"],
    }
    return rows, told


def left_out(*keys: str, what: str) -> Row:
    """Row of the axle without passes, elastic or pressed once with yield, as `keys` say; what: its
    name in the table."""
    solved, spent = tables.timed(partial(rh.solve, AXLE.replace(keys), quiet=True))
    found = solved.summary
    plastic = found["result"].get("plastic") or {}
    return {
        "what": what,
        "pressure": found["result"]["pressure"]["max_MPa"],
        "strain": plastic.get("strain_max", 0.0),
        "groove": 1e3 * plastic.get("residual_depth_rail_mm", 0.0),
        "von_mises": plastic.get("residual_von_mises_max_MPa", 0.0),
        "seconds": spent,
    }


def mapped(traction: float, share: float, law: str) -> Row:
    """Row with the verdict on a line contact in full slip whose pressure is kept.

    traction: Q/P. share: p0 over that of the shakedown limit. law: of LAWS.
    """
    limit = damage.shakedown_limit(traction, POISSON)
    modulus, p0 = YOUNG / (1 - POISSON**2), share * limit * SHEAR
    contact = pass_contact.line_contact(
        1.0, math.pi * p0 / 2, 2 * p0 / modulus, modulus, keeps=True, slips=traction
    )
    block = passes_of_scene.rolling_block(
        Material(YOUNG, POISSON, LAWS[law]),
        (1.0, 1.0),
        line=True,
        half=False,
        per_length=PER_LENGTH,
        reach=REACH,
    )
    (found,) = passes_of_scene.roll([pass_contact.Below(block, contact)], contact, MAPPED)
    return {
        "traction": traction,
        "law": law,
        "limit": limit,
        "ratio": share * limit,
        "share": share,
        "strain": found.rows[-1]["strain_increment_max"],
        "forward_over_width": found.rows[-1]["forward_mm"],
        "verdict": found.verdict,
    }


def main(out: Path, *, quick: bool) -> None:
    """Write passes_axle.csv, passes_map.csv, passes_study.png and page.md; quick: two passes on a
    coarse block, and two places of the map."""
    count = f"rolling.passes={QUICK if quick else COUNT}"
    size = ("mesh.patch_size=4",) if quick else ()
    ways = tables.told({"no traction": (), "Q/N 0.15": DRIVES}.items(), "axle, {0[0]}".format)
    found, after = zip(*(run_in(count, *size, *k, traction=name) for name, k in ways), strict=True)
    axle = [row for rows in found for row in rows]
    print("axle without passes", file=sys.stderr)
    others = [left_out(*FAST, "effects.plasticity=off", what="elastic")]
    others += [] if quick else [left_out(what="pressed once")]
    places = TRACTIONS[:1] if quick else TRACTIONS, SHARES[1:5:3] if quick else SHARES
    every = itertools.product(*places, list(LAWS)[: 1 if quick else 2])
    points = [mapped(*each) for each in tables.told(every, "map, {}".format)]
    draw(axle, points, out / "passes_study.png")
    tables.publish(
        out, page(axle, after, others, points), UNITS, passes_axle=axle, passes_map=points
    )


def page(
    axle: Sequence[Row], after: Sequence[Row], others: Sequence[Row], points: Sequence[Row]
) -> str:
    """Text of the page: passes of the axle, what they and leaving them out cost, and the map."""
    return tables.render(
        "passes",
        axle=tables.cells(
            [row for row in axle if row["pass"] in SHOWN],
            *("{traction}", "{pass}", "{strain:.2g}", "{forward:.2f}", "{groove:.1f}"),
            *("{pressure:.0f}", "{along:.0f}", "{across:.0f}"),
        ),
        after=after,
        costs=tables.cells(
            [*others, *after],
            *("{what}", "{pressure:.0f}", "{strain:.4f}", "{groove:.1f}", "{von_mises:.0f}"),
            "{seconds:.0f}",
        ),
        elastic=others[0],
        pressed=others[1] if len(others) > 1 else None,
        points=[
            [
                f"{rows[0]['traction']:g}",
                f"{rows[0]['limit']:.3f}",
                f"{rows[0]['ratio']:.2f}",
                f"{rows[0]['share']:.2f}",
                *(f"{row['verdict']}, {row['forward_over_width']:.1e}" for row in rows),
            ]
            for rows in tables.groups(points, "traction", "share").values()
        ],
        laws=list(dict.fromkeys(row["law"] for row in points)),
        wrong=[
            row
            for row in points
            if row["law"] == "perfect"
            and (row["verdict"] in ("elastic", "shakes down")) != (row["share"] < 1)
        ],
        total=sum(row["law"] == "perfect" for row in points),
    )


def draw(axle: Sequence[Row], points: Sequence[Row], path: Path) -> None:
    """Draw what each pass of the axle adds, and the map of verdicts with its limits."""
    with new_figure(path, 11.0, 4.4) as figure:
        left, right = figure.subplots(1, 2)
        for (traction, rows), colour in zip(
            tables.groups(axle, "traction").items(), (FE, HERTZ), strict=True
        ):
            number = [row["pass"] for row in rows]
            for name, factor, look in (("strain", 100, "o-"), ("forward", 1, "s--")):
                size = [factor * abs(row[name]) for row in rows]
                left.plot(number, size, look, color=colour, label=f"{name}, {traction}")
        left.set(yscale="log", xlabel="pass", ylabel="of each pass: strain, %; forward, um (size)")
        left.xaxis.get_major_locator().set_params(integer=True)
        left.legend()
        traction = np.linspace(0.0, max(TRACTIONS), 13)
        for limit, label, style in (
            (damage.shakedown_limit, "shakedown", "-"),
            (damage.elastic_limit, "first yield", ":"),
        ):
            values = [limit(float(q), POISSON) for q in traction]
            right.plot(traction, values, style, color=GREY, label=label)
        perfect = [row for row in points if row["law"] == "perfect"]
        for verdict, rows in tables.groups(perfect, "verdict").items():
            colour = FE if verdict in ("elastic", "shakes down") else HERTZ
            x, y = ([row[key] for row in rows] for key in ("traction", "ratio"))
            right.plot(x, y, MARKS[verdict], color=colour, label=verdict, ls="none")
        right.set(xlabel="Q/P, full slip", ylabel="p0/k, perfect plasticity")
        right.legend()

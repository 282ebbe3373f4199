"""The page of the study effects: what its runs say, in words and tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from railhead.studies.tables import percent, table

Row = Mapping[str, Any]
"""One run with the fields of the study's CSV, without units."""
JUDGED = ("p_max", "area", "tau_max")
REDUCTIONS = ("symmetry", "symmetry_x", "symmetry_y")  # on is the cheaper state
NOISE = 0.1  # relative difference of two median times that is none


def page(runs: Sequence[Row], bare: Sequence[Row]) -> str:
    """The whole page; bare: the two routes of the same contact."""
    parts = [
        "# What effects cost",
        "Each scene is solved as planned, then again with one effect at a time in the other state. "
        "Seconds are processor seconds of one process (plan to findings; no imports, compilation, "
        "files or pictures), the least of the repeats. Changes are relative to the run as "
        "planned; meshes differ, so a few hundredths of a per cent are noise. Only what can be "
        "had is listed: a rigid body cannot be made deformable, nor an inclined rail symmetric. "
        "A whole section that can twist is a metre long. "
        "Plasticity and friction are recognised but not simulated, so they have no row.",
        "## Was the plan right?",
        verdict(runs),
    ]
    for scene in dict.fromkeys(row["scene"] for row in runs):
        parts += [f"## {scene}", _scene([row for row in runs if row["scene"] == scene])]
    parts += ["## Off means free", _free(bare)]
    return "\n\n".join(parts) + "\n"


def wrong(runs: Sequence[Row]) -> list[Row]:
    """Runs which show that the plan left out too much: an effect left off, or a reduction used,
    that changes a judged quantity by more than the accuracy."""
    return [
        row for row in runs if row["effect"] and _left_out(row) and _change(row) > row["accuracy"]
    ]


def verdict(runs: Sequence[Row]) -> str:
    """In words, with the numbers that decide."""
    left = [row for row in runs if row["effect"] and _left_out(row)]
    kept = [row for row in runs if row["effect"] and not _left_out(row)]
    limit = percent(runs[0]["accuracy"])
    lines = []
    if bad := wrong(runs):
        named = "; ".join(
            f"{row['effect']} of {row['scene']} ({percent(_change(row))})" for row in bad
        )
        lines.append(f"**No.** What the plan left out changes more than {limit}: {named}.")
    elif left:
        worst = max(left, key=_change)
        lines.append(
            f"Yes: of {len(left)} effects and whole models that the plans left out, none changes "
            f"p_max, area or tau_max by more than {limit}. The largest change is "
            f"{percent(_change(worst))} ({worst['effect']} of {worst['scene']})."
        )
    small = [row for row in kept if _change(row) <= row["accuracy"]]
    lines.append(
        f"Of {len(kept)} effects that the plans kept, {len(kept) - len(small)} change one of them "
        f"by more than {limit} when left out."
    )
    lines += [
        f"Not so `{row['effect']}` of {row['scene']}: {percent(_change(row))} (its approach "
        f"{percent(abs(row['change_approach']))})."
        for row in small
    ]
    return " ".join(lines)


def _left_out(row: Row) -> bool:
    """Whether this run simulates more than the plan did."""
    return bool(row["on"] != (row["effect"] in REDUCTIONS))


def _change(row: Row) -> float:
    return max(abs(row[f"change_{key}"]) for key in JUDGED)


def _scene(rows: Sequence[Row]) -> str:
    first = rows[0]
    header = (
        "run", "unknowns", "seconds", "time", "p_max", "area", "tau_max", "approach",
    )  # fmt: skip
    lines = []
    for row in rows:
        state = "on" if row["on"] else "off"
        changes = [f"{row[f'change_{key}']:+.3%}" for key in (*JUDGED, "approach")]
        lines.append(
            [
                f"{row['effect']} {state}" if row["effect"] else "as planned",
                f"{row['unknowns']}",
                f"{row['seconds']:.2f}",
                f"x {row['seconds'] / first['seconds']:.2f}",
                *(changes if row["effect"] else [""] * 4),
            ]
        )
    values = (
        f"As planned: p_max {first['p_max']:.5g} MPa, area {first['area']:.5g} mm2, tau_max "
        f"{first['tau_max']:.5g} MPa, approach {first['approach']:.4g} mm."
    )
    whole = [row for row in rows if row["effect"] == "symmetry" and not row["on"]]
    said = [
        f" The whole model takes {row['seconds'] / first['seconds']:.1f} times the time and "
        f"{row['unknowns'] / first['unknowns']:.1f} times the unknowns of the part that symmetry "
        "leaves."
        for row in whole
    ]
    return values + "".join(said) + "\n\n" + table(header, lines)


def _free(bare: Sequence[Row]) -> str:
    planned, direct = bare
    ratio = planned["seconds"] / direct["seconds"]
    same = planned["unknowns"] == direct["unknowns"] and planned["forms"] == direct["forms"]
    noise = "within" if abs(ratio - 1) < NOISE else "not within"
    lines = [
        (
            row["route"],
            row["unknowns"],
            row["forms"],
            f"{row['seconds']:.3f}",
            f"{row['p_max']:.10g}",
        )
        for row in bare
    ]
    return (
        "An elastic sphere on a rigid plane with every optional effect off, by way of the plan and "
        "by calling the mesh generator and the solver directly, where no effect exists (medians). "
        f"Unknowns and compiled forms are {'the same' if same else 'different'}; the plan's route "
        f"takes {ratio:.3f} times the time, {noise} the noise of {NOISE:.0%}.\n\n"
        + table(("route", "unknowns", "forms", "seconds", "largest raw pressure, MPa"), lines)
    )

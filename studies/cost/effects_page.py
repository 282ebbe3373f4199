"""What the page of the study effects says of its runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from studies.tables import render

Row = Mapping[str, Any]
"""One run with the fields of the study's CSV, without units."""
JUDGED = ("p_max", "area", "tau_max")
REDUCTIONS = (
    "symmetry",
    "symmetry_x",
    "symmetry_y",
    "axisymmetry",
    "plane_strain",
)  # on is cheaper
NOISE = 0.1  # relative difference of two median times that is none


def page(runs: Sequence[Row], bare: Sequence[Row]) -> str:
    """The whole page; bare: the two routes of the same contact."""
    planned, direct = bare
    names = dict.fromkeys(row["scene"] for row in runs)
    return render(
        "effects",
        verdict=verdict(runs),
        scenes={name: _scene([row for row in runs if row["scene"] == name]) for name in names},
        same=all(planned[key] == direct[key] for key in ("unknowns", "forms")),
        ratio=planned["seconds"] / direct["seconds"],
        noise=NOISE,
        bare=[
            (
                row["route"],
                row["unknowns"],
                row["forms"],
                f"{row['seconds']:.3f}",
                f"{row['p_max']:.10g}",
            )
            for row in bare
        ],
    )


def wrong(runs: Sequence[Row]) -> list[Row]:
    """Runs which show that the plan left out too much: an effect left off, or a reduction used,
    that changes a judged quantity by more than the accuracy."""
    return [row for row in _left(runs) if _change(row) > row["accuracy"]]


def verdict(runs: Sequence[Row]) -> str:
    """In words, with the numbers that decide."""
    left = _left(runs)
    kept = [row for row in runs if row["effect"] and not _simulates_more(row)]
    overruled = [row for row in runs if row["effect"] and _overruled(row)]
    small = [row for row in kept if _change(row) <= row["accuracy"]]
    worst = max(left, key=_change, default=None)
    return render(
        "effects_verdict",
        change=_change,
        limit=runs[0]["accuracy"],
        wrong=wrong(runs),
        left=len(left),
        worst=worst,
        kept=len(kept),
        small=small,
        overruled=overruled,
    )


def _left(runs: Sequence[Row]) -> list[Row]:
    """Runs that simulate more than the plan did, of its own accord."""
    return [r for r in runs if r["effect"] and _simulates_more(r) and not _overruled(r)]


def _simulates_more(row: Row) -> bool:
    return bool(row["on"] != (row["effect"] in REDUCTIONS))


def _overruled(row: Row) -> bool:
    """Whether the plan called for the state of this run, and the scene chose the other one."""
    return bool(row["on"] == row["called_for"])


def _change(row: Row) -> float:
    return max(abs(row[f"change_{key}"]) for key in JUDGED)


def _scene(rows: Sequence[Row]) -> tuple[Row, list[Row], list[list[Any]]]:
    """The run as planned, the whole model if there is one, and the lines of the table."""
    first = rows[0]
    whole = [row for row in rows if row["effect"] == "symmetry" and not row["on"]]
    lines = []
    for row in rows:
        state = f"{row['effect']} {'on' if row['on'] else 'off'}" if row["effect"] else "as planned"
        changes = [f"{row[f'change_{key}']:+.3%}" for key in (*JUDGED, "approach")]
        time = f"{row['seconds']:.2f}", f"x {row['seconds'] / first['seconds']:.2f}"
        lines.append([state, row["unknowns"], *time, *(changes if row["effect"] else [""] * 4)])
    return first, whole, lines

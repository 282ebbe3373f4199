"""Creep tables solved side by side, a record of each part in a folder, and the table's files."""

from collections.abc import Mapping
from concurrent.futures import as_completed
from contextlib import ExitStack
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from railhead.results import result_folder
from railhead.run.progress import Progress
from railhead.scene.sections import ArgumentError, refuse_first
from railhead.scene.units import FRACTION, to_base
from railhead.sweeps import store, worker_pool
from railhead.theory.array_types import Array
from railhead.theory.friction import creep_table as theory
from railhead.theory.friction.creep_table import AXES, NUMBERS, CreepTable
from railhead.theory.friction.kalker import coefficients

LARGEST = 100.0  # that a force or its error over mu N cannot be
TABLE, ROWS, FOUND = "table.npz", "table.csv", result_folder.SUMMARY
HEAD = """# railhead creep table. Poisson's ratio {poisson:g}, {cells} cells each way, law {law}.
# axis_ratio: a/b, a along. along, across, spin: G a b C11 xi_x/(mu N), G a b C22 xi_y/(mu N),
# G (a b)^1.5 C23 phi/(mu N). Forces of the wheel on the rail over mu N; moment over mu N sqrt(a b).
"""


def creep_table(
    folder: str | Path,
    *,
    poisson: float = 0.28,
    accuracy: float | str = 0.02,
    ratios: tuple[float, float] | str = (0.1, 10.0),
    cells: int = 24,
    law: theory.Law | None = None,
    force: bool = False,
    quiet: bool = True,
) -> CreepTable | None:
    """Solve a creep table side by side and write it into a folder, or read and complete the one
    that was begun there with the same values. Under MPI called on all ranks.

    poisson: Poisson's ratio, 0 to 0.5.
    accuracy: asked of the interpolation along each axis, over mu N, 0.005 to 0.2 or "0.5%" to
        "20%".
    ratios: smallest and largest a/b, 0.05 to 20; equal: one ratio. Also as "LOW:HIGH".
    cells: of the finer grid each way, 12 to 96, even.
    law: kinetic over static coefficient, s_half G a b/(V mu N), and memory over sqrt(a b) of a
        coefficient that falls exponentially with slip; None: Coulomb's law.
    force: whether another result in the folder is replaced. quiet: no progress is shown.
    Returns None on all MPI ranks but the first. Raises SceneError for a wrong value or folder and
    for a part that is not solved, OSError where nothing can be written.
    """
    asked = _checked(poisson, accuracy, ratios, cells, law)
    folder = Path(folder)
    with ExitStack() as claim:

        def solve(submit: worker_pool.Submit) -> CreepTable:
            """Make the folder ready for the records, and solve the table."""
            result_folder.check_folder(folder)
            with Progress(quiet=quiet) as progress:
                progress.stage("looking where the forces bend")
                try:
                    axes = theory.axes(**asked)
                except ValueError as error:
                    raise ArgumentError("law", f"{law}: {error}") from None
                claim.enter_context(result_folder.claimed(folder))
                request = {"railhead": result_folder.VERSION, "table": asked}
                store.begin(folder, request, "replace" if force else "refuse", (TABLE, ROWS, FOUND))
                return _solved(folder, submit, progress, axes, poisson, cells, law)

        return worker_pool.on_first(MPI.COMM_WORLD, solve)


def _checked(
    poisson: float,
    accuracy: float | str,
    ratios: tuple[float, float] | str,
    cells: int,
    law: theory.Law | None,
) -> dict[str, Any]:
    """The values of a table by the names of `creep_table`, as numbers. Raises SceneError for the
    first one that is none or out of its range.
    """
    try:
        accuracy = to_base(accuracy, FRACTION)
    except ValueError as error:
        raise ArgumentError("accuracy", str(error)) from None
    if isinstance(ratios, str):
        first, _, last = ratios.partition(":")
        try:
            ratios = float(first), float(last or first)
        except ValueError:
            raise ArgumentError("ratios", f"{ratios!r} is not allowed; give LOW:HIGH") from None
    low, high = ratios
    even = 12 <= cells <= 96 and cells % 2 == 0
    falls = law is None or (min(law) > 0 and law[0] <= 1)
    text = "{} is not allowed; give {}".format
    refuse_first(
        (not 0 <= poisson <= 0.5, "poisson", text(poisson, "0 to 0.5")),
        (not 0.005 <= accuracy <= 0.2, "accuracy", text(accuracy, "0.5% to 20%")),
        (
            not 0.05 <= low <= high <= 20,
            "ratios",
            text(f"{low:g}:{high:g}", "LOW:HIGH within 0.05:20"),
        ),
        (not even, "cells", text(cells, "12 to 96, even")),
        (not falls, "law", text(law, "KINETIC above 0 to 1, HALF and MEMORY above 0")),
        kind=ArgumentError,
    )
    return {"poisson": poisson, "accuracy": accuracy, "ratios": ratios, "cells": cells, "law": law}


def _solved(
    folder: Path,
    submit: worker_pool.Submit,
    progress: Progress,
    axes: dict[str, list[float]],
    poisson: float,
    cells: int,
    law: theory.Law | None,
) -> CreepTable:
    """The table of values as of `creep_table` over axes, whose parts without a record are
    submitted; written into a folder. Raises SceneError for a part that failed, and a broken record.
    """
    rest = axes["across"], axes["spin"]
    parts = list(product(axes["axis_ratio"], axes["along"]))
    finished = store.done(folder)
    jobs = {
        submit(theory.solve, poisson, cells, *parts[n], rest, law): n
        for n in range(len(parts))
        if n not in finished
    }
    progress.jobs(len(parts) - len(jobs), len(parts))
    for count, job in enumerate(as_completed(jobs), len(parts) - len(jobs) + 1):
        found = worker_pool.outcome(job)
        if found.value is None:
            ratio, along = parts[jobs[job]]
            text = f"{str(folder)!r}: a/b = {ratio:.4g}, along = {along:.4g}: {found.fault}"
            raise ArgumentError("folder", text)
        store.write(folder, jobs[job], {"values": found.value.tolist()})
        progress.jobs(count, len(parts))
    values = np.array(
        [_read(folder, n, (2, len(NUMBERS), *map(len, rest))) for n in range(len(parts))]
    )
    shape = len(axes["axis_ratio"]), len(axes["along"])
    values = np.moveaxis(values.reshape(*shape, *values.shape[1:]), (0, 1), (2, 3))
    linear = [coefficients(each, poisson) for each in axes["axis_ratio"]]
    table = CreepTable(
        poisson=poisson,
        cells=cells,
        axes={name: np.array(axes[name]) for name in AXES},
        kalker=np.array([[each.c11, each.c22, each.c23] for each in linear]).T,
        values=values,
        interpolation=np.zeros(3),
        law=law,
    ).checked()
    table.save(folder / TABLE)
    store.write_whole(folder, folder / ROWS, _text(table).encode())
    said = result_folder.to_json(result_folder.origin() | summary(table))
    store.write_whole(folder, folder / FOUND, said.encode())
    return table


def _read(folder: Path, number: int, shape: tuple[int, ...]) -> Array:
    """Values of a part, of a shape. Raises SceneError for a record that is broken."""
    try:
        values = np.array(store.read(folder, number)["values"], dtype=float)
        if values.shape == shape and bool((np.abs(values) < LARGEST).all()):
            return values
    except (LookupError, TypeError, ValueError):
        pass
    raise store.broken(store.record_path(folder, number))


def _text(table: CreepTable) -> str:
    """Lines of table.csv: a head, then one for each node."""
    names = [*AXES, *NUMBERS, *(f"{name}_error" for name in NUMBERS)]
    places = np.array(list(product(*(table.axes[name] for name in AXES))))
    columns = np.hstack([places, table.values.reshape(6, -1).T])
    lines = (",".join(f"{each:.6g}" for each in row) for row in columns)
    return HEAD.format(**vars(table) | {"law": table.law or "Coulomb"}) + "\n".join(
        [",".join(names), *lines, ""]
    )


def words(found: Mapping[str, Any]) -> list[str]:
    """Lines that say how many cases a table has, and its errors over mu N. found: `summary`."""
    lines = [f"{found['cases']} cases; between them 95 % of places are within, over mu N:"]
    for name, between in found["interpolation_error"].items():
        lines.append(f"  {name:12s} {between:.2%}, grid at most {found['grid_error'][name]:.2%}")
    return lines


def summary(table: CreepTable) -> dict[str, Any]:
    """Entries of summary.json and `railhead table --json`: Poisson's ratio, cells, law, number of
    values on each axis and in all, and the errors over mu N of grid (largest) and of interpolation
    by number.
    """
    axes = {name: len(table.axes[name]) for name in AXES}
    grid = table.values[1].max(axis=(1, 2, 3, 4))
    return {
        "poisson": table.poisson,
        "cells": table.cells,
        "law": table.law,
        "axes": axes,
        "cases": int(np.prod(list(axes.values()))),
        "grid_error": dict(zip(NUMBERS, map(float, grid), strict=True)),
        "interpolation_error": dict(zip(NUMBERS, map(float, table.interpolation), strict=True)),
    }

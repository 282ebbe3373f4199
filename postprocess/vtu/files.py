"""The grids of a result as files for ParaView."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import meshio

from railhead.meshing.tags import other
from railhead.postprocess.findings import Array, Findings
from railhead.postprocess.stress.gauss_points import nodal_stress
from railhead.postprocess.vtu import export
from railhead.postprocess.vtu.mirror import whole_grid
from railhead.solver.fields import Fields
from railhead.solver.solution import FrictionSolution


def write(
    fields: Fields, stress: Array, found: Findings, residual: Fields | None,
    rubbing: FrictionSolution | None, folder: Path, *, whole: bool = False,
) -> None:  # fmt: skip
    """solution.vtu and contact.vtu; with the state after the load residual.vtu and solution.pvd,
    with friction traction.vtu. stress (n, 6): of the fields, as `nodal_stress` reads it; whole:
    with the images of what symmetry left out. OSError."""
    for name, grid in _grids(fields, stress, found, residual, rubbing):
        shown = whole_grid(grid, fields.mirrors) if whole else grid
        export.write(shown, folder / f"{name}.vtu")
    if residual is not None:
        names = {0.0: "solution.vtu", 1.0: "residual.vtu"}
        export.series(names, folder / "solution.pvd")


def _grids(
    fields: Fields,
    stress: Array,
    found: Findings,
    residual: Fields | None,
    rubbing: FrictionSolution | None,
) -> Iterator[tuple[str, meshio.Mesh]]:
    """Grids of all files of a result, each with its file name."""
    surfaces = {fields.slave: found.surface}
    if found.opposite is not None:
        surfaces[other(fields.slave)] = found.opposite
    yield "contact", export.contact_grid(surfaces)
    yield "solution", export.volume_grid(fields, stress)
    if residual is not None:
        yield "residual", export.volume_grid(residual, nodal_stress(residual))
    if rubbing is not None:
        yield "traction", export.traction_points(rubbing)

"""The grids of a result as files for ParaView."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import meshio

from railhead.meshing.bodies import other
from railhead.postprocess import symmetry
from railhead.postprocess.findings import Array, Findings
from railhead.postprocess.stress.gauss_points import nodal_stress
from railhead.postprocess.vtu import export
from railhead.solver.fields import Fields
from railhead.solver.solution import FrictionSolution


def write(
    fields: Fields,
    stress: Array,
    found: Findings,
    residual: Fields | None,
    rubbing: FrictionSolution | None,
    folder: Path,
    *,
    whole: bool = False,
) -> None:
    """Write the .vtu files of one result into a folder.

    solution.vtu holds the cells, contact.vtu the contact surfaces. With friction there is
    traction.vtu. With a state after the load there are residual.vtu, and solution.pvd, which steps
    from the loaded state to it.

    fields: under the load. stress (n, 6): at their nodes, MPa, as `nodal_stress` computes it.
        found: gives the contact surfaces. residual: fields after the load, or None. rubbing:
        solution with friction, or None. whole: whether mirror images of a cut model are added.
        OSError: a file cannot be written.
    """
    for name, grid in _grids(fields, stress, found, residual, rubbing):
        shown = symmetry.grid(grid, fields.mirrors) if whole else grid
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
    """File names without suffix and grids of one result: "contact", "solution", and, if given,
    "residual" and "traction".

    stress (n, 6): at the nodes of the fields, MPa. residual: fields after the load, or None.
        rubbing: solution with friction, or None.
    """
    surfaces = {fields.slave: found.surface}
    if found.opposite is not None:
        surfaces[other(fields.slave)] = found.opposite
    yield "contact", export.contact_grid(surfaces)
    yield "solution", export.volume_grid(fields, stress)
    if residual is not None:
        yield "residual", export.volume_grid(residual, nodal_stress(residual))
    if rubbing is not None:
        yield "traction", export.traction_points(rubbing)

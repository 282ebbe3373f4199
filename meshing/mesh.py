"""From bodies to a dolfinx mesh with tags, checked for bad elements."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import gmsh
import numpy as np
from mpi4py import MPI

from railhead.meshing import blocks, isolated_process
from railhead.meshing.bodies import Body, Options
from railhead.meshing.sizing import Grading

MIN_QUALITY = 0.01
RETRIES = (1.0, 0.95, 0.9)  # of the element size, where gmsh leaves a flat element or gives up
PATIENCE, PACE = 60.0, 1e-3  # s, and s a cell, which usually takes a seventh: gmsh hangs


class MeshError(RuntimeError):
    """gmsh could not mesh the bodies, or made elements that cannot be computed with."""


@dataclass(frozen=True)
class ContactMesh:
    """dolfinx mesh of both bodies; cell tags RAIL, WHEEL; facet tags as in `tags`.

    quality: of the worst cell, see `blocks.qualities`; cells: number of all cells.
    """

    mesh: Any
    cell_tags: Any
    facet_tags: Any
    quality: float
    cells: int


def generate(
    bodies: list[Body],
    grading: Grading,
    options: Options,
    comm: MPI.Intracomm,
    save: Path | None = None,
    meanwhile: Callable[[], object] = lambda: None,
) -> ContactMesh:
    """Mesh on rank 0 and distribute. save: also write the gmsh file (.msh, readable by meshio);
    meanwhile: what every rank does while gmsh works.

    Raises MeshError (on every rank) when gmsh fails or an element is inverted or nearly flat.
    """
    if comm.rank:
        meanwhile()
        from railhead.solver import compat

        _raise_together(comm, None)
        quality, count = comm.bcast(None)
        return ContactMesh(*compat.model_to_mesh(None, comm, options.dim), quality, count)
    seconds = PATIENCE
    if not options.plane:
        hexahedra = options.cell == "hexahedron"
        reach = max(body.reach for body in bodies)
        seconds += PACE * grading.predicted_cells(reach, hexahedra=hexahedra)
    for share in RETRIES:
        finer = replace(grading, size=share * grading.size)
        try:
            found, shapes = isolated_process.run(
                _meshed, bodies, finer, options, save, seconds=seconds, meanwhile=meanwhile
            )
            _check(shapes)
        except isolated_process.IsolatedProcessError as error:
            problem = MeshError(f"gmsh: {error}")
        except MeshError as error:
            problem = error
        else:
            from railhead.solver import compat

            with blocks.restore_model(found) as model:
                _raise_together(comm, None)
                quality, count = comm.bcast((float(shapes.min()), len(shapes)))
                return ContactMesh(*compat.model_to_mesh(model, comm, options.dim), quality, count)
    _raise_together(comm, str(problem))
    raise problem


def _meshed(
    bodies: list[Body], grading: Grading, options: Options, save: Path | None
) -> tuple[blocks.ModelSnapshot, np.ndarray]:
    """The mesh and the quality of its cells."""
    with blocks.model(bodies, grading, options):
        shapes = blocks.qualities(options.dim)
        blocks.undo_stretch(bodies, grading)
        if save is not None:
            gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)  # meshio reads its groups
            gmsh.write(str(save))
        return blocks.snapshot_model(), shapes


def _check(shapes: np.ndarray) -> None:
    bad = int(np.sum(shapes < MIN_QUALITY))
    if bad:
        raise MeshError(
            f"{bad} of {len(shapes)} elements have a quality (scaled Jacobian) below "
            f"{MIN_QUALITY} (smallest {shapes.min():.3g}); try another mesh.patch_size"
        )


def _raise_together(comm: MPI.Intracomm, message: str | None) -> None:
    message = comm.bcast(message)
    if comm.rank and message is not None:
        raise MeshError(message)

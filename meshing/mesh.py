"""From bodies to a dolfinx mesh with tags, checked for bad elements."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gmsh
import numpy as np
from mpi4py import MPI

from meshing import blocks
from meshing.bodies import Body, Options
from meshing.sizing import Grading

MIN_QUALITY = 0.01


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
) -> ContactMesh:
    """Mesh on rank 0 and distribute. save: also write the gmsh file (.msh, readable by meshio).

    Raises MeshError (on every rank) when gmsh fails or an element is inverted or nearly flat.
    """
    from solver import compat

    if comm.rank:
        _raise_together(comm, None)
        quality, count = comm.bcast(None)
        return ContactMesh(*compat.model_to_mesh(None, comm), quality, count)
    try:
        with blocks.model(bodies, grading, options) as model:
            shapes = blocks.qualities()
            _check(shapes)
            if save is not None:
                gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)  # meshio reads it with its groups
                gmsh.write(str(save))
            _raise_together(comm, None)
            quality, count = comm.bcast((float(shapes.min()), len(shapes)))
            return ContactMesh(*compat.model_to_mesh(model, comm), quality, count)
    except MeshError as error:
        _raise_together(comm, str(error))
        raise
    except Exception as error:  # gmsh raises bare Exception
        _raise_together(comm, str(error))
        raise MeshError(f"gmsh: {error}") from error


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

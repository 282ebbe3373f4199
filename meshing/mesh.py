"""From bodies to a dolfinx mesh with tags, checked for bad elements."""

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from mpi4py import MPI

from railhead.meshing import blocks, isolated_process
from railhead.meshing.bodies import Body, Options
from railhead.meshing.grading import Grading

MIN_QUALITY = 0.01
RETRIES = (1.0, 0.95, 0.9)  # of the element size, where gmsh leaves a flat element or gives up
FAR_POWER = 4  # of these of the largest elements, as flat ones lie on fillets far from the patch
PATIENCE, PACE = 60.0, 1e-3  # s, and s a predicted cell, of which gmsh usually takes a seventh;
# beyond them it hangs


class MeshError(RuntimeError):
    """Raised where gmsh cannot mesh the bodies, or makes elements that are inverted or nearly
    flat.
    """


@dataclass(frozen=True)
class ContactMesh:
    """Mesh of the bodies that deform, distributed over all ranks.

    mesh: dolfinx mesh, mm, of the meshed part; coordinates x, y, z, or the two of a section.
    cell_tags: dolfinx MeshTags of the cells, RAIL or WHEEL.
    facet_tags: dolfinx MeshTags of the contact, support and symmetry facets, numbers as in
        `meshing.bodies`.
    quality: quality of the worst cell of all ranks, 1 ideal, 0 flat, see `blocks.qualities`. It is
        taken as gmsh made the cells, where x is divided by `Grading.stretch`; the final cells are
        longer along the rail by that factor.
    cells: number of cells of all ranks.
    share: size of the elements over that of the grading; below 1 where gmsh failed at first.
    """

    mesh: Any
    cell_tags: Any
    facet_tags: Any
    quality: float
    cells: int
    share: float


def generate(
    bodies: list[Body],
    grading: Grading,
    options: Options,
    comm: MPI.Intracomm,
    meanwhile: Callable[[], object] = lambda: None,
) -> ContactMesh:
    """Mesh the bodies with gmsh on rank 0 and distribute the mesh (collective).

    bodies: what is meshed.
    grading: element size; where gmsh fails, it is tried again with 0.95 and then 0.9 of `size`, and
        with 0.81 and 0.66 of `coarsest`.
    options: type of the cells, degree, symmetry, plane.
    comm: communicator of the mesh. Cells are distributed, gmsh runs on its rank 0 alone.
    meanwhile: what every rank calls while gmsh works; rank 0 calls it again with each new trial.
    Raises MeshError on every rank when in the last trial gmsh fails or takes too long, or an
    element is inverted or nearly flat. Too long is 60 s (PATIENCE), for solids plus 1 ms (PACE) a
    predicted cell.
    """
    found, shapes, problem, share = None, np.zeros(0), "", 1.0
    if comm.rank:
        meanwhile()
    else:
        seconds = PATIENCE
        if not options.plane:
            hexahedra = options.cell == "hexahedron"
            reach = max(body.reach for body in bodies)
            seconds += PACE * grading.predicted_cells(reach, hexahedra=hexahedra)
        for share in RETRIES:
            coarsest = share**FAR_POWER * grading.coarsest
            finer = replace(grading, size=share * grading.size, coarsest=coarsest)
            try:
                found, shapes = isolated_process.run(
                    _meshed, bodies, finer, options, seconds=seconds, meanwhile=meanwhile
                )
                problem = _bad_elements(shapes)
            except isolated_process.IsolatedProcessError as error:
                problem = f"gmsh: {error}"
            if not problem:
                break
    shape = float(shapes.min(initial=1.0)), len(shapes)
    problem, (quality, count), share = comm.bcast((problem, shape, share))
    if problem:
        raise MeshError(problem)
    from railhead.solver import compat

    with blocks.restore_model(found) if found else nullcontext() as model:
        return ContactMesh(*compat.model_to_mesh(model, comm, options.dim), quality, count, share)


def _meshed(
    bodies: list[Body], grading: Grading, options: Options
) -> tuple[blocks.ModelSnapshot, np.ndarray]:
    """Mesh the bodies with gmsh in this process; returns a snapshot of the gmsh model and the
    quality (m,) of its cells.

    The quality is that of the stretched mesh, before its elements get their true length.
    """
    with blocks.model(bodies, grading, options):
        shapes = blocks.qualities(options.dim)
        blocks.undo_stretch(bodies, grading)
        return blocks.snapshot_model(), shapes


def _bad_elements(shapes: np.ndarray) -> str:
    """Message that some cells have a quality below 0.01 (`MIN_QUALITY`); '' where none has. shapes:
    quality of the cells (m,).
    """
    bad = int(np.sum(shapes < MIN_QUALITY))
    if not bad:
        return ""
    return (
        f"{bad} of {len(shapes)} elements have a quality (scaled Jacobian) below "
        f"{MIN_QUALITY} (smallest {shapes.min():.3g}); try another mesh.patch_size"
    )

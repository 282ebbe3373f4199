"""What differs between dolfinx versions (0.5.2, 0.9, 0.11), and safe use of their disk cache.

No other module asks for a version. Tested with those of Debian 12, Debian 13 and sid.

Compiled forms are cached: ffcx takes the C file NAME.c for a lock, which NAME.c.cached releases,
and gives up after ten seconds. A process that is killed while it compiles leaves that lock, and a
library that is cut ends the process that loads it. The lock of this module is released by the
system whatever ends a process. So the process that holds it knows that no other one of this program
compiles, and removes the files of each form that is not as it was finished.
"""

import errno
import fcntl
import logging
import os
import re
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from operator import attrgetter
from pathlib import Path
from typing import Any

import cffi  # type: ignore[import-untyped]
import dolfinx
import numpy as np
import ufl
from dolfinx import fem, jit
from dolfinx import mesh as dmesh
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

VERSION = tuple(int(part) for part in dolfinx.__version__.split(".")[:2])
_OLD = VERSION < (0, 8)
LOCK, FINISHED = "railhead.lock", "railhead.forms"


def model_to_mesh(model: Any, comm: MPI.Comm, dim: int = 3) -> tuple[Any, Any, Any]:
    """Distributed dolfinx mesh, MeshTags of its cells and MeshTags of its facets, from a gmsh model
    on rank 0 (collective).

    model: gmsh model with physical groups; None on the other ranks.
    dim: number of coordinates of the mesh.
    """
    if VERSION < (0, 10):
        from dolfinx.io import gmshio

        return gmshio.model_to_mesh(model, comm, 0, gdim=dim)[:3]
    from dolfinx.io import gmsh as gmsh_io

    data = gmsh_io.model_to_mesh(model, comm, 0, gdim=dim)
    return data.mesh, data.cell_tags, data.facet_tags


@contextmanager
def alone(comm: MPI.Comm, folder: Path) -> Iterator[None]:
    """Context in which no other process of this program compiles into a cache folder; other
    processes wait. Forms there that are not finished, or whose files are not those that were
    compiled, are removed.

    comm: ranks that compile together; only rank 0 takes the lock. folder: cache folder.
    An OSError on rank 0 is raised on all ranks, another error where it arises (collective). A C
    compiler that fails or is missing is an OSError, too, with the first error that it printed.
    Without write access to the folder nothing is locked. Any error on rank 0 is then replaced by
    the OSError of the refused access, on all ranks.
    dolfinx 0.5 and setuptools log each form at INFO; such messages are suppressed in the context.
    """
    disabled = logging.root.manager.disable
    with ExitStack() as held:
        held.callback(logging.disable, disabled)
        logging.disable(max(disabled, logging.INFO))
        refused: OSError | None = None
        if comm.rank == 0:
            try:
                folder.mkdir(parents=True, exist_ok=True)
                fcntl.flock(held.enter_context(open(folder / LOCK, "w")), fcntl.LOCK_EX)
                record = held.enter_context(open(folder / FINISHED, "a+b", buffering=0))
                record.seek(0)
                finished = set(record.read().decode(errors="replace").splitlines())
                for name, line in _cached(folder).items():
                    if line not in finished:
                        for path in folder.glob(f"{name}.*"):
                            path.unlink(missing_ok=True)
            except OSError as error:
                refused = error
        problem: Exception | None = None
        try:
            with _compiler_messages(folder):
                yield
        except Exception as error:
            problem = error
        # Of several ranks dolfinx tells a RuntimeError only.
        cause = problem if isinstance(problem, OSError) else problem and refused
        if problem := comm.bcast(cause) or problem:
            raise problem
        if comm.rank == 0 and not refused:
            with suppress(OSError):  # a full disk: they are compiled again
                new = set(_cached(folder).values()) - finished
                record.write("".join(f"{line}\n" for line in sorted(new)).encode())


def _cached(folder: Path) -> dict[str, str]:
    """Names and sizes of the files of each compiled form in a cache folder, as a line of text, by
    the form's name.
    """
    lines: dict[str, str] = {}
    with os.scandir(folder) as files:
        for file in sorted(files, key=attrgetter("name")):
            name = file.name.partition(".")[0]
            if name.startswith("libffcx_"):
                lines[name] = f"{lines.get(name, '')} {file.name} {file.stat().st_size}"
    return lines


@contextmanager
def _compiler_messages(folder: Path) -> Iterator[None]:
    """Context in which nothing is printed on standard error. OSError, with the cache folder as its
    file: the C compiler fails, of which the first error is told; nothing can be written; or a
    library cannot be loaded.
    """
    with os.fdopen(os.memfd_create("messages"), "r+", errors="replace") as kept:
        printed = os.dup(2)
        os.dup2(kept.fileno(), 2)
        try:
            yield
        except OSError as error:
            error.filename = error.filename or str(folder)
            raise
        except (cffi.VerificationError, ImportError, RuntimeError) as error:
            kept.seek(0)
            found = re.search("(?im)^.*(?:error|failed).*$", kept.read())
            text = f"no form can be compiled: {found[0] if found else error}"
            raise OSError(errno.EIO, text, str(folder)) from None
        finally:
            os.dup2(printed, 2)
            os.close(printed)


@contextmanager
def _compiling(mesh: Any, **options: Any) -> Iterator[dict[str, Any]]:
    """Context in which no other process of this program compiles forms and elements; yields
    keywords for dolfinx.

    mesh: mesh whose ranks compile together. options: options of the compiler.
    The cache folder is this program's own, because only its processes respect the lock and expect
    that unfinished files are removed.
    """
    chosen = jit.get_parameters() if _OLD else jit.get_options()
    folder = Path(chosen["cache_dir"]) / "railhead"
    with alone(mesh.comm, folder):
        yield {"jit_params" if _OLD else "jit_options": {"cache_dir": folder, **options}}


def vector_space(mesh: Any, degree: int) -> Any:
    """Continuous Lagrange space of vectors with as many components as the mesh has coordinates;
    degree: polynomial degree.
    """
    kind = ("Lagrange", degree, (mesh.geometry.dim,))
    if _OLD:
        kind = ufl.VectorElement("Lagrange", mesh.ufl_cell(), degree)
    return _space(mesh, kind)


def tensor_space(mesh: Any, degree: int) -> Any:
    """Space of tensors (3, 3) that jump between cells; degree: polynomial degree in each cell."""
    kind: Any = ("DG", degree, (3, 3))
    if _OLD:
        family = "DQ" if cell_type(mesh) in ("quadrilateral", "hexahedron") else "DG"
        kind = ufl.TensorElement(family, mesh.ufl_cell(), degree, shape=(3, 3))
    return _space(mesh, kind)


def _space(mesh: Any, kind: Any) -> Any:
    """dolfinx function space on a mesh; kind: a UFL element, or (family, degree) and for vectors
    the shape.
    """
    if VERSION >= (0, 11):
        return fem.functionspace(mesh, kind)  # which compiles nothing
    with _compiling(mesh) as how:
        return (fem.FunctionSpace if _OLD else fem.functionspace)(mesh, kind, **how)


def cellwise_constant(mesh: Any, values: NDArray[np.float64]) -> Any:
    """dolfinx function that is constant in each cell; values: (cells,) of all local cells, ghosts
    included.
    """
    space = _space(mesh, ("DG", 0))
    function = fem.Function(space)
    function.x.array[_table(space.dofmap.list, len(values)).ravel()] = values
    return function


def form(expression: ufl.Form, mesh: Any) -> Any:
    """Compile a UFL form on a mesh with -O3 -march=native; returns the dolfinx form."""
    with _compiling(mesh, cffi_extra_compile_args=["-O3", "-march=native"]) as how:
        return fem.form(expression, **how)


def expression(value: Any, points: NDArray[np.float64], mesh: Any) -> Any:
    """Compile a UFL expression at reference points (g, c) of the cells of a mesh."""
    with _compiling(mesh) as how:
        return fem.Expression(value, points, **how)


def evaluated(made: Any, mesh: Any, cells: NDArray[Any]) -> NDArray[np.float64]:
    """Values of a compiled expression (m, g values) in local cells of its mesh (m,)."""
    cells = cells.astype(np.int32)
    return np.asarray(made.eval(cells) if _OLD else made.eval(mesh, cells)).reshape(len(cells), -1)


def collect(comm: MPI.Comm) -> None:
    """Free PETSc objects that Python no longer refers to (collective). PETSc 3.18 keeps them until
    this is called."""
    if hasattr(PETSc, "garbage_cleanup"):
        PETSc.garbage_cleanup(comm)


def _table(table: Any, rows: int) -> NDArray[np.int32]:
    """An adjacency list of equal rows, or an array, as an array (rows, entries of a row)."""
    array = np.asarray(table.array if hasattr(table, "array") else table, dtype=np.int32)
    return array.reshape(-1, array.size // max(rows, 1))


def cell_nodes(mesh: Any) -> NDArray[np.int32]:
    """Local numbers (cells, nodes) of the geometry nodes of every local cell, ghosts included, in
    basix order.
    """
    geometry = mesh.geometry
    table = geometry.dofmaps[0] if hasattr(geometry, "dofmaps") else geometry.dofmap
    cells = mesh.topology.index_map(mesh.topology.dim)
    return _table(table, cells.size_local + cells.num_ghosts)


def cell_dofs(space: Any) -> NDArray[np.int32]:
    """Local numbers (cells, dofs) of the block dofs of every local cell, ghosts included, in basix
    order.
    """
    cells = space.mesh.topology.index_map(space.mesh.topology.dim)
    return _table(space.dofmap.list, cells.size_local + cells.num_ghosts)


def cell_type(mesh: Any) -> str:
    """Type of the cells of a mesh: 'tetrahedron', 'hexahedron', 'triangle' or 'quadrilateral'."""
    kind = mesh.topology.cell_type
    return str(dmesh.to_string(kind)) if hasattr(dmesh, "to_string") else str(kind.name)


def cells_mesh(
    comm: MPI.Comm, cells: NDArray, points: NDArray[np.float64], cell: str, degree: int = 1
) -> Any:
    """dolfinx mesh of cells.

    comm: communicator of the mesh.
    cells: (m, k) nodes of each cell as row numbers of `points`, in basix order.
    points: (n, d), mm.
    cell: 'tetrahedron', 'hexahedron', 'triangle' or 'quadrilateral'.
    degree: of the map from the reference cell; 1: straight cells.
    """
    cells, dim = cells.astype(np.int64), points.shape[1]
    if _OLD:
        domain = ufl.Mesh(ufl.VectorElement("Lagrange", ufl.Cell(cell, dim), degree))
        return dmesh.create_mesh(comm, cells, points, domain)
    from basix.ufl import element

    domain = ufl.Mesh(element("Lagrange", cell, degree, shape=(dim,)))
    return dmesh.create_mesh(comm, cells, x=points, e=domain)


def node_points(mesh: Any) -> NDArray[np.float64]:
    """Coordinates (n, d) of the local geometry nodes, ghosts included, mm; d is the number of
    coordinates of the mesh.
    """
    return np.asarray(mesh.geometry.x[:, : mesh.geometry.dim])


def interpolation(coarse: Any, fine: Any) -> PETSc.Mat:
    """PETSc matrix that interpolates functions of one space (coarse) into another (fine) on the
    same mesh.
    """
    if VERSION < (0, 9):
        matrix = dolfinx.cpp.fem.petsc.interpolation_matrix(coarse._cpp_object, fine._cpp_object)
    else:
        matrix = fem.petsc.interpolation_matrix(coarse, fine)
    matrix.assemble()
    return matrix


def function(space: Any, values: PETSc.Vec) -> Any:
    """dolfinx function of a space from the values of the dofs that this process owns; ghosts are
    updated (collective).
    """
    made = fem.Function(space)
    made.x.array[: values.getLocalSize()] = values.array
    made.x.scatter_forward()
    return made


def dof_points(space: Any) -> NDArray[np.float64]:
    """Coordinates (n, d) of the block dofs that this process owns, without ghosts, mm; d is the
    number of coordinates of the mesh.
    """
    owned = space.dofmap.index_map.size_local
    return np.asarray(space.tabulate_dof_coordinates()[:owned, : space.mesh.geometry.dim])


def geometry_degree(mesh: Any) -> int:
    """Polynomial degree of the map from the reference cell to the cells of a dolfinx mesh; 1 where
    cells are straight.
    """
    geometry = mesh.geometry
    cmap = geometry.cmaps[0] if hasattr(geometry, "cmaps") else geometry.cmap
    degree = cmap.degree
    return int(degree() if callable(degree) else degree)

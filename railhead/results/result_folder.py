"""The result folder: complete or not there at all."""

from __future__ import annotations

import fcntl
import glob
import json
import os
import shutil
import tempfile
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import psutil

from railhead.results import quantity_rows, table_file
from railhead.run import process
from railhead.scene.io import to_toml
from railhead.scene.scene import SceneError

if TYPE_CHECKING:
    import meshio

    from railhead.postprocess.findings import Array, Findings
    from railhead.postprocess.plots.gallery import Drawing
    from railhead.results.result import Result

Page = Callable[[Path, "Findings | None", "tuple[meshio.Mesh, meshio.Mesh] | None"], None]
SUMMARY = "summary.json"
TABLE = "result.csv"
MANIFEST = ".railhead"  # names of the files in a result folder that are replaced by the next one


def foreign(folder: Path) -> list[str]:
    """Sorted names of the files in a folder that no result wrote."""
    names, own = set(os.listdir(folder)), {MANIFEST}
    if MANIFEST in names:
        text = (folder / MANIFEST).read_text(encoding="utf-8", errors="replace")
        own |= set(text.splitlines())
    return sorted(names - own)


def check_folder(folder: Path, keeps: Collection[str] = ()) -> None:
    """Raise SceneError if results cannot be written to `folder`; called before anything is
    computed.

    A result replaces an earlier one as a whole. The folder must be new, empty, or hold only files
    of a result and those named in `keeps`. A link to a folder is followed.
    """
    try:
        problem = _obstacle(folder, keeps)
    except OSError as error:
        problem = f"{str(folder)!r}: {error.strerror}"
    except ValueError as error:  # a null character
        problem = f"{str(folder)!r}: {error}"
    if problem:
        raise SceneError("--out", f"{problem}; give another folder")


def _obstacle(folder: Path, keeps: Collection[str]) -> str:
    """Reason why results cannot be written to a folder; empty if they can. keeps: names of files
    that are allowed there.
    """
    name = repr(str(folder))
    with suppress(FileNotFoundError, NotADirectoryError):
        (folder.parent / (_prefix(folder) + 16 * "x")).lstat()  # raises if the name is too long
    if folder.is_symlink() and not folder.exists():
        return f"{name} is a link to nothing"
    if folder.exists() and not folder.is_dir():
        return f"{name} is a file"
    target = folder.resolve()
    parent = target.parent
    while not parent.exists():
        parent = parent.parent
    if not parent.is_dir() or not os.access(parent, os.W_OK):
        return f"{str(parent)!r} cannot be written to"
    if target.parent.is_dir() and process.rank() == 0:
        settle(target)
    if folder.is_dir():
        if folder.samefile(os.curdir) or os.path.ismount(folder):
            kind = "a mount point" if os.path.ismount(folder) else "the working directory"
            return f"{name} is {kind}, which cannot be replaced"
        if others := [other for other in foreign(folder) if other not in keeps]:
            return f"{name} holds {others[0]!r}, which is no result"
    return ""


@contextmanager
def replacing(folder: Path, later: Collection[str] = ()) -> Iterator[Path]:
    """A temporary folder that replaces `folder` when the block ends without an error. later: names
    of files that are written into `folder` afterwards and belong to the result, too.

    The earlier result is renamed to `.NAME.earlier`, then the new one to its name. Whenever the
    process is killed, one of both is complete; `settle` finishes the exchange. Files that others
    put into `folder` are kept. Of two results written at once, the later one remains. OSError: the
    files cannot be written.
    """
    folder = folder.resolve()
    folder.parent.mkdir(parents=True, exist_ok=True)
    work = _temporary(folder)
    try:
        yield work
        names = "".join(f"{name}\n" for name in sorted({*os.listdir(work), *later}))
        (work / MANIFEST).write_text(names, encoding="utf-8")
        work.chmod(0o755)
        with _locked(folder.parent):
            _settle(folder)
            try:
                if folder.is_dir():
                    os.rename(folder, _earlier(folder))
                os.rename(work, folder)
            finally:
                _settle(folder)
    except OSError as error:
        error.filename = error.filename or str(folder)  # a full disk names none
        raise
    finally:
        shutil.rmtree(work, ignore_errors=True)


def settle(folder: Path) -> None:
    """Finish the exchange of folders after a process that was killed in `replacing`, and remove its
    temporary folders. OSError: a folder cannot be changed.
    """
    with _locked(folder.parent):
        _settle(folder)
        for work in folder.parent.glob(glob.escape(_prefix(folder)) + "*"):
            process_id = work.name.removeprefix(_prefix(folder)).partition(".")[0]
            if process_id.isdecimal() and not psutil.pid_exists(int(process_id)):
                shutil.rmtree(work, ignore_errors=True)


def _settle(folder: Path) -> None:
    """Finish the exchange of folders: restore the earlier result, or move foreign files from it to
    the new one and remove it. The parent folder must be locked.
    """
    earlier = _earlier(folder)
    if not earlier.is_dir():
        return
    if not folder.exists():
        os.rename(earlier, folder)
        return
    for name in foreign(earlier):
        os.rename(earlier / name, folder / name)
    doomed = _temporary(folder)
    os.rename(earlier, doomed)  # half of it must not be taken for files of others
    shutil.rmtree(doomed, ignore_errors=True)


def _earlier(folder: Path) -> Path:
    """Path of the earlier result during an exchange of folders."""
    return folder.parent / f".{folder.name}.earlier"


def _prefix(folder: Path) -> str:
    """Beginning of the names of temporary folders that processes of this machine make for a result
    folder.
    """
    return f".{folder.name}.{os.uname().nodename}."


def _temporary(folder: Path) -> Path:
    """Path of a new temporary folder beside a result folder, named after this process."""
    return Path(tempfile.mkdtemp(prefix=f"{_prefix(folder)}{os.getpid()}.", dir=folder.parent))


@contextmanager
def _locked(parent: Path) -> Iterator[None]:
    """Lock a folder against exchanges by other processes for the block. The system releases the
    lock when the process ends.
    """
    handle = os.open(parent, os.O_RDONLY)
    try:
        with suppress(OSError):  # a disk that knows no locks
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def write_grids(result: Result, folder: Path, *, whole: bool = False) -> Array | None:
    """Write the files for ParaView into a folder; returns the stresses at the nodes (n, 6), columns
    xx, yy, zz, xy, xz, yz, MPa. None, and no files, where nothing touches. whole: with the
    mirror images of what symmetry left out.
    """
    from railhead.postprocess.stress import gauss_points
    from railhead.postprocess.vtu import files

    found, fields = result.findings, result.fields
    if fields is None or found is None:
        return None
    residual = result.mesh_solution.unloaded_fields
    stresses, rubbing = gauss_points.nodal_stress(fields), result.mesh_solution.solution.friction
    files.write(fields, stresses, found, residual, rubbing, folder, whole=whole)
    return stresses


def write(
    result: Result, folder: Path, *, pictures: bool, page: Page | None = None, whole: bool = False
) -> None:
    """Write all files of a result into its folder: numbers first, then what shows them.

    pictures: whether PNG files are written.
    page: writes further files, called with folder, findings and grids; None: none.
    whole: whether the files for ParaView contain the mirror images of what symmetry left out.
    OSError: the numbers cannot be written; or, a line for each, other files that could not be
        written, after all the others are.
    """
    failures: list[str] = []
    with replacing(folder) as work:
        (work / "scene.toml").write_text(to_toml(result.plan.scene), encoding="utf-8")
        (work / SUMMARY).write_text(as_json(result), encoding="utf-8")
        table = quantity_rows.everything(result.summary)
        (work / TABLE).write_bytes(table_file.encoded(table))
        attempt = partial(_attempt, folder, work, failures)
        stresses: Array | None = None
        grids: tuple[meshio.Mesh, meshio.Mesh] | None = None
        found = _titled(result)
        with attempt("*.vtu"):
            stresses = write_grids(result, work, whole=whole)
        if pictures and found is not None and stresses is not None:
            with attempt("*.png"):
                grids, drawings = _drawings(result, found, stresses)
                for name, draw in drawings.items():
                    with attempt(name):
                        draw(work / name)
        if page is not None:
            with attempt("report.html"):
                page(work, found, grids)
    if failures:
        raise OSError("\n".join(failures))


@contextmanager
def _attempt(folder: Path, work: Path, failures: list[str], name: str) -> Iterator[None]:
    """Catch an error of the block, remove the files that the block began in `work`, and add a line
    to `failures`. folder, name: of what is written, for that line.
    """
    before = set(work.iterdir())
    try:
        yield
    except Exception as error:  # of matplotlib, VTK or the disk: the numbers are worth having
        for path in set(work.iterdir()) - before:
            path.unlink()
        failures.append(f"{folder / name}: {' '.join(f'{type(error).__name__}: {error}'.split())}")


def _titled(result: Result) -> Findings | None:
    """Findings of a result with the title and notes of its pictures; None where nothing touches."""
    from railhead.results.subject import subject

    if result.findings is None:
        return None
    after = result.mesh_solution.after.items()
    needed = tuple(f"{name.replace('_', ' ')}: {each.why}" for name, each in after if each.needed)
    return replace(result.findings, notes=needed, subject=subject(result.plan, result.load))


def _drawings(
    result: Result, found: Findings, stresses: Array
) -> tuple[tuple[meshio.Mesh, meshio.Mesh], dict[str, Drawing]]:
    """Grids of the cells and of the slave's contact surface, and the pictures by file name.
    stresses (n, 6): at the nodes, MPa.
    """
    from railhead.postprocess.plots import gallery, plastic_plots, shakedown, traction_plots
    from railhead.postprocess.vtu import export

    fields, solved, plan = result.fields, result.mesh_solution, result.plan
    assert fields is not None
    poisson = plan.reported_body.poisson_ratio
    volume, contact = (
        export.volume_grid(fields, stresses),
        export.contact_grid({fields.slave: found.surface}),
    )
    grids = volume, contact
    every = gallery.drawings(fields, stresses, grids, found, result.ellipse, poisson)
    residual, elastic = solved.unloaded_fields, solved.elastic_reference
    if residual is not None and elastic is not None and elastic.findings:
        exact = result.ellipse if len(found.patch.each) < 2 else None
        every["plastic.png"] = partial(
            plastic_plots.draw, fields, residual, found, elastic.findings, exact
        )
    if (rubbing := solved.solution.friction) is not None:
        coefficient, friction = (
            plan.scene.friction.coefficient,
            result.summary["result"]["friction"],
        )
        every["friction.png"] = partial(
            traction_plots.draw, rubbing, found, coefficient, mirrored=plan.half_y
        )
        if "p0_over_k" in friction:
            every["shakedown.png"] = partial(
                shakedown.draw, friction, poisson, title=found.subject.title
            )
    return grids, every


def as_json(result: Result) -> str:
    """summary.json of a solved scene as text."""
    return to_json(result.summary)


def to_json(summary: dict[str, Any]) -> str:
    """JSON text of plain data; infinite numbers are written as "inf" and "-inf"."""
    return json.dumps(_plain(summary), indent=2, allow_nan=False) + "\n"


def _plain(value: object) -> object:
    """Plain data with tuples as lists and infinite numbers as words."""
    if isinstance(value, dict):
        return {key: _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    if isinstance(value, float) and value in (float("inf"), float("-inf")):
        return "inf" if value > 0 else "-inf"
    return value

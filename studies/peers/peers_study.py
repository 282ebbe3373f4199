"""hertz_ellipse by other codes and by this one: errors against exact Hertz, time and memory."""

import json
import shutil
import sys
import tempfile
import venv
from collections.abc import Iterator, Mapping, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import Any

from railhead.run.progress import Progress
from railhead.scene import catalogue
from studies import processes, tables
from studies.peers import block_meshes, peers_page
from studies.peers.codes import Peer, peers
from studies.peers.peers_page import OURS, TRAVEL

CASE = "hertz_ellipse"
VENV = Path("results") / "peers" / "venv"
KEEPS = (VENV.name,)
OWN_RUNS: dict[str, list[str]] = {
    "default": [],
    "--accuracy 1%": ["--accuracy", "1%"],
    "--accuracy 0.1%": ["--accuracy", "0.1%"],
}
REPEATS = 3  # of ours
COARSE = {"coarse": ["--set", "mesh.patch_size=1.2"]}  # quick
CHILD = Path(__file__).with_name("child.py")
DEBIAN_PYTHON = "/usr/bin/python3"
APT = "apt-get install -q -y --no-install-recommends"
Mesh = tuple[str, float]  # cell, and size in mm


def install() -> None:
    """Install what each code needs: Debian's packages by apt-get, others by pip in VENV. What fails
    is said, and the others follow."""
    if not (VENV / "bin" / "python").exists():
        venv.create(VENV, with_pip=True)
    with Progress(quiet=False) as progress:
        for peer in peers():
            progress.stage(f"installing {peer.TITLE}")
            command = [python(peer), "-m", "pip", "install", "-q", *peer.PIP]
            if peer.DEBIAN:
                names = " ".join(peer.DEBIAN)
                command = ["sh", "-c", f"dpkg -s {names} || (apt-get update -q && {APT} {names})"]
            try:
                processes.run(command, VENV)
            except processes.FailedError as error:
                print(f"railhead: not installed: {peer.TITLE}: {error}", file=sys.stderr)


def python(peer: Peer) -> str:
    """Path of the Python in which a code runs."""
    return DEBIAN_PYTHON if peer.DEBIAN else str(VENV.absolute() / "bin" / "python")


def install_command(peer: Peer) -> str:
    """The command that installs a code by hand."""
    program = "apt-get" if peer.DEBIAN else "pip"
    return f"{program} install {' '.join(peer.DEBIAN or peer.PIP)}"


def main(out: Path, *, quick: bool) -> None:
    """Run every code that is installed (quick: its coarsest mesh, and ours on a coarse one); CSV,
    picture, page."""
    versions: dict[str, str] = {}
    absent: dict[str, str] = {}
    known = peers()
    with Progress(quiet=False) as progress, tempfile.TemporaryDirectory(prefix="peers.") as work:
        for peer in known:
            progress.stage(f"{peer.TITLE}: version")
            try:
                versions[peer.TITLE] = version(peer, Path(work))
            except processes.FailedError as error:
                absent[peer.TITLE] = str(error)
        present = [peer for peer in known if peer.TITLE in versions]
        runs = list(measured(present, Path(work), progress, quick=quick))
    peers_page.draw(runs, out / "peers.png")
    tables.publish(
        out, peers_page.page(runs, present, versions, absent), peers_page.UNITS, peers=runs
    )


def measured(
    present: Sequence[Peer], work: Path, progress: Progress, *, quick: bool
) -> Iterator[tables.Row]:
    """One process at a time: of every code its coarsest run, ours, every second run, ours, ...
    so that what else the machine does meets all of them."""
    case = _case()
    lists = [list(peer.RUNS.items())[: 1 if quick else None] for peer in present]
    runs = [run for own in lists for _, run in own if "mesh" in run]
    meshes: set[Mesh] = {tuple(run["mesh"]) for run in runs}
    files = {(cell, size): work / f"{cell}_{size}.npz" for cell, size in sorted(meshes)}
    for (cell, size), file in files.items():
        progress.stage(f"meshing: {cell}, {size:g} mm")
        block_meshes.write(file, case, cell, size)
    own = [COARSE] if quick else [OWN_RUNS] * REPEATS
    for theirs, ours in zip_longest(zip_longest(*lists), own, fillvalue=()):
        for peer, chosen in zip(present, theirs, strict=False):
            if chosen is not None:
                setting, run = chosen
                progress.stage(f"{peer.TITLE}: {setting}")
                yield solve(peer, setting, run, case, files, work)
        for setting, options in dict(ours).items():
            progress.stage(f"{OURS}: {setting}")
            yield _own(setting, options, work)


def version(peer: Peer, work: Path) -> str:
    """Version of an installed code. Raises FailedError, with the reason, where there is none."""
    try:
        if not Path(python(peer)).exists():
            raise processes.FailedError("not installed")
        return str(_asked(peer, None, work)[0])
    except processes.FailedError as error:
        raise processes.FailedError(f"{error} ({install_command(peer)})") from None


def _case() -> dict[str, Any]:
    """What `solve` is told of the case, in N, mm and MPa."""
    scene = catalogue.find(CASE)
    return {
        "load": scene.load,
        "travel": TRAVEL,
        "rail_radius": scene.rail.crown_radius,
        "wheel_radius": scene.wheel.rolling_radius,
        "young": scene.rail.young_modulus,
        "poisson": scene.rail.poisson_ratio,
    }


def solve(
    peer: Peer,
    setting: str,
    run: Mapping[str, Any],
    case: Mapping[str, float],
    files: Mapping[Mesh, Path],
    work: Path,
) -> tables.Row:
    """One run of a code, with its costs and errors, or why there are none."""
    head = peer.TITLE, peer.METHOD, setting
    options = {key: value for key, value in run.items() if key != "mesh"}
    mesh = str(files[tuple(run["mesh"])]) if "mesh" in run else None
    try:
        found, cost = _asked(peer, {"case": case, "mesh": mesh, "run": options}, work)
        return peers_page.row(*head, cost | peers_page.read(case, found))
    except (processes.FailedError, ValueError) as error:
        return peers_page.row(*head, {}, str(error))


def _asked(peer: Peer, job: Mapping[str, Any] | None, work: Path) -> tuple[Any, processes.Cost]:
    """What a code answers to a job (None: its version), run in a process of its own in an empty
    folder, and the cost of that process. Raises FailedError as `processes.run` does."""
    with tempfile.TemporaryDirectory(dir=work) as empty:
        folder = Path(empty)
        (folder / "job.json").write_text(json.dumps(job), encoding="utf-8")
        command = [python(peer), "-P", str(CHILD), str(peer.__file__), "job.json"]
        cost = processes.run(command, folder)
        return json.loads((folder / "found.json").read_text(encoding="utf-8")), cost


def _own(setting: str, options: Sequence[str], work: Path) -> tables.Row:
    """Row of `railhead run hertz_ellipse --no-pictures` with further options, as a person starts
    it."""
    head = OURS, "finite elements", setting
    start = [sys.executable, "-c", "from railhead.cli import main; main()"]
    command = [*start, "run", CASE, "--no-pictures", "--out", "own", *options]
    try:
        cost = processes.run(command, work)
        summary = json.loads((work / "own" / "summary.json").read_text(encoding="utf-8"))
        return peers_page.row(*head, cost | peers_page.read_own(summary))
    except processes.FailedError as error:
        return peers_page.row(*head, {}, str(error))
    finally:
        shutil.rmtree(work / "own", ignore_errors=True)

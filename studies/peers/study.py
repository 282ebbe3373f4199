"""hertz_ellipse by other codes and by this one: errors against exact Hertz, time and memory."""

from __future__ import annotations

import json
import shutil
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import zip_longest
from pathlib import Path
from typing import Any

from railhead.run.progress import Progress
from studies.peers import blocks
from studies.peers import install as installing
from studies.peers.codes import Peer, peers
from studies.peers.page import OURS, TRAVEL, draw
from studies.peers.page import page as page_of
from studies.peers.process import running
from studies.peers.reading import UNITS, Run, fitted_run, own_run
from studies.tables import write_csv

CASE = "hertz_ellipse"
VENV = Path("results") / "peers" / "venv"
KEEPS = (VENV.name,)
OWN_RUNS: dict[str, list[str]] = {
    "default": [],
    "--accuracy 1%": ["--accuracy", "1%"],
    "--accuracy 0.1%": ["--accuracy", "0.1%"],
}
REPEATS = 3  # of ours
COARSE = ["--set", "mesh.patch_size=1.2"]  # quick
CHILD = running.ACCOUNT.with_name("child.py")


def install() -> None:
    """Install all codes, those from PyPI in VENV; what fails is said and left out."""
    with Progress(quiet=False) as progress:
        installing.install(peers(), VENV, progress)


def main(out: Path, *, quick: bool) -> None:
    """Run every code that is installed (quick: its coarsest mesh, and ours on a coarse one); CSV,
    picture, page."""
    versions: dict[str, str] = {}
    absent: dict[str, str] = {}
    present: list[Peer] = []
    with Progress(quiet=False) as progress, tempfile.TemporaryDirectory(prefix="peers.") as work:
        for peer in peers():
            progress.stage(f"{peer.TITLE}: version")
            try:
                versions[peer.TITLE] = version(peer, Path(work))
                present.append(peer)
            except running.FailedError as error:
                absent[peer.TITLE] = str(error)
        runs = list(measured(present, Path(work), progress, quick=quick))
    write_csv(out / "peers.csv", runs, UNITS)
    draw(runs, out / "peers.png")
    (out / "page.md").write_text(page_of(runs, present, versions, absent), encoding="utf-8")


def measured(
    present: Sequence[Peer], work: Path, progress: Progress, *, quick: bool
) -> Iterator[Run]:
    """One process at a time: of every code its coarsest run, ours, every second run, ours, ...
    so that what else the machine does meets all of them."""
    case = _case()
    files = {mesh: work / f"{i}.npz" for i, mesh in enumerate(_meshes(present, quick))}
    for (cell, order, size), file in files.items():
        progress.stage(f"meshing: {cell}, order {order}, {size:g} mm")
        blocks.write(file, case, cell, order, size)
    lists = [list(peer.RUNS.items())[: 1 if quick else None] for peer in present]
    columns = list(zip_longest(*lists))
    own = {"coarse": COARSE} if quick else OWN_RUNS
    repeats = 1 if quick else REPEATS
    for i in range(max(len(columns), repeats)):
        for peer, chosen in zip(present, columns[i], strict=True) if i < len(columns) else ():
            if chosen is not None:
                progress.stage(f"{peer.TITLE}: {chosen[0]}")
                setting, run = chosen
                yield _solve(peer, setting, run, case, files, work)
        for setting, options in own.items() if i < repeats else ():
            progress.stage(f"{OURS}: {setting}")
            yield _own(setting, options, work)


def version(peer: Peer, work: Path) -> str:
    """Of a code as it is installed; running.FailedError says why there is none."""
    try:
        if not Path(installing.python(peer, VENV)).exists():
            raise running.FailedError("not installed")
        return str(_asked(peer, None, work)[0])
    except running.FailedError as error:
        raise running.FailedError(installing.reason(peer, VENV, str(error))) from None


def _case() -> dict[str, float]:
    """What `solve` is told of the case, in N, mm and MPa."""
    from railhead.scene import catalogue

    scene = catalogue.find(CASE)
    load, rail_radius, wheel_radius = (
        scene.load,
        scene.rail.crown_radius,
        scene.wheel.rolling_radius,
    )
    assert load is not None and rail_radius is not None and wheel_radius is not None
    return {
        "load": load,
        "travel": TRAVEL,
        "rail_radius": rail_radius,
        "wheel_radius": wheel_radius,
        "young": scene.rail.young_modulus,
        "poisson": scene.rail.poisson_ratio,
    }


def _meshes(present: Sequence[Peer], quick: bool) -> list[tuple[str, int, float]]:
    """The meshes that the runs are given, each once."""
    runs = (run for peer in present for run in list(peer.RUNS.values())[: 1 if quick else None])
    return list(dict.fromkeys(tuple(run["mesh"]) for run in runs if "mesh" in run))


def _solve(
    peer: Peer,
    setting: str,
    run: Mapping[str, Any],
    case: Mapping[str, float],
    files: Mapping[tuple[str, int, float], Path],
    work: Path,
) -> Run:
    record = Run(peer.TITLE, peer.METHOD, setting)
    options = {key: value for key, value in run.items() if key != "mesh"}
    mesh = str(files[tuple(run["mesh"])]) if "mesh" in run else None
    try:
        found, cost = _asked(peer, {"case": case, "mesh": mesh, "run": options}, work)
        return fitted_run(record, cost, case, found)
    except (running.FailedError, ValueError) as error:
        return replace(record, failure=str(error))


def _asked(peer: Peer, job: Mapping[str, Any] | None, work: Path) -> tuple[Any, running.Cost]:
    """What a code answers in a process of its own, in an empty folder."""
    with tempfile.TemporaryDirectory(dir=work) as empty:
        folder = Path(empty)
        (folder / "job.json").write_text(json.dumps(job), encoding="utf-8")
        command = [installing.python(peer, VENV), "-P", str(CHILD), peer.__file__, "job.json"]
        cost = running.run(command, folder)
        return json.loads((folder / "found.json").read_text(encoding="utf-8")), cost


def _own(setting: str, options: Sequence[str], work: Path) -> Run:
    """`railhead run hertz_ellipse --no-pictures` as a person starts it."""
    record = Run(OURS, "finite elements", setting)
    start = [sys.executable, "-c", "from railhead.cli import main; main()"]
    command = [*start, "run", CASE, "--no-pictures", "--out", "own", *options]
    try:
        cost = running.run(command, work)
        summary = json.loads((work / "own" / "summary.json").read_text(encoding="utf-8"))
        return own_run(record, cost, summary)
    except running.FailedError as error:
        return replace(record, failure=str(error))
    finally:
        shutil.rmtree(work / "own", ignore_errors=True)

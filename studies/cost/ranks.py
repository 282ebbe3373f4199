"""What processes of MPI bring: the same meshes with one and with two, and what that lets expect of
more."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from railhead.cli import launch, study
from studies import tables

SIZES = (0.4, 0.28, 0.22, 0.142, 0.112)  # mm in the patch of hertz_ellipse
PARTS = ("start", "mesh", "assemble", "solve", "postprocess")
FORECAST = (2, 8, 64)
BLOCK = 3 * 3 * 8 + 4  # bytes of a block of K and of its column
NODE = 3 * 8  # bytes of a node's unknowns


@dataclass(frozen=True)
class Record:
    """One mesh with some processes. seconds by the clock, whole: from the start of the interpreter
    to the findings, start: what is none of the other parts. product: bytes of K that one process
    reads for one product; halo: bytes that it is sent for it (the mean of all)."""

    unknowns: int
    ranks: int
    newton_iterations: int
    linear_iterations: int
    whole: float
    start: float
    mesh: float
    assemble: float
    solve: float
    postprocess: float
    product: float
    halo: float


def measure(patch_size: float) -> dict[str, float]:
    """Solve with the processes there are; what the first of them knows."""
    import numpy as np
    import scipy.sparse as sp
    from mpi4py import MPI

    from railhead.results import pipeline
    from railhead.run.progress import Progress
    from railhead.scene import catalogue
    from railhead.solver import compat

    scene = catalogue.find("hertz_ellipse").replace([f"mesh.patch_size={patch_size}"])
    result = pipeline.run(scene, Progress(quiet=True))
    comm, end = MPI.COMM_WORLD, time.time()
    space = result.mesh_solution.space
    nodes, places = compat.cell_dofs(space), space.dofmap.index_map
    rows = np.repeat(np.arange(len(nodes)), nodes.shape[1])
    touching = sp.csr_matrix((np.ones(nodes.size, np.int8), (rows, nodes.ravel())))
    blocks = (touching.T[: places.size_local].astype(bool) @ touching.astype(bool)).nnz
    cost = result.summary["cost"]
    return {
        "first": comm.rank == 0,
        "end": end,
        **{key: cost[key] for key in ("dofs", "newton_iterations", "linear_iterations")},
        **cost["seconds"],
        "product": comm.allreduce(BLOCK * blocks) / comm.size,
        "halo": comm.allreduce(NODE * places.num_ghosts) / comm.size,
    }


def _record(patch_size: float, ranks: int) -> Record:
    command = [sys.executable, "-m", "studies.cost.ranks", str(patch_size)]
    launcher, environment = launch.under_mpirun(
        ranks, os.environ | {"OMP_NUM_THREADS": "1", "PYTHONPATH": str(study.ROOT)}
    )
    begin = time.time()
    done = subprocess.run(
        [*launcher, *command], capture_output=True, text=True, check=True, env=environment
    )
    found = json.loads(done.stdout.splitlines()[-1])
    whole = found["end"] - begin
    parts = {name: found[name] for name in PARTS[1:]}
    return Record(
        found["dofs"],
        ranks,
        found["newton_iterations"],
        found["linear_iterations"],
        whole,
        whole - sum(parts.values()),
        **parts,
        product=found["product"],
        halo=found["halo"],
    )


def forecast(one: Record, two: Record, ranks: int) -> dict[str, float]:
    """Seconds of each part with so many processes, each on a core of its own with its share of the
    memory's bandwidth: T = s + p / ranks through what one and two take (Amdahl), none faster than
    p = T(1)."""
    found = {}
    for part in PARTS:
        first, second = getattr(one, part), getattr(two, part)
        shared = min(max(2 * (first - second), 0.0), first)
        found[part] = first - shared + shared / ranks
    return found


def main(out: Path, *, quick: bool) -> None:
    """Write ranks.csv and page.md; quick: the smallest mesh."""
    records = []
    for size in SIZES[: 1 if quick else None]:
        for ranks in (1, 2):
            print(f"patch size {size:g} mm, {ranks} processes", file=sys.stderr)
            records.append(_record(size, ranks))
    tables.write_csv(out / "ranks.csv", records)
    (out / study.PAGE).write_text(page(records), encoding="utf-8")


def page(records: Sequence[Record]) -> str:
    """What was measured, and the forecast from the largest mesh."""
    pairs = list(zip(records[::2], records[1::2], strict=True))
    one, two = pairs[-1]
    measured = [
        (
            r.unknowns,
            r.ranks,
            r.newton_iterations,
            r.linear_iterations,
            *(f"{getattr(r, part):.1f}" for part in PARTS),
            f"{r.whole:.1f}",
            f"{1e6 * r.whole * r.ranks / r.unknowns:.0f}",
            f"{first.whole / r.whole:.2f}" if r.ranks > 1 else "",
        )
        for first, second in pairs
        for r in (first, second)
    ]
    forecasts = [_forecast_row(one, two, ranks) for ranks in FORECAST]
    return tables.render(
        "ranks",
        measured=measured,
        forecasts=forecasts,
        largest=one,
        parts=list(PARTS),
        worth=launch.UNKNOWNS_PER_PROCESS,
    )


def _forecast_row(one: Record, two: Record, ranks: int) -> tuple[str, ...]:
    parts: Mapping[str, float] = forecast(one, two, ranks)
    whole = sum(parts.values())
    return (
        str(ranks),
        *(f"{value:.1f}" for value in parts.values()),
        f"{whole:.1f}",
        f"{one.whole / whole:.1f}",
        f"{one.product / ranks / 1e6:.0f}",
        f"{halo(one.unknowns, ranks) / 1e3:.0f}",
    )


def halo(unknowns: int, ranks: int) -> float:
    """Bytes that a process is sent for a product: the faces 6 (k - 1) / k that a cube among k^3 of
    a body has with others, k^3 = ranks / 2, by the nodes of a face, those of the cube to 2/3."""
    edge = (ranks / 2) ** (1 / 3)
    return 6 * (edge - 1) / edge * (unknowns / 3 / ranks) ** (2 / 3) * NODE


if __name__ == "__main__":
    _found = measure(float(sys.argv[1]))
    if _found["first"]:
        print(json.dumps(_found))

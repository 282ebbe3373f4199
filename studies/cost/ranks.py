"""What processes of MPI bring: the same meshes with one and with two, and what that lets expect of
more."""

import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp
from mpi4py import MPI

from railhead.cli import launch
from railhead.results import pipeline
from railhead.run.progress import Progress
from railhead.scene import catalogue
from railhead.solver import compat
from studies import processes, tables
from studies.tables import Row

SIZES = (0.4, 0.28, 0.22, 0.142, 0.112)  # mm in the patch of hertz_ellipse
PARTS = ("start", "mesh", "assemble", "solve", "postprocess")
FORECAST = (2, 8, 64)
BLOCK = 3 * 3 * 8 + 4  # bytes of a block of K and of its column
NODE = 3 * 8  # bytes of a node's unknowns


COUNTS = ("newton_iterations", "linear_iterations")


def measure(patch_size: float) -> dict[str, Any] | None:
    """Solve one mesh with all processes of MPI; patch_size: mm. Returns counts, seconds and bytes
    on the first process, None on the others."""
    scene = catalogue.find("hertz_ellipse").replace([f"mesh.patch_size={patch_size}"])
    result = pipeline.run(scene, Progress(quiet=True))
    comm, end = MPI.COMM_WORLD, time.time()
    space, cost = result.mesh_solution.space, result.summary["cost"]
    nodes, places = compat.cell_dofs(space), space.dofmap.index_map
    rows = np.repeat(np.arange(len(nodes)), nodes.shape[1])
    touching = sp.csr_matrix((np.ones(nodes.size, np.int8), (rows, nodes.ravel())))
    blocks = (touching.T[: places.size_local].astype(bool) @ touching.astype(bool)).nnz
    found = {
        "end": end,
        **{key: cost[key] for key in ("dofs", *COUNTS)},
        **cost["seconds"],
        "product": comm.allreduce(BLOCK * blocks) / comm.size,
        "halo": comm.allreduce(NODE * places.num_ghosts) / comm.size,
    }
    return found if comm.rank == 0 else None


def recorded(patch_size: float, ranks: int) -> Row:
    """One mesh with some processes. seconds by the clock, whole: from the start of the interpreter
    to the findings, start: what is none of the other parts. product: bytes of K that one process
    reads for one product; halo: bytes that it is sent for it (the mean of all)."""
    begin = time.time()
    found = processes.measured("studies.cost.ranks", patch_size, ranks)
    whole, parts = found["end"] - begin, {name: found[name] for name in PARTS[1:]}
    return {
        "unknowns": found["dofs"],
        "ranks": ranks,
        **{key: found[key] for key in COUNTS},
        "whole": whole,
        "start": whole - sum(parts.values()),
        **parts,
        "product": found["product"],
        "halo": found["halo"],
    }


def forecast(one: Row, two: Row, ranks: int) -> dict[str, float]:
    """Seconds of each part with so many processes, each on a core of its own with its share of the
    memory's bandwidth: T = s + p / ranks through what one and two take (Amdahl), none faster than
    p = T(1)."""
    found = {}
    for part in PARTS:
        shared = min(max(2 * (one[part] - two[part]), 0.0), one[part])
        found[part] = one[part] - shared + shared / ranks
    return found


def main(out: Path, *, quick: bool) -> None:
    """Write ranks.csv and page.md; quick: the smallest mesh."""
    records = []
    for size in SIZES[: 1 if quick else None]:
        for ranks in (1, 2):
            print(f"patch size {size:g} mm, {ranks} processes", file=sys.stderr)
            records.append(recorded(size, ranks))
    tables.publish(out, page(records), ranks=records)


def page(records: Sequence[Row]) -> str:
    """What was measured, and the forecast from the largest mesh."""
    one, two = records[-2:]
    parts = [f"{{{part}:.1f}}" for part in PARTS]
    measured = [
        {
            **r,
            "each": 1e6 * r["whole"] * r["ranks"] / r["unknowns"],
            "gain": f"{records[i - 1]['whole'] / r['whole']:.2f}" if r["ranks"] > 1 else "",
        }
        for i, r in enumerate(records)
    ]
    forecasts = []
    for ranks in FORECAST:
        expected = forecast(one, two, ranks)
        whole = sum(expected.values())
        expected |= {"ranks": ranks, "whole": whole, "gain": one["whole"] / whole}
        expected |= {"product": one["product"] / ranks / 1e6}
        forecasts.append({**expected, "halo": halo(one["unknowns"], ranks) / 1e3})
    return tables.render(
        "ranks",
        measured=tables.cells(
            measured,
            *("{unknowns}", "{ranks}", "{newton_iterations}", "{linear_iterations}"),
            *(*parts, "{whole:.1f}", "{each:.0f}", "{gain}"),
        ),
        forecasts=tables.cells(
            forecasts,
            *("{ranks}", *parts, "{whole:.1f}", "{gain:.1f}", "{product:.0f}", "{halo:.0f}"),
        ),
        largest=one,
        parts=list(PARTS),
        worth=launch.UNKNOWNS_PER_PROCESS,
    )


def halo(unknowns: int, ranks: int) -> float:
    """Bytes that a process is sent for a product: the faces 6 (k - 1) / k that a cube among k^3 of
    a body has with others, k^3 = ranks / 2, by the nodes of a face, those of the cube to 2/3."""
    edge = (ranks / 2) ** (1 / 3)
    return 6 * (edge - 1) / edge * (unknowns / 3 / ranks) ** (2 / 3) * NODE


if __name__ == "__main__":
    processes.answer(measure)

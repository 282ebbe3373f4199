"""Seconds and memory of a run, predicted from the number of unknowns; this machine.

Seconds are those of the processor, all processes of a run together: on a machine that is shared a
run takes longer by the clock.

One shipped number for each kind of model; what finished runs took on this machine corrects it (see
`correction`).
"""

import json
import math
import platform
import statistics
from dataclasses import dataclass
from pathlib import Path

import psutil

from railhead.meshing.isolated_process import address_space
from railhead.scene import files

RUNS = 9  # number of the latest runs that are kept; the first one of them may compile
LEAST_RUNS = 3  # least number of runs by which predictions are corrected
LEAST_UNKNOWNS = 20_000  # least size of a mesh whose time is recorded
START = 1.2  # seconds to import everything
BASE_BYTES = 400_000_000  # memory of the libraries
SMALL = 30_000  # unknowns above which the seconds of an unknown grow
# Time of a load step of bodies that yield, its share of unloading included, over that of an elastic
# run, by whether the contact is a line: 0.3 to 0.6 were measured on solids of 73 000 to 405 000
# unknowns, 0.14 on a line of 7 300 with its many small steps.
LOAD_STEP = {False: 0.45, True: 0.15}
YIELD_BYTES = 6_000  # more bytes per unknown with yield: 4 500 to 5 500 were measured
# Additional time with friction of like solids over that of an elastic run, and seconds beside it:
# 0.4 to 1.4 were measured from 26 000 to 230 000 unknowns, with one to three patches.
FRICTION, FRICTION_SECONDS = 1.0, 1.0
LAW = 1.0  # seconds by a law of friction: 0.3 to 2.9 were measured on half-spaces and solids
FRICTION_BYTES = 3_000  # more bytes per unknown with it: up to 1 700 were measured
# Additional time with condensed friction over that of an elastic run at CONDENSING_AT unknowns, in
# proportion to them: 4 to 17 were measured from 28 000 to 140 000 unknowns.
CONDENSING, CONDENSING_AT = 5.5, 46_000
CONDENSING_BYTES = 26_000  # more bytes per unknown with it: 13 000 to 24 000 were measured

# Seconds before passes and of each, and bytes that they take, by whether the contact is a line:
# measured on the block of the 22.5 t axle (210 000 unknowns) and of a line (17 000).
PASSES = {False: (80.0, 10.0), True: (1.0, 2.5)}
PASS_BYTES = {False: 6_000_000_000, True: 300_000_000}

# Seconds of half-spaces without and with friction, without and with stresses. Measured were 0.01 to
# 0.1 and 0.01 to 0.2 without; with friction 0.1 to 0.4, and 1.1 to 1.8 with stresses.
BOUNDARY_ELEMENTS = {
    (False, False): 0.1,
    (False, True): 0.2,
    (True, False): 0.3,
    (True, True): 1.5,
}

# Processor seconds of all pictures and the report, by what answers: 0.6 to 1.0 of half-spaces, 2.4
# to 2.9 of sections, 4.3 to 6.0 of solids, 10.9 where one yields.
PICTURES = {"half-spaces": 0.8, "section": 2.6, "solid": 4.8, "solid that yields": 10.8}


def cache_file() -> Path:
    """Path of the file that holds the ratios of finished runs, in the cache folder of the user."""
    return files.cache_folder() / "processor.json"


def correction() -> float:
    """Factor on predicted seconds for this machine, read from the file of finished runs: median of
    taken over predicted seconds of the latest runs; 1 before there are three of them (LEAST_RUNS).
    """
    ratios = _ratios()
    return statistics.median(ratios) if len(ratios) >= LEAST_RUNS else 1.0


def record(taken: float, predicted: float) -> None:
    """Append the ratio of taken to predicted (uncorrected) seconds of a finished run to the stored
    ratios; the latest nine (RUNS) are kept, this one included. Ratios of other machines are
    dropped from the file. A file that cannot be written is ignored.
    """
    try:
        file = cache_file()
        file.parent.mkdir(parents=True, exist_ok=True)
        ratios = [*_ratios(), taken / predicted][-RUNS:]
        file.write_text(json.dumps({platform.node(): ratios}), encoding="utf-8")
    except OSError:
        pass  # predictions stay as they are


def _ratios() -> list[float]:
    """Ratios of taken to predicted seconds of this machine's runs in the file, latest last; empty
    without a readable file.
    """
    try:
        kept = json.loads(cache_file().read_text(encoding="utf-8"))
        return [float(each) for each in kept[platform.node()] if 0 < float(each) < math.inf]
    except (OSError, ValueError, KeyError, TypeError):
        return []


def free_memory() -> int:
    """Memory that is available on this machine now, within `address_space`, bytes."""
    return int(min(psutil.virtual_memory().available, address_space()))


@dataclass(frozen=True)
class Cost:
    """Cost of one unknown of one kind of model, from mesh to results, elastic and frictionless.

    seconds: seconds per unknown on two cores of 2026, up to 30 000 unknowns (SMALL).
    growth: power of unknowns / SMALL by which the seconds per unknown grow beyond.
    bytes: bytes per unknown at the peak.
    """

    seconds: float
    growth: float
    bytes: int

    def time(self, unknowns: int) -> float:
        """Seconds for one mesh with that number of unknowns, elastic and frictionless, without
        imports and without the correction for this machine.
        """
        return self.seconds * unknowns * max(1.0, unknowns / SMALL) ** self.growth


# Half-spaces of quadratic tetrahedra from 16 000 to 1 330 000 unknowns take 33 to 60e-6 s and 2.5e3
# B, bodies with profiles from 25 000 to 385 000 34 to 65e-6 s; linear cells were measured at 33 000
# to 168 000, quadratic hexahedra at 118 000, sections to 1 000 000. Factorisations and multigrid of
# linear cells grow.
SECTION = Cost(30e-6, 0.0, 2_000)
HALF_SPACES = Cost(45e-6, 0.0, 3_000)
PROFILES = Cost(50e-6, 0.0, 3_500)
OTHER_CELLS = {
    ("tetrahedron", 1): Cost(120e-6, 0.25, 5_000),
    ("hexahedron", 1): Cost(65e-6, 0.86, 13_000),
    ("hexahedron", 2): Cost(42e-6, 0.8, 13_000),
}
CELLS = json.loads((Path(__file__).parent / "data" / "cells.json").read_text(encoding="utf-8"))


def unknowns_per_cell(kind: str, cell: str, order: int) -> float:
    """Unknowns per predicted cell of a mesh (`Grading.predicted_cells` or `predicted_triangles`);
    kind is 'solid' or 'section', cell and order are as mesh.cell and mesh.order. Values were
    measured by `studies.accuracy.calibrate`.
    """
    return float(CELLS[kind][cell][str(order)])

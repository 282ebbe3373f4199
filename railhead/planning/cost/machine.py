"""What this machine can do: its speed, measured once and kept, and its free memory."""

from __future__ import annotations

import json
import os
import platform
from dataclasses import dataclass
from pathlib import Path

import psutil

REFERENCE = 55e-6  # seconds an unknown of the case that measures a machine: two cores of 2026
START = 1.3  # seconds to import everything there
BASE_BYTES = 400_000_000  # libraries
SMALL = 30_000  # unknowns from which on a growth counts


@dataclass(frozen=True)
class Cost:
    """What an unknown of one kind of model takes, mesh to findings: seconds on the reference
    machine, times (unknowns / SMALL) ** growth above that, and bytes at the peak."""

    seconds: float
    growth: float
    bytes: int

    def time(self, unknowns: int) -> float:
        """Predicted seconds of one mesh on this machine, imports not included."""
        growth = max(1.0, unknowns / SMALL) ** self.growth
        return self.seconds * unknowns * growth * speed()


# Measured on elastic scenes without friction: half-spaces of quadratic tetrahedra from 17 000 to
# 1 000 000 unknowns take 34 to 80e-6 s and 2.5e3 B, bodies with profiles to 630 000 44 to 97e-6 s;
# the others to 160 000, sections to 970 000. Factorisations and multigrid of linear cells grow.
SECTION = Cost(30e-6, 0.0, 2_000)
HALF_SPACES = Cost(45e-6, 0.0, 3_000)
PROFILES = Cost(65e-6, 0.0, 3_500)
OTHER = {
    ("tetrahedron", 1): Cost(150e-6, 0.4, 5_000),
    ("hexahedron", 1): Cost(140e-6, 0.8, 13_000),
    ("hexahedron", 2): Cost(140e-6, 0.8, 13_000),
}


def cache_file() -> Path:
    """Where the speed is kept."""
    root = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(root) / "railhead" / "speed.json"


def speed() -> float:
    """Time of this machine over the reference's; 1.0 until it was measured."""
    try:
        kept = json.loads(cache_file().read_text(encoding="utf-8"))
        factor = float(kept[platform.node()])
    except (OSError, ValueError, KeyError, TypeError):
        return 1.0
    return factor if 0.01 < factor < 1000 else 1.0


def known() -> bool:
    """Whether the speed was measured on this machine."""
    try:
        return platform.node() in json.loads(cache_file().read_text(encoding="utf-8"))
    except (OSError, ValueError, TypeError):
        return False


def keep(factor: float) -> None:
    """Remember the time of this machine over the reference's, where there is a place for it."""
    try:
        file = cache_file()
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps({platform.node(): factor}), encoding="utf-8")
    except OSError:
        pass  # without a cache the speed is measured again next time


def free_memory() -> int:
    """Bytes that can still be taken."""
    return int(psutil.virtual_memory().available)

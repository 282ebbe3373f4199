"""What this machine can do: its speed, measured once and kept, and its free memory."""

from __future__ import annotations

import json
import os
import platform
from pathlib import Path

import psutil

REFERENCE = 55e-6  # seconds an unknown on two shared cores of 2026: mesh to findings ...
REFERENCE_SIZE = 27_000  # ... of so many; of more of them each takes longer
START = 1.3  # seconds to import everything there
BYTES_PER_UNKNOWN = 9_000
BASE_BYTES = 300_000_000


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


def seconds(unknowns: int) -> float:
    """Predicted for one mesh, imports not included."""
    growth = max(1.0, unknowns / REFERENCE_SIZE) ** (1 / 3)
    return REFERENCE * unknowns * growth * speed()


def memory(unknowns: int) -> int:
    """Predicted peak, bytes."""
    return BASE_BYTES + BYTES_PER_UNKNOWN * unknowns


def free_memory() -> int:
    """Bytes that can still be taken."""
    return int(psutil.virtual_memory().available)

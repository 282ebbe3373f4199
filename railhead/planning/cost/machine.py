"""This machine: how its finished runs compare with predictions, and its free memory."""

from __future__ import annotations

import json
import os
import platform
import statistics
from pathlib import Path

import psutil

RUNS = 9  # number of the latest runs that are kept; the first one of them may compile
LEAST_RUNS = 3  # least number of runs by which predictions are corrected
LEAST_UNKNOWNS = 10_000  # least size of a mesh whose time is recorded


def cache_file() -> Path:
    """Path of the file that holds the ratios of finished runs, in the cache folder of the user."""
    root = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(root) / "railhead" / "speed.json"


def correction() -> float:
    """Factor on predicted seconds for this machine: median of taken over predicted seconds of the
    latest runs; 1 before there are three of them (LEAST_RUNS).
    """
    ratios = _ratios()
    return statistics.median(ratios) if len(ratios) >= LEAST_RUNS else 1.0


def record(taken: float, predicted: float) -> None:
    """Append the ratio of taken to predicted (uncorrected) seconds of a finished run to the stored
    ratios; the latest nine (RUNS) are kept, this one included. A file that cannot be written is
    ignored.
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
    without a readable file, and without values outside 0.01 to 1000.
    """
    try:
        kept = json.loads(cache_file().read_text(encoding="utf-8"))
        ratios = [float(each) for each in kept[platform.node()]]
    except (OSError, ValueError, KeyError, TypeError):
        return []
    return [each for each in ratios if 0.01 < each < 1000]


def free_memory() -> int:
    """Memory that is available on this machine now, bytes."""
    return int(psutil.virtual_memory().available)

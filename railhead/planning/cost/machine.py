"""This machine: how its finished runs compare with predictions, and its free memory."""

from __future__ import annotations

import json
import os
import platform
import statistics
from pathlib import Path

import psutil

RUNS = 9  # latest runs that are kept; their median, as the first one compiles
LEAST_RUNS = 3  # before predictions are corrected
LEAST_UNKNOWNS = 10_000  # of a mesh that tells: smaller ones take a time of their own


def cache_file() -> Path:
    """Where the ratios of finished runs are kept."""
    root = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(root) / "railhead" / "speed.json"


def correction() -> float:
    """What predicted seconds are multiplied with: the median of `record` over the latest runs of
    this machine, 1 before there are LEAST_RUNS of them."""
    ratios = _ratios()
    return statistics.median(ratios) if len(ratios) >= LEAST_RUNS else 1.0


def record(taken: float, predicted: float) -> None:
    """Keep the seconds that a mesh took over those predicted without correction, where there is a
    place for it."""
    try:
        file = cache_file()
        file.parent.mkdir(parents=True, exist_ok=True)
        ratios = [*_ratios(), taken / predicted][-RUNS:]
        file.write_text(json.dumps({platform.node(): ratios}), encoding="utf-8")
    except OSError:
        pass  # predictions stay as they are


def _ratios() -> list[float]:
    try:
        kept = json.loads(cache_file().read_text(encoding="utf-8"))
        ratios = [float(each) for each in kept[platform.node()]]
    except (OSError, ValueError, KeyError, TypeError):
        return []
    return [each for each in ratios if 0.01 < each < 1000]


def free_memory() -> int:
    """Bytes that can still be taken."""
    return int(psutil.virtual_memory().available)

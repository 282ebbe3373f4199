"""Measured profiles: points from a file, smoothed, and how smooth they came out."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_smoothing_spline

from railhead.meshing.profiles import Profile, Spline

Array = NDArray[np.float64]
EDGE = 0.02  # of the width at either end that the report leaves out


def from_points(name: str, y: Sequence[float] | Array, z: Sequence[float] | Array) -> Profile:
    """Smoothing cubic spline (scipy's cross-validated choice) through measured points (y, z)."""
    order = np.argsort(y)
    ys, zs = np.asarray(y, dtype=float)[order], np.asarray(z, dtype=float)[order]
    if len(ys) < 5 or np.any(np.diff(ys) <= 0) or not np.all(np.isfinite([ys, zs])):
        raise ValueError(f"profile {name}: give at least 5 finite points with different y")
    return Profile(name, (Spline(ys[0], ys[-1], make_smoothing_spline(ys, zs)),))


def from_csv(path: Path) -> Profile:
    """Points y, z in mm, one a line; a header line and lines beginning with # are skipped."""
    points = []
    with path.open(newline="") as file:
        for number, row in enumerate(csv.reader(file)):
            if not row or row[0].lstrip().startswith("#"):
                continue
            try:
                points.append((float(row[0]), float(row[1])))
            except (ValueError, IndexError):
                if number:
                    raise ValueError(f"{path.name}, line {number + 1}: not a pair y, z") from None
    y, z = zip(*points, strict=True) if points else ((), ())
    return from_points(path.stem, y, z)


@dataclass(frozen=True)
class Smoothness:
    """curvatures: 5, 50 and 95 % of the profile lie below them, 1/mm, positive is convex; waves:
    changes between convex and concave; both without the outermost 2 % at each end."""

    curvatures: tuple[float, float, float]
    waves: int


def smoothness(profile: Profile) -> Smoothness:
    """What a contact will see of a measured profile: a wavy curvature scatters the pressure."""
    start, end = profile.domain
    margin = EDGE * (end - start)
    curvature = profile.curvature(np.linspace(start + margin, end - margin, 2001))
    low, middle, high = (float(value) for value in np.quantile(curvature, (0.05, 0.5, 0.95)))
    return Smoothness((low, middle, high), int(np.sum(np.diff(np.sign(curvature)) != 0)))

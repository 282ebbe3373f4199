"""Points of measured profiles and files of them, for the tests of their reading."""

import numpy as np
from one_line import refusal

from railhead.geometry import profiles
from railhead.geometry.measured import measured_profile as measured
from railhead.geometry.measured.formats import FormatError


def even(points: np.ndarray, spacing: float) -> np.ndarray:
    """Points (n, 2) that far apart along straight lines, mm."""
    s = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    places = np.arange(0, s[-1], spacing)
    return np.column_stack([np.interp(places, s, column) for column in points.T])


def crown(y: np.ndarray, name: str = "60E1") -> np.ndarray:
    """Points (n, 2) of the head of a standard rail at positions y (n,), mm."""
    return np.column_stack([y, profiles.rail_head(name).height(y)])


def wheel(y: np.ndarray | None = None) -> np.ndarray:
    """Points (n, 2) of S1002, which reaches from -70 to 60 mm."""
    y = np.linspace(-70.0, 60.0, 300) if y is None else y
    return np.column_stack([y, profiles.s1002().height(y)])


def read(tmp_path, points: np.ndarray, body: str, header: str = "y [mm],z [mm]"):
    """The profile of a file of the points."""
    file = tmp_path / f"{body}.csv"
    np.savetxt(file, points, delimiter=",", header=header, comments="")
    return measured.read(file, body)


def refused(tmp_path, points: np.ndarray, body: str = "rail") -> str:
    """The line that says why a file of the points is refused; the points begin at line 1."""
    return refusal(lambda: read(tmp_path, points, body, header=""), FormatError)

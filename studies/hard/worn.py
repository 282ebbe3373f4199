"""Worn rails as measured: 54E1 and 60E1 less a smooth wear, sampled, with the noise of a gauge."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from railhead.geometry import profiles
from railhead.results import pipeline
from railhead.scene.scene import Scene
from studies.hard.case import Case, Measured
from studies.hard.scenes import (
    Solve,
    against_boundary_elements,
    half_space,
    measure,
    refusals,
    resolved,
)

STEP = 0.25  # mm between points of a profile gauge
NOISES = (0.0, 0.002, 0.01, 0.02)  # mm, standard deviation
ELEMENTS = 5.0  # per semi-axis
EDGE = 0.5  # mm that the gauge does not reach


@dataclass(frozen=True)
class Wear:
    """depth (mm) lost at `centre` (mm across the rail), less by exp(-(y/width)^2 / 2) beside it:
    wide enough to leave the rail convex."""

    place: str
    rail: str
    depth: float
    centre: float
    width: float
    keys: tuple[str, ...]

    @property
    def name(self) -> str:
        """For people."""
        return f"{self.rail}, {self.depth:g} mm off the {self.place}"

    def scene(self, folder: Path, noise: float) -> Scene:
        """A wheel on that rail, whose profile is written into a folder."""
        profile = profiles.rail_head(self.rail)
        y = np.arange(profile.domain[0] + EDGE, profile.domain[1] - EDGE, STEP)
        z = profile.height(y) - self.depth * np.exp(-(((y - self.centre) / self.width) ** 2) / 2)
        seed = hashlib.sha256(f"{self.name} {noise}".encode()).digest()
        z += np.random.default_rng(list(seed)).normal(0.0, noise, y.shape)
        rows = "\n".join(f"{a:.4f},{b:.6f}" for a, b in zip(y, z, strict=True))
        file = folder / f"noise{1e3 * noise:g}.csv"
        file.write_text(f"y,z\n{rows}\n", encoding="utf-8")
        return Scene.from_mapping(
            {"name": "worn", "load": 5e4, "rail": {"profile": str(file)},
             "wheel": {"rolling_radius": 460}}
        ).replace(self.keys)  # fmt: skip


WEAR = (
    Wear("crown", "54E1", 1.0, 0.0, 25.0, ()),
    Wear("crown", "60E1", 3.0, 0.0, 45.0, ("rail.inclination=1:40",)),
    Wear("gauge corner", "54E1", 2.0, -30.0, 10.0, ("wheel.profile=S1002", "wheelset.shift=4")),
    Wear("gauge corner", "60E1", 3.0, -31.0, 12.0,
         ("wheel.profile=S1002", "wheelset.shift=4", "rail.inclination=1:40")),
)  # fmt: skip


def against_true_profile(wear: Wear, noise: float) -> Solve:
    """The measured profile by finite elements, the one without noise by boundary elements; the mesh
    is that for the latter."""

    def solve() -> Measured:
        with tempfile.TemporaryDirectory() as folder:
            smooth = resolved(wear.scene(Path(folder), 0.0), ELEMENTS)
            size = f"mesh.patch_size={smooth.mesh.patch_size!r}"
            result = pipeline.run(wear.scene(Path(folder), noise).replace([size]))
            true = half_space(smooth, result.mesh_solution)
        return measure(result, against_boundary_elements(result.summary, true))

    return refusals(solve)


def worn() -> Iterator[Case]:
    """Where the noise hides the profile, a refusal is an answer."""
    for wear in WEAR:
        for noise in NOISES:
            yield Case(
                "worn", f"{wear.name}, noise {1e3 * noise:g} um", "a measured profile",
                "boundary elements without noise", against_true_profile(wear, noise),
                refusable=noise > 0, seconds=240,
            )  # fmt: skip

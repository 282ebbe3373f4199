"""What a load that made bodies yield has left: plastic strain, its zone, the residual state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import basix
import numpy as np

from railhead.meshing.tags import BODIES
from railhead.postprocess.findings import Array, Frame, Place
from railhead.postprocess.stress.gauss_points import at_gauss, before_yield, gauss
from railhead.solver.fields import Fields
from railhead.solver.material.elasticity import quadrature_degree
from railhead.solver.solution import PlasticSolution
from railhead.theory.elastic.subsurface import von_mises

TRACE = 1e-9  # plastic strain below which a point has not yielded: rounding


@dataclass(frozen=True)
class Zone:
    """strain: largest equivalent plastic strain, at a Gauss point of a body (name) and place (mm);
    volume mm3 of the whole model; depth: of the deepest point that yields, mm; top: of the
    shallowest one."""

    strain: float
    body: str
    place: Place
    volume: float
    depth: float
    top: float


@dataclass(frozen=True)
class Left:
    """over: load over that of first yield; steps: load steps; residual: the unloaded fields (None
    if they were not asked for) with their largest von Mises stress (MPa) and, by body, how far its
    surface stays pushed in (mm)."""

    zone: Zone
    over: float
    steps: int
    residual: Fields | None
    von_mises: float | None
    indentation: Mapping[str, float]

    def summary(self, elastic_pressure: float, shear_yield: float) -> dict[str, Any]:
        """As "plastic" in summary.json. elastic_pressure: the largest without yield; shear_yield:
        of the body that yields first, MPa."""
        zone = self.zone
        return {
            "load_over_first_yield": self.over,
            "load_steps": self.steps,
            "strain_max": zone.strain,
            "body": zone.body,
            "place_mm": list(zone.place),
            "volume_mm3": zone.volume,
            "depth_mm": zone.depth,
            "top_mm": zone.top,
            **{f"residual_depth_{body}_mm": depth for body, depth in self.indentation.items()},
            "residual_von_mises_max_MPa": self.von_mises,
            "elastic_p0_over_k": elastic_pressure / shear_yield,
        }


def left(found: PlasticSolution, fields: Fields, residual: Fields | None, frame: Frame) -> Left:
    """Of a load, from its fields and those after it."""
    return Left(
        zone(fields, frame), found.load_over_first_yield, found.first_loading_steps, residual,
        None if residual is None else largest_von_mises(residual),
        {BODIES[tag]: depth for tag, depth in found.indentation_depth.items()},
    )  # fmt: skip


def zone(fields: Fields, frame: Frame) -> Zone:
    """Of a state with plastic strain."""
    assert fields.plastic_strain is not None
    points, weights = _samples(fields)
    strain = fields.plastic_strain.equivalent
    cell, point = np.unravel_index(int(np.argmax(strain)), strain.shape)
    yields = strain > TRACE
    depths = np.abs(frame.local(points[yields])[:, 2]) if yields.any() else np.zeros(1)
    x, y, z = (float(value) for value in points[cell, point])
    parts = 1 if fields.kinematics.revolved else 2 ** len(fields.mirrors)
    return Zone(
        float(strain.max()), BODIES[int(fields.body[cell])], (x, y, z),
        float(weights[yields].sum()) * parts, float(depths.max()),
        float(depths.min()),
    )  # fmt: skip


def largest_von_mises(fields: Fields) -> float:
    """At the Gauss points, MPa: what yield bounds there a smooth field through them need not
    respect."""
    _, stress = at_gauss(fields, np.arange(len(fields.cells)))
    return float(von_mises(stress).max())


def _samples(fields: Fields) -> tuple[Array, Array]:
    """Places (m, g, 3) and weights (m, g) of the Gauss points."""
    every = np.arange(len(fields.cells))
    degree = quadrature_degree(fields.cell, fields.degree, fields.kinematics)
    _, shares = basix.make_quadrature(getattr(basix.CellType, fields.cell), degree)
    places, weights = [], []
    for point, share in zip(gauss(fields), shares, strict=True):
        x, _, size = before_yield(fields, every, point)
        places.append(x)
        weights.append(share * size * fields.kinematics.measure(fields.kinematics.flatten(x)))
    return np.stack(places, axis=1), np.stack(weights, axis=1)

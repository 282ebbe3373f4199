"""State after a load with yield: plastic strain, its zone, residual stress, indentation."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from railhead.meshing.bodies import BODY_NAMES
from railhead.postprocess.findings import Frame, Place
from railhead.postprocess.stress.gauss_points import stress_at_gauss_points
from railhead.solver.system.fields import Fields
from railhead.solver.system.solution import PlasticSolution
from railhead.theory.elastic.subsurface import von_mises

TRACE = 1e-9  # plastic strain below which a point has not yielded: rounding


@dataclass(frozen=True, kw_only=True)
class ResidualState:
    """What a load that made bodies yield leaves behind. Where neither rail nor wheel has yielded,
    the strain is at most 1e-9 (TRACE), volume, depth and top are zero, and body and place mean
    nothing.

    strain: largest equivalent plastic strain.
    body: name of the body that has it, 'rail' or 'wheel'.
    place: Gauss point of that strain in space, in the modelled part, mm.
    volume: volume that has yielded, of the whole model, mm3.
    depth, top: distance from the tangent plane, into either body, of the deepest and of the
        shallowest Gauss point that has yielded, mm.
    load_over_first_yield: load over the load of first yield.
    load_steps: number of steps in which the load was applied for the first time, failed ones and
        the halves of a halved step included.
    unloaded: fields without the load; None where they were not computed.
    largest_von_mises: largest von Mises stress of the unloaded fields, MPa; None without them.
    indentation: largest depth by which each deformable body's surface stays pushed in, by body
        name, mm; empty where the load was not removed.
    """

    strain: float
    body: str
    place: Place
    volume: float
    depth: float
    top: float
    load_over_first_yield: float
    load_steps: int
    unloaded: Fields | None = None
    largest_von_mises: float | None = None
    indentation: Mapping[str, float] = field(default_factory=dict)

    def summary(self, elastic_pressure: float, shear_yield: float) -> dict[str, Any]:
        """Entries of "plastic" in summary.json.

        elastic_pressure: largest pressure of the same load without yield, MPa. shear_yield: yield
            stress in shear of the body with the largest plastic strain, MPa.
        """
        return {
            "load_over_first_yield": self.load_over_first_yield,
            "load_steps": self.load_steps,
            "strain_max": self.strain,
            "body": self.body,
            "place_mm": list(self.place),
            "volume_mm3": self.volume,
            "depth_mm": self.depth,
            "top_mm": self.top,
            **{f"residual_depth_{body}_mm": depth for body, depth in self.indentation.items()},
            "residual_von_mises_max_MPa": self.largest_von_mises,
            "elastic_p0_over_k": elastic_pressure / shear_yield,
        }


def residual_state(
    yielding: PlasticSolution, fields: Fields, unloaded: Fields | None, frame: Frame
) -> ResidualState:
    """Read what has yielded, that is where the equivalent plastic strain exceeds 1e-9 (TRACE), the
    residual stress and the indentation that a load leaves behind; nothing is solved here.

    yielding: solution with plastic strains. fields: under the load. unloaded: fields after the
        load, or None. frame: of the contact; depths are along its normal.
    """
    assert fields.plastic_strain is not None
    points, _, volumes = stress_at_gauss_points(fields, np.arange(len(fields.cells)))
    strain = fields.plastic_strain.equivalent
    cell, point = np.unravel_index(int(np.argmax(strain)), strain.shape)
    yields = strain > TRACE
    depths = np.abs(frame.local(points[yields])[:, 2]) if yields.any() else np.zeros(1)
    x, y, z = (float(value) for value in points[cell, point])
    loaded = ResidualState(
        strain=float(strain.max()),
        body=BODY_NAMES[int(fields.body[cell])],
        place=(x, y, z),
        volume=float(volumes[yields].sum()) * fields.copies,
        depth=float(depths.max()),
        top=float(depths.min()),
        load_over_first_yield=yielding.load_over_first_yield,
        load_steps=yielding.loading_steps,
    )
    if unloaded is None:
        return loaded
    return replace(
        loaded,
        unloaded=unloaded,
        largest_von_mises=largest_von_mises(unloaded),
        indentation={BODY_NAMES[tag]: depth for tag, depth in yielding.indentation_depth.items()},
    )


def largest_von_mises(fields: Fields) -> float:
    """Largest von Mises stress at the Gauss points of all cells, MPa.

    The yield condition holds at these points; a smooth field through them may exceed it.
    """
    _, stress, _ = stress_at_gauss_points(fields, np.arange(len(fields.cells)))
    return float(von_mises(stress).max())

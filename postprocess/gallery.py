"""All pictures of one result."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import meshio

from railhead.postprocess.findings import Array, Findings
from railhead.postprocess.plots import diagrams
from railhead.postprocess.views import render, section
from railhead.solver.fields import Fields
from railhead.theory.elastic.contacts import Hertz
from railhead.theory.elastic.line import LineContact

Drawing = Callable[[Path], object]


def drawings(
    fields: Fields,
    stresses: Array,
    grids: tuple[meshio.Mesh, meshio.Mesh],
    found: Findings,
    ellipse: Hertz,
    poisson: float,
) -> dict[str, Drawing]:
    """The pictures of one result: functions that write a PNG file to a path, by file name. Six, or
    four of a section or a line contact.

    stresses (n, 6): at the nodes of the fields, MPa. grids: of the cells, and of the slave's
        contact surface. ellipse: exact Hertz contact; left out where there are several patches.
        poisson: Poisson's ratio of the body on the depth axis.
    """
    volume, contact = grids
    # Hertz's ellipse lies at the first contact, which need not be the most loaded of several.
    exact = ellipse if len(found.patch.each) < 2 else None
    every: dict[str, Drawing] = {
        "pressure.png": partial(diagrams.pressure, found, exact),
        "depth.png": partial(diagrams.depth, found, exact, poisson),
    }
    if fields.kinematics.dim == 2 or isinstance(ellipse, LineContact):
        return every | {
            "wheel_rail.png": partial(section.bodies, fields, found),
            "stress_cut.png": partial(section.stress_cut, fields, stresses, found),
        }
    assert not isinstance(exact, LineContact)
    return every | {
        "patch.png": partial(diagrams.patch, found, exact),
        "wheel_rail.png": partial(render.wheel_rail, volume, found),
        "stress_cut.png": partial(render.stress_cut, volume, found),
        "patch_on_rail.png": partial(render.patch_on_rail, contact, found, exact),
    }

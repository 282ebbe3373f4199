"""All pictures of one result."""

from __future__ import annotations

from functools import partial

import meshio

from railhead.postprocess.findings import Findings
from railhead.postprocess.pictures.plots import diagrams
from railhead.postprocess.pictures.plots.diagrams import Drawing
from railhead.postprocess.pictures.views import render, section_views
from railhead.theory.elastic.contacts import Hertz
from railhead.theory.elastic.line import LineContact


def drawings(
    grids: tuple[meshio.Mesh, meshio.Mesh],
    axis: int | None,
    found: Findings,
    exact: Hertz | None,
    poisson: float,
) -> dict[str, Drawing]:
    """The pictures of one result of finite elements by name of their PNG file. Nothing is drawn
    here. Pictures of the patch from above are those of a solid only.

    grids: of the cells, with nodal stresses, and of the slave's contact surface, images of what
        symmetry left out included. axis: of a section, 0 where it runs along x, 1 along s; None of
        a solid. found: findings whose surface is the whole contact surface, images included. exact:
        exact Hertz contact, or None; a line contact only with a section, else AssertionError.
        poisson: Poisson's ratio of the body of `found.axis`.
    """
    volume, contact = grids
    every: dict[str, Drawing] = {
        "pressure.png": partial(diagrams.pressure, found, exact),
        "depth.png": partial(diagrams.depth, found, exact, poisson),
    }
    if axis is not None:
        return every | {
            "wheel_rail.png": partial(section_views.bodies, volume, axis, found),
            "stress_cut.png": partial(section_views.stress_cut, volume, axis, found),
        }
    assert not isinstance(exact, LineContact)
    if found.subject.rolls:
        every["stress_cut_along.png"] = partial(render.stress_cut, volume, 0, found)
    return every | {
        "patch.png": partial(diagrams.patch, found, exact),
        "wheel_rail.png": partial(render.wheel_rail, volume, found),
        "stress_cut.png": partial(render.stress_cut, volume, 1, found),
        "patch_on_rail.png": partial(render.patch_on_rail, contact, found, exact),
    }

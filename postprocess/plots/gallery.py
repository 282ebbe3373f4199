"""All pictures of one result."""

from __future__ import annotations

from pathlib import Path

import meshio

from railhead.postprocess.findings import Array, Findings
from railhead.postprocess.plots import diagrams, section_plots
from railhead.postprocess.views import render
from railhead.postprocess.vtu import export
from railhead.solver.fields import Fields
from railhead.theory.elastic.contacts import Hertz
from railhead.theory.elastic.line import LineContact


def draw(
    fields: Fields,
    stresses: Array,
    found: Findings,
    ellipse: Hertz,
    poisson: float,
    folder: Path,
) -> tuple[meshio.Mesh, meshio.Mesh]:
    """Write the PNG files: six, four of a section. stresses (n, 6): of the fields, as
    `nodal_stress` reads them. Returns what they show: cells, and the surface
    that the pressure was found on."""
    volume = export.volume_grid(fields, stresses)
    contact = export.contact_grid({fields.slave: found.surface})
    # Hertz's ellipse lies at the first contact, which need not be the most loaded of several.
    exact = ellipse if len(found.patch.each) < 2 else None
    diagrams.pressure(found, exact, folder / "pressure.png")
    diagrams.depth(found, exact, poisson, folder / "depth.png")
    if fields.kinematics.dim == 2 or isinstance(ellipse, LineContact):
        section_plots.bodies(fields, found, folder / "wheel_rail.png")
        section_plots.stress_cut(fields, stresses, found, folder / "stress_cut.png")
        return volume, contact
    assert not isinstance(exact, LineContact)
    diagrams.patch(found, exact, folder / "patch.png")
    render.wheel_rail(volume, found, folder / "wheel_rail.png")
    render.stress_cut(volume, found, folder / "stress_cut.png")
    render.patch_on_rail(contact, found, exact, folder / "patch_on_rail.png")
    return volume, contact

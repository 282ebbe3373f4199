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
    """Write the pictures of one result as PNG files into a folder: six, or four of a section or a
    line contact.

    stresses (n, 6): at the nodes of the fields, MPa. ellipse: exact Hertz contact; left out where
        there are several patches. poisson: Poisson's ratio of the body on the depth axis. Returns
        the grid of the cells, and that of the slave's contact surface.
    """
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

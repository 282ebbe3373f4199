"""All files of one result: grids for ParaView and the pictures."""

from __future__ import annotations

from pathlib import Path

from postprocess import export, plots, render, stress
from postprocess.findings import Findings
from solver.gather import Fields
from theory import thesis
from theory.hertz import Ellipse


def draw(
    fields: Fields,
    found: Findings,
    ellipse: Ellipse,
    poisson: float,
    folder: Path,
    *,
    pictures: bool,
) -> None:
    """Write solution.vtu and contact.vtu and, with `pictures`, the six PNG files."""
    volume = export.volume_grid(fields, stress.nodal(fields))
    contact = export.contact_grid(fields, found.surface)
    export.write(volume, folder / "solution.vtu")
    export.write(contact, folder / "contact.vtu")
    if not pictures:
        return
    plots.patch(found, ellipse, folder / "patch.png")
    plots.pressure(found, ellipse, folder / "pressure.png")
    route = thesis.thesis_contact(
        (ellipse.curvature_x, ellipse.curvature_y), (0.0, 0.0),
        ellipse.contact_modulus, ellipse.load,
    )  # fmt: skip
    plots.depth(found, ellipse, poisson, folder / "depth.png", (route.p0, route.a))
    render.wheel_rail(volume, found, folder / "wheel_rail.png")
    render.stress_cut(volume, found, folder / "stress_cut.png")
    render.patch_on_rail(contact, found, ellipse, folder / "patch_on_rail.png")

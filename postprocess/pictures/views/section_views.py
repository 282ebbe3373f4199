"""Pictures of a section: the bodies with their mesh, and the stresses around the contact."""

from __future__ import annotations

from typing import Any

import meshio
import numpy as np
from matplotlib.figure import Figure

from railhead.meshing.bodies import BODY_NAMES
from railhead.postprocess.findings import Findings
from railhead.postprocess.pictures.plots.diagrams import Target, new_figure
from railhead.postprocess.pictures.views.fringes import draw_fringes
from railhead.postprocess.pictures.views.render import COLOURS, CONTACT, EDGE, bodies_of, outer


def bodies(grid: meshio.Mesh, axis: int, findings: Findings, target: Target = None) -> Figure:
    """Two panels: the whole section with its mesh, and the mesh around the
    contact.

    grid: cells of the whole section, as `vtu.volume_grid` makes them. axis: 0 where the section
        runs along x, 1 along s.
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Patch as Swatch

    half, middle = (findings.patch.a, findings.patch.b)[axis], findings.patch.centre[axis]
    names, skins = findings.subject.names, {k: outer(part) for k, part in bodies_of(grid).items()}
    with new_figure(target, 10, 6.2, findings) as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1.4, 1))
        for axes in (left, right):
            for name, skin in skins.items():
                corners = findings.frame.local(skin.points)[:, [axis, 2]][skin.regular_faces]
                look: dict[str, Any] = {"facecolors": COLOURS[name], "edgecolors": EDGE}
                axes.add_collection(PolyCollection(list(corners), linewidths=0.3, **look))
            axes.set(aspect="equal", xlabel=findings.subject.label(axis))
            axes.grid(False)
        left.autoscale_view()
        left.set(title="the section that is solved", ylabel="height over the contact, mm")
        for line in findings.patch.outlines:
            ends = [line[:, axis].min(), line[:, axis].max()]
            right.plot(ends, [0, 0], color=CONTACT, lw=3, gid="contact patch")
        for name in set(BODY_NAMES.values()) - set(skins):
            for axes in (left, right):
                axes.axhline(0.0, color="black", lw=1.2, zorder=0)
            text, side = f"{names[name]}: rigid, not meshed", 0.25 if name == "rail" else 0.75
            right.text(0.5, side, text, transform=right.transAxes, ha="center")
        reach = 2.5 * half
        right.set(xlim=(middle - reach, middle + reach), ylim=(-1.2 * reach, 1.2 * reach))
        right.set_title("close")
        swatches = [Swatch(fc=COLOURS[name], ec=EDGE, label=names[name]) for name in skins]
        swatches.append(Swatch(fc=CONTACT, label="contact patch"))
        figure.legend(handles=swatches, loc="outside lower center", ncols=3)
    return figure


def stress_cut(grid: meshio.Mesh, axis: int, findings: Findings, target: Target = None) -> Figure:
    """The smallest principal stress and the largest shear stress around the contact, of a section
    in two dimensions; solids are drawn by `render.stress_cut`.

    grid: cells of the whole section with nodal stresses, as `vtu.volume_grid` makes them. axis:
        0 where the section runs along x, 1 along s.
    """
    patch = findings.patch
    reach = np.array([2.4, 1.8]) * (patch.a, patch.b)[axis]
    centre = np.array([patch.centre[axis], 0.0])
    sections = [
        part.extract_surface(nonlinear_subdivision=1, algorithm="dataset_surface").triangulate()
        for part in bodies_of(grid).values()
    ]
    return draw_fringes(sections, axis, None, (centre - reach, centre + reach), findings, target)

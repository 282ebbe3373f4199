"""Pictures of a section: the bodies with their mesh, and the stresses around the contact."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhead.meshing.tags import BODY_NAMES, RAIL
from railhead.postprocess.findings import Array, Findings
from railhead.postprocess.patch.section import coordinate
from railhead.postprocess.plots.diagrams import new_figure
from railhead.postprocess.views.fringes import Cut, Fringes, draw_fringes
from railhead.postprocess.views.render import COLOURS, CONTACT, EDGE
from railhead.solver.fields import Fields
from railhead.theory.elastic.subsurface import max_shear, principal

_CORNERS = {"triangle": [0, 1, 2], "quadrilateral": [0, 1, 3, 2]}
_TRIANGLES = {  # flat triangles through all nodes of a cell
    ("triangle", 1): [[0, 1, 2]],
    ("triangle", 2): [[0, 5, 4], [5, 1, 3], [4, 3, 2], [3, 4, 5]],
    ("quadrilateral", 1): [[0, 1, 2], [1, 3, 2]],
    ("quadrilateral", 2): [
        [0, 4, 5],
        [4, 8, 5],
        [4, 1, 8],
        [1, 6, 8],
        [5, 8, 2],
        [8, 7, 2],
        [8, 6, 7],
        [6, 3, 7],
    ],
}


def bodies(fields: Fields, findings: Findings, path: Path) -> None:
    """Write a PNG file with two panels: the whole section with its mesh, mirror image included, and
    the mesh around the contact.
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Patch as Swatch

    half, middle = _half_width(fields, findings)
    names, axis = findings.subject.names, coordinate(fields)
    tags = [tag for tag in BODY_NAMES if np.any(fields.body == tag)]
    with new_figure(path, 10, 6.2, findings) as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1.4, 1))
        for axes in (left, right):
            for tag, local, cells in _parts(fields, findings):
                corners = local[cells[:, _CORNERS[fields.cell]]]
                look: dict[str, Any] = {"facecolors": COLOURS[BODY_NAMES[tag]], "edgecolors": EDGE}
                axes.add_collection(PolyCollection(list(corners), linewidths=0.3, **look))
            axes.set(aspect="equal", xlabel=findings.subject.label(axis))
            axes.grid(False)
        left.autoscale_view()
        kind = "the meridian section" if findings.subject.revolved else "the section"
        left.set(title=f"{kind} that is solved", ylabel="height over the contact, mm")
        for line in findings.patch.outlines:
            ends = [line[:, axis].min(), line[:, axis].max()]
            right.plot(ends, [0, 0], color=CONTACT, lw=3, gid="contact patch")
        for tag in set(BODY_NAMES) - set(tags):
            for axes in (left, right):
                axes.axhline(0.0, color="black", lw=1.2, zorder=0)
            side = 0.25 if tag == RAIL else 0.75
            text = f"{names[BODY_NAMES[tag]]}: rigid, not meshed"
            right.text(0.5, side, text, transform=right.transAxes, ha="center")
        reach = 2.5 * half
        right.set(xlim=(middle - reach, middle + reach), ylim=(-1.2 * reach, 1.2 * reach))
        right.set_title("close")
        swatches = [
            Swatch(fc=COLOURS[BODY_NAMES[tag]], ec=EDGE, label=names[BODY_NAMES[tag]])
            for tag in tags
        ]
        swatches.append(Swatch(fc=CONTACT, label="contact patch"))
        figure.legend(handles=swatches, loc="outside lower center", ncols=3)


def stress_cut(fields: Fields, stress: Array, findings: Findings, path: Path) -> None:
    """Write a PNG file of the smallest principal stress and the largest shear stress in a section
    around the contact.

    stress (n, 6): at the nodes of the fields, MPa. path: of the file.
    """
    half, middle = _half_width(fields, findings)
    reach, axis = np.array([2.4, 1.8]) * half, coordinate(fields)
    at = findings.frame.local(fields.points)[:, [axis, 2]]
    seen = np.all(np.abs(at - [middle, 0.0]) < reach, axis=1)
    fringes = Fringes(
        [principal(stress)[seen, 2], max_shear(stress)[seen]],
        (middle - reach[0], middle + reach[0]),
        (-reach[1], reach[1]),
        axis,
    )
    parts = []
    for _, local, cells in _parts(fields, findings):
        pattern = _TRIANGLES[fields.cell, fields.degree]
        corners = np.concatenate([cells[:, part] for part in pattern])
        parts.append(Cut(local, corners, (principal(stress)[:, 2], max_shear(stress))))
    draw_fringes(parts, fringes, findings, path)


def _half_width(fields: Fields, findings: Findings) -> tuple[float, float]:
    """Half width of the patch in the section, and coordinate of its centre, mm."""
    axis, patch = coordinate(fields), findings.patch
    return (patch.a, patch.b)[axis], patch.centre[axis]


def _parts(fields: Fields, findings: Findings) -> Iterator[tuple[int, Array, NDArray[np.int64]]]:
    """For each body, and again for its mirror image where the model was cut: tag, coordinates (n,
    2) of all nodes of the model, as x or s and height, mm, and nodes (m, k) of the body's cells.
    """
    local = findings.frame.local(fields.points)[:, [coordinate(fields), 2]]
    for sign in (1.0, -1.0) if fields.mirrors else (1.0,):
        for tag in np.unique(fields.body):
            yield int(tag), local * [sign, 1.0], fields.cells[fields.body == tag]

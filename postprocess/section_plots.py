"""Pictures of a section: the bodies with their mesh, and the stresses around the contact."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhead.postprocess.findings import Array, Findings
from railhead.postprocess.plots import BANDS, mark_largest, new_figure
from railhead.postprocess.render import BODIES, COLOURS, CONTACT, EDGE
from railhead.postprocess.section import coordinate
from railhead.solver.gather import Fields
from railhead.theory.subsurface import principal

NAMES = ("x, along the rail, mm", "s, across the rail, mm")
_CORNERS = {"triangle": [0, 1, 2], "quadrilateral": [0, 1, 3, 2]}
_TRIANGLES = {  # flat triangles through all nodes of a cell
    ("triangle", 1): [[0, 1, 2]],
    ("triangle", 2): [[0, 5, 4], [5, 1, 3], [4, 3, 2], [3, 4, 5]],
    ("quadrilateral", 1): [[0, 1, 2], [1, 3, 2]],
    ("quadrilateral", 2): [
        [0, 4, 5], [4, 8, 5], [4, 1, 8], [1, 6, 8], [5, 8, 2], [8, 7, 2], [8, 6, 7], [6, 3, 7],
    ],
}  # fmt: skip


def bodies(fields: Fields, findings: Findings, path: Path) -> None:
    """The whole section with its mesh, and the mesh around the contact."""
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Patch as Swatch

    half, middle = _half_width(fields, findings)
    with new_figure(path, 10, 6.2) as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1.4, 1))
        for axes in (left, right):
            for tag, local, cells in _parts(fields, findings):
                corners = local[cells[:, _CORNERS[fields.cell]]]
                look: dict[str, Any] = {"facecolors": COLOURS[BODIES[tag]], "edgecolors": EDGE}
                axes.add_collection(PolyCollection(list(corners), linewidths=0.3, **look))
            axes.set(aspect="equal", xlabel=NAMES[coordinate(fields)])
            axes.grid(False)
        left.autoscale_view()
        left.set(title="the section", ylabel="height over the contact, mm")
        right.plot(middle + half * np.array([-1, 1]), [0, 0], color=CONTACT, lw=3)
        reach = 2.5 * half
        right.set(xlim=(middle - reach, middle + reach), ylim=(-1.2 * reach, 1.2 * reach))
        right.set_title("close")
        tags = [tag for tag in BODIES if np.any(fields.body == tag)]
        swatches = [Swatch(fc=COLOURS[BODIES[tag]], ec=EDGE, label=BODIES[tag]) for tag in tags]
        swatches.append(Swatch(fc=CONTACT, label="contact"))
        figure.legend(handles=swatches, loc="outside lower center", ncols=3)


def stress_cut(fields: Fields, stress: Array, findings: Findings, path: Path) -> None:
    """sigma_3 in both bodies around the contact; stress (n, 6) MPa at the nodes."""
    from matplotlib.ticker import MaxNLocator

    half, middle = _half_width(fields, findings)
    reach = np.array([2.4, 1.8]) * half
    sigma = principal(stress)[:, 2]
    at = findings.frame.local(fields.points)[:, [coordinate(fields), 2]]
    seen = np.all(np.abs(at - [middle, 0.0]) < reach, axis=1)
    levels = np.array(MaxNLocator(BANDS + 2).tick_values(sigma[seen].min(), sigma[seen].max()))
    with new_figure(path, 10, 7.2) as figure:
        axes = figure.add_subplot()
        for _, local, cells in _parts(fields, findings):
            corners = np.concatenate(
                [cells[:, part] for part in _TRIANGLES[fields.cell, fields.degree]]
            )
            bands = axes.tricontourf(
                *local.T, corners, sigma, levels, cmap="YlGnBu_r", extend="both"
            )
        mark_largest(axes, findings, coordinate(fields))
        figure.colorbar(bands, ax=axes, label=r"$\sigma_3$, MPa", ticks=levels)
        axes.set(xlabel=NAMES[coordinate(fields)], ylabel="height over the contact, mm")
        axes.set(xlim=middle + reach[0] * np.array([-1, 1]), ylim=(-reach[1], reach[1]))
        axes.set_aspect("equal")
        axes.grid(False)
        figure.legend(loc="outside upper center", ncols=2)


def _half_width(fields: Fields, findings: Findings) -> tuple[float, float]:
    """Half width of the patch in the section and its middle, mm."""
    axis, patch = coordinate(fields), findings.patch
    return (patch.a, patch.b)[axis], patch.centre[axis]


def _parts(fields: Fields, findings: Findings) -> Iterator[tuple[int, Array, NDArray[np.int64]]]:
    """Tag, nodes (n, 2) in the section and cells of each body, and of its mirror image."""
    local = findings.frame.local(fields.points)[:, [coordinate(fields), 2]]
    for sign in (1.0, -1.0) if fields.mirrors else (1.0,):
        for tag in np.unique(fields.body):
            yield int(tag), local * [sign, 1.0], fields.cells[fields.body == tag]

"""Stresses in a cut through both bodies: bands of sigma_3 and of the largest shear stress."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import meshio
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from railhead.meshing.bodies import BODY_NAMES
from railhead.postprocess.findings import Array, Findings
from railhead.postprocess.pictures.diagrams import (
    BANDS,
    Target,
    levels,
    minus,
    new_figure,
    rounded,
)
from railhead.postprocess.pictures.render import bodies_of

LABELS = (r"smallest principal stress $\sigma_3$, MPa", r"largest shear stress $\tau$, MPa")
LONG = 66  # letters of a label: two longer ones do not fit beside each other
SURFACE = 1e-3  # of the smaller half length: a depth that is less counts as none
# Of its depth (at least that share of the smaller half length): a point farther off a cut is said
# to be so.
OFF_CUT = 0.2
MAPS = ("YlGnBu_r", "YlOrRd")


def of_solid(grid: meshio.Mesh, axis: int, findings: Findings, target: Target = None) -> Figure:
    """The smallest principal stress and the largest shear stress in a plane cut through the
    contact: across the rail, at the x of the frame's origin, or along it and normal to the patch,
    at the s of the largest pressure.

    grid: cells with nodal stresses, as `vtu.volume_grid` makes them. axis: 1 across, 0 along.
        findings: frame, patch and largest stresses.
    """
    frame, patch = findings.frame, findings.patch
    ends = patch.box if axis else (patch.main.min(axis=0), patch.main.max(axis=0))
    low, high = (each[axis] for each in ends)
    half = np.array([1.2 * (high - low), min(0.9 * (high - low), 5 * (patch.b, patch.a)[axis])])
    centre, cut = np.array([(low + high) / 2, 0.0]), 0.0 if axis else findings.along.at
    beside = cut + 1e-3 * min(patch.a, patch.b)  # at x = 0 itself there may be faces of cells
    origin = frame.place(beside, 0.0) if axis else frame.place(0.0, beside)
    sections = {
        name: part.slice(normal=frame.axes[1 - axis], origin=origin).triangulate()
        for name, part in bodies_of(grid).items()
    }
    return _draw_fringes(sections, axis, cut, (centre - half, centre + half), findings, target)


def of_section(grid: meshio.Mesh, axis: int, findings: Findings, target: Target = None) -> Figure:
    """The smallest principal stress and the largest shear stress around the contact, of a section
    in two dimensions; solids are drawn by `of_solid`.

    grid: cells of the whole section with nodal stresses, as `vtu.volume_grid` makes them. axis:
        0 where the section runs along x, 1 along s.
    """
    patch = findings.patch
    reach = np.array([2.4, 1.8]) * (patch.a, patch.b)[axis]
    centre = np.array([patch.centre[axis], 0.0])
    sections = {
        name: part.extract_surface(
            nonlinear_subdivision=1, algorithm="dataset_surface"
        ).triangulate()
        for name, part in bodies_of(grid).items()
    }
    return _draw_fringes(sections, axis, None, (centre - reach, centre + reach), findings, target)


def _draw_fringes(
    sections: Mapping[str, Any],
    axis: int,
    cut: float | None,
    window: tuple[Array, Array],
    findings: Findings,
    target: Target = None,
) -> Figure:
    """Two panels: bands of the smallest principal stress and of the largest shear stress in all
    bodies of a plane cut through the contact.

    sections: pyvista surfaces of triangles by body name, with the point data "principal_stresses"
        and "max_shear", MPa. axis: 0 where the horizontal axis of the picture is x, 1 where it is
        s. cut: the other coordinate of the cut, mm; None of a section. window: smallest and largest
        coordinate along that axis, and height over the tangent plane, that are shown, (2,) each,
        mm; the stresses there set the limits of the colour bands. findings: give the title, the
        edges of the patch and the largest shear stress of each body, which is marked in the second
        panel.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.lines import Line2D

    names, (low, high) = findings.subject.names, window
    places = [findings.frame.local(each.points)[:, [axis, 2]] for each in sections.values()]
    inside = [np.all((at > low) & (at < high), axis=1) for at in places]
    stresses = (
        [each["principal_stresses"][:, 2] for each in sections.values()],
        [each["max_shear"] for each in sections.values()],
    )
    shape = float(np.divide(*(high - low)[::-1]))
    with new_figure(target, 10, 2.0 + 4.4 * shape, findings) as figure:
        panels = figure.subplots(1, 2, sharey=True)
        for number, axes in enumerate(panels):
            seen = [own[shown] for own, shown in zip(stresses[number], inside, strict=True)]
            every = np.concatenate(seen)
            every = every if number else np.minimum(every, 0.0)
            ticks = levels(findings.subject.units, "MPa", every, BANDS + 2)
            look = {"cmap": MAPS[number], "extend": "neither" if number else "max"}
            for each, at, own in zip(sections.values(), places, stresses[number], strict=True):
                drawn = axes.tricontourf(*at.T, each.regular_faces, own, ticks, **look)
                rim = each.extract_feature_edges(
                    feature_edges=False, manifold_edges=False, non_manifold_edges=False
                )
                ends = findings.frame.local(rim.points)[:, [axis, 2]][
                    rim.lines.reshape(-1, 3)[:, 1:]
                ]
                axes.add_collection(LineCollection(list(ends), colors="black", linewidths=1.2))
            figure.colorbar(
                drawn,
                ax=axes,
                label=LABELS[number],
                ticks=ticks[::2] if number else ticks[::-2][::-1],
                location="bottom",
            )
            axes.set(xlabel=findings.subject.label(axis), aspect="equal")
            axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
            axes.grid(False)
            for body in BODY_NAMES.values():
                height, side = (0.03, "bottom") if body == "rail" else (0.97, "top")
                text = names[body] + ("" if body in sections else ": not meshed")
                axes.text(0.02, height, text, transform=axes.transAxes, va=side, fontsize=13)
            along = cut is not None and axis == 0  # which cuts the most loaded patch alone
            for line in [findings.patch.main] if along else findings.patch.outlines:
                edges = np.array([line[:, axis].min(), line[:, axis].max()])
                axes.plot(edges, [0, 0], "|", color="black", ms=14, mew=1.6, gid="contact patch")
        panels[0].set_ylabel("height over the contact, mm")
        marked = "edges of the patch (drawn undeformed)"
        if cut is not None:
            units, half = findings.subject.units, (findings.patch.b, findings.patch.a)[axis]
            marked += f", cut at {'sx'[axis]} = {rounded(units, cut, half)} {units.unit('mm')}"
        _mark_largest(panels[1], findings, axis, cut or 0.0)
        handles, labels = panels[1].get_legend_handles_labels()
        mark = Line2D([], [], color="black", marker="|", ms=12, mew=1.6, ls="none")
        long = max(map(len, [*labels, marked])) > LONG
        figure.legend(
            [*handles, mark],
            [*labels, marked],
            loc="outside upper center",
            ncols=1 if long else 2,
            fontsize=10,
        )
    return figure


def _mark_largest(axes: Axes, findings: Findings, axis: int, cut: float) -> None:
    """Mark the place of the largest shear stress of each body in a picture of x or s over height.

    axis: 0 where the horizontal axis is x, 1 where it is s. cut: the other coordinate of the cut,
        mm. Legend entries give the value, the depth and, if the place lies off the cut, how far.
    """
    half, subject = min(findings.patch.a, findings.patch.b), findings.subject
    for body, largest in findings.largest.items():
        peak = largest.tau
        local = findings.frame.local(np.array([peak.place]))[0]
        depth = subject.units.text(peak.depth, "mm", 3)
        deep = "at the surface" if peak.depth < SURFACE * half else f"{depth} deep"
        value = subject.units.text(peak.value, "MPa")
        label = rf"$\tau_{{max}}$ in the {subject.names[body]}: {value}, {deep}"
        if abs(off := local[1 - axis] - cut) > OFF_CUT * max(peak.depth, OFF_CUT * half):
            sign, way = "+" if off > 0 else "", (subject.across, subject.along)[axis]
            label += minus(f", {sign}{subject.units.text(off, 'mm', 2)} {way}")
        marker = "v" if body == "rail" else "^"
        look: dict[str, Any] = {"ms": 10, "mfc": "white", "mec": "black", "ls": "none"}
        axes.plot(local[axis], local[2], marker, label=label, **look)

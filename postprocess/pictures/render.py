"""Pictures of the bodies: their mesh, in space and close to the contact; and fields in a plane cut
through the contact, as bands: stresses under the load, and what yield leaves.

The grids are those of `vtu`, of whole bodies with the images of what symmetry left out; nothing is
deformed. A grid is of a solid, or of a section in two dimensions. pyvista cuts it and renders it in
space, off screen; matplotlib draws the cuts.
"""

import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import meshio
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch as Swatch
from numpy.typing import NDArray

from railhead.meshing import isolated_process
from railhead.meshing.bodies import BODY_NAMES
from railhead.postprocess.findings import Array, Findings
from railhead.postprocess.pictures.diagrams import BANDS, Target, levels, new_figure, rounded

COLOURS = {"rail": "#b4c3d3", "wheel": "#dcc9a3"}
EDGE, CONTACT = "#5a6570", "#b2182b"
GRAPHICS_BYTES = 1_200_000_000  # address space that VTK maps; with less it crashes
PIXELS = 1400, 1300  # of the image in space, before its empty margins are cut off
MESH = {
    "show_edges": True,
    "edge_color": EDGE,
    "edge_opacity": 0.6,
    "line_width": 0.8,
    "ambient": 0.45,  # of the colour everywhere, and more by the light
    "diffuse": 0.6,
}
TOWARDS = 1.0, 0.5, 0.35  # the eye, from the bodies
CORNERS = {"triangle": 3, "quad": 4, "tetra": 4, "hexahedron": 8}
NEAR = 0.1  # of the patch's half length: a contact so near to x = 0 is cut there, between cells
ASIDE = 1e-3  # of the smaller half length: a cut lies so far beside faces of cells


class Shade(NamedTuple):
    """A field that is drawn in bands.

    name: of the data of cells or nodes; of several columns the last one is drawn.
    label: with unit.
    colours: matplotlib's name of the colour map.
    factor: from the data to the unit of the label.
    top: largest value that has a band of its own.
    """

    name: str
    label: str
    colours: str
    factor: float = 1.0
    top: float = np.inf


SHEAR = Shade("max_shear", r"largest shear stress $\tau$, MPa", "YlOrRd")
STRESSES = (
    Shade("principal_stresses", r"smallest principal stress $\sigma_3$, MPa", "YlGnBu_r", top=0.0),
    SHEAR,
)
YIELD = (
    Shade("equivalent_plastic_strain", "equivalent plastic strain, %", "YlOrRd", factor=100.0),
    Shade("residual_von_mises", "residual von Mises stress, MPa", "YlOrRd"),
)


def load_pyvista() -> Any:
    """The pyvista module, imported at first use because the import is slow. Without a DISPLAY it
    renders through EGL. MemoryError: too little address space is left for it.
    """
    if "pyvista" not in sys.modules and isolated_process.address_space() < GRAPHICS_BYTES:
        raise MemoryError("the graphics libraries need 1.2 GB of address space")
    if not os.environ.get("DISPLAY"):
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    import pyvista

    return pyvista


def bodies_of(grid: meshio.Mesh) -> dict[str, Any]:
    """Split a grid of cells, tagged by its cell data "body", into one pyvista grid for each body,
    by body name.
    """
    volume = load_pyvista().from_meshio(grid)
    tags = np.unique(volume["body"])
    return {BODY_NAMES[int(tag)]: volume.extract_cells(volume["body"] == tag) for tag in tags}


def bodies(grid: meshio.Mesh, axis: int, findings: Findings, target: Target = None) -> Figure:
    """Two panels: a solid cut open across the rail at the contact, or the whole section, with its
    mesh; and the mesh around the patch.

    grid: cells of the whole bodies, as `vtu.volume_grid` makes them. axis: 0 where the section
        runs along x, 1 along s; 1 of a solid.
    """
    frame, patch, subject = findings.frame, findings.patch, findings.subject
    skins = {name: skin(part, findings) for name, part in bodies_of(straight(grid)).items()}
    local = frame.local(findings.surface.points)
    middle = local[np.abs(local[:, 1 - axis]) <= (patch.b, patch.a)[axis] / 2]
    middle = middle[np.argsort(middle[:, axis])]
    low, high = (each[axis] for each in patch.box)
    with new_figure(target, 10, 6.6, findings) as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1.6, 1))
        plane = frame.axes[[axis, 2, 1 - axis]]
        _draw_faces(right, skins, plane, np.array(frame.origin))
        if grid.cells[0].dim == 3:
            left.imshow(image(skins))
            left.set_axis_off()
            left.set_title("cut open at the contact")
            right.set_title("the same cut, close" + (", gauge side left" if subject.gauge else ""))
        else:
            _draw_faces(left, skins, plane, np.array(frame.origin))
            left.set(title="the section that is solved", xlabel=subject.label(axis))
            right.set_title("close")
        for line in patch.outlines:
            t = np.linspace(line[:, axis].min(), line[:, axis].max(), 61)
            height = np.interp(t, middle[:, axis], middle[:, 2])
            right.plot(t, height, color=CONTACT, lw=3, gid="contact patch")
        right.set(xlabel=subject.label(axis).split("\n")[0], ylabel="height over the contact, mm")
        right.set_xlim((low + high) / 2 + 0.7 * (high - low) * np.array([-1.0, 1.0]))
        right.set_ylim(low - high, high - low)
        _legend(figure, right, skins)
    return figure


def straight(grid: meshio.Mesh) -> meshio.Mesh:
    """The same cells with straight edges between their corners, without data of nodes."""
    (block,) = grid.cells
    kind = block.type.rstrip("0123456789")
    cells = [(kind, block.data[:, : CORNERS[kind]])]
    return meshio.Mesh(grid.points, cells, cell_data={"body": grid.cell_data["body"]})


def skin(part: Any, findings: Findings) -> Any:
    """Outer faces, as a pyvista surface, of the half of a solid that lies at smaller x than the
    contact point, or all cells of a section. Of a contact near x = 0 the half ends there, beside
    the faces of cells.
    """
    if part.get_cell(0).dimension == 3:
        at, patch = findings.frame.origin[0], findings.patch
        at = 0.0 if abs(at) < NEAR * patch.a else at
        part = part.clip("x", origin=(at - ASIDE * min(patch.a, patch.b), 0.0, 0.0))
    return part.extract_surface(algorithm="dataset_surface")


def image(skins: Mapping[str, Any]) -> NDArray[np.uint8]:
    """RGB image (h, w, 3) of pyvista surfaces by body name, in parallel projection as seen from
    `TOWARDS`, without empty margins.
    """
    pv = load_pyvista()
    plotter = pv.Plotter(off_screen=True, window_size=PIXELS, lighting="none")
    plotter.add_light(pv.Light(light_type="headlight"))
    plotter.set_background("white")
    for name, surface in skins.items():
        plotter.add_mesh(surface, color=COLOURS[name], **MESH)
    plotter.enable_parallel_projection()
    plotter.view_vector(TOWARDS, viewup=(0, 0, 1))
    shown = np.asarray(plotter.screenshot(return_img=True))
    plotter.close()
    rows, columns = (np.flatnonzero((shown < 255).any(axis=(2, across))) for across in (1, 0))
    return shown[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]


def _draw_faces(axes: Axes, skins: Mapping[str, Any], plane: Array, origin: Array) -> None:
    """Draw the faces of surfaces by body name in parallel projection, the nearest last.

    plane (3, 3): unit vectors to the right, upwards and towards the eye. origin (3,): point in
        space that is at zero, mm.
    """
    faces: list[Array] = []
    colours: list[str] = []
    for name, surface in skins.items():
        points = (surface.points - origin) @ plane.T
        faces += [points[face] for face in surface.irregular_faces]
        colours += [COLOURS[name]] * surface.n_cells
    order = np.argsort([face[:, 2].mean() for face in faces])
    shown, filled = zip(*((faces[number][:, :2], colours[number]) for number in order), strict=True)
    look: dict[str, Any] = {"facecolors": filled, "edgecolors": EDGE + "99", "linewidths": 0.3}
    axes.add_collection(PolyCollection(shown, **look))
    axes.set_aspect("equal")
    axes.grid(False)
    axes.autoscale_view()


def _legend(figure: Figure, axes: Axes, drawn: Iterable[str]) -> None:
    """Draw the legend of the bodies that are drawn and of the patch, and say on the axes which body
    is not meshed.
    """
    swatches = [Swatch(fc=COLOURS[name], ec=EDGE, label=name) for name in drawn]
    swatches.append(Swatch(fc=CONTACT, label="contact patch"))
    figure.legend(handles=swatches, loc="outside upper center", ncols=3)
    for name in set(BODY_NAMES.values()).difference(drawn):
        text, side = f"{name}: not meshed", 0.25 if name == "rail" else 0.75
        axes.text(0.5, side, text, transform=axes.transAxes, ha="center")


def fringes(
    grid: meshio.Mesh,
    axis: int,
    shades: Sequence[Shade],
    findings: Findings,
    target: Target = None,
) -> Figure:
    """A panel for each field: its bands in all bodies, in a plane cut of a solid through the
    contact, or in the section.

    grid: cells with the data of `shades`, as `vtu.volume_grid` makes them. axis: 1 of a cut across
        the rail, at the x of the frame's origin, 0 of one along it and normal to the patch, at the
        s of the largest pressure; of a section as it runs. findings: give the title, the edges of
        the patches that are cut and the largest shear stress of each body.
    """
    patch, subject, solid = findings.patch, findings.subject, grid.cells[0].dim == 3
    along = solid and axis == 0  # such a cut goes through one patch
    cut, outlines = (findings.along.at, [patch.main]) if along else (0.0, patch.outlines)
    low, high = (end(np.concatenate(outlines)[:, axis]) for end in (np.min, np.max))
    half = np.array([1.2, 0.9]) * (high - low)
    if solid:
        half[1] = min(half[1], 5 * (patch.b, patch.a)[axis])
    window = np.array([(low + high) / 2, 0.0]) + half * [[-1.0], [1.0]]
    parts = bodies_of(grid)
    sections = {name: _section(part, axis, cut, findings) for name, part in parts.items()}
    with new_figure(target, 10, 2.0 + 4.4 * float(half[1] / half[0]), findings) as figure:
        panels = figure.subplots(1, len(shades), sharey=True)
        for axes, shade in zip(panels, shades, strict=True):
            _draw_bands(axes, shade, sections, axis, window, findings)
            for line in outlines:
                ends = np.array([line[:, axis].min(), line[:, axis].max()])
                axes.plot(ends, [0, 0], "|", color="black", ms=14, mew=1.6, gid="contact patch")
            if shade is SHEAR:
                _mark_largest(axes, findings, axis)
        panels[0].set_ylabel("height over the contact, mm")
        marked = "edges of the patch (drawn undeformed)"
        if solid:
            place = rounded(subject.units, cut, (patch.b, patch.a)[axis])
            marked += f", cut at {'sx'[axis]} = {place} {subject.units.unit('mm')}"
        handles, labels = panels[-1].get_legend_handles_labels()
        edge = Line2D([], [], color="black", marker="|", ms=12, mew=1.6, ls="none")
        look: dict[str, Any] = {"loc": "outside upper center", "ncols": 2, "fontsize": 10}
        figure.legend([*handles, edge], [*labels, marked], **look)
    return figure


def _section(part: Any, axis: int, cut: float, findings: Findings) -> Any:
    """Triangles, as a pyvista surface, of a body in a plane, with the data of nodes and those of
    cells as means at nodes; arguments as of `fringes`. cut: coordinate of a solid's plane, mm.
    """
    part = part.cell_data_to_point_data()
    if part.get_cell(0).dimension < 3:
        surface = part.extract_surface(nonlinear_subdivision=1, algorithm="dataset_surface")
        return surface.triangulate()
    frame, patch = findings.frame, findings.patch
    beside = cut + ASIDE * min(patch.a, patch.b)
    origin = frame.place(beside, 0.0) if axis else frame.place(0.0, beside)
    return part.slice(normal=frame.axes[1 - axis], origin=origin).triangulate()


def _draw_bands(
    axes: Axes,
    shade: Shade,
    sections: Mapping[str, Any],
    axis: int,
    window: Array,
    findings: Findings,
) -> None:
    """Draw a field in bands with a colour bar, the borders of the bodies and their names.

    sections: surfaces of triangles by body name. axis: 0 where the horizontal axis of the picture
        is x, 1 where it is s. window (2, 2): smallest and largest coordinate along that axis and
        height over the tangent plane, mm; the values there set the limits of the bands.
    """
    subject, (low, high) = findings.subject, window
    places = [findings.frame.local(each.points)[:, [axis, 2]] for each in sections.values()]
    values = [
        shade.factor * each[shade.name].reshape(each.n_points, -1)[:, -1]
        for each in sections.values()
    ]
    seen = np.all((np.concatenate(places) > low) & (np.concatenate(places) < high), axis=1)
    shown = np.minimum(np.concatenate(values)[seen], shade.top)
    limits = levels(subject.units, shade.label, shown, BANDS + 2)
    extend = "max" if np.isfinite(shade.top) else "neither"
    for each, at, own in zip(sections.values(), places, values, strict=True):
        drawn = axes.tricontourf(
            *at.T, each.regular_faces, own, limits, cmap=shade.colours, extend=extend
        )
        rim = each.extract_feature_edges(
            feature_edges=False, manifold_edges=False, non_manifold_edges=False
        )
        ends = findings.frame.local(rim.points)[:, [axis, 2]][rim.lines.reshape(-1, 3)[:, 1:]]
        axes.add_collection(LineCollection(list(ends), colors="black", linewidths=1.2))
    ticks = limits[int(np.argmin(np.abs(limits))) % 2 :: 2]  # zero is one of them
    axes.figure.colorbar(drawn, ax=axes, label=shade.label, ticks=ticks, location="bottom")
    axes.set(xlabel=subject.label(axis), aspect="equal")
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    axes.grid(False)
    for body in BODY_NAMES.values():
        height, side = (0.03, "bottom") if body == "rail" else (0.97, "top")
        text = body if body in sections else f"{body}: not meshed"
        axes.text(0.02, height, text, transform=axes.transAxes, va=side, fontsize=13)


def _mark_largest(axes: Axes, findings: Findings, axis: int) -> None:
    """Mark the place of the largest shear stress of each body in a picture of x or s over height,
    also where it lies off the cut; legend entries give value and depth.

    axis: 0 where the horizontal axis is x, 1 where it is s.
    """
    subject = findings.subject
    for body, largest in findings.largest.items():
        peak = largest.tau
        local = findings.frame.local(np.array([peak.place]))[0]
        value, depth = (
            subject.units.text(peak.value, "MPa"),
            subject.units.text(peak.depth, "mm", 3),
        )
        label = rf"$\tau_{{max}}$ in the {body}: {value}, {depth} deep"
        look: dict[str, Any] = {"ms": 10, "mfc": "white", "mec": "black", "ls": "none"}
        axes.plot(local[axis], local[2], "v" if body == "rail" else "^", label=label, **look)

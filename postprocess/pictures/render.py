"""Pictures of the bodies: their mesh, of solids by a parallel camera, of sections as polygons; and
the stresses in a cut, as bands of sigma_3 and of the largest shear stress.

Images of meshes are shaded; lines and labels are placed over them in mm. The grids are those of
`vtu`, of whole bodies with the images of what symmetry left out; nothing is deformed. All text is
set by matplotlib. VTK's own colour bars and scales are not used: their number formats go through
std::regex, which ends the process once the libraries of dolfinx are loaded beside VTK.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import meshio
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.interpolate import griddata

from railhead.meshing import isolated_process
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

COLOURS = {"rail": "#b4c3d3", "wheel": "#dcc9a3"}
EDGE, CONTACT = "#5a6570", "#b2182b"
GRAPHICS_BYTES = 1_200_000_000  # address space that VTK and Mesa map; with less they crash
NEAR = 0.1  # of the patch's half length: a plane of the mesh so near to the contact will do
MESH = {"show_edges": True, "edge_color": EDGE, "edge_opacity": 0.6, "line_width": 0.8}
SHADE = {"ambient": 0.45, "diffuse": 0.6}
STRESSES = (r"smallest principal stress $\sigma_3$, MPa", r"largest shear stress $\tau$, MPa")
LONG = 66  # letters of a label: two longer ones do not fit beside each other
SURFACE = 1e-3  # of the smaller half length: a depth that is less counts as none
# Of its depth (at least that share of the smaller half length): a point farther off a cut is said
# to be so.
OFF_CUT = 0.2
MAPS = ("YlGnBu_r", "YlOrRd")


def load_pyvista() -> Any:
    """The pyvista module, imported at first use because the import is slow. Without a DISPLAY it is
    set to draw off screen through EGL. MemoryError: too little address space is left for it.
    """
    if "pyvista" not in sys.modules and isolated_process.address_space() < GRAPHICS_BYTES:
        raise MemoryError("the graphics libraries need 1.2 GB of address space")
    if not os.environ.get("DISPLAY"):
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    import pyvista

    return pyvista


@dataclass(frozen=True)
class Camera:
    """A camera with parallel projection, for images of pyvista meshes.

    focal (3,): point in space in the middle of the image, mm.
    towards (3,): direction from that point to the eye, of any length, not along `up`.
    half_width, half_height: half the width and height of the visible rectangle, mm.
    up (3,): direction in space whose projection points upwards in the image; z by default.
    pixels: number of pixels along the longer side of the image.
    """

    focal: Array
    towards: Array
    half_width: float
    half_height: float
    up: Array = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    pixels: int = 1200

    @property
    def axes(self) -> Array:
        """(3, 3) rows: unit vectors to the right in the image, upwards in the image, and from the
        focal point to the eye.
        """
        eye = self.towards / np.linalg.norm(self.towards)
        right = np.cross(self.up, eye)
        right /= np.linalg.norm(right)
        return np.array([right, np.cross(eye, right), eye])

    def project(self, points: Array) -> Array:
        """Image coordinates (n, 2) of points (n, 3) in space: mm to the right of and above the
        middle of the image.
        """
        return np.asarray((points - self.focal) @ self.axes[:2].T)

    def shoot(self, meshes: list[tuple[Any, dict[str, Any]]]) -> NDArray[np.uint8]:
        """RGB image (h, w, 3), uint8, of pyvista meshes, each given with its keyword arguments for
        `Plotter.add_mesh`.
        """
        half = np.array([self.half_width, self.half_height])
        size = np.round(half / half.max() * self.pixels).astype(int)
        pv = load_pyvista()
        plotter = pv.Plotter(off_screen=True, window_size=size.tolist(), lighting="none")
        plotter.add_light(pv.Light(light_type="headlight"))
        plotter.set_background("white")
        for mesh, options in meshes:
            plotter.add_mesh(mesh, show_scalar_bar=False, **options)
        right, upwards, eye = self.axes
        camera = plotter.camera
        camera.focal_point = self.focal
        camera.position = self.focal + 10 * half.max() * eye
        camera.up = upwards
        camera.parallel_projection = True
        camera.parallel_scale = self.half_height
        plotter.renderer.reset_camera_clipping_range()
        image = plotter.screenshot(return_img=True)
        plotter.close()
        return np.asarray(image)

    def show(self, axes: Axes, image: NDArray[np.uint8], origin: Array | None = None) -> None:
        """Draw an image (h, w, 3) of this camera on matplotlib axes, whose data coordinates then
        are mm in the image. The zero of these coordinates is at the projection of `origin` (3,),
        a point in space in mm, or at the middle of the image if it is None.
        """
        shift = np.zeros(2) if origin is None else self.project(origin[None])[0]
        w, h = self.half_width, self.half_height
        left, low = -w - shift[0], -h - shift[1]
        axes.imshow(image, extent=(left, left + 2 * w, low, low + 2 * h))
        axes.grid(False)


def wheel_rail(grid: meshio.Mesh, findings: Findings, target: Target = None) -> Figure:
    """Two panels: the bodies cut open across the rail at the contact, with their mesh, and the mesh
    around the patch.

    grid: cells of the whole bodies, as `vtu.volume_grid` makes them. findings: frame, patch,
        surface and names.
    """
    frame, patch = findings.frame, findings.patch
    halves = {name: behind(part, findings) for name, part in bodies_of(grid).items()}
    meshes = [(half, {"color": COLOURS[name], **MESH, **SHADE}) for name, half in halves.items()]
    corners = np.concatenate([half.points for half in halves.values()])
    general = _around(corners, np.array([1.0, 0.5, 0.35]))
    low, high = patch.box
    reach = (high - low).max()
    middle = np.array(frame.place(0.0, (low[1] + high[1]) / 2))
    close = Camera(middle, frame.axes[0], 0.7 * reach, reach, frame.axes[2], pixels=900)
    local = frame.local(findings.surface.points)
    with new_figure(target, 10, 6.6, findings) as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1.6, 1))
        general.show(left, general.shoot(meshes))
        left.set_axis_off()
        left.set_title("cut open at the contact")
        close.show(right, close.shoot(meshes), np.array(frame.origin))
        for line in patch.outlines:
            s = np.linspace(line[:, 1].min(), line[:, 1].max(), 61)
            near = local[np.abs(local).max(axis=1) < 2 * np.abs(s).max()]
            height = griddata(near[:, :2], near[:, 2], (0 * s, s), fill_value=0.0)
            right.plot(s, height, color=CONTACT, lw=3)
        right.set(
            title="the same cut, close" + (", gauge side left" if findings.subject.gauge else ""),
            xlabel=findings.subject.label(1).split("\n")[0],
        )
        right.set(xlim=right.get_xlim(), ylim=right.get_ylim())
        right.set_ylabel("height over the contact, mm")
        _legend(figure, right, findings.subject.names, halves)
    return figure


def section(grid: meshio.Mesh, axis: int, findings: Findings, target: Target = None) -> Figure:
    """Two panels: the whole section with its mesh, and the mesh around the contact.

    grid: cells of the whole section, as `vtu.volume_grid` makes them. axis: 0 where the section
        runs along x, 1 along s.
    """
    from matplotlib.collections import PolyCollection

    half, middle = (findings.patch.a, findings.patch.b)[axis], findings.patch.centre[axis]
    skins = {name: outer(part) for name, part in bodies_of(grid).items()}
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
        if len(skins) == 1:  # the plane of a rigid body
            for axes in (left, right):
                axes.axhline(0.0, color="black", lw=1.2, zorder=0)
        reach = 2.5 * half
        right.set(xlim=(middle - reach, middle + reach), ylim=(-1.2 * reach, 1.2 * reach))
        right.set_title("close")
        _legend(figure, right, findings.subject.names, skins)
    return figure


def bodies_of(grid: meshio.Mesh) -> dict[str, Any]:
    """Split a grid of cells, tagged by its cell data "body", into one pyvista grid for each body,
    by body name.
    """
    volume = load_pyvista().from_meshio(grid)
    tags = np.unique(volume["body"])
    return {BODY_NAMES[int(tag)]: volume.extract_cells(volume["body"] == tag) for tag in tags}


def outer(part: Any) -> Any:
    """Outer faces of a pyvista grid as a surface, with the cells' straight edges."""
    return part.extract_surface(nonlinear_subdivision=0, algorithm="dataset_surface")


def behind(part: Any, findings: Findings) -> Any:
    """Outer faces, as a pyvista surface, of the half of a body that lies at smaller x than the
    contact point. If a plane between cells lies there, or near it at x = 0, the body is parted at
    it. Otherwise cells are clipped.
    """
    x, at = part.points[:, 0], findings.frame.origin[0]
    rounding = 1e-9 * np.ptp(x)
    for plane in (at, 0.0 if abs(at) < NEAR * findings.patch.a else at):
        sides = (way * (x - plane) < rounding for way in (1, -1))
        below, above = (part.extract_points(side, adjacent_cells=False) for side in sides)
        if below.n_cells + above.n_cells == part.n_cells:
            return outer(below)
    return outer(part.clip(normal="x", origin=(at, 0.0, 0.0)))


def _around(points: Array, towards: Array) -> Camera:
    """A camera that looks from the direction `towards` (3,) and whose image just holds all points
    (n, 3), mm.
    """
    image = Camera(np.zeros(3), towards, 1.0, 1.0)
    flat = image.project(points)
    middle = (flat.min(0) + flat.max(0)) / 2 @ image.axes[:2]
    return Camera(middle, towards, *(0.52 * np.ptp(flat, axis=0)))


def _legend(figure: Figure, axes: Axes, names: Mapping[str, str], drawn: Iterable[str]) -> None:
    """Draw the legend of the bodies that are drawn and of the patch, and say on the axes which body
    is not meshed. names: in pictures, by body name.
    """
    from matplotlib.patches import Patch as Swatch

    swatches = [Swatch(fc=COLOURS[name], ec=EDGE, label=names[name]) for name in drawn]
    swatches.append(Swatch(fc=CONTACT, label="contact patch"))
    figure.legend(handles=swatches, loc="outside upper center", ncols=3)
    for name in set(BODY_NAMES.values()).difference(drawn):
        text, side = f"{names[name]}: not meshed", 0.25 if name == "rail" else 0.75
        axes.text(0.5, side, text, transform=axes.transAxes, ha="center")


def stresses_of_solid(
    grid: meshio.Mesh, axis: int, findings: Findings, target: Target = None
) -> Figure:
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


def stresses_of_section(
    grid: meshio.Mesh, axis: int, findings: Findings, target: Target = None
) -> Figure:
    """The smallest principal stress and the largest shear stress around the contact, of a section
    in two dimensions; solids are drawn by `stresses_of_solid`.

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
                label=STRESSES[number],
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

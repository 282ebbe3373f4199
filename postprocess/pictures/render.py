"""Pictures of the bodies and their mesh: of solids by a parallel camera, of sections as polygons.

Images of meshes are shaded; lines and labels are placed over them in mm. The grids are those of
`vtu`, of whole bodies with the images of what symmetry left out; nothing is deformed. All text is
set by matplotlib. VTK's own colour bars and scales are not used: their number formats go through
std::regex, which ends the process once the libraries of dolfinx are loaded beside VTK.
"""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass, field
from typing import Any

import meshio
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import griddata
from scipy.spatial import cKDTree

from railhead.meshing import isolated_process
from railhead.meshing.bodies import BODY_NAMES
from railhead.postprocess.findings import Array, Findings, Frame, Patch
from railhead.postprocess.pictures.diagrams import FE, Target, new_figure
from railhead.theory.elastic.line import Hertz

COLOURS = {"rail": "#b4c3d3", "wheel": "#dcc9a3"}
FREE_SURFACE, EDGE, CONTACT = "#d9dfe5", "#5a6570", "#b2182b"
GRAPHICS_BYTES = 1_200_000_000  # address space that VTK and Mesa map; with less they crash
NEAR = 0.1  # of the patch's half length: a plane of the mesh so near to the contact will do
BESIDE = 0.15  # of half the picture: from a patch to a dimension line, and to its words, at least
LABELS = 0.83, 0.92  # of half the picture: the middles of words stay within, none is cut
SEVERAL = 1.2  # times as much is seen of several patches: the lines stand beside one of them
MESH = {"show_edges": True, "edge_color": EDGE, "edge_opacity": 0.6, "line_width": 0.8}
SHADE = {"ambient": 0.45, "diffuse": 0.6}


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
        plotter = self.plotter(meshes)
        image = plotter.screenshot(return_img=True)
        plotter.close()
        return np.asarray(image)

    def plotter(self, meshes: list[tuple[Any, dict[str, Any]]]) -> Any:
        """A pyvista plotter, off screen, with the meshes and this camera. Each mesh comes with its
        keyword arguments for `Plotter.add_mesh`. The caller must close the plotter.
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
        return plotter

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
    from matplotlib.patches import Patch as Swatch

    frame, patch = findings.frame, findings.patch
    halves = {name: behind(part, findings) for name, part in bodies_of(grid).items()}
    meshes = [(half, {"color": COLOURS[name], **MESH, **SHADE}) for name, half in halves.items()]
    corners = np.concatenate([half.points for half in halves.values()])
    general = _around(corners, np.array([1.0, 0.5, 0.35]))
    low, high = patch.box
    reach = (high - low).max()
    middle = _global(frame, [[0.0, (low[1] + high[1]) / 2, 0.0]])[0]
    close = Camera(middle, frame.axes[0], 0.7 * reach, reach, frame.axes[2], pixels=900)
    names = findings.subject.names
    with new_figure(target, 10, 6.6, findings) as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1.6, 1))
        general.show(left, general.shoot(meshes))
        left.set_axis_off()
        left.set_title("cut open at the contact")
        close.show(right, close.shoot(meshes), np.array(frame.origin))
        surface = findings.surface
        for line in patch.outlines:
            s = np.linspace(line[:, 1].min(), line[:, 1].max(), 61)
            at = _on(surface, frame, np.column_stack((np.zeros_like(s), s)))
            right.plot(s, frame.local(at)[:, 2], color=CONTACT, lw=3, label="contact patch")
        right.set(
            title="the same cut, close" + (", gauge side left" if findings.subject.gauge else ""),
            xlabel=findings.subject.label(1).split("\n")[0],
        )
        right.set(xlim=right.get_xlim(), ylim=right.get_ylim())
        right.set_ylabel("height over the contact, mm")
        swatches = [Swatch(fc=COLOURS[name], ec=EDGE, label=names[name]) for name in halves]
        for name in set(BODY_NAMES.values()) - set(halves):
            text, side = f"{names[name]}: not meshed", 0.25 if name == "rail" else 0.75
            right.text(0.5, side, text, transform=right.transAxes, ha="center")
        figure.legend(handles=[*swatches, right.lines[0]], loc="outside upper center", ncols=3)
    return figure


def section(grid: meshio.Mesh, axis: int, findings: Findings, target: Target = None) -> Figure:
    """Two panels: the whole section with its mesh, and the mesh around the contact.

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
            text, side = f"{names[name]}: not meshed", 0.25 if name == "rail" else 0.75
            right.text(0.5, side, text, transform=right.transAxes, ha="center")
        reach = 2.5 * half
        right.set(xlim=(middle - reach, middle + reach), ylim=(-1.2 * reach, 1.2 * reach))
        right.set_title("close")
        swatches = [Swatch(fc=COLOURS[name], ec=EDGE, label=names[name]) for name in skins]
        swatches.append(Swatch(fc=CONTACT, label="contact patch"))
        figure.legend(handles=swatches, loc="outside lower center", ncols=3)
    return figure


def patch_on_rail(
    grid: meshio.Mesh, findings: Findings, hertz: Hertz | None, target: Target = None
) -> Figure:
    """The pressure on the contact surface, seen obliquely from above, with outlines and dimensions
    of the patch.

    grid: the contact surface, as `vtu.contact_grid` makes it. hertz: exact Hertz contact,
        whose outline is drawn too, or None.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    frame, patch = findings.frame, findings.patch
    surface = outer(load_pyvista().from_meshio(grid))
    pressed, free = split(surface, frame, patch)
    shown = (0.0, float(surface["pressure"].max()))
    plain = {"lighting": False, "color": FREE_SURFACE}
    # without light, so that the colours are those of the colour bar
    look = {"lighting": False, "scalars": "pressure", "cmap": "YlOrRd", "clim": shown}
    lines = {"style": "wireframe", "color": EDGE, "opacity": 0.3, "line_width": 0.8}
    camera = camera_over(findings)
    with new_figure(target, 10, 6.8, findings) as figure:
        axes = figure.subplots()
        nearer = surface.translate(1e-3 * camera.half_width * frame.axes[2])
        image = camera.shoot([(free, plain), (pressed, look), (nearer, lines)])
        camera.show(axes, image)
        axes.set_axis_off()
        for number, line in enumerate(patch.outlines):
            name = findings.subject.method if number == 0 else None
            axes.plot(*camera.project(_on(surface, frame, line)).T, color=FE, lw=2.2, label=name)
        if hertz is not None:
            line = camera.project(_on(surface, frame, hertz.outline))
            axes.plot(*line.T, "--", color="black", lw=1.4, label="exact Hertz")
        _dimensions(axes, camera, findings)
        colours = ScalarMappable(Normalize(*shown), "YlOrRd")
        figure.colorbar(colours, ax=axes, label="contact pressure, MPa", shrink=0.8)
        figure.legend(loc="outside upper center", ncols=2)
    return figure


def camera_over(findings: Findings) -> Camera:
    """A camera that looks obliquely from above at the middle of all patches, and shows them all."""
    frame = findings.frame
    low, high = findings.patch.box
    reach = (high - low).max() * (SEVERAL if len(findings.patch.outlines) > 1 else 1.0)
    middle = _global(frame, [[*(low + high) / 2, 0.0]])[0]
    towards = np.array([-0.3, -0.6, 1.0]) @ frame.axes
    return Camera(middle, towards, reach, 0.72 * reach, frame.axes[2])


def bodies_of(grid: meshio.Mesh) -> dict[str, Any]:
    """Split a grid of cells, tagged by its cell data "body", into one pyvista grid for each body,
    by body name.
    """
    volume = load_pyvista().from_meshio(grid)
    tags = np.unique(volume["body"])
    return {BODY_NAMES[int(tag)]: volume.extract_cells(volume["body"] == tag) for tag in tags}


def split(surface: Any, frame: Frame, patch: Patch) -> tuple[Any, Any]:
    """Cut a pyvista contact surface along the outlines of all patches, into the part inside and the
    part outside. Both carry the point data "outside": distance to the nearest outline point in x
    and s, mm, negative inside. Triangles that a patch covers only in part are cut.
    """
    from matplotlib.path import Path as Path2D

    local = frame.local(surface.points)[:, :2]
    distance = cKDTree(np.concatenate(patch.outlines)).query(local)[0]
    inside = np.zeros(len(local), dtype=bool)
    for line in patch.outlines:  # a hole in a patch turns it round
        inside ^= Path2D(line).contains_points(local)
    surface = surface.copy()
    surface["outside"] = np.where(inside, -distance, distance)
    pressed = surface.clip_scalar(scalars="outside", value=0.0)
    return pressed, surface.clip_scalar(scalars="outside", value=0.0, invert=False)


def outer(part: Any) -> Any:
    """Outer faces of a pyvista grid as a surface, with the cells' straight edges."""
    return part.extract_surface(nonlinear_subdivision=0, algorithm="dataset_surface")


def behind(part: Any, findings: Findings) -> Any:
    """Outer faces, as a pyvista surface, of the half of a body that lies at smaller x than the
    contact point.
    """
    return outer(_half(part, findings.frame.origin[0], NEAR * findings.patch.a))


def _half(part: Any, at: float, reach: float) -> Any:
    """Cells of a body at x below `at`, mm. If a plane between cells lies there, or at x = 0 within
    `reach` (mm) of `at`, the body is parted at it. Otherwise cells are clipped at `at`.
    """
    x = part.points[:, 0]
    rounding = 1e-9 * np.ptp(x)
    for plane in (at, 0.0 if abs(at) < reach else at):
        sides = (way * (x - plane) < rounding for way in (1, -1))
        below, above = (part.extract_points(side, adjacent_cells=False) for side in sides)
        if below.n_cells + above.n_cells == part.n_cells:
            return below
    return part.clip(normal="x", origin=(at, 0.0, 0.0))


def _dimensions(axes: Axes, camera: Camera, findings: Findings) -> None:
    """Draw on the axes the dimension lines 2a along x and 2b along s beside the most loaded patch.
    Where the subject has them, also name the gauge side, the field side and the direction of
    rolling.
    """
    frame, patch, subject = findings.frame, findings.patch, findings.subject
    length, width = (subject.units.text(2 * half, "mm") for half in (patch.a, patch.b))
    (x0, s0), (x1, s1) = patch.main.min(axis=0), patch.main.max(axis=0)
    away = max(0.2 * max(x1 - x0, s1 - s0), BESIDE * camera.half_width)
    low, high = patch.box[0][1], patch.box[1][1]
    beyond = s1 + away if high - s1 < s0 - low else s0 - away  # off other patches
    lines = {
        f"2a = {length}\n(x, {subject.along})": [[x0, beyond, 0], [x1, beyond, 0]],
        f"2b = {width}\n(s, {subject.across})": [
            [x0 - away, s0, 0],
            [x0 - away, s1, 0],
        ],
    }
    middle = camera.project(_global(frame, [[(x0 + x1) / 2, (s0 + s1) / 2, 0]]))[0]
    box = {"fc": "white", "ec": "none", "alpha": 0.85, "pad": 2}
    look: dict[str, Any] = {"ha": "center", "va": "center", "bbox": box, "clip_on": True}
    inside = np.array([camera.half_width, camera.half_height]) * LABELS
    for text, line in lines.items():
        start, stop = camera.project(_global(frame, line))
        arrow = {"arrowstyle": "<->", "shrinkA": 0, "shrinkB": 0, "lw": 1.5}
        axes.annotate("", tuple(start), tuple(stop), arrowprops=arrow)
        outwards = (start + stop) / 2 - middle
        beside = max(away, BESIDE * camera.half_width) * outwards / np.linalg.norm(outwards)
        right, upwards = np.clip((start + stop) / 2 + beside, -inside, inside)
        axes.text(right, upwards, text, **look)
    ends = {"gauge side": (x0 - away, s0 - away / 2), "field side": (x0 - away, s1 + away / 2)}
    sides = ends if subject.gauge else {}
    if subject.rolls:
        sides["rolls"] = (x1 + away / 2, beyond)
    for text, at in sides.items():
        right, upwards = camera.project(_global(frame, [[*at, 0.0]]))[0]
        axes.text(right, upwards, text, style="italic", **look)


def _around(points: Array, towards: Array) -> Camera:
    """A camera that looks from the direction `towards` (3,) and whose image just holds all points
    (n, 3), mm.
    """
    image = Camera(np.zeros(3), towards, 1.0, 1.0)
    flat = image.project(points)
    middle = (flat.min(0) + flat.max(0)) / 2 @ image.axes[:2]
    return Camera(middle, towards, *(0.52 * np.ptp(flat, axis=0)))


def _global(frame: Frame, local: ArrayLike) -> Array:
    """Points (n, 3) in space, mm, from x, s and height in the contact frame (n, 3)."""
    return np.asarray(np.array(frame.origin) + np.asarray(local) @ frame.axes)


def _on(surface: Any, frame: Frame, line: Array) -> Array:
    """Points (n, 3) in space, mm, of a curve (n, 2) of x and s in the frame, mm, at the heights of
    a contact surface there. These are linear between its points; where it ends, the points lie on
    the tangent plane. surface: has points (k, 3) in space, mm. frame: axes of the tangent plane.
    """
    local = frame.local(surface.points)
    near = np.abs(local).max(axis=1) < 2 * np.abs(line).max()
    height = griddata(local[near, :2], local[near, 2], line, fill_value=0.0)
    return _global(frame, np.column_stack((line, height)))

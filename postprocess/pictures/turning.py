"""Views in three dimensions that turn in a browser, for vtk.js: no network, no server."""

from __future__ import annotations

import io
import json
import zipfile
from dataclasses import dataclass
from typing import Any

import meshio
import numpy as np

from railhead.postprocess import vtu
from railhead.postprocess.findings import Array, Findings
from railhead.postprocess.pictures.render import (
    EDGE,
    FREE_SURFACE,
    SHADE,
    Camera,
    behind,
    bodies_of,
    load_pyvista,
    outer,
    split,
)
from railhead.solver.system.fields import Fields

STRESS, PRESSURE = "von_mises", "pressure"
COLOURS = "YlOrRd"
HILL = 0.35  # height of the largest pressure over the length of the patch
STEPS = 48  # around a body of revolution
OPEN = 270.0  # degrees of it that are drawn
LONGEST = 3.0  # half widths of a line contact that are drawn of its length
PIXELS = 900


@dataclass(frozen=True, kw_only=True)
class View:
    """A scene in three dimensions that turns in a browser.

    name: its title.
    text: one line that says what is seen.
    top: stress or pressure of the last colour, MPa; that of the first colour is 0.
    colours: nine colours from the first to the last, as hexadecimal codes.
    scene: content of a zip file that vtk.js's OfflineLocalView reads.
    still: the same view as a PNG image, for paper.
    """

    name: str
    text: str
    top: float
    colours: list[str]
    scene: bytes
    still: bytes


def views(fields: Fields, findings: Findings, volume: meshio.Mesh) -> list[View]:
    """Two views: von Mises stress in the bodies, cut open at the contact, and the contact pressure
    as a hill over the contact surface.

    Bodies of a plane section are drawn with a length, those of a meridian section turned about the
    axis. findings: with the whole contact surface. volume: grid of the whole bodies, images
    included, as `vtu.volume_grid` makes it.
    """
    low, high = findings.patch.main.min(axis=0), findings.patch.main.max(axis=0)
    if fields.kinematics.dim == 2:
        solids, hill = _swept_bodies(fields, findings, volume), _swept_hill(fields, findings)
        (axis,) = fields.kinematics.varying
        towards = np.array(([0.45, -1.0, 0.35], [1.0, 0.45, 0.35])[axis])
        low[1 - axis], high[1 - axis] = 0.0, 0.0  # the length of the contact is not looked at
    else:
        solids = [behind(part, findings) for part in bodies_of(volume).values()]
        hill, towards = _hill(fields, findings), np.array([1.0, 0.5, 0.35])
    reach = float((high - low).max())
    frame, centre = findings.frame, np.array([*(low + high) / 2, 0.0])
    focal = np.array(frame.origin) + centre @ frame.axes
    close = Camera(focal, towards @ frame.axes, 1.7 * reach, 1.02 * reach, frame.axes[2], PIXELS)
    above = np.array([-0.3, -0.6, 0.7]) @ frame.axes
    over = Camera(focal, above, 1.4 * reach, 0.84 * reach, frame.axes[2], PIXELS)
    most = max(each.von_mises.value for each in findings.largest.values())
    pressed, free = hill
    plain: dict[str, Any] = {"color": FREE_SURFACE, "show_edges": True, "edge_color": EDGE}
    return [
        _view(
            "Stress",
            "von Mises stress in the bodies, cut open at the contact",
            most,
            close,
            [(_bare(each, STRESS), {"scalars": STRESS}) for each in solids],
        ),
        _view(
            "Pressure",
            "contact pressure as a hill over the surface",
            findings.patch.max_pressure,
            over,
            [
                (_bare(pressed, PRESSURE), {"scalars": PRESSURE}),
                *((_bare(each), plain | {"edge_opacity": 0.3}) for each in free),
            ],
        ),
    ]


def _bare(surface: Any, *keep: str) -> Any:
    """Outer triangles of a pyvista mesh in single precision, with only those point data whose names
    are in `keep`.
    """
    surface = surface.extract_surface(
        algorithm="dataset_surface", pass_cellid=False, pass_pointid=False
    ).triangulate()
    bare = load_pyvista().PolyData(surface.points.astype(np.float32), surface.faces)
    for name in keep:
        bare[name] = np.asarray(surface[name], dtype=np.float32)
    return bare


def _hill(fields: Fields, findings: Findings) -> tuple[Any, list[Any]]:
    """Pyvista surface of all patches, its points raised along the rail's normal in proportion to
    the pressure. The largest is raised by 0.35 (HILL) times the longer side of the most loaded
    patch, or the shorter one if that is less than a sixth. Then, in a list of one, the contact
    surface around them.
    """
    frame, patch = findings.frame, findings.patch
    contact = vtu.contact_grid({fields.slave: findings.surface})
    pressed, free = split(outer(load_pyvista().from_meshio(contact)), frame, patch)
    rim = np.abs(pressed["outside"]) < 1e-6 * np.ptp(patch.main)
    pressed[PRESSURE] = np.where(rim, 0.0, pressed[PRESSURE])
    long, wide = sorted(np.ptp(patch.main, axis=0), reverse=True)
    size = float(wide if long > 6 * wide else long)  # not a tower
    raised = _raised(findings, pressed[PRESSURE], size)
    pressed.points = pressed.points + raised[:, None] * frame.axes[2]
    return pressed, [free]


def _raised(findings: Findings, pressure: Array, size: float) -> Array:
    """Height (n,) of the hill, mm, over points with pressure (n,) in MPa, in proportion to it: 0.35
    (HILL) times `size` (mm) at the largest pressure.
    """
    return np.asarray(HILL * size * pressure / findings.patch.max_pressure)


def _swept_bodies(fields: Fields, findings: Findings, volume: meshio.Mesh) -> list[Any]:
    """Bodies of a section as pyvista solids with von Mises stress: turned by 270 degrees about the
    axis for a meridian section, otherwise extruded along the contact line.
    """
    found = []
    for part in bodies_of(volume).values():
        if fields.kinematics.revolved:  # one side of the meridian section
            part = part.extract_cells(part.cell_centers().points[:, 0] > 0)
        flat = outer(part)
        for array in [name for name in flat.point_data if name != STRESS]:
            del flat.point_data[array]
        flat.cell_data.clear()
        if fields.kinematics.revolved:
            found.append(flat.extrude_rotate(resolution=STEPS, angle=OPEN, capping=True))
            continue
        found.append(flat.extrude(_along(fields, findings), capping=True))
    return found


def _along(fields: Fields, findings: Findings) -> Array:
    """Vector (3,) in space, mm, along which a plane section is extruded, away from the eye. Its
    length is the thickness, at most three half widths of the patch (LONGEST).
    """
    patch, axis = findings.patch, fields.kinematics.varying[0]
    length = min(fields.kinematics.thickness, LONGEST * (patch.a, patch.b)[axis])
    return np.asarray(length * (findings.frame.axes[1] if axis == 0 else -findings.frame.axes[0]))


def _swept_hill(fields: Fields, findings: Findings) -> tuple[Any, list[Any]]:
    """Pyvista surface whose height is the pressure along a section: a ridge extruded along the
    contact line, or half a turn about the axis for a meridian section. Then an empty list: there is
    no surface around it.
    """
    frame, axis = findings.frame, fields.kinematics.varying[0]
    line = (findings.along, findings.across)[axis]
    raised = _raised(findings, line.pressure, 2 * (findings.patch.a, findings.patch.b)[axis])
    local = np.zeros((len(raised), 3))
    local[:, axis], local[:, 2] = line.coordinate, raised
    if fields.kinematics.revolved:
        turn = np.linspace(0, np.pi, STEPS)
        x, y = np.outer(np.cos(turn), local[:, axis]), np.outer(np.sin(turn), local[:, axis])
        points = np.stack([x, y, np.broadcast_to(local[:, 2], x.shape)], axis=-1)
        points = points + np.array(frame.origin)
    else:
        start = np.array(frame.origin) + local @ frame.axes
        half = _along(fields, findings) / 2
        points = start + np.array([-1.0, 1.0])[:, None, None] * half
    x, y, z = np.moveaxis(points[None], -1, 0)
    grid = load_pyvista().StructuredGrid(x, y, z)
    grid[PRESSURE] = np.broadcast_to(line.pressure, points.shape[:2])[None].ravel(order="F")
    return grid, []


def _view(
    name: str, text: str, top: float, camera: Camera, meshes: list[tuple[Any, dict[str, Any]]]
) -> View:
    """Render meshes in perspective, and pack the scene and its image.

    name, text, top: entries of the view. camera: gives the direction and the visible height.
        meshes: pyvista meshes with keyword arguments for `Plotter.add_mesh`; those with "scalars"
        are coloured from 0 to `top`, MPa.
    """
    import matplotlib.image
    from matplotlib.colors import to_hex

    look = {"cmap": COLOURS, "clim": (0.0, top), **SHADE}
    plotter = camera.plotter(
        [(each, look | own if "scalars" in own else own) for each, own in meshes]
    )
    eye = plotter.camera  # vtk.js knows perspective alone: as far away as shows the same height
    distance = camera.half_height / np.tan(np.radians(eye.view_angle) / 2)
    eye.parallel_projection = False
    eye.position = camera.focal + distance * camera.axes[2]
    plotter.renderer.reset_camera_clipping_range()
    still = io.BytesIO()
    image = plotter.screenshot(return_img=True)
    matplotlib.image.imsave(still, image, format="png")
    scene = packed(plotter)
    plotter.close()
    colours = [to_hex(c) for c in matplotlib.colormaps[COLOURS](np.linspace(0, 1, 9))]
    return View(name=name, text=text, top=top, colours=colours, scene=scene, still=still.getvalue())


def packed(plotter: Any) -> bytes:
    """Content of a zip file that vtk.js reads, with the scene of a rendered pyvista plotter."""
    from trame_vtk.modules.vtk.serializers import (
        SynchronizationContext,
        extract_array_hash,
        initialize_serializers,
        reference_id,
        serialize,
    )

    initialize_serializers()
    context, window = SynchronizationContext(), plotter.render_window
    context.set_ignore_last_dependencies(True)
    scene = serialize(None, window, reference_id(window), context, 1)
    scene["extra"] = {
        "vtkRefId": reference_id(window),
        "centerOfRotation": list(plotter.camera.focal_point),
        "camera": reference_id(plotter.camera),
    }
    arrays = {
        each["hash"]: {**each, "content": context.get_cached_data_array(each["hash"], False)}
        for each in extract_array_hash(scene)
    }
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("index.json", json.dumps({"hashes": arrays, "scene": scene}))
    return content.getvalue()


def viewer() -> str:
    """Text of the HTML page with vtk.js that shows a zip file of a scene; its script function
    loadDataSet() opens the file.
    """
    from trame_vtk.tools.vtksz2html import HTML_VIEWER_PATH

    return str(HTML_VIEWER_PATH.read_text(encoding="utf-8"))

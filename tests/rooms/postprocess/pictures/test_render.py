"""The pictures in space: the camera, mirrored models, scale and colours."""

import os
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.image import imread

from railhead.postprocess import vtu
from railhead.postprocess.pictures import render, stress_cuts
from railhead.postprocess.pictures.render import Camera, load_pyvista


def image(path) -> Any:
    """(h, w, 3) of a PNG file, 0 to 1."""
    return imread(path)[:, :, :3]


def draw(case: Any, folder) -> dict[str, Any]:
    """All three pictures of a case, by name."""
    folder.mkdir()
    volume = case.volume
    contact = vtu.contact_grid({1: case.findings.surface})
    render.wheel_rail(volume, case.findings, folder / "wheel_rail.png")
    stress_cuts.of_solid(volume, 1, case.findings, folder / "stress_cut.png")
    render.patch_on_rail(contact, case.findings, case.ellipse, folder / "patch_on_rail.png")
    return {path.stem: image(path) for path in folder.iterdir()}


@pytest.fixture(scope="module")
def usual(blocks, tmp_path_factory) -> dict[str, Any]:
    """Pictures of a quarter of hexahedra under 25 kN."""
    return draw(blocks(), tmp_path_factory.mktemp("usual") / "quarter")


def test_camera_draws_where_it_projects() -> None:
    focal, towards = np.array([5.0, -2.0, 1.0]), np.array([1.0, 0.5, 0.35])
    camera = Camera(focal, towards, 8.0, 6.0, pixels=400)
    assert camera.axes @ camera.axes.T == pytest.approx(np.eye(3), abs=1e-14)
    spot = np.array([6.0, 1.0, 3.0])
    ball = load_pyvista().Sphere(radius=1.5, center=spot, theta_resolution=90, phi_resolution=90)
    picture = camera.shoot([(ball, {"color": "red", "lighting": False})]).astype(float)
    assert picture.shape == (300, 400, 3)
    rows, columns = np.nonzero((picture[:, :, 0] > 200) & (picture[:, :, 1] < 50))
    place = np.array([columns.mean() + 0.5, 300 - rows.mean() - 0.5]) / 25 - [8.0, 6.0]
    assert place == pytest.approx(camera.project(spot[None])[0], abs=0.02)
    assert len(rows) == pytest.approx(np.pi * 1.5**2 * 25**2, rel=0.03)


@pytest.mark.parametrize(
    ("display", "given", "expected"),
    [
        ("", None, "vtkEGLRenderWindow"),
        (None, None, "vtkEGLRenderWindow"),
        ("", "vtkOSOpenGLRenderWindow", "vtkOSOpenGLRenderWindow"),
        (":0", None, None),
    ],
)
def test_no_display_no_window(
    monkeypatch: pytest.MonkeyPatch, display: str | None, given: str | None, expected: str | None
) -> None:
    for key, value in (("DISPLAY", display), ("VTK_DEFAULT_OPENGL_WINDOW", given)):
        monkeypatch.setenv(key, value or "")
        if value is None:
            monkeypatch.delenv(key)
    load_pyvista()
    assert os.environ.get("VTK_DEFAULT_OPENGL_WINDOW") == expected


def test_a_whole_model_is_opened_between_its_cells(blocks) -> None:
    """Points of the plane of the cut are off it by rounding, where clipping leaves slivers; so does
    a contact that is a little off that plane. A plane further away cuts cells."""
    case = blocks("tetrahedron", 2, cut=False)
    found, volume = case.findings, case.volume
    for body in render.bodies_of(volume).values():
        on = np.flatnonzero(np.abs(body.points[:, 0]) < 1e-9)
        body.points[on, 0] = 1e-13 * (-1.0) ** np.arange(len(on))
        for origin, opened in ((0.0, 0.0), (0.05, 0.0), (0.6, 0.6)):
            frame = replace(found.frame, origin=(origin, 0.0, 0.0))
            skin = render.behind(body, replace(found, frame=frame)).triangulate()
            assert skin.bounds[1] == pytest.approx(opened, abs=1e-6)
            corners = skin.points[skin.faces.reshape(-1, 4)[:, 1:]]
            cut = (np.abs(corners[:, :, 0] - opened) < 1e-6).all(axis=1)
            area = skin.compute_cell_sizes()["Area"][cut]
            depth, width = (np.ptp(body.points[:, axis]) for axis in (2, 1))
            assert area.sum() == pytest.approx(depth * width, rel=1e-6)
            assert opened or area.min() > 1e-3 * area.max()


def test_pressure_has_the_colours_of_the_bar(blocks, tmp_path, sharp: None) -> None:
    case = blocks(cut=False)
    contact = vtu.contact_grid({1: case.findings.surface})
    render.patch_on_rail(contact, case.findings, case.ellipse, tmp_path / "with.png")
    render.patch_on_rail(contact, case.findings, None, tmp_path / "without.png")
    with_it, without = image(tmp_path / "with.png"), image(tmp_path / "without.png")
    free = np.abs(without - to_rgb(render.FREE_SURFACE)).max(axis=2) < 2 / 255
    assert free.mean() > 0.2
    darkest = np.abs(without - (128 / 255, 0, 38 / 255)).max(axis=2) < 8 / 255  # end of YlOrRd
    bar = np.zeros_like(darkest)
    bar[:, 1350:] = True
    assert darkest[bar].sum() > 20
    assert darkest[~bar].sum() > 500
    black = [(each.max(axis=2) < 0.05).sum() for each in (with_it, without)]
    assert black[0] > black[1] + 1000


@pytest.mark.parametrize("apart", [0.0, 3.0, -3.0])
def test_dimensions_are_whole_and_off_the_patches(blocks, apart: float) -> None:
    """Beside a patch three times as long across the rail, and beside one of two."""
    findings = blocks().findings
    patch = findings.patch
    main = patch.outlines[0] * [0.3, 1.0]
    outlines = [main] if not apart else [main, main + [0.0, apart * patch.b]]
    shown = replace(findings, patch=replace(patch, outlines=outlines))
    camera = render.camera_over(shown)
    figure = Figure(figsize=(10, 6.8))
    axes = figure.add_axes((0.0, 0.0, 0.84, 0.9))
    camera.show(axes, np.full((10, 14, 3), 255, dtype=np.uint8))
    render._dimensions(axes, camera, shown)
    FigureCanvasAgg(figure).draw()
    frame = axes.get_window_extent()
    seen = [
        axes.transData.transform(camera.project(np.column_stack((line, 0 * line[:, 0]))))
        for line in outlines
    ]
    for text in filter(lambda each: each.get_text(), axes.texts):
        words = text.get_window_extent()
        assert frame.x0 <= words.x0
        assert words.x1 <= frame.x1
        assert frame.y0 <= words.y0
        assert words.y1 <= frame.y1
        assert not any(words.contains(*point) for line in seen for point in line)

"""The pictures in space: the camera, mirrored models, scale and colours."""

import os
from dataclasses import replace

import numpy as np
import pytest

from railhead.postprocess.pictures import render
from railhead.postprocess.pictures.render import Camera, load_pyvista


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

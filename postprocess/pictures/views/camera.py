"""A parallel camera: shaded images of meshes, with lines and labels placed over them in mm.

All text is set by matplotlib. VTK's own colour bars and scales are not used: their number formats
go through std::regex, which ends the process once the libraries of dolfinx are loaded beside VTK.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from railhead.postprocess.findings import Array


def load_pyvista() -> Any:
    """The pyvista module, imported at first use because the import is slow. Without a DISPLAY it is
    set to draw off screen through EGL.
    """
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

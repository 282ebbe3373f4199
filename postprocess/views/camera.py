"""A parallel camera: shaded images of meshes, with lines and labels placed over them in mm.

All text is set by matplotlib. VTK's own colour bars and scales are not used: their number formats
go through std::regex, which ends the process once the libraries of dolfinx are loaded beside VTK.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from railhead.postprocess.findings import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def load_pyvista() -> Any:
    """pyvista, imported at first use as it is slow; it draws without a display if there is none."""
    if not os.environ.get("DISPLAY"):
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    import pyvista

    return pyvista


@dataclass(frozen=True)
class Camera:
    """A parallel camera.

    focal (3,): point in the middle of the image, mm.
    towards (3,): direction from there to the eye; z, or `up`, points upwards.
    half_width, half_height: of what is seen, mm.
    pixels: of the longer side.
    """

    focal: Array
    towards: Array
    half_width: float
    half_height: float
    up: Array = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    pixels: int = 1200

    @property
    def axes(self) -> Array:
        """(3, 3) rows: unit vectors to the right, upwards and to the eye."""
        eye = self.towards / np.linalg.norm(self.towards)
        right = np.cross(self.up, eye)
        right /= np.linalg.norm(right)
        return np.array([right, np.cross(eye, right), eye])

    def project(self, points: Array) -> Array:
        """Position (n, 2) in the image, mm from its middle, of points (n, 3) in space, mm."""
        return np.asarray((points - self.focal) @ self.axes[:2].T)

    def shoot(self, meshes: list[tuple[Any, dict[str, Any]]]) -> NDArray[np.uint8]:
        """Image (h, w, 3) of pyvista meshes, each with its options for `add_mesh`."""
        plotter = self.plotter(meshes)
        image = plotter.screenshot(return_img=True)
        plotter.close()
        return np.asarray(image)

    def plotter(self, meshes: list[tuple[Any, dict[str, Any]]]) -> Any:
        """A pyvista plotter of meshes with options for `add_mesh`; the caller closes it."""
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
        """Put the image on axes whose data coordinates are mm in the image, from `origin` (3,)."""
        shift = np.zeros(2) if origin is None else self.project(origin[None])[0]
        w, h = self.half_width, self.half_height
        left, low = -w - shift[0], -h - shift[1]
        axes.imshow(image, extent=(left, left + 2 * w, low, low + 2 * h))
        axes.grid(False)

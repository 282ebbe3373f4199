"""The pictures of bodies: what of them is drawn, and from where."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from railhead.postprocess.pictures import diagrams, render


@pytest.mark.parametrize(("origin", "opened"), [(0.0, 0.0), (0.05, 0.0), (0.6, 0.6)])
def test_a_solid_is_opened_at_the_contact(blocks, origin: float, opened: float) -> None:
    """A contact that is a little off the plane between cells, too."""
    case = blocks("tetrahedron", 2, cut=False)
    found = replace(case.findings, frame=replace(case.findings.frame, origin=(origin, 0.0, 0.0)))
    parts = render.bodies_of(render.straight(case.volume))
    skins = {name: render.skin(part, found) for name, part in parts.items()}
    for surface in skins.values():
        assert surface.bounds[1] == pytest.approx(opened, abs=1e-2)
        front = surface.points[:, 0] > surface.bounds[1] - 1e-6
        assert np.ptp(surface.points[front], axis=0)[1:] == pytest.approx(
            np.ptp(surface.points, axis=0)[1:]
        )


def test_the_nearest_face_is_drawn_last(blocks) -> None:
    pv = render.load_pyvista()
    skins = {name: pv.Plane(center=(x, 0, 0), direction=(1, 0, 0), i_resolution=1, j_resolution=1)
             for name, x in (("wheel", 1.0), ("rail", 0.0))}  # fmt: skip
    with diagrams.new_figure(None, 5, 5, blocks(cut=False).findings) as figure:
        axes = figure.add_subplot()
        render._draw_faces(axes, skins, np.roll(np.eye(3), -1, axis=0), np.zeros(3))  # from +x
    (drawn,) = axes.collections
    expected = [to_rgb(render.COLOURS[name]) for name in ("rail", "wheel")]
    np.testing.assert_allclose(drawn.get_facecolor()[:, :3], expected)


def test_a_solid_is_rendered_off_screen_in_its_colours(blocks) -> None:
    """Without margins; faces that look to the light are lighter."""
    case = blocks("tetrahedron", 2, cut=False)
    parts = render.bodies_of(render.straight(case.volume))
    shown = render.image({name: render.skin(part, case.findings) for name, part in parts.items()})
    assert shown.dtype == np.uint8 and min(shown.shape[:2]) > 400
    filled = (shown < 255).any(axis=2)
    assert filled[[0, -1]].any(axis=1).all() and filled[:, [0, -1]].any(axis=0).all()
    red, _, blue = shown[filled].astype(int).T
    assert (red > blue + 20).any() and (blue > red + 10).any()  # wheel and rail

"""The pictures of bodies: what of them is drawn, and from where."""

from dataclasses import replace

import numpy as np
import pytest

from railhead.postprocess.pictures import diagrams, render


def test_a_view_is_turned_to_the_eye() -> None:
    view = render.view_from(np.array([2.0, 1.0, 0.7]))
    assert view @ view.T == pytest.approx(np.eye(3), abs=1e-14) and np.linalg.det(view) > 0
    assert view[0, 2] == 0.0 and view[1, 2] > 0.9  # z upwards


@pytest.mark.parametrize(("origin", "opened"), [(0.0, 0.0), (0.05, 0.0), (0.6, 0.6)])
def test_a_solid_is_opened_at_the_contact(blocks, origin: float, opened: float) -> None:
    """A contact that is a little off the plane between cells, too. The nearest face is drawn
    last."""
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
    with diagrams.new_figure(None, 5, 5, found) as figure:
        axes = figure.add_subplot()
        render._draw_faces(axes, skins, render.view_from(np.array([1.0, 0.0, 0.0])), np.zeros(3))
    (drawn,) = axes.collections
    last = drawn.get_facecolor()[-20:, :3]
    light = [render.to_rgb(colour) for colour in render.COLOURS.values()]
    assert all(min(np.abs(each - colour).max() for colour in light) < 1e-6 for each in last)

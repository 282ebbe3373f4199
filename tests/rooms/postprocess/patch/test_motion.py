"""Rotation and movement of a body beside its patch, apart from what half-spaces do."""

from dataclasses import replace

import numpy as np
import pytest
from painted import POISSON, YOUNG

from railhead.postprocess.findings import Frame, OnePatch
from railhead.postprocess.patch.body_motion import motion
from railhead.theory.elastic.halfspace import boussinesq_displacement

LOAD = 25000.0


def _patch(centre: tuple[float, float, float], angle: float, a: float, b: float) -> OnePatch:
    return OnePatch(centre=centre, angle=angle, a=a, b=b, area=1.0, max_pressure=1.0, share=1.0)


@pytest.mark.parametrize("body", [1, 2])
@pytest.mark.parametrize("angle", [0.0, 0.2])
def test_a_rigid_motion_is_found_below_a_load(blocks, body, angle) -> None:
    case = blocks("tetrahedron", 2)
    b = case.ellipse.b / 2
    patch = _patch((0.0, 0.3, 0.0), angle, 0.8 * b, b)
    frame = Frame(patch.centre, patch.angle)
    points = case.fields.points
    turned, aside, sink = 3e-4, 0.02, -0.05
    y, z = points[:, 1] - 0.3, points[:, 2]
    rigid = np.column_stack([0 * y, aside - turned * z, sink + turned * y])
    mirror = np.array([1.0, 1.0, 1.0 if body == 1 else -1.0])
    local = frame.local(points) * mirror
    local[:, 2] = np.minimum(local[:, 2], 0.0)
    local[:, 0] += 1e-9 * (np.linalg.norm(local, axis=1) == 0)
    elastic = boussinesq_displacement(local, LOAD, YOUNG, POISSON) * mirror @ frame.axes
    fields = replace(case.fields, displacement=rigid + elastic)
    assert motion(fields, body, (patch,), LOAD) == pytest.approx((turned, aside), rel=1e-9)
    halved = motion(fields, body, (patch,), LOAD / 2)
    assert abs(halved[1] / aside - 1) > 1e-3 or angle == 0.0


def test_a_body_that_ends_within_its_patch_tells_no_motion(blocks) -> None:
    case = blocks("tetrahedron", 1)
    patch = _patch((0.0, 0.0, 0.0), 0.0, 1e3, 1e3)
    assert motion(case.fields, 1, (patch,), LOAD) == (0.0, 0.0)

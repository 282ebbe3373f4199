"""The contact surface as triangles, how far it is drawn, and how a body moves beside its patch."""

from dataclasses import replace

import basix
import numpy as np
import pytest
from matplotlib.image import imread
from painted import POISSON, YOUNG, painted

from railhead.postprocess.findings import Frame, OnePatch
from railhead.postprocess.patch import patch, surface
from railhead.postprocess.patch.body_motion import motion
from railhead.postprocess.patch.separate_patches import separate_patches
from railhead.postprocess.pictures import diagrams, render
from railhead.theory.elastic.halfspace import boussinesq_displacement


@pytest.mark.parametrize(
    ("cell", "degree"),
    [
        ("tetrahedron", 1),
        ("tetrahedron", 2),
        ("tetrahedron", 3),
        ("hexahedron", 1),
        ("hexahedron", 2),
    ],
)
def test_the_triangles_of_a_facet_cover_it_once(cell: str, degree: int) -> None:
    """Equal parts of the reference facet, whose nodes are in the order of dolfinx."""
    kind = basix.CellType.triangle if cell == "tetrahedron" else basix.CellType.quadrilateral
    variant = basix.LagrangeVariant.equispaced
    nodes = basix.create_element(basix.ElementFamily.P, kind, degree, variant).points
    first, second, third = nodes[np.array(surface._TRIANGLES[cell, degree])].transpose(1, 0, 2)
    areas = np.linalg.det(np.stack([second - first, third - first], axis=1)) / 2
    whole = 0.5 if cell == "tetrahedron" else 1.0
    assert np.abs(areas) == pytest.approx(whole / len(areas))
    middle = (first + second + third).mean(axis=0) / 3
    assert middle == pytest.approx(np.full(2, 1 / 3 if cell == "tetrahedron" else 1 / 2))


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


def lopsided(case):
    """The findings with an outline that reaches farther to negative s than its centre tells."""
    b = case.findings.patch.b
    line = case.findings.patch.outlines[0] * [1.0, 0.75] - [0.0, 0.25 * b]
    return replace(case.findings, patch=replace(case.findings.patch, outlines=[line], b=0.75 * b))


def test_the_bar_of_the_patch_is_as_wide_as_the_patch(blocks) -> None:
    case = blocks()
    close = render.wheel_rail(case.volume, lopsided(case)).axes[1]
    (bar,) = [line.get_xdata() for line in close.lines if line.get_color() == render.CONTACT]
    b = case.ellipse.b
    assert (bar.min(), bar.max()) == pytest.approx((-b, 0.5 * b), rel=1e-3)


def test_the_size_of_the_most_loaded_patch_is_said(blocks) -> None:
    found = lopsided(blocks())
    title = diagrams.patch(found, None).axes[0].get_title()
    assert title == f"2a = {2 * found.patch.a:.4g} mm, 2b = {2 * found.patch.b:.4g} mm"


def test_no_pressure_is_coloured_outside_the_outline(blocks, tmp_path, laid_out: None) -> None:
    case = blocks(cut=False)
    small = replace(
        case.findings.patch, outlines=[case.findings.patch.outlines[0] * 0.5]
    )  # a quarter of the area
    coloured = []
    for name, of in (("whole", case.findings.patch), ("half", small)):
        path = tmp_path / f"{name}.png"
        diagrams.patch(replace(case.findings, patch=of), case.ellipse, path)
        picture = imread(path)[:, :, :3]
        bar = int(0.8 * picture.shape[1])
        warm = (picture[:, :, 0] > 0.4) & (picture[:, :, 2] < 0.8 * picture[:, :, 0])
        coloured.append(warm[:, :bar].sum())
    assert coloured[1] == pytest.approx(coloured[0] / 4, rel=0.08)


def test_the_pressure_is_cut_through_its_peak_over_the_whole_patch() -> None:
    def two_hills(x, s):
        return np.maximum(1 - x**2 - ((s - 0.8) / 1.3) ** 2, 2 - 2 * x**2 - 3 * (s + 1.1) ** 2)

    fields = painted(two_hills, (1.5, 3.0), 0.12, waver=0.0)
    frame = Frame((0.0, 0.0, 0.0), 0.0)
    reading = patch.read(fields, separate_patches(fields), frame)
    found, along, across = reading.patch, reading.along, reading.across
    assert along.at == pytest.approx(-1.1, abs=0.05)
    assert found.centre[1] > -0.6  # a cut there would miss the peak
    for line, axis in ((along, 0), (across, 1)):
        assert line.pressure.max() == pytest.approx(found.max_pressure, rel=0.01)
        assert line.pressure[0] == line.pressure[-1] == 0.0
        assert line.coordinate.min() < found.main[:, axis].min()
        assert line.coordinate.max() > found.main[:, axis].max()

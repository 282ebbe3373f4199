"""The files for ParaView against solutions without symmetry, and both surfaces of a contact."""

import numpy as np
import pytest
import pyvista as pv
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import cKDTree
from solved import solved

import railhead as rh

ODD = 0.4  # relative: two coarse meshes differ by half of it, a wrong sign by 2


def coarse(*changes: str) -> rh.Scene:
    return rh.find("hertz_ellipse").replace(["mesh.patch_size=1.5", *changes])


def saved(scene: rh.Scene, folder, *, whole: bool = True):
    solved(scene).save(folder, pictures=False, whole=whole)
    return folder


def off(found, expected):
    """Relative L2 difference of each component."""
    size = np.linalg.norm(expected, axis=0)
    return np.linalg.norm(found - expected, axis=0) / np.maximum(size, 1e-300)


@pytest.mark.slow
def test_mirrored_fields_are_those_of_a_whole_model(tmp_path) -> None:
    """At points of three quarters that were not solved, in both bodies: all components."""
    quarter = pv.read(saved(coarse(), tmp_path / "quarter") / "solution.vtu")
    whole = pv.read(saved(coarse("effects.symmetry=off"), tmp_path / "whole") / "solution.vtu")
    assert quarter.bounds == pytest.approx(whole.bounds)
    corner = np.random.default_rng(1).uniform([0, 0, 1], [4, 3.4, 4], (800, 3))
    for signs in ((-1, 1, 1), (1, -1, -1), (-1, -1, 1), (-1, -1, -1)):
        places = pv.PolyData(corner * signs)
        one, other = places.sample(quarter), places.sample(whole)
        assert off(one["stress"], other["stress"]).max() < ODD
        assert off(one["displacement"], other["displacement"]).max() < ODD / 2


@pytest.mark.slow
def test_mirrored_friction_is_that_of_a_whole_model(tmp_path) -> None:
    """Rolling along: slip and tractions along the rail are even across it, slip across is odd."""
    rolls = ("friction.coefficient=0.3", "rolling.creepage_along=0.1%")
    half = saved(coarse(*rolls), tmp_path / "half")
    whole = saved(coarse(*rolls, "effects.symmetry_y=off"), tmp_path / "whole")
    one, other = (pv.read(folder / "traction.vtu") for folder in (half, whole))
    here = one.points[:, 1] < 0
    assert here.sum() == len(here) / 2
    for name, columns in (("slip", [0, 1]), ("traction", [0])):
        exact = LinearNDInterpolator(other.points[:, :2], other[name])(one.points[:, :2])
        seen = here & np.isfinite(exact[:, 0])
        assert off(one[name][seen], exact[seen])[columns].max() < ODD


def surfaces(folder):
    """By body."""
    file = pv.read(folder / "contact.vtu")
    return {
        int(body): file.extract_cells(file["body"] == body).extract_surface(
            nonlinear_subdivision=0, algorithm="dataset_surface"
        )
        for body in np.unique(file["body"])
    }


def carried(surface) -> float:
    """N, down."""
    cells = surface.point_data_to_cell_data().compute_cell_sizes(length=False, volume=False)
    down = np.abs(surface.compute_normals(point_normals=False)["Normals"][:, 2])
    return float(cells["pressure"] @ (cells["Area"] * down))


def test_both_surfaces_meet_under_the_same_pressure(tmp_path) -> None:
    """A 54E1 head and a wheel, warped by their displacement: 22 um apart before."""
    scene = rh.find("uic54_thesis").replace(["mesh.patch_size=1.2"])
    found = surfaces(saved(scene, tmp_path / "out"))
    assert set(found) == {1, 2}
    rail, wheel = (found[body].warp_by_vector("displacement") for body in (1, 2))
    for surface in (rail, wheel):
        assert carried(surface) == pytest.approx(25e3, rel=0.02)
        on = surface["status"] == 1
        assert np.array_equal(on, surface["pressure"] > 0)
        assert np.abs(surface["gap"][on]).max() < 3e-4
        assert surface["gap"].min() > -3e-4
    assert rail["pressure"].max() == pytest.approx(wheel["pressure"].max(), rel=0.01)
    for one, other in ((rail, wheel), (wheel, rail)):
        near = one["gap"] < 0.05
        apart = pv.PolyData(one.points[near]).compute_implicit_distance(other)
        assert np.abs(apart["implicit_distance"]) == pytest.approx(one["gap"][near], abs=1e-3)


def test_gaps_far_from_the_contact_are_those_of_the_surfaces(tmp_path) -> None:
    """Of two cylinders side on, whose surfaces turn away from each other: no gap is less than the
    distance to the other cylinder, nor falls away from the contact."""
    found = pv.read(saved(rh.find("two_cylinders"), tmp_path / "out") / "contact.vtu")
    moved = (found.points + found["displacement"])[:, 1:]
    for body, other in ((1, 2), (2, 1)):
        parts = [found.extract_cells(found["body"] == each) for each in (body, other)]
        own, opposite = (np.unique(part["vtkOriginalPointIds"]) for part in parts)
        line = moved[opposite[np.argsort(moved[opposite, 0])]]
        y = np.linspace(line[0, 0], line[-1, 0], 4001)
        apart = cKDTree(np.column_stack([y, np.interp(y, *line.T)])).query(moved[own])[0]
        gap, away = found["gap"][own], np.abs(moved[own, 0])
        assert (gap > 0.98 * apart - 0.01).all()
        order = np.argsort(away)
        assert np.diff(gap[order]).min() > -0.02 and away.max() > {1: 5.0, 2: 6.5}[body]


def test_a_section_is_written_as_two_lines_and_a_rigid_body_not_at_all(tmp_path) -> None:
    """A section has two lines; of a rigid plane there is no surface."""
    strip = pv.read(saved(rh.find("long_roller"), tmp_path / "strip") / "contact.vtu")
    parts = [strip.extract_cells(strip["body"] == body) for body in (1, 2)]
    assert strip.celltypes.tolist() == [pv.CellType.LINE] * strip.n_cells
    tops = [part["pressure"].max() for part in parts]
    assert tops[0] == pytest.approx(tops[1], rel=1e-3)
    for part in parts:
        assert part.bounds[0] == pytest.approx(-part.bounds[1])
        on = part["status"] == 1
        assert np.abs(part["gap"][on]).max() < 1e-4 < part["gap"].max()
    sphere = saved(rh.find("sphere_on_plane"), tmp_path / "sphere", whole=False)
    assert set(pv.read(sphere / "contact.vtu")["body"]) == {2}

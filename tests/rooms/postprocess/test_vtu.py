"""The files open in pyvista and hold what was put in, on the real cells."""

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
import pyvista as pv
from vtkmodules.vtkCommonCore import vtkDataArray

from railhead.postprocess import symmetry, vtu
from railhead.solver.system.solution import PlasticStrain
from railhead.theory.friction.solution import FrictionSolution

UNITS_LABEL = vtkDataArray.UNITS_LABEL()
KINDS = [("tetrahedron", 1), ("tetrahedron", 2), ("hexahedron", 1), ("hexahedron", 2)]


@pytest.mark.parametrize(("cell", "degree"), KINDS)
def test_volume_file_holds_the_arrays(blocks, cell: str, degree: int, tmp_path) -> None:
    case = blocks(cell, degree)
    mesh = vtu.volume_grid(case.fields, case.stress)
    vtu.write(mesh, tmp_path / "solution.vtu")
    back = pv.read(tmp_path / "solution.vtu")
    assert np.array_equal(back.points, case.fields.points)
    assert np.array_equal(back.cells, pv.from_meshio(mesh).cells)
    assert np.array_equal(back["body"], case.fields.body)
    assert np.array_equal(back["displacement"], case.fields.displacement)
    names = {"displacement", "stress", "principal_stresses", "von_mises", "max_shear"}
    names |= {f"principal_direction_{k}" for k in (1, 2, 3)}
    assert set(back.point_data) == names
    assert all(np.array_equal(back[name], mesh.point_data[name]) for name in names)
    assert b"vtkZLibDataCompressor" in (tmp_path / "solution.vtu").read_bytes()


def test_tensor_rows_and_the_order_of_principal_stresses(blocks) -> None:
    case = blocks("hexahedron", 1)
    data = vtu.volume_grid(case.fields, case.stress).point_data
    tensor = data["stress"].reshape(-1, 3, 3)
    assert np.array_equal(tensor, tensor.transpose(0, 2, 1))
    for column, (row, other) in enumerate([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]):
        assert np.array_equal(tensor[:, row, other], case.stress[:, column])
    assert np.all(np.diff(data["principal_stresses"], axis=1) <= 0)


def test_contact_file_holds_pressure_and_gap(blocks, tmp_path) -> None:
    case = blocks()
    surface = replace(case.findings.surface, gap=np.arange(len(case.findings.surface.gap)) / 7)
    vtu.write(vtu.contact_grid(surface, case.fields.slave), tmp_path / "contact.vtu")
    back = pv.read(tmp_path / "contact.vtu")
    assert np.array_equal(back.points, surface.points)
    found = np.sort(back.cells.reshape(-1, 4)[:, 1:], axis=1)
    assert np.array_equal(found, np.sort(surface.triangles, axis=1))
    assert np.array_equal(back["pressure"], surface.pressure)
    assert np.array_equal(back["gap"], surface.gap) and set(back["body"]) == {case.fields.slave}
    assert np.array_equal(back["status"], surface.pressure > 0)
    for name, unit in (("pressure", "MPa"), ("gap", "mm"), ("status", None)):
        array = back.point_data.VTKObject.GetAbstractArray(name)
        label = array.GetInformation().Get(UNITS_LABEL)
        assert (label and label.strip()) == unit


def test_triangles_look_out_of_their_body(blocks) -> None:
    """So that pressure times normal is the force on each body, with its sign."""
    surface = blocks().findings.surface
    mixed = surface.triangles.copy()
    mixed[::2] = mixed[::2, ::-1]
    for tag, sense in ((1, 1), (2, -1)):
        grid = vtu.contact_grid(replace(surface, triangles=mixed), tag)
        a, b, c = grid.points[grid.cells[0].data].transpose(1, 0, 2)
        assert np.all(sense * np.cross(b - a, c - a)[:, 2] > 0)


def test_cells_that_vtk_does_not_know_are_refused(blocks) -> None:
    case = blocks()
    with pytest.raises(ValueError, match="degree 3"):
        vtu.volume_grid(replace(case.fields, degree=3), case.stress)


def test_cells_hold_the_mean_of_their_plastic_strains(blocks) -> None:
    case = blocks("hexahedron", 1)
    count = len(case.fields.cells)
    strain = np.random.default_rng(0).random((count, 8, 3, 3))
    fields = replace(case.fields, plastic_strain=PlasticStrain(strain, strain[..., 0, 0]))
    data = vtu.volume_grid(fields, case.stress).cell_data
    np.testing.assert_allclose(data["plastic_strain"][0].reshape(-1, 3, 3), strain.mean(axis=1))
    found = data["equivalent_plastic_strain"][0]
    np.testing.assert_allclose(found, strain[..., 0, 0].mean(axis=1))


def test_traction_points_are_those_that_touch() -> None:
    number = np.arange(4.0)
    vectors = np.column_stack([number, number, number])
    found = SimpleNamespace(
        pressure=np.array([1.0, 0.0, 2.0, 0.0]),
        points=vectors,
        traction=10 * vectors,
        slip=100 * vectors,
        sticks=np.array([True, True, False, False]),
        rise_rail=None,
        rise_wheel=None,
    )
    grid = symmetry.grid(vtu.traction_points(cast(FrictionSolution, found)), [(0.0, 1.0, 0.0)])
    assert grid.points.tolist() == [[0.0, 0.0, 0.0], [2.0, 2.0, 2.0], [2.0, -2.0, 2.0]]
    for name, factor in (("traction", 10.0), ("slip", 100.0)):
        assert np.array_equal(grid.point_data[name], factor * grid.points)
    assert grid.point_data["sticks"].tolist() == [1, 0, 0]
    assert grid.point_data["pressure"].tolist() == [1.0, 2.0, 2.0]

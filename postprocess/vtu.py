"""The solution as grids, which pictures show, and as .vtu files for ParaView."""

import re
from pathlib import Path

import meshio
import numpy as np
from numpy.typing import NDArray

from railhead.meshing.bodies import RAIL
from railhead.postprocess.findings import SYMMETRIC, Array, Surface
from railhead.postprocess.pass_rows import RailState
from railhead.solver.space.cells import VTK_CELLS
from railhead.solver.system.fields import Fields
from railhead.theory.elastic.subsurface import directions, max_shear, principal, von_mises
from railhead.theory.friction.solution import FrictionSolution

UNITS = {
    "displacement": "mm",
    "gap": "mm",
    "pressure": "MPa",
    "stress": "MPa",
    "principal_stresses": "MPa",
    "von_mises": "MPa",
    "max_shear": "MPa",
    "traction": "MPa",
    "residual_stress": "MPa",
    "temperature_rise_rail": "K",
    "temperature_rise_wheel": "K",
}
_ARRAY = re.compile(rb'<DataArray [^>]*Name="(\w+)"[^>]*>[^<]*')  # with its data


def volume_grid(fields: Fields, stress: Array) -> meshio.Mesh:
    """Cells of the modelled part, undeformed, with displacements and stresses at their nodes.

    stress (n, 6): at the nodes, components xx, yy, zz, xy, xz, yz in global axes, MPa.
    Point data: displacement (n, 3) mm; stress (n, 9) MPa, the full tensor row by row, which
        ParaView labels XX, XY, ... ZZ; principal_stresses (n, 3), descending, and
        principal_direction_1, _2, _3 (n, 3), unit vectors with either sign, in the same order;
        von_mises and max_shear (n,), MPa.
    Cell data: body, 1 the rail, 2 the wheel; in solutions with plastic strain
        equivalent_plastic_strain (m,) and the tensor plastic_strain (m, 9), row by row, averages of
        the Gauss points of each cell.
    ValueError: VTK has no counterpart here for the type or degree of the cells.
    """
    if (fields.cell, fields.degree) not in VTK_CELLS:
        raise ValueError(f"no VTK cell for a {fields.cell} of degree {fields.degree}")
    name, order = VTK_CELLS[fields.cell, fields.degree]
    towards = directions(stress)
    return meshio.Mesh(
        fields.points,
        [(name, fields.cells[:, order])],
        point_data={
            "displacement": fields.displacement,
            "stress": stress[:, SYMMETRIC.ravel()],
            "principal_stresses": principal(stress),
            **{f"principal_direction_{k + 1}": towards[:, k] for k in range(3)},
            "von_mises": von_mises(stress),
            "max_shear": max_shear(stress),
        },
        cell_data={"body": [fields.body.astype(np.int32)], **_plastic(fields)},
    )


def _plastic(fields: Fields) -> dict[str, list[Array]]:
    """Cell data of plastic strain, averaged over the Gauss points of each cell:
    equivalent_plastic_strain (m,) and plastic_strain (m, 9), the tensor row by row. Empty where
    nothing yields.
    """
    if fields.plastic_strain is None:
        return {}
    strain = fields.plastic_strain.strain.mean(axis=1).reshape(-1, 9)
    return {
        "equivalent_plastic_strain": [fields.plastic_strain.equivalent.mean(axis=1)],
        "plastic_strain": [strain],
    }


def contact_grid(surface: Surface, tag: int) -> meshio.Mesh:
    """Triangles of the contact surface of the body with that tag, undeformed, wound so that their
    normals point out of the body; of a section lines. As much as `surface` holds: the modelled
    part, or all.

    Point data: displacement (n, 3) mm; smooth pressure (n,) MPa; gap (n,) mm between the deformed
        surfaces; status (n,), 1 where that pressure is positive, 0 elsewhere. Cell data: body, 1
        the rail, 2 the wheel.
    """
    cells = _outwards(surface, tag)
    return meshio.Mesh(
        surface.points,
        [("triangle" if cells.shape[1] == 3 else "line", cells)],
        point_data={
            "displacement": surface.displacement,
            "pressure": surface.pressure,
            "gap": surface.gap,
            "status": (surface.pressure > 0).astype(np.int32),
        },
        cell_data={"body": [np.full(len(cells), tag, np.int32)]},
    )


def _outwards(surface: Surface, tag: int) -> NDArray[np.int64]:
    """Triangles (t, 3) of a contact surface, wound so that they face out of the body with that tag;
    lines unchanged.
    """
    triangles = surface.triangles
    if triangles.shape[1] < 3:
        return triangles
    a, b, c = surface.points[triangles].transpose(1, 0, 2)
    inwards = (np.cross(b - a, c - a)[:, 2] > 0) != (tag == RAIL)
    return np.where(inwards[:, None], triangles[:, ::-1], triangles)


def traction_points(found: FrictionSolution) -> meshio.Mesh:
    """Contact points with pressure, of the modelled part, as vertices. Point data: traction (n, 3)
    in space of the wheel on the rail, MPa; slip (n, 3) in space of the wheel over the rail, mm, or,
    in rolling, dimensionless; sticks (n,), 1 where the point sticks, 0 where it slips; pressure
    (n,), MPa; with heat temperature_rise_rail and temperature_rise_wheel (n,), K.
    """
    touches = found.pressure > 0
    count = int(touches.sum())
    return meshio.Mesh(
        found.points[touches],
        [("vertex", np.arange(count)[:, None])],
        point_data={
            "traction": found.traction[touches],
            "slip": found.slip[touches],
            "sticks": found.sticks[touches].astype(np.int32),
            "pressure": found.pressure[touches],
            **{
                f"temperature_rise_{body}": rise[touches]
                for body, rise in (("rail", found.rise_rail), ("wheel", found.rise_wheel))
                if rise is not None
            },
        },
    )


def section_grid(state: RailState) -> meshio.Mesh:
    """Section of a rail after passes: quadrilaterals, or of plane strain lines, between its points
    (0, y, z), y from the middle of the patch and z out of the surface, mm.

    Point data: residual_stress (n, 9), MPa, the tensor row by row; equivalent_plastic_strain (n,).
    """
    number = np.arange(state.strain.size).reshape(state.strain.shape)
    if len(state.y) > 1:
        corners = [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]
        kind = "quad"
    else:
        corners, kind = [number[:, :-1], number[:, 1:]], "line"
    y, depth = np.meshgrid(state.y, state.depth, indexing="ij")
    stress = state.stress.reshape(-1, 6)
    return meshio.Mesh(
        np.column_stack([0 * y.ravel(), y.ravel(), -depth.ravel()]),
        [(kind, np.stack([each.ravel() for each in corners], axis=1))],
        point_data={
            "residual_stress": stress[:, SYMMETRIC.ravel()],
            "equivalent_plastic_strain": state.strain.ravel(),
        },
    )


def write(mesh: meshio.Mesh, path: Path) -> None:
    """Write a .vtu file, binary and compressed by zlib, with the unit of each array under VTK's key
    UNITS_LABEL. OSError: the path cannot be written.
    """
    meshio.write(path, mesh, file_format="vtu", binary=True, compression="zlib")
    path.write_bytes(_ARRAY.sub(_with_unit, path.read_bytes()))


def _with_unit(tag: re.Match[bytes]) -> bytes:
    """Header and data of one array of a .vtu file, followed by the XML element with its unit if
    UNITS has one. tag: match of an array, whose first group is the array's name.
    """
    unit = UNITS.get(tag[1].decode())
    if unit is None:
        return tag[0]
    key = '<InformationKey name="UNITS_LABEL" location="vtkDataArray">%s</InformationKey>'
    return tag[0] + (key % unit).encode()

"""The solution as grids, which pictures show, and as .vtu files for ParaView."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import meshio
import numpy as np
from numpy.typing import NDArray

from railhead.meshing.bodies import RAIL
from railhead.postprocess.findings import SYMMETRIC, Array, Surface
from railhead.postprocess.pass_rows import RailState
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
_HEXAHEDRON = [0, 1, 3, 2, 4, 5, 7, 6]
# (cell, degree): VTK's name in meshio, and the basix number of each node in VTK's order: vertices,
# edges (as pairs of vertices), faces and interior.
_CELLS = {
    ("triangle", 1): ("triangle", [0, 1, 2]),
    ("triangle", 2): ("triangle6", [0, 1, 2, 5, 3, 4]),
    ("quadrilateral", 1): ("quad", [0, 1, 3, 2]),
    ("quadrilateral", 2): ("quad9", [0, 1, 3, 2, 4, 6, 7, 5, 8]),
    ("tetrahedron", 1): ("tetra", [0, 1, 2, 3]),
    ("tetrahedron", 2): ("tetra10", [0, 1, 2, 3, 9, 6, 8, 7, 5, 4]),
    ("hexahedron", 1): ("hexahedron", _HEXAHEDRON),
    ("hexahedron", 2): (
        "hexahedron27",
        [*_HEXAHEDRON, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 15, 14, 22, 23, 21, 24, 20, 25, 26],
    ),
}


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
    ValueError: the stress has another shape or is not finite, or VTK has no counterpart here for
        the type or degree of the cells.
    """
    if stress.shape != (len(fields.points), 6):
        raise ValueError(f"stress must be ({len(fields.points)}, 6), got {stress.shape}")
    if not np.isfinite(stress).all():
        raise ValueError("stress must be finite at every node")
    if (fields.cell, fields.degree) not in _CELLS:
        raise ValueError(f"no VTK cell for a {fields.cell} of degree {fields.degree}")
    name, order = _CELLS[fields.cell, fields.degree]
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


def contact_grid(surfaces: Mapping[int, Surface]) -> meshio.Mesh:
    """Triangles of contact surfaces, undeformed, wound so that their normals point out of the body;
    of a section lines. As much as `surfaces` hold: the modelled part, or all.

    surfaces: by tag of their body. Point data: displacement (n, 3) mm; smooth pressure (n,) MPa;
        gap (n,) mm between the deformed surfaces; status (n,), 1 where that pressure is positive, 0
        elsewhere. Cell data: body, 1 the rail, 2 the wheel.
    """
    each = list(surfaces.values())
    first = np.cumsum([0, *(len(one.points) for one in each)])
    pieces = [_outwards(one, tag) for tag, one in surfaces.items()]
    cells = np.concatenate([one + at for one, at in zip(pieces, first, strict=False)])
    pressure = np.concatenate([one.pressure for one in each])
    body = np.repeat(list(surfaces), [len(one.triangles) for one in each])
    return meshio.Mesh(
        np.concatenate([one.points for one in each]),
        [("triangle" if cells.shape[1] == 3 else "line", cells)],
        point_data={
            "displacement": np.concatenate([one.displacement for one in each]),
            "pressure": pressure,
            "gap": np.concatenate([one.gap for one in each]),
            "status": (pressure > 0).astype(np.int32),
        },
        cell_data={"body": [body.astype(np.int32)]},
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

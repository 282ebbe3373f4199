"""Fields in the cells of a solved model, and files of a solution for ParaView."""

from pathlib import Path
from typing import Any

import basix
import meshio
import numpy as np

from railhead.solver import compat
from railhead.solver.model.assembly import Assembly
from railhead.solver.model.problem import State
from railhead.solver.space.cells import (
    VTK_CELLS,
    CellSet,
    lagrange_element,
    quadrature_degree,
    tabulate,
)
from railhead.solver.space.facets import facet_type
from railhead.theory.array_types import Array


def cell_fields(model: Assembly, state: State) -> dict[str, Any]:
    """Stress, plastic strain and back stress (3, 3) as dolfinx Functions of one degree less than
    the displacement, which jump between cells: the least-squares fit to the values at Gauss points.
    The last two are None where nothing yields (collective). An energy in a section does not tell
    the stress out of it, which is NaN then.
    """
    cells = CellSet.owned(model.bulk)
    if model.energies:
        model.energies.put(state.displacement)
        plane = model.energies.stress(cells.numbers)[0]
        full, dim = np.zeros((*plane.shape[:2], 3, 3)), plane.shape[3]
        full[..., 2, 2] = np.nan
        full[..., :dim, :dim] = plane
        found = _fitted(model, full, model.energies.reference)
        return {"stress": found, "plastic_strain": None, "back_stress": None}
    rule = quadrature_degree(cells.cell, cells.degree, model.kinematics)
    at, _, _ = cells.quadrature_points(rule)
    every = model.gathered(state.displacement, state.motions)[cells.dofs[at[0]]]
    strain = np.einsum("nmdc,ndc->nm", cells.strains(*at), every)
    trace = np.einsum("ndc,ndc->n", cells.divergence(*at), every)
    lam, mu = cells.lame[at[0]].T
    each = len(at[0]) // max(len(cells), 1)
    plastic, back = np.zeros_like(strain), np.zeros_like(strain)
    yields = any(material.hardening for material in model.materials.values())
    if yields:
        points = model.unknowns(state.loads).points
        where = (points.cells[:, None] * each + np.arange(each)).ravel()
        plastic[where], back[where] = state.bulk.plastic, state.bulk.back.sum(axis=1)
    stress = 2 * mu[:, None] * (strain - plastic)
    thermal = state.share * model.applied.thermal[cells.numbers[at[0]]]
    stress[:, :3] += (lam * trace - thermal)[:, None]
    if model.section == "plane stress":
        stress[:, 2] = 0.0
    reference, tensors = at[1][:each], model.kinematics.tensors
    return {
        "stress": _fitted(model, tensors(stress), reference),
        "plastic_strain": _fitted(model, tensors(plastic), reference) if yields else None,
        "back_stress": _fitted(model, tensors(back), reference) if yields else None,
    }


def _fitted(model: Assembly, tensors: Array, reference: Array) -> Any:
    """Tensors (3, 3) as a dolfinx Function, of one degree less than the displacement: in each cell
    the least-squares fit to values (..., 3, 3) at reference points (g, c), which are the same in
    all cells of this rank (collective).
    """
    mesh, degree = model.bulk.space.mesh, model.bulk.degree - 1
    made = compat.fem.Function(compat.tensor_space(mesh, degree))
    tensors = tensors.reshape(-1, len(reference), 9)
    cell = compat.cell_type(mesh)
    basis = tabulate(cell, degree, reference)[0] if degree else np.ones((len(reference), 1))
    fitted = np.einsum("dg,mgs->mds", np.linalg.pinv(basis), tensors)
    made.x.array.reshape(-1, 9)[compat.cell_dofs(made.function_space)[: len(tensors)]] = fitted
    made.x.scatter_forward()
    return made


def write(model: Assembly, state: State, fields: dict[str, Any], path: str | Path) -> None:
    """Write bodies_NNNN.vtu and contact_NNNN.vtu to a folder, NNNN the number of the state, so that
    ParaView shows a series (collective; rank 0 writes). Raises OSError where it cannot be written.

    bodies: cells with nodes of their own, so that fields jump between them. Point data:
        displacement, von_mises, and the fields in the cells, tensors (9) row by row. Cell data:
        body, its tag.
    contact: a vertex for each contact point and, after these, the secondary facets with the mean of
        their points. Point data: displacement of the secondary surface, pressure, traction, gap,
        slip, sticking, contact.
    """
    folder = Path(path)
    grids = {"bodies": _bodies(model, state, fields), "contact": _contact(model, state)}
    for name, grid in grids.items():
        parts = model.comm.gather(grid)
        if parts is not None:
            folder.mkdir(parents=True, exist_ok=True)
            file = folder / f"{name}_{state.number:04d}.vtu"
            meshio.write(file, _joined(parts), file_format="vtu", binary=True)


def _bodies(model: Assembly, state: State, fields: dict[str, Any]) -> meshio.Mesh:
    """Grid of the cells of this rank (collective)."""
    cells = CellSet.owned(model.bulk)
    name, order = VTK_CELLS[cells.cell, cells.degree]
    nodes = np.asarray(
        lagrange_element(cells.cell, cells.degree, basix.LagrangeVariant.gll_warped).points
    )
    degree = cells.degree - 1
    basis = tabulate(cells.cell, degree, nodes)[0] if degree else np.ones((len(nodes), 1))
    displacement = model.gathered(state.displacement, state.motions)[cells.dofs]
    data = {"displacement": _spatial(displacement)}
    for key, field in fields.items():
        if field is not None:
            dofs = compat.cell_dofs(field.function_space)[: len(cells)]
            values = field.x.array.reshape(-1, 9)[dofs]
            data[key] = np.einsum("nd,mds->mns", basis, values).reshape(-1, 9)
    tensors = data["stress"].reshape(-1, 3, 3)
    mean = np.einsum("nii->n", tensors) / 3
    deviator = tensors - mean[:, None, None] * np.eye(3)
    data["von_mises"] = np.sqrt(1.5 * (deviator**2).sum(axis=(1, 2)))
    body = cells.tags(model.cell_tags).astype(np.int32)
    numbers = np.arange(len(cells) * len(nodes)).reshape(len(cells), -1)[:, order]
    points = _spatial(cells.dof_points())
    return meshio.Mesh(points, [(name, numbers)], point_data=data, cell_data={"body": [body]})


def _contact(model: Assembly, state: State) -> meshio.Mesh:
    """Grid of the contact points of this rank and their facets (collective)."""
    face, every = state.pairing, model.gathered(state.displacement, state.motions)
    along = np.einsum("nk,nkc->nc", state.traction, face.tangents)
    data = {
        "displacement": face.slave.values(face.facet, face.xi, every),
        "pressure": state.pressure,
        "traction": along - state.pressure[:, None] * face.normals,
        "gap": state.gap,
        "slip": state.slip,
        "sticking": state.sticking.astype(float),
        "contact": face.contact.astype(float),
    }
    facets, of = np.unique(face.facet, return_inverse=True)
    corners = face.slave.vertices[facets]
    each = corners.shape[1]
    area = np.bincount(of, face.weights, minlength=len(facets))
    for key, values in data.items():
        rows = values if values.ndim == 2 else values[:, None]
        sums = [np.bincount(of, face.weights * row, minlength=len(facets)) for row in rows.T]
        means = np.repeat((np.array(sums) / area).T, each, axis=0)
        both = np.concatenate([rows, means])
        data[key] = both[:, 0] if values.ndim == 1 else _spatial(both)
    kind = facet_type(face.slave.cell)
    name, order = VTK_CELLS.get((kind, 1), ("line", [0, 1]))
    numbers = len(of) + np.arange(corners.size // corners.shape[2]).reshape(-1, each)[:, order]
    points = _spatial(np.concatenate([face.points, corners.reshape(-1, corners.shape[2])]))
    blocks = [("vertex", np.arange(len(of))[:, None]), (name, numbers)]
    return meshio.Mesh(points, blocks, point_data=data)


def _spatial(vectors: Array) -> Array:
    """Vectors (n, 3), of those in a section with a third component of zero; vectors: (..., c)."""
    flat = vectors.reshape(-1, vectors.shape[-1])
    return np.column_stack([flat, np.zeros((len(flat), 3 - flat.shape[1]))])


def _joined(parts: list[meshio.Mesh]) -> meshio.Mesh:
    """One grid of those of all ranks, which have the same kinds of cells and data."""
    starts = np.cumsum([0, *(len(part.points) for part in parts)])
    cells = [
        (
            block.type,
            np.concatenate([p.cells[k].data + s for p, s in zip(parts, starts, strict=False)]),
        )
        for k, block in enumerate(parts[0].cells)
    ]
    point_data = {
        key: np.concatenate([part.point_data[key] for part in parts]) for key in parts[0].point_data
    }
    cell_data = {
        key: [np.concatenate([part.cell_data[key][0] for part in parts])]
        for key in parts[0].cell_data
    }
    return meshio.Mesh(
        np.concatenate([part.points for part in parts]),
        cells,
        point_data=point_data,
        cell_data=cell_data,
    )

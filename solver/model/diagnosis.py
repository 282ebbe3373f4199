"""What a model that does not answer, or answers badly, may lack: supports, and facets."""

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from mpi4py import MPI
from scipy.sparse.csgraph import connected_components

from railhead.solver.algebra.problem import ContactProblem
from railhead.solver.model.assembly import Assembly
from railhead.solver.model.problem import FrictionalProblem, HubLoads
from railhead.solver.space.cells import CellSet
from railhead.solver.space.contact_interface import Interface
from railhead.solver.space.operators import vector
from railhead.solver.system.surfaces import Tie
from railhead.theory.array_types import Array, Index, Mask

LOOSE = "nothing holds"
HELD = 0.01  # least stiffness of a motion that is held, over that of the body's stiffest one
UNHELD = 1e-10  # stiffness of a motion over D up to which it is rounding: nothing touches the body
LEAST_FACETS = {1: (5.0, 5.0), 2: (1.2, 4.0)}  # on the half width, of a degree: in sections, solids
MAY_BE_OFF = {1: "a tenth", 2: "3 %"}  # by which pressures of discs and balls are off with fewer
FLAT, ALL = 1e-6, 0.9  # range of the gap over a facet, and share of points, of contacts at once


def warn_where_coarse(model: Assembly, pairing: Interface, pressure: Array) -> None:
    """Warn of contacts that touch on a part of a curved surface with too few facets from the
    largest pressure to the edge (collective); pressure: at the points (n,).
    """
    on = pressure > 0
    size = np.bincount(pairing.facet, pairing.weights)[pairing.facet[on]]
    size = size / model.kinematics.measure(pairing.points[on])
    found = pairing.contact[on], pressure[on], size, pairing.initial_gap[on], pairing.points[on]
    every = [np.concatenate(parts) for parts in zip(*model.comm.allgather(found), strict=True)]
    degree, dim = model.bulk.degree, model.kinematics.dim
    least = LEAST_FACETS[degree][dim - 2]
    for number in np.unique(every[0]):
        p, sizes, gap, x = (each[every[0] == number] for each in every[1:])
        length = float(np.mean(sizes)) ** (1 / (dim - 1))
        facets = np.linalg.norm(x - x[p.argmax()], axis=1).max() / length
        whole = model.comm.allreduce(int((pairing.contact == number).sum()))
        tied = isinstance(model.contacts[number], Tie)
        if not tied and facets < least and np.ptp(gap) > FLAT * length and len(p) < ALL * whole:
            model.warn(
                f"contact {number} has {facets:.1f} facets from its largest pressure to its "
                f"edge: with less than {least} its pressure may be off by {MAY_BE_OFF[degree]}"
            )


def why_not(
    model: Assembly, problem: ContactProblem, loads: HubLoads, touching: Mask, held: Mask
) -> str:
    """Why Newton's method found no equilibrium, in words; empty where that is not known
    (collective). touching: points (n,) that touch; held: those that may hold the bodies.
    """
    touched, hubs = model.comm.allreduce(int(touching.sum())), model.unknowns(loads).hubs
    if not touched and any(hub.rigid for hub in hubs):
        return f"{LOOSE} a rigid surface: its force does not press it on a body"
    if isinstance(problem, FrictionalProblem) and problem.all_slides(touching):
        return "everything slides: a force is above what friction carries"
    return loose_motion(model, problem, held, loads)


def loose_motion(model: Assembly, problem: ContactProblem, active: Mask, loads: HubLoads) -> str:
    """Words for a rigid motion of a body against which the tangent at the active points (n,) has
    little stiffness, of several the one that the forces drive; empty: all are held (collective).

    With rigid motions Y in the free unknowns, the tangent A and the diagonal D of the stiffness,
    these are eigenvectors of Y^T A Y v = l Y^T D Y v with l near 0. D is scaled for each body so
    that its stiffest motion by itself has l = 1.
    """
    reduction, x = model.unknowns(loads).reduction, model.bulk_points
    tangent, diagonal = problem.assembled_tangent(active), problem.stiffness.diagonal()
    labels, middles = _bodies(model)
    found = []  # body, number of the motion, and its unknowns
    for body, middle in enumerate(middles):
        away = (x - middle) * (labels == body)[:, None]
        size = model.comm.allreduce(float(np.abs(away).max(initial=0.0)), op=MPI.MAX)
        for k, mode in enumerate(model.kinematics.rigid_motions(away / size)):
            own = mode * (labels == body)[:, None]
            y = reduction.restricted(vector(model.stiffness, own))
            if y.norm():
                found.append((body, k, y))
    pairs = [[(a.dot(tangent * b), a.dot(diagonal * b)) for *_, b in found] for *_, a in found]
    stiff, mass = np.moveaxis(np.array(pairs), 2, 0)
    if not np.isfinite(stiff).all():  # of cells that are turned inside out
        return ""
    bodies = np.array([body for body, *_ in found])
    for body in set(bodies):
        own = np.ix_(bodies == body, bodies == body)
        stiffest = scipy.linalg.eigvalsh((stiff[own] + stiff[own].T) / 2, mass[own])[-1]
        mass[own] *= max(stiffest, UNHELD)
    values, vectors = scipy.linalg.eigh((stiff + stiff.T) / 2, mass)
    free = vectors[:, values <= HELD]
    if not free.size:
        return ""
    driven = free.T @ [y.dot(problem.force) for *_, y in found]
    share = free @ (driven if driven.any() else np.eye(len(driven))[0]) * np.sqrt(mass.diagonal())
    body, parts = bodies[np.abs(share).argmax()], np.zeros(6)
    for (number, k, _), each in zip(found, share, strict=True):
        parts[k] += each if number == body else 0.0
    return _words(model, middles[body], parts)


def _words(model: Assembly, middle: Array, parts: Array) -> str:
    """A rigid motion in words; parts: factors of the rigid motions, see `rigid_motions`."""
    dim, revolved = model.kinematics.dim, model.kinematics.revolved
    moves = np.eye(dim)[1] if revolved else parts[:dim]
    turns = np.zeros(1) if revolved else parts[dim : 2 * dim - 3 + dim // 3 * 3]
    place = ", ".join(f"{each:.4g}" for each in middle)
    text = f"{LOOSE} the body around ({place}): it may "
    turning = np.linalg.norm(turns) > np.linalg.norm(moves)
    along = turns if turning else moves
    axis = ", ".join(f"{each:.2g}" for each in along / np.linalg.norm(along))
    if turning:
        return text + ("turn" if dim == 2 else f"turn about ({axis})")
    return text + f"move along ({axis})"


def _bodies(model: Assembly) -> tuple[Index, list[Array]]:
    """Bodies as cells that share nodes: number of the body of each node of this rank, and the
    middle of each body (collective).
    """
    x, comm = model.bulk_points, model.comm
    dofs = np.concatenate(comm.allgather(CellSet.owned(model.bulk).dofs))
    first = np.repeat(dofs[:, 0], dofs.shape[1])
    start, total = comm.exscan(len(x)) or 0, comm.allreduce(len(x))
    graph = sp.coo_matrix((np.ones(dofs.size), (first, dofs.ravel())), shape=(total, total))
    count, labels = connected_components(graph, directed=False)
    own = labels[start : start + len(x)]
    sums = [np.append(x[own == body].sum(axis=0), (own == body).sum()) for body in range(count)]
    every = comm.allreduce(np.array(sums))
    return own, list(every[:, :-1] / every[:, -1:])

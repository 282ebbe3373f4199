"""How a model goes from one state to the next: pairing, equations, load steps."""

from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc
from scipy.spatial import cKDTree

from railhead.solver.algebra import newton
from railhead.solver.algebra.linear import StalledError
from railhead.solver.algebra.problem import ContactProblem
from railhead.solver.algebra.reduced_stiffness import Stiffness
from railhead.solver.model.assembly import Assembly
from railhead.solver.model.diagnosis import LOOSE, why_not
from railhead.solver.model.energy import Deformed, DeformedProblem
from railhead.solver.model.problem import FrictionalProblem, HubLoads, State, prescribed_motions
from railhead.solver.plasticity.plastic_problem import surface_points
from railhead.solver.plasticity.radial_return import History
from railhead.solver.space.contact_interface import Interface
from railhead.solver.space.operators import add_transposed, transposed
from railhead.solver.space.supports import Hub
from railhead.solver.space.vectors import unit
from railhead.theory.array_types import Array, Mask

TOLERANCE = 1e-8  # of Newton's method
DRIFT = 0.1  # of a facet, by which a point may slide before pairs are made anew
MOST_PAIRINGS = 6  # in one step
MISMATCH = 0.01  # of the largest pressure, that the gap of a pairing may be off by; and of the
# force, that points may carry which have nothing opposite any more
STEPS = 50  # Newton's, at most


def advance(
    model: Assembly, state: State, target: HubLoads, steps: int, progress: Callable[[str], Any]
) -> State:
    """State under other loads, which change evenly in steps, see `in_steps`; from rest the bodies'
    forces grow with them. Where a step fails, the last state that converged, with the result that
    did not (collective). progress: called on the first rank with a line of each step.
    """
    start, first, loose = _continued(state, target), state.share, 0

    def step(share: float) -> bool | None:
        """Go to the loads at a share of the way; returns whether that converged, None where nothing
        holds a body in a smaller step, too.
        """
        nonlocal state, loose
        grown = first + share * (1 - first)
        loads = {hub: start[hub] + share * (load - start[hub]) for hub, load in target.items()}
        new = _step(model, state, loads, grown)
        done = [replace(each, share=share) for each in new.result.history]
        history, converged = state.history + tuple(done), new.result.converged
        if not model.comm.rank:
            said = "" if converged else f": {new.result.reason}"
            touch = done[-1].active if done else 0
            progress(f"share {share:.4g}: {len(done)} Newton steps, {touch} points touch{said}")
        state = replace(new if converged else state, result=new.result, history=history)
        loose = loose + 1 if new.result.reason.startswith(LOOSE) else 0
        return None if loose > 1 else converged

    newton.in_steps(np.linspace(0.0, 1.0, steps + 1)[1:], 0.0, step)
    return state


def _continued(state: State, target: HubLoads) -> HubLoads:
    """Loads of the state, told as forces and motions of the same hubs as in the target."""
    out: dict[Hub, Array] = {}
    for hub, load in target.items():
        motion = state.motions[hub]
        if not np.isnan(load[0]):
            free = unit("free", hub.free)
            motion = motion.copy()
            motion[: len(free)] -= (motion[: len(free)] @ free) * free
        out[hub] = np.append(np.nan_to_num(state.loads[hub][0]), motion)
    return out


def _step(model: Assembly, before: State, loads: HubLoads, share: float) -> State:
    """State after one step, converged or not, under a share of the bodies' forces; its history is
    that of the step (collective).
    """
    pairing, y, unknowns = before.pairing, None, model.unknowns(loads)
    started = before.motions  # where points stick at first, the surface below moves with them
    if not (model.energies and any(each.friction for each in model.contacts)):
        started = unknowns.started(loads, before.motions)
    moves = model.rigid_motions(started) != model.rigid_motions(before.motions)
    if before.outdated or moves.any():
        pairing = model.pair(before.displacement, started)
    done: list[newton.NewtonStep] = []
    outdated, prescribed = False, model.prescribed(loads)
    problem: ContactProblem

    def moved(y: PETSc.Vec) -> PETSc.Vec:
        """Displacement of free unknowns."""
        u = prescribed.copy()
        unknowns.reduction.matrix.multAdd(y, prescribed, u)
        return u

    def anew(y: PETSc.Vec, active: Mask) -> tuple[ContactProblem, Mask]:
        """Equations of the deformed bodies, and their active points."""
        nonlocal pairing, problem
        u, last = moved(y), pairing
        try:
            pairing = model.pair(u, unknowns.motions(loads, y))
        except ValueError as error:
            raise StalledError(0, str(error)) from error
        problem = _problem(model, before, pairing, loads, share, u)
        problem.reference_force = reference
        return problem, _carried(active, last, pairing)

    for _ in range(MOST_PAIRINGS):
        problem = _problem(model, before, pairing, loads, share, before.displacement)
        pressed = _carried(before.pressure, before.pairing, pairing)
        reference = problem.reference_force = problem.contact_force(pressed)
        bonded = np.isneginf(np.broadcast_to(problem.floor, len(pressed)))
        active = (pressed > 0) & ~bonded
        if not model.comm.allreduce(int(active.sum())):
            active = model.first_touch(pairing, loads)
        active = active | bonded
        preconditioner = model.preconditioner(problem, pairing, loads)
        how: dict[str, Any] = {"rtol": TOLERANCE, "max_steps": STEPS}
        if model.energies:  # the bodies of the last step, as linear ones, show where they touch
            near = newton.solve(problem, preconditioner, active, rtol=TOLERANCE, max_steps=1)
            done, y, how["anew"] = near.history, near.y if near.y.norm() else None, anew
            active = near.pressure > 0
        result = newton.solve(problem, preconditioner, active, y, **how)
        done += result.history
        u = moved(result.y)
        motions = unknowns.motions(loads, result.y)
        gap = model.gap(pairing, u, motions)
        if not result.converged:
            touching = result.pressure > 0
            held = touching if model.energies else active
            result.reason = why_not(model, problem, loads, touching, held) or result.reason
            break
        if model.energies:
            break
        every = model.gathered(u, motions)
        drift, change, lost = model.surfaces.outdated(pairing, every, gap, result.pressure)
        outdated = drift > DRIFT
        stiff = problem.tau * (result.pressure > 0), result.pressure
        local = [float(np.max(each, initial=0.0)) for each in stiff]
        stiffness, largest = np.max(model.comm.allgather(local), axis=0)
        fits = stiffness * change <= MISMATCH * largest and lost <= MISMATCH
        if fits and np.isfinite(drift):
            break
        paired = pairing
        try:
            pairing, y = model.surfaces.pair(every), result.y
        except ValueError as error:
            result.reason = str(error)
            break
        overlaps = bool((model.gap(pairing, u, motions) < 0).any())
        if fits and not model.comm.allreduce(overlaps, op=MPI.LOR):  # open, and stays so
            pairing = paired
            break
    else:
        pairing = paired
        why = why_not(model, problem, loads, result.pressure > 0, result.pressure > 0)
        result.reason = why or "the pairs of points do not settle"
    after = replace(
        before,
        displacement=u,
        loads=loads,
        motions=motions,
        share=share,
        pairing=pairing,
        outdated=outdated,
        pressure=result.pressure,
        gap=gap,
        result=replace(result, history=done),
        history=(),
    )
    return _with_tractions(model, before, after, problem)


def _carried(values: Any, old: Interface, new: Interface) -> Any:
    """Values (n, ...) at the points of a pairing, from those at the points of another: each takes
    the nearest one's.
    """
    if old is new:
        return values
    if not len(values):
        return np.zeros((len(new.contact), *values.shape[1:]), dtype=values.dtype)
    return values[cKDTree(old.points).query(new.points)[1]]


def _problem(
    model: Assembly,
    before: State,
    pairing: Interface,
    loads: HubLoads,
    share: float,
    at: PETSc.Vec,
) -> ContactProblem:
    """Equations of a step from a state (collective); at: displacement at which energies are made
    linear.
    """
    unknowns, law = model.unknowns(loads), model.law
    p, prescribed = unknowns.reduction.matrix, model.prescribed(loads)
    change, stiffness, force = prescribed, unknowns.stiffness, model.applied.force * float(share)
    outer = transposed(p, force.array)
    for hub, place in zip(unknowns.hubs, unknowns.reduction.places, strict=True):
        if place >= 0:
            outer.array[place] += loads[hub][0]
    if model.energies:
        change = prescribed - at
        tangent, inner = model.tangent(at)
        inner += tangent * change
        stiffness = Stiffness.reduced(tangent, unknowns.reduction)
    else:
        inner, stiffness = model.stiffness * prescribed, stiffness.copy()
    stress = pairing.pull(pairing.normals[:, None])[:, 0]
    stress -= share * model.applied.thermal_at(pairing)
    more: dict[str, Any] = {
        "force": outer - transposed(p, inner.array),
        "gap": unknowns.rows(pairing, pairing.gap, pairing.normals[:, None]),
        "start_gap": model.gap(pairing, prescribed, prescribed_motions(loads)),
        "start_stress": (pairing.stress * change).array + stress,
    }
    given = law, stiffness, pairing, p
    if not model.remembers:
        return ContactProblem.reduced(*given, **more)
    more |= _with_history(model, before, pairing, loads, prescribed, change)
    if isinstance(pairing, Deformed):
        more["least_force"] = newton.ROUNDING * stiffness.diagonal().norm() * model.size
        more |= {"exact": at is not before.displacement, "outer": outer.norm()}
        every = np.tile(-np.eye(model.kinematics.dim), (len(pairing.contact), 1, 1))
        more |= {"points": pairing, "map": p, "jump": unknowns.rows(pairing, pairing.jump, every)}
        return DeformedProblem.reduced(*given, **more)
    problem = FrictionalProblem.reduced(*given, **more)
    problem.set_prescribed_strain(prescribed)
    return problem


def _with_history(
    model: Assembly,
    before: State,
    pairing: Interface,
    loads: HubLoads,
    prescribed: PETSc.Vec,
    change: PETSc.Vec,
) -> dict[str, Any]:
    """Fields of the equations with yield and friction that those without them do not have;
    prescribed, change: displacement, and that from where stresses are linear.
    """
    unknowns, shape = model.unknowns(loads), pairing.tangents.shape[:2]
    p, bulk = unknowns.reduction.matrix, unknowns.points
    surface = surface_points(pairing, None, model.bulk, unknowns.reduction, model.comm)
    laws = [model.hardening(number, pairing) for number in range(len(model.secondary))]
    surface.groups = [
        (np.flatnonzero(pairing.contact == number), law)
        for number, law in enumerate(laws)
        if law is not None
    ]
    bulk.history = before.bulk
    surface.history = History(
        *(
            _carried(getattr(before.surface, e.name), before.pairing, pairing)
            for e in fields(History)
        )
    )
    dyads, outward = model.kinematics.dyads, np.repeat(pairing.outward, shape[1], axis=0)
    sheared = dyads(pairing.tangents.reshape(outward.shape), outward)
    slipped = prescribed - before.displacement
    pulled = pairing.pull(pairing.tangents)
    friction = np.array([each.friction for each in model.surfaces.contacts])[pairing.contact]
    bonded = np.isinf(friction)
    start = (pairing.slip * slipped).array.reshape(shape).copy()
    ends = (model.rigid_motions(each) for each in (prescribed_motions(loads), before.motions))
    start -= np.einsum("nkc,nc->nk", pairing.tangents, np.subtract(*ends)[pairing.contact])
    start[bonded] = (pairing.slip * prescribed).array.reshape(shape)[bonded]
    return {
        "bulk": bulk,
        "surface": surface,
        "normal_dyads": dyads(pairing.normals, pairing.outward),
        "coefficient": friction,
        "floor": np.where(bonded, -np.inf, 0.0),
        "slip": unknowns.rows(pairing, pairing.slip, -pairing.tangents),
        "shear": pairing.shear.matMult(p),
        "start_slip": start,
        "start_shear": (pairing.shear * change).array.reshape(shape) + pulled,
        "shear_dyads": sheared.reshape(*shape, sheared.shape[1]),
    }


def _with_tractions(model: Assembly, before: State, after: State, problem: ContactProblem) -> State:
    """State whose equations are solved, with tractions, slip, histories of yield and nodal forces
    (collective). before: the state at the last step.
    """
    pressure, pairing, share = after.pressure, after.pairing, after.share
    bulk, surface = before.bulk, before.surface
    traction, lost = np.zeros(pairing.tangents.shape[:2]), share * model.applied.thermal_at(pairing)
    slip, sticking = _carried(before.slip, before.pairing, pairing), np.zeros(len(pressure), bool)
    nodal = model.tangent(after.displacement)[1]
    nodal.axpy(-share, model.applied.force)
    if isinstance(problem, FrictionalProblem):
        bulk, surface = problem.state
        traction = problem.traction
        sticking = (pressure > problem.floor) & (problem.coefficient > 0) & ~problem.slides
        slip = slip + np.einsum("nk,nkc->nc", problem.slip_increment, pairing.tangents)
        lost = lost + problem.plastic_normal_stress(surface.plastic)
        stress = -2 * problem.bulk.mu[:, None] * bulk.plastic * problem.bulk.weights[:, None]
        add_transposed(problem.bulk.full_strain_matrix, stress, nodal)
        add_transposed(pairing.slip, -pairing.weights[:, None] * traction, nodal)
    add_transposed(pairing.gap, -pairing.weights * pressure, nodal)
    if problem.consistency:
        normal = (pairing.stress * after.displacement).array - lost
        add_transposed(
            pairing.stress, -problem.consistency * problem.weight * (pressure + normal), nodal
        )
    return replace(
        after,
        nodal=nodal.array.reshape(-1, model.kinematics.dim).copy(),
        bulk=bulk,
        surface=surface,
        traction=traction,
        slip=slip,
        sticking=sticking,
    )

"""A contact model of a mesh with tags, and its solutions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from railhead.solver import compat
from railhead.solver.algebra.newton import NewtonStep
from railhead.solver.model.assembly import ON_AXIS, Assembly
from railhead.solver.model.diagnosis import warn_where_coarse
from railhead.solver.model.output import cell_fields, write
from railhead.solver.model.parts import (
    Body,
    Clamp,
    Contact,
    Elastic,
    Energy,
    Force,
    Hub,
    Load,
    Move,
    Part,
    Slide,
    Spring,
)
from railhead.solver.model.problem import State
from railhead.solver.model.stepping import advance
from railhead.solver.space.kinematics import SOLID, Kinematics
from railhead.solver.space.rigid import Cylinder
from railhead.solver.space.vectors import finite, unit
from railhead.theory.array_types import Array

VECTORS = ("free", "normal", "force", "point", "centre", "axis")  # of parts and rigid surfaces
OPEN = ("free", "force")  # those that may be None
ALONG = 1e-9  # of a motion, that may lie across a direction by rounding
Progress = Callable[[str], Any]
SECTIONS = (None, "plane strain", "plane stress", "axisymmetric")
STEPS = {False: 1, True: 10}  # of loads, without and with yield or friction


class Model:
    """Bodies in contact on a dolfinx mesh, in small strain or, with an `Energy`, in finite strain.

        model = Model(mesh, cell_tags, facet_tags, section="plane strain")
        model.add(Body(1, Elastic(210e3, 0.3)), Body(2, Elastic(210e3, 0.3)))
        model.add(Contact(secondary=12, primary=11), Clamp(21))
        punch = model.add(Hub(22, free=(0, -1)))
        solution = model.solve({punch: Force(1000)})

    mesh, cell_tags, facet_tags: dolfinx mesh and MeshTags. Each cell belongs to one body.
    section: None: a solid; "plane strain", "plane stress" or, with coordinates (r, z),
        "axisymmetric".
    degree: polynomial degree of the displacement, 1 or 2.
    mean_dilatation: the volume strain is averaged in each cell: for Poisson's ratios from 0.45 on
        and for large plastic strain, where cells lock.
    Self-contact is not there. Raises ValueError for a section that does not fit.
    """

    def __init__(
        self,
        mesh: Any,
        cell_tags: Any,
        facet_tags: Any,
        section: str | None = None,
        *,
        degree: int = 2,
        mean_dilatation: bool = False,
    ) -> None:
        dim = getattr(getattr(mesh, "topology", None), "dim", None)
        if dim is None:
            raise TypeError(f"mesh must be a dolfinx Mesh, not {mesh!r}")
        dims = [getattr(each, "dim", None) for each in (cell_tags, facet_tags)]
        if dims != [dim, dim - 1]:
            raise ValueError("cell_tags and facet_tags must be MeshTags of cells and of facets")
        if type(degree) is not int or degree not in (1, 2):
            raise ValueError(f"degree {degree!r} is not there: give 1 or 2")
        if not isinstance(mean_dilatation, bool):
            raise ValueError(f"mean_dilatation must be True or False, not {mean_dilatation!r}")
        self.kinematics = _kinematics(mesh, section, mean_dilatation)
        self._mesh = mesh, cell_tags, facet_tags, section, degree, self.kinematics
        self.parts: list[Part] = []
        self._assembly: Assembly | None = None

    @cached_property
    def u(self) -> Any:
        """Displacement, a dolfinx Function that energies are expressions of; a solution has its
        own.
        """
        mesh, degree = self._mesh[0], self._mesh[4]
        return compat.fem.Function(compat.vector_space(mesh, degree))

    def add(self, *parts: Part) -> Any:
        """Add parts; returns the part or, of several, all of them. Raises ValueError for a vector
        that does not fit the mesh, a tag that is no whole number and once solved, TypeError for
        what is no part.
        """
        if self._assembly is not None:
            raise ValueError("nothing can be added to a model that was solved")
        for each in parts:
            if not isinstance(each, Part):
                raise TypeError(f"{each!r} is no part of a model")
            if isinstance(each, Body) and not isinstance(each.material, Elastic | Energy):
                raise TypeError(f"{each!r} needs a material: Elastic, Plastic or Energy")
        dim = self._mesh[0].geometry.dim
        for each in parts:
            for owner in (each, getattr(each, "primary", getattr(each, "tag", None))):
                if isinstance(owner, Cylinder) and dim != 3:
                    raise ValueError(f"{owner} is for solids: in a section take a Sphere")
                for name in VECTORS:
                    given = getattr(owner, name, None)
                    shape = getattr(given, "ufl_shape", None)
                    if shape is not None and shape != (dim,):
                        raise ValueError(f"{owner}: {name} must be a vector of {dim} components")
                    needed = name not in OPEN and hasattr(owner, name)
                    if (given is not None or needed) and shape is None:
                        finite(owner, name, given, dim)
                    if given is not None and name in ("free", "normal", "axis"):
                        unit(name, given)
            tags = each.tags if isinstance(each, Contact) else [each.tag]
            tags = tags if not getattr(each, "rigid", False) else []
            if not all(isinstance(tag, int | np.integer) and abs(tag) < 2**31 for tag in tags):
                raise ValueError(f"{each}: a tag must be a whole number of 32 bits")
        self.parts += parts
        return parts[0] if len(parts) == 1 else parts

    def solve(
        self,
        loads: Mapping[Hub, Load] | None = None,
        *,
        steps: int | None = None,
        progress: Progress = lambda line: None,
    ) -> Solution:
        """Equilibrium under loads that grow from zero (collective).

        loads: of each hub a `Force` or a `Move`; a hub without a load does not move.
        steps: number of equal load steps; None: 1, and 10 with yield or friction.
        progress: called on the first rank with a line of text after each step.
        Raises ValueError for tags that no cell or facet has, for a cell without a body, and for
        loads that do not fit their hub. Where a step does not converge, the last state that did is
        returned, with `converged` False.
        """
        if self._assembly is None:
            self._assembly = Assembly(*self._mesh, self.parts, self.__dict__.get("u"))
        start = Solution(self._assembly, self._assembly.rest())
        return start.then({} if loads is None else loads, steps=steps, progress=progress)


class Solution:
    """Answer of a model, at the n contact points of this rank.

    u: displacement, a dolfinx Function.
    stress: Cauchy stress (3, 3), a dolfinx Function of one degree less that jumps between cells.
        An energy in a plane section does not tell the stress out of it: NaN.
    plastic_strain, back_stress: (3, 3), Functions of the same kind; None where nothing yields.
    points: (n, c) on the secondary surfaces, undeformed. weights: area of each (n,), of deformed
        surfaces where a body has an energy.
    contact: number of the contact of each point (n,), in the order in which they were added.
    normals: unit normals (n, c) of the contacts, out of the secondary bodies.
    pressure: (n,), never negative but in a Tie, which can be pulled.
    traction: (n, c) on the secondary surface, with friction.
    sticking: (n,) whether a point with friction touches and does not slide.
    slip: (n, c) of the secondary surface past the primary one since rest, where points slide with
        friction; 0 where they stuck all the time.
    gap: now (n,), negative where Nitsche's method lets surfaces overlap.
    missed: share of each secondary surface that has nothing opposite, and cannot touch.
    touching: whether anything touches.
    converged, reason: whether the solution is one, and why the iterations ended.
    history: all of Newton's steps since the solution that it goes on from.
    Where a step does not converge, everything else is the last state that did.
    """

    def __init__(self, model: Assembly, state: State) -> None:
        """Read a state (collective)."""
        self._model, self._state = model, state
        face, size = state.pairing, state.traction
        self.points, self.weights, self.normals = face.points, face.weights, face.normals
        self.contact, self.missed = state.pairing.contact, state.pairing.missed
        self.pressure, self.gap = state.pressure, state.gap
        along = np.einsum("nk,nkc->nc", size, state.pairing.tangents)
        self.traction = along - state.pressure[:, None] * face.normals
        self.converged, self.reason = state.result.converged, state.result.reason
        if self.converged:
            warn_where_coarse(model, state.pairing, state.pressure)
        self.history: tuple[NewtonStep, ...] = state.history
        self.touching = bool(model.comm.allreduce(int((state.pressure > 0).sum())))
        self.u = compat.function(model.bulk.space, state.displacement)
        self._fields = cell_fields(model, state)
        self.stress, self.plastic_strain, self.back_stress = self._fields.values()
        self.sticking, self.slip = state.sticking, state.slip
        nodal = {part: state.nodal[mask].sum(axis=0) for part, mask in model.masks.items()}
        self._forces = {part: sum(model.comm.allgather(each)) for part, each in nodal.items()}

    def force(self, part: Clamp | Slide | Hub | Contact | Spring) -> Any:
        """Force by which a part acts on the bodies: along the free direction of a hub, positive
        pushes that way; a vector (c,) of a hub without one, a clamp, a slide, a spring; of a
        contact that on its secondary body (collective). In plane sections per unit of depth, in
        axisymmetric ones of the whole turn.
        """
        if isinstance(part, Spring) and part in self._model.applied.springs:
            return self._model.applied.spring_force(part, self._state.displacement)
        if isinstance(part, Contact) and part in self._model.contacts:
            number = self._model.contacts.index(part)
            own = self.contact == number
            same = self._model.surfaces.contacts[number].secondary == part.secondary
            total = self._model.comm.allreduce(self.weights[own] @ self.traction[own])
            return total if same else -total
        if not isinstance(part, Clamp | Slide | Hub) or part not in self._forces:
            raise ValueError(f"{part!r} is no support or contact of the model")
        total, free = np.asarray(self._forces[part]), getattr(part, "free", None)
        if isinstance(part, Hub) and part.rigid:
            own = self._model.moved_by(self._state.pairing, part)
            total = self._model.comm.allreduce(self.weights[own] @ self.traction[own])
        if isinstance(part, Slide):
            normal = unit("normal", part.normal)
            return (total @ normal) * normal
        return total if free is None else float(total @ unit("free", free))

    def motion(self, hub: Hub) -> Any:
        """Motion of a hub from rest: along its free direction, or a vector (c,) without one; where
        a Function moves it, the mean of its nodes.
        """
        if not isinstance(hub, Hub) or hub not in self._state.motions:
            raise ValueError(f"{hub!r} is no hub of the model")
        moved = self._state.motions[hub][: self._model.kinematics.dim]
        return moved if hub.free is None else float(moved @ unit("free", hub.free))

    def write(self, path: str | Path) -> None:
        """Write bodies_NNNN.vtu (displacement, stress, plastic strain) and contact_NNNN.vtu
        (pressure, traction, gap, slip) for ParaView to a folder; NNNN: number of solutions since
        rest, so that a chain of `then` is a series (collective). Raises OSError where it cannot.
        """
        write(self._model, self._state, self._fields, path)

    def then(
        self,
        loads: Mapping[Hub, Load],
        *,
        steps: int | None = None,
        progress: Progress = lambda line: None,
    ) -> Solution:
        """Solution under further loads, from this state on: slip, plastic strain and unloading go
        on. Hubs that are not named keep their load. Arguments and errors as `Model.solve`.
        """
        model, state = self._model, self._state
        if not self.converged:
            raise ValueError(f"there is no state to go on from: {self.reason}")
        count = STEPS[model.stepped] if steps is None else steps
        if not isinstance(loads, Mapping):
            raise TypeError(f"loads must be a dict of hubs and their loads, not {loads!r}")
        if not callable(progress):
            raise TypeError(f"progress must be a function of a line, not {progress!r}")
        if type(count) is not int or count < 1:
            raise ValueError(f"steps must be a whole number from 1 on, not {steps!r}")
        target = {**state.loads, **{hub: _checked(model, hub, load) for hub, load in loads.items()}}
        state = replace(state, history=(), number=state.number + 1)
        return Solution(model, advance(model, state, target, count, progress))


def _kinematics(mesh: Any, section: str | None, mean: bool) -> Kinematics:
    """Meaning of the mesh's coordinates in a section (collective). Raises ValueError for a mesh
    with another number of coordinates or negative radii, and for an unknown section.
    """
    if section not in SECTIONS:
        raise ValueError(f"section {section!r} is unknown; give one of {SECTIONS}")
    dim = mesh.geometry.dim
    if dim != (3 if section is None else 2):
        raise ValueError(f"section {section!r} does not fit a mesh with {dim} coordinates")
    if dim != mesh.topology.dim:
        cells = mesh.topology.dim
        raise ValueError(f"cells of dimension {cells} need {cells} coordinates each, not {dim}")
    if section is None:
        return replace(SOLID, mean_dilatation=mean)
    revolved = section == "axisymmetric"
    r = mesh.geometry.x[:, 0]
    ends = [float(np.max(each, initial=0.0)) for each in (r, -r)]
    largest, beyond = np.max(mesh.comm.allgather(ends), axis=0)
    if revolved and beyond > ON_AXIS * largest:
        raise ValueError(f"an axisymmetric mesh has r from 0 on, not from {-beyond:.6g}")
    return Kinematics(np.eye(3)[:2], revolved=revolved, mean_dilatation=mean)


def _checked(model: Assembly, hub: Hub, load: Load) -> Array:
    """A load as of `HubLoads`. Raises ValueError for a hub that is not of the model, a force on
    a hub without a free direction, and values that do not fit.
    """
    if hub not in model.masks or not isinstance(hub, Hub):
        raise ValueError(f"{hub!r} is no hub of the model")
    if not isinstance(load, Force | Move):
        raise TypeError(f"{load!r} is no load of a hub: give Force or Move")
    dim, on = model.kinematics.dim, model.masks[hub]
    given = load.move if isinstance(load, Force) else load.vector
    if isinstance(load, Force) and given is None:
        given = [0.0] * dim
    if hasattr(given, "function_space"):
        nodes = _nodal(model, hub, load, given)[on]
        total, count = (model.comm.allreduce(each) for each in (nodes.sum(axis=0), len(nodes)))
        motion = np.concatenate([total[None] / count, nodes - total / count])
    else:
        motion = np.zeros((1 + on.sum(), dim))
        motion[0] = finite(load, "motion", given, dim)
    free = None if hub.free is None else unit("free", hub.free)
    across = motion if free is None else motion - np.outer(motion @ free, free)
    off = np.linalg.norm(across) > ALONG * np.linalg.norm(motion)
    if hub.slides and model.comm.allreduce(int(off)):
        raise ValueError(f"{load} moves across the free direction of {hub}, which slides")
    if not isinstance(load, Force):
        return np.append(np.nan, motion)
    if free is None:
        raise ValueError(f"{hub} has no free direction for a force")
    return np.append(finite(load, "value", load.value), across)


def _nodal(model: Assembly, hub: Hub, load: Load, given: Any) -> Array:
    """Values (nodes, c) of a dolfinx Function at the nodes of this rank (collective). Raises
    ValueError for one on another mesh, of another size or not finite, and for a rigid surface.
    """
    space, dim = model.bulk.space, model.kinematics.dim
    if hub.rigid:
        raise ValueError(f"{load}: a Function moves facets, not the rigid surface of {hub}")
    if given.function_space.mesh != space.mesh or given.ufl_shape != (dim,):
        raise ValueError(f"{load}: a Function must have {dim} components, on the model's mesh")
    made = compat.fem.Function(space)
    made.interpolate(given)
    values = made.x.array[: space.dofmap.index_map.size_local * dim].reshape(-1, dim)
    if not model.comm.allreduce(int(np.isfinite(values).all()), op=MPI.MIN):
        raise ValueError(f"{load}: the Function is not finite everywhere")
    return np.asarray(values)

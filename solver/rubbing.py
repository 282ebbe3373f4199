"""A contact model with friction: pressed first, then shifted or rolled."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numpy as np
from petsc4py import PETSc

from railhead.solver import compat
from railhead.solver.cells import Array
from railhead.solver.condensed import Condensed, Condenser
from railhead.solver.contact import ContactModel, Solution
from railhead.solver.friction import Friction, Sheared
from railhead.solver.problem import Mask
from railhead.solver.setup import Rub

UNSETTLED = "friction: the tractions do not settle"


@dataclass(frozen=True)
class Rubbing:
    """n contact points, of all ranks: points (n, 3) mm, weights (n,) mm2 of the whole model,
    pressure (n,) MPa; traction (n, 3) MPa of the wheel on the rail; slip (n, 3) of the wheel over
    the rail, mm, or, rolling, of 1; sticks (n,) of those with pressure; motion: creepage, or shift
    in mm, along and across, and spin (1/mm); force along and across, N; moment N mm about the
    normal at the origin; limit mu N, N; history: see `Sheared`."""

    points: Array
    weights: Array
    pressure: Array
    traction: Array
    slip: Array
    sticks: Mask
    motion: tuple[float, float, float]
    force: tuple[float, float]
    moment: float
    limit: float
    history: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class Rubbed(Solution):
    """A load case with friction. frictionless: the same without."""

    frictionless: Solution
    rubbing: Rubbing


class RubbingModel(ContactModel):
    """A contact model whose surfaces rub. tangential: force along and across that the far field
    follows, N."""

    tangential: Array

    def solve(
        self,
        *,
        load: float = 0.0,
        approach: float = 0.0,
        active: Mask,
        max_steps: int = 30,
        progress: Callable[[int, float], None] = lambda step, residual: None,
        force: PETSc.Vec | None = None,
    ) -> Solution:
        """Without friction (a shift begins from there), then with it on the patch that was found,
        then pressed again under the tractions: what they do to the pressure."""
        self.tangential = np.zeros(2)

        def press(active: Mask, force: PETSc.Vec | None) -> Solution:
            return super(RubbingModel, self).solve(
                load=load, approach=approach, active=active, max_steps=max_steps,
                progress=progress, force=force,
            )  # fmt: skip

        pressed = press(active, force)
        rub = self.setup.rub
        assert rub is not None
        if not pressed.newton.converged:
            return pressed
        start = time.perf_counter()
        condenser = Condenser(self, pressed)
        contact = condenser.condense(rolling=rub.rolling)
        problem, rigid = Friction(contact, rub.coefficient), slips(rub, contact)
        modes = [index for index, _ in rub.free]
        forces = [[*rub.axes[index], value] for index, value in rub.free]
        sheared = problem.solve(
            np.asarray(np.tensordot(rub.known, rigid, axes=1)),
            rigid[modes] if modes else None,
            np.array(forces) if modes else None,
            settled=None if rub.rolling else contact.moved,
        )
        motion = np.array(rub.known)
        motion[modes] = sheared.motion
        rubbing, total = self._rubbing(contact, sheared, motion, problem.limit)
        if rub.far is not None:
            self.tangential = np.array(rubbing.force)
        push = condenser.push(sheared.nodal, contact)
        if force is not None:
            push.axpy(1.0, force)
        self.seconds["solve"] += time.perf_counter() - start
        found = press(pressed.pressure > 0, push)
        newton = found.newton
        if newton.converged and not sheared.converged:
            newton = replace(newton, reason=UNSETTLED)
        base = {each.name: getattr(found, each.name) for each in fields(Solution)}
        carried = found.load + float(total @ np.array(self.setup.direction))
        return Rubbed(
            **base | {"newton": newton, "load": carried}, frictionless=pressed, rubbing=rubbing
        )

    def prescribed(self, load: float, approach: float) -> PETSc.Vec:
        """With the far field of the tangential force."""
        values = super().prescribed(load, approach)
        if np.any(self.tangential):
            for share, far in zip(self.tangential, self.beyond(), strict=False):
                values.axpy(share, far)
        return values

    def beyond(self) -> list[PETSc.Vec]:
        """Displacement of the supported faces under 1 N along and across, on all dofs, mm; none of
        bodies that end there."""
        setup = self.setup
        if setup.rub is None or setup.rub.far is None:
            return []
        supports, found = self.supports(self.bulk.space), []
        points = setup.kinematics.lift(compat.dof_points(self.bulk.space))
        for way in range(setup.kinematics.dim - 1):
            values = np.zeros((self.owned, setup.kinematics.dim))
            for side, mask in ((setup.fixed, supports.fixed), (setup.moving, supports.hub)):
                if mask is not None and mask.any():
                    moved = setup.rub.far(way, side.tag, points[mask])
                    values[mask] = setup.kinematics.flatten(moved)
            u = self.reduction.matrix.createVecLeft()
            u.array[:] = values.ravel()
            found.append(u)
        return found

    def _rubbing(
        self, contact: Condensed, found: Sheared, motion: Array, limit: float
    ) -> tuple[Rubbing, Array]:
        """With the force in space (3,), N; mirror images cancel what a plane of symmetry turns."""
        rub = self.setup.rub
        assert rub is not None
        traction, slip = (
            np.einsum("nk,nkc->nc", values, contact.tangents)
            for values in (found.traction, found.slip)
        )
        total = contact.weights @ traction
        arm = contact.points - np.array(rub.origin)
        moment = float(contact.weights @ np.cross(arm, traction) @ rub.axes[2])
        for _, normal in self.setup.planes:
            total = 2 * (total - np.array(normal) * (total @ np.array(normal)))
            moment = 0.0
        rubbing = Rubbing(
            contact.points, contact.parts * contact.weights, found.pressure, traction, slip,
            found.sticks, (float(motion[0]), float(motion[1]), float(motion[2])),
            (float(total @ rub.axes[0]), float(total @ rub.axes[1])), moment, limit,
            found.history,
        )  # fmt: skip
        return rubbing, total


def slips(rub: Rub, contact: Condensed) -> Array:
    """Rigid slip (3, n, k) of motions of 1: along, across, and of a spin of 1/mm."""
    spun = np.cross(rub.axes[2], contact.points - np.array(rub.origin))
    motions = [np.broadcast_to(axis, spun.shape) for axis in rub.axes[:2]]
    return np.stack([
        np.einsum("nc,nkc->nk", motion, contact.tangents) for motion in (*motions, spun)
    ])  # fmt: skip

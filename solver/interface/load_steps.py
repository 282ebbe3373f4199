"""The legs of a load case with friction: shares of the load and of the given forces, in turn."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from railhead.solver.algebra.problem import Mask
from railhead.solver.contact import LoadCase
from railhead.solver.interface.condensation import ContactCompliance, StaticCondensation
from railhead.solver.interface.friction import LEAST, CoulombContact, TangentialState
from railhead.solver.setup import FrictionSettings
from railhead.solver.solution import FrictionSolution, Solution
from railhead.solver.space.cells import Array

if TYPE_CHECKING:
    from railhead.solver.interface.frictional_model import RubbingModel

UNSETTLED = "friction: the tractions do not settle"
SETTLED = 1e-3  # change of the tractions, over the largest mu p, under the pressure that they make
PASSES = 30  # of tractions and pressure in turn
MEMORY = 5  # of them that the next one draws on


class FrictionHistory:
    """From a contact pressed without friction, each leg from the end of the last: tractions on the
    contact linear around what was found, and bodies pressed under these tractions, in turn until
    neither changes. sheared: of the last leg. ValueError: as `StaticCondensation`."""

    sheared: TangentialState

    def __init__(self, model: RubbingModel, pressed: Solution, case: LoadCase) -> None:
        self.model, self.rub, self.case = model, model.friction_settings, case
        self.condenser = StaticCondensation(model, pressed, rolling=self.rub.rolling)
        self.contact = contact = self.condenser.condense(pressed)
        self.rigid = slips(self.rub, contact)
        self.motion = np.array([*self.rub.creepage, 1.0])  # multiples of the modes of rigid slip
        self.known = np.tensordot(self.motion, self.rigid, axes=1)
        self.modes = [index for index, _ in self.rub.force_controlled]
        self.settled = None if self.rub.rolling else contact.moved
        self.nodal: Array = np.zeros(contact.answer.shape[1])
        self.ends: list[Array] = []
        self.share, self.peaked = 1.0, False
        self.touched: Mask = np.zeros(len(contact.points), dtype=bool)
        self.energy, self.passes = 0.0, 0
        self.history: tuple[float, ...] = ()

    def leg(self, found: Solution, share: float, force: float) -> Solution:
        """To shares of the load and of the given forces, from a solution."""
        self.model.settle()
        if share != self.share:
            found = self._loaded(found, share)
        forces = [
            [*self.rub.axes[index], force * value] for index, value in self.rub.force_controlled
        ]
        start: TangentialState | None = None
        changed, tried = np.inf, list[tuple[Array, Array]]()
        for _ in range(PASSES):
            friction = CoulombContact(self.contact, self.rub.coefficient)
            self.sheared = start = friction.solve(
                self.known,
                self.rigid[self.modes],
                np.array(forces).reshape(-1, 4),
                settled=self.settled,
                start=start,
            )
            self.motion[self.modes] = start.motion
            self.passes += 1
            self.history = max(self.history, start.history, key=len)
            change = start.nodal - self.nodal
            changed = float(np.abs(change).max()) / friction.top
            if changed <= SETTLED or not start.converged:
                break
            tried = [*tried[-MEMORY:], (change, start.nodal)]
            self.nodal, self.model.tangential = mixed(tried), self._force(self.sheared)
            found = self._pressed(found)
            if not found.newton.converged:
                return found
        if not (self.sheared.converged and changed <= SETTLED):
            return replace(found, newton=replace(found.newton, reason=UNSETTLED))
        self._rest(force)
        return found

    def _rest(self, force: float) -> None:
        """What slipped comes to rest; the leg is noted."""
        sheared = self.sheared
        if self.settled is not None:
            self.settled = self.settled + sheared.slip
            if self.peaked:
                work = np.einsum("n,nk,nk->", self.contact.area, sheared.traction, sheared.slip)
                self.energy += float(work)
        self.peaked = self.peaked or force == 1
        self.ends.append(np.concatenate([self._force(self.sheared), self.motion[:2]]))

    def _loaded(self, found: Solution, share: float) -> Solution:
        """Pressed by a share of the load under the tractions there are."""
        before, self.share = self._place(), share
        found = self._pressed(found)
        if self.settled is not None:
            came = self._touched(self.touched)[:, None]
            settled = before + came * (self._place() - before)
            self.settled = np.where(self.touched[:, None], self.settled, settled)
        self.touched = self.contact.touches
        return found

    def _pressed(self, found: Solution) -> Solution:
        """Under the tractions at the nodes; the contact then is linear around that."""
        share, case = self.share, self.case
        force = self.condenser.push(self.nodal, self.contact)
        if case.force is not None:
            force.axpy(1.0, case.force)
        load, approach, active = share * case.load, share * case.approach, found.pressure > 0
        case = replace(case, load=load, approach=approach, active=active, force=force)
        found = self.model.sheared(found, case)
        self.contact = self.condenser.around(self.contact, found, self.nodal)
        return found

    def _touched(self, before: Mask) -> Array:
        """When points came to touch, as a share of the step (n,): the patch's length grows evenly,
        and where p = p0 sqrt(1 - r^2) it reached them at r."""
        pressure, touches = self.contact.pressure, self.contact.touches
        share = np.clip(pressure / pressure[touches].max(), 0.0, 1.0)
        r = np.where(touches, np.sqrt(1 - share**2), 1.0)
        edge = np.min(r[touches & ~before], initial=1.0)
        return np.clip((r - edge) / max(1 - edge, LEAST), 0.0, 1.0)

    def _place(self) -> Array:
        """Where the wheel's surface is over the rail's, mm (n, k)."""
        contact = self.contact
        given = (contact.movement @ self.nodal).reshape(contact.moved.shape)
        rigid = np.tensordot(self.motion, self.rigid, axes=1)
        return np.asarray(contact.moved + given + rigid)

    def _force(self, sheared: TangentialState) -> Array:
        """Along and across (2,), N; mirror images cancel what a plane of symmetry turns."""
        total = self.contact.area @ self.contact.in_space(sheared.traction)
        for _, normal in self.model.setup.planes:
            total = total - np.array(normal) * (total @ np.array(normal))
        return np.asarray(self.rub.axes[:2] @ total)

    @property
    def carried(self) -> float:
        """What the tractions that the bodies are pressed under carry of the load, N."""
        direction = np.array(self.model.setup.direction)
        return float(self.contact.force(direction) @ self.nodal)

    def friction_solution(self) -> FrictionSolution:
        """After the last leg; of rolling also what the same contact has without creepage."""
        found = self._friction_solution(self.sheared, self.motion)
        if not self.rub.rolling:
            return found
        friction = CoulombContact(self.contact, self.rub.coefficient)
        still = friction.solve(np.zeros_like(self.known), self.rigid[:0], np.zeros((0, 4)))
        return replace(
            found, without_creepage=self._friction_solution(still, np.zeros_like(self.motion))
        )

    def _friction_solution(self, found: TangentialState, motion: Array) -> FrictionSolution:
        contact, rub = self.contact, self.rub
        traction, area = contact.in_space(found.traction), contact.area
        arm = contact.points - np.array(rub.origin)
        moment = float(area @ np.cross(arm, traction) @ rub.axes[2])
        force = self._force(found)
        along, across, spin = (float(value) for value in motion[:3])
        rigid = np.tensordot(motion, self.rigid, axes=1)
        return FrictionSolution(
            points=contact.points,
            weights=area,
            pressure=found.pressure,
            traction=traction,
            slip=contact.in_space(found.slip),
            sticks=found.sticks,
            rigid_motion=(along, across, spin),
            force=(float(force[0]), float(force[1])),
            moment=0.0 if self.model.setup.planes else moment,
            friction_limit=float(rub.coefficient * (area @ found.pressure)),
            load_steps=np.array(self.ends),
            dissipated_energy=self.energy,
            coupling_iterations=self.passes,
            rigid_slip=contact.in_space(rigid),
            newton_history=self.history,
        )


def mixed(tried: list[tuple[Array, Array]]) -> Array:
    """Tractions to try next, from changes and results of the last ones: of the least change, were
    it linear (Anderson 1965)."""
    changes, results = (np.array(each) for each in zip(*tried, strict=True))
    if len(tried) == 1:
        return np.asarray(results[-1])
    shares, *_ = np.linalg.lstsq(np.diff(changes, axis=0).T, changes[-1], rcond=None)
    return np.asarray(results[-1] - shares @ np.diff(results, axis=0))


def slips(rub: FrictionSettings, contact: ContactCompliance) -> Array:
    """Modes of rigid slip (4, n, k), see `FrictionSettings`."""
    return np.einsum("mnc,nkc->mnk", rub.rigid_slip(contact.points), contact.tangents)

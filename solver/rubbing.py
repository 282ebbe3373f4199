"""A contact model with friction: pressed first, then shifted or rolled."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from petsc4py import PETSc

from railhead.solver import compat
from railhead.solver.cells import Array
from railhead.solver.condensed import Condensed, Condenser
from railhead.solver.contact import ContactModel, LoadCase
from railhead.solver.friction import LEAST, Friction, Sheared
from railhead.solver.problem import Mask
from railhead.solver.setup import Rub
from railhead.solver.solution import Rubbing, Solution
from railhead.solver.yielding import State, YieldingModel

UNSETTLED = "friction: the tractions do not settle"
SETTLED = 1e-3  # change of the tractions, over the largest mu p, under the pressure that they make
PASSES = 30  # of tractions and pressure in turn
MEMORY = 5  # of them that the next one draws on


class RubbingModel(ContactModel):
    """A contact model whose surfaces rub. tangential: force along and across that the far field
    follows, N."""

    tangential: Array

    def run(self, case: LoadCase) -> Solution:
        """Without friction, then with it: tractions on the contact linear around what was found,
        and bodies pressed under these tractions, in turn until neither changes."""
        self.tangential = np.zeros(2)
        pressed, rub = self.press(case), self.setup.rub
        assert rub is not None
        if not pressed.newton.converged:
            return pressed
        condenser = Condenser(self, pressed, rolling=rub.rolling)
        way = _Way(self, rub, condenser, condenser.condense(pressed), case)
        found = pressed
        for load, force in rub.legs:
            found = way.leg(found, load, force)
            if not found.newton.converged:
                break
        rubbing, total = way.rubbing()
        carried = found.load + float(total @ np.array(self.setup.direction))
        return replace(found, load=carried, plain=pressed, rubbing=rubbing)

    def sheared(self, found: Solution, case: LoadCase, push: PETSc.Vec) -> Solution:
        """Pressed under tractions (forces on all dofs, N) from a solution without or with others,
        in the state of the last call of `settle`."""
        force = push if case.force is None else push + case.force
        return self.press(replace(case, active=found.pressure > 0, force=force))

    def settle(self) -> None:
        """A leg begins: what has yielded stays."""

    def lost_shear(self, condenser: Condenser) -> Array:
        """What yield takes of the shear stress t . sigma . n at the condenser's points (n, k), MPa,
        in the last state."""
        return np.zeros((len(condenser.own), condenser.size))

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


class YieldingRubbingModel(RubbingModel, YieldingModel):
    """A contact model whose bodies yield and whose surfaces rub: pressed first, then shifted."""

    _before: State

    def run(self, case: LoadCase) -> Solution:
        """Shifted after the last time that it was loaded, and unloaded with the shift."""
        return self.unloaded(super().run(case))

    def sheared(self, found: Solution, case: LoadCase, push: PETSc.Vec) -> Solution:
        """From the history before the leg."""
        if self.loading is None:
            return super().sheared(found, case, push)
        force = push if case.force is None else push + case.force
        again = self.loading.sheared(force, self._before)
        return replace(again, plain=found.plain, yielding=found.yielding)

    def settle(self) -> None:
        """The history of the next leg."""
        if self.loading is None:
            self.plastic.forget()
        self._before = self.plastic.state if self.loading is None else self.loading.state

    def lost_shear(self, condenser: Condenser) -> Array:
        """2 mu t . eps_p . n."""
        surface = self.plastic.state[1].plastic[condenser.own]
        strain = self.setup.kinematics.tensors(surface)
        lift = self.setup.kinematics.lift
        tangents = lift(condenser.tangents.reshape(-1, condenser.tangents.shape[2]))
        along = tangents.reshape(len(strain), -1, 3)
        shear = np.einsum("pkc,pcd,pd->pk", along, strain, lift(condenser.normals))
        return np.asarray(2 * self.plastic.surface.mu[condenser.own, None] * shear)


class _Way:
    """The legs of one load case with friction."""

    def __init__(
        self, model: RubbingModel, rub: Rub, condenser: Condenser, contact: Condensed,
        case: LoadCase,
    ) -> None:  # fmt: skip
        self.model, self.rub, self.condenser, self.case = model, rub, condenser, case
        self.contact, self.rigid = contact, slips(rub, contact)
        self.known = np.asarray(np.tensordot(rub.known, self.rigid, axes=1))
        if rub.beyond is not None:
            self.known += rub.beyond(contact.points)[:, None] * self.rigid[0]
        self.modes = [index for index, _ in rub.free]
        self.settled = None if rub.rolling else contact.moved
        self.sheared: Sheared | None = None
        self.nodal: Array = np.zeros(contact.answer.shape[1])
        self.legs: list[Array] = []
        self.load, self.peaked, self.share = 1.0, False, case
        self.touched: Mask = np.zeros(len(contact.points), dtype=bool)
        self.energy, self.passes = 0.0, 0
        self.history: tuple[float, ...] = ()

    def leg(self, found: Solution, load: float, force: float) -> Solution:
        """To shares of the load and of the given forces, from a solution."""
        self.model.settle()
        tried: list[tuple[Array, Array]] = []
        if load != self.load:
            found = self._loaded(found, load)
        sheared, changed = None, np.inf
        for _ in range(PASSES):
            friction = Friction(self.contact, self.rub.coefficient)
            forces = [[*self.rub.axes[index], force * value] for index, value in self.rub.free]
            sheared = friction.solve(
                self.known,
                self.rigid[self.modes],
                np.array(forces).reshape(-1, 4),
                settled=self.settled,
                start=sheared,
            )
            self.passes += 1
            self.history = max(self.history, sheared.history, key=len)
            changed = float(np.abs(sheared.nodal - self.nodal).max()) / friction.top
            if changed <= SETTLED or not sheared.converged:
                break
            tried = [*tried[-MEMORY:], (sheared.nodal - self.nodal, sheared.nodal)]
            found = self._pressed(found, sheared, mixed(tried))
            if not found.newton.converged:
                break
        assert sheared is not None
        self.sheared = sheared
        if not found.newton.converged:
            return found
        if not (sheared.converged and changed <= SETTLED):
            return replace(found, newton=replace(found.newton, reason=UNSETTLED))
        if self.settled is not None:
            self.settled = self.settled + sheared.slip
            if self.peaked:
                weights = self.contact.parts * self.contact.weights
                work = np.einsum("n,nk,nk->", weights, sheared.traction, sheared.slip)
                self.energy += float(work)
        self.peaked = self.peaked or force == 1
        self.legs.append(np.concatenate([self._force(sheared)[1], self._motion(sheared)[:2]]))
        return found

    def _loaded(self, found: Solution, share: float) -> Solution:
        """Pressed by a share of the load under the tractions there are."""
        before = self._place()
        self.load = share
        case, push = self.case, self.condenser.push(self.nodal, self.contact)
        self.share = replace(case, load=share * case.load, approach=share * case.approach)
        found = self.model.sheared(found, self.share, push)
        self.contact = self.condenser.around(self.contact, found, self.nodal)
        if self.settled is not None:
            came = self._touched(self.touched)[:, None]
            settled = before + came * (self._place() - before)
            self.settled = np.where(self.touched[:, None], self.settled, settled)
        self.touched = self.contact.touches
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
        place = contact.moved + (contact.movement @ self.nodal).reshape(contact.moved.shape)
        if self.sheared is not None:
            place += np.tensordot(self._motion(self.sheared), self.rigid, axes=1)
        return place

    def _pressed(self, found: Solution, sheared: Sheared, nodal: Array) -> Solution:
        """Under tractions (m,) at the nodes; the contact then is linear around that."""
        model, condenser = self.model, self.condenser
        self.nodal = nodal
        if self.rub.far is not None:
            model.tangential = self._force(sheared)[1]
        found = model.sheared(found, self.share, condenser.push(self.nodal, self.contact))
        self.contact = condenser.around(self.contact, found, self.nodal)
        return found

    def _force(self, sheared: Sheared) -> tuple[Array, Array]:
        """In space (3,) and along and across (2,), N; mirror images cancel what a plane of symmetry
        turns."""
        total = self.contact.weights @ self._in_space(sheared.traction)
        for _, normal in self.model.setup.planes:
            total = 2 * (total - np.array(normal) * (total @ np.array(normal)))
        return total, self.rub.axes[:2] @ total

    def _in_space(self, values: Array) -> Array:
        return np.einsum("nk,nkc->nc", values, self.contact.tangents)

    def _beyond(self, along: Array) -> float:
        if self.rub.beyond is None:
            return 0.0
        weights = self.contact.parts * self.contact.weights
        return float(weights @ (along * self.rub.beyond(self.contact.points)))

    def _motion(self, sheared: Sheared) -> Array:
        """Along, across and spin."""
        motion = np.array(self.rub.known)
        motion[self.modes] = sheared.motion
        return motion

    def rubbing(self) -> tuple[Rubbing, Array]:
        """After the last leg, with the force in space (3,), N."""
        contact, rub, found = self.contact, self.rub, self.sheared
        assert found is not None
        traction, weights = self._in_space(found.traction), contact.parts * contact.weights
        arm = contact.points - np.array(rub.origin)
        moment = float(contact.weights @ np.cross(arm, traction) @ rub.axes[2])
        total, force = self._force(found)
        along, across, spin = (float(value) for value in self._motion(found))
        rubbing = Rubbing(
            contact.points, weights, found.pressure, traction, self._in_space(found.slip),
            found.sticks, (along, across, spin), (float(force[0]), float(force[1])),
            0.0 if self.model.setup.planes else moment,
            float(rub.coefficient * (weights @ found.pressure)), np.array(self.legs), self.energy,
            self.passes, self._beyond(traction @ rub.axes[0]), self.history,
        )  # fmt: skip
        return rubbing, total


def mixed(tried: list[tuple[Array, Array]]) -> Array:
    """Tractions to try next, from changes and results of the last ones: of the least change, were
    it linear (Anderson 1965)."""
    changes, results = (np.array(each) for each in zip(*tried, strict=True))
    if len(tried) == 1:
        return np.asarray(results[-1])
    shares, *_ = np.linalg.lstsq(np.diff(changes, axis=0).T, changes[-1], rcond=None)
    return np.asarray(results[-1] - shares @ np.diff(results, axis=0))


def slips(rub: Rub, contact: Condensed) -> Array:
    """Rigid slip (3, n, k) of motions of 1: along, across, and of a spin of 1/mm."""
    spun = np.cross(rub.axes[2], contact.points - np.array(rub.origin))
    motions = [np.broadcast_to(axis, spun.shape) for axis in rub.axes[:2]]
    return np.stack([
        np.einsum("nc,nkc->nk", motion, contact.tangents) for motion in (*motions, spun)
    ])  # fmt: skip

"""A contact model with friction: pressed first, then shifted or rolled."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property, partial

import numpy as np
from petsc4py import PETSc

from railhead.solver.contact import ContactModel, LoadCase
from railhead.solver.interface.condensation import StaticCondensation
from railhead.solver.interface.load_steps import FrictionHistory
from railhead.solver.material.yielding import State, YieldingModel
from railhead.solver.setup import FrictionSettings
from railhead.solver.solution import Solution
from railhead.solver.space.cells import Array
from railhead.solver.space.operators import vector


class RubbingModel(ContactModel):
    """A contact model whose surfaces rub. tangential: force along and across that the far field
    follows, N; share: of it that acts now."""

    tangential: Array = np.zeros(2)
    share: float = 1.0

    @property
    def friction_settings(self) -> FrictionSettings:
        """How they do."""
        assert self.setup.friction is not None
        return self.setup.friction

    def run(self, case: LoadCase) -> Solution:
        """Without friction, then with it, leg by leg."""
        self.tangential, self.share = np.zeros(2), 1.0
        pressed = found = self.press(case)
        if not pressed.newton.converged:
            return pressed
        legs = FrictionHistory(self, pressed, case)
        for share, force in self.friction_settings.load_steps:
            found = legs.leg(found, share, force)
            if not found.newton.converged:
                break
        load = found.load + legs.carried
        return replace(found, load=load, reference=pressed, friction=legs.friction_solution())

    def sheared(self, found: Solution, case: LoadCase) -> Solution:
        """Pressed under the tractions among the forces of a case, from a solution without or with
        others, in the state of the last call of `settle`."""
        return self.press(case)

    def settle(self) -> None:
        """A leg begins: what has yielded stays."""

    def lost_shear(self, condenser: StaticCondensation) -> Array:
        """What yield takes of the shear stress t . sigma . n at the condenser's points (n, k), MPa,
        in the last state."""
        return np.zeros((len(condenser.own), condenser.size))

    def prescribed(self, load: float, approach: float) -> PETSc.Vec:
        """With the far field of the tangential force."""
        values = super().prescribed(load, approach)
        for force, far in zip(self.share * self.tangential, self.far, strict=False):
            values.axpy(force, far)
        return values

    @cached_property
    def far(self) -> list[PETSc.Vec]:
        """Displacement of the supported faces under 1 N along and across, on all dofs, mm; none of
        bodies that end there."""
        if self.friction_settings.far_field is None:
            return []
        fields = [
            partial(self.friction_settings.far_field, way)
            for way in range(self.setup.kinematics.dim - 1)
        ]
        return [vector(self.reduction.matrix, self.following(field)) for field in fields]


class YieldingRubbingModel(RubbingModel, YieldingModel):
    """A contact model whose bodies yield and whose surfaces rub: pressed first, then shifted."""

    _before: State

    def run(self, case: LoadCase) -> Solution:
        """Shifted after the last time that it was loaded, and unloaded with the shift."""
        return self.unloaded(super().run(case))

    def sheared(self, found: Solution, case: LoadCase) -> Solution:
        """From the history before the leg."""
        if self.loading is None:
            return super().sheared(found, case)
        assert case.force is not None
        again = self.loading.sheared(case.force, self._before)
        return replace(again, reference=found.reference, plasticity=found.plasticity)

    def settle(self) -> None:
        """The history of the next leg."""
        if self.loading is None:
            self.plastic.forget()
        self._before = self.plastic.state if self.loading is None else self.loading.state

    def lost_shear(self, condenser: StaticCondensation) -> Array:
        """2 mu t . eps_p . n."""
        surface = self.plastic.state[1].plastic[condenser.own]
        strain = self.setup.kinematics.tensors(surface)
        lift = self.setup.kinematics.lift
        tangents = lift(condenser.tangents.reshape(-1, condenser.tangents.shape[2]))
        along = tangents.reshape(len(strain), -1, 3)
        shear = np.einsum("pkc,pcd,pd->pk", along, strain, lift(condenser.normals))
        return np.asarray(2 * self.plastic.surface.mu[condenser.own, None] * shear)

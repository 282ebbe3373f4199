"""Load steps of a contact with friction, and how tractions and pressure are coupled in each."""

import math
from dataclasses import replace

import numpy as np

from railhead.solver.algebra.coulomb import TINY, CoulombContact, TangentialState
from railhead.solver.algebra.mixing import Anderson
from railhead.solver.system.condensation import StaticCondensation
from railhead.solver.system.contact_system import ContactSystem, LoadCase
from railhead.solver.system.load_stepping import Response
from railhead.solver.system.setup import FrictionSettings
from railhead.solver.system.solution import Solution
from railhead.theory.array_types import Array, Mask
from railhead.theory.friction.solution import FrictionSolution
from railhead.theory.friction_laws import agree, settled

COUPLING_TOLERANCE = 1e-3  # change of the tractions in one coupling iteration, over max(mu p)
COUPLING_ITERATIONS = 30  # at most in a load step
ANDERSON_DEPTH = 5  # former coupling iterations that the next one draws on


class FrictionHistory:
    """Friction on a pressed contact, load step by load step. n contact points have k tangents.

    A step alternates until the tractions no longer change: tractions on the contact linearised
    around the last solution (`CoulombContact`), then the bodies pressed under these tractions. A
    step starts where the last one ended.

    system: contact system.
    response: response of the bodies, elastic or with yield.
    settings: friction settings.
    case: load case of the frictionless solution.
    pressed: frictionless solution.
    condensation: static condensation of the pressed contact.
    contact: compliance, linearised around the last solution.
    coefficient: coefficient of friction (n,), with a law that of the last solve for the tractions.
    rigid_slip: modes of rigid slip (4, n, k) along the tangents, see `FrictionSettings.rigid_slip`.
    motion: factors (4,) of these modes, prescribed or last found.
    prescribed_slip: rigid slip (n, k) of the prescribed motions alone.
    free_modes: indices of the modes that follow from prescribed forces.
    rest: tangential displacement (n, k) of the wheel relative to the rail, rigid slip included, at
        which the surfaces last came to rest, mm; None when rolling.
    nodal: tractions at the nodes (m,), MPa, that the bodies are pressed under.
    tangential: force (2,) of the wheel on the rail along and across, whole model, N, of the solve
        for the tractions before the last pressing.
    load_share: share of the load that acts, 0 to 1.
    was_active: (n,) points in contact after the last step that changed the load; none before it.
    tangential_state: tractions and slip of the last solve for them; missing before the first.
    Raises ValueError when rolling and a surface ends upstream of the patch.
    """

    tangential_state: TangentialState

    def __init__(
        self,
        system: ContactSystem,
        response: Response,
        settings: FrictionSettings,
        case: LoadCase,
        pressed: Solution,
    ) -> None:
        self.system, self.response, self.settings = system, response, settings
        self.case, self.pressed = case, pressed
        self.condensation = StaticCondensation(system, response, settings, pressed)
        self.contact = contact = self.condensation.condense(pressed)
        self.coefficient = settings.coefficient(contact.points)
        modes = settings.rigid_slip(contact.points)
        self.rigid_slip = np.einsum("mnc,nkc->mnk", modes, contact.tangents)
        self.motion = np.array([*settings.creepage, 1.0])
        self.prescribed_slip = np.tensordot(self.motion, self.rigid_slip, axes=1)
        self.free_modes = [index for index, _ in settings.force_controlled]
        self.rest = None if settings.rolling else contact.displacement
        self.nodal: Array = np.zeros(contact.trial_compliance.shape[1])
        self.tangential: Array = np.zeros(2)
        self.load_share = 1.0
        self.was_active: Mask = np.zeros(len(contact.points), dtype=bool)

    def solve(self) -> Solution:
        """Solution after all load steps, or after the first that does not converge; its field
        `newton` says whether all converged (collective). Its field `reference` is the frictionless
        solution, and its load includes what tractions on inclined surfaces carry.
        """
        solution = self.pressed
        if reason := self._beyond_friction():
            return replace(solution, newton=replace(solution.newton, reason=reason))
        for load_share, force_share in self.settings.load_steps:
            solution = self._step(solution, load_share, force_share)
            if not solution.newton.converged:
                break
        return replace(
            solution,
            load=solution.load + self._upwards(),
            reference=self.pressed,
            friction=self._friction_solution(),
        )

    def _upwards(self) -> float:
        """Part of the load that the present tractions carry on inclined surfaces, N, of the whole
        model.
        """
        direction = np.array(self.system.setup.direction)
        return float(self.contact.force(direction) @ self.nodal)

    def _beyond_friction(self) -> str:
        """Why the prescribed forces cannot be carried: in some load step they are above the
        integral of the pressure times the coefficient of friction; empty where they can.
        """
        system, face = self.system, self.system.interface
        bound = self.settings.coefficient(system.setup.kinematics.lift(face.points))
        carried = float(face.weights @ (bound * self.pressed.pressure))
        limit = system.setup.parts * system.comm.allreduce(carried)
        given = math.hypot(*(force for _, force in self.settings.force_controlled))
        for load, force in self.settings.load_steps:
            if force * given > load * limit:
                wanted = f"a force of {force * given:.6g} N"
                return f"friction: {wanted} is above what it can carry, {load * limit:.6g} N"
        return ""

    def _step(self, solution: Solution, load_share: float, force_share: float) -> Solution:
        """Solution after one load step; its result of Newton's method says whether the step
        converged.

        solution: solution at the end of the last step.
        load_share: share of the load at the end of this step.
        force_share: share of the prescribed tangential forces at the end of this step.
        """
        self.response.start_friction_step()
        held: Array | None = None  # before the load grows
        loaded = self.was_active.any()
        if load_share != self.load_share:
            before = self._relative_displacement() if loaded else self.prescribed_slip
            held, self.load_share = self.rest, load_share
            solution = self._press_again(solution)
        forces = [
            [*self.settings.axes[index], force_share * value]
            for index, value in self.settings.force_controlled
        ]
        state: TangentialState | None = None
        change, mixing = np.inf, Anderson(ANDERSON_DEPTH)
        for _ in range(COUPLING_ITERATIONS):
            if held is not None and (loaded or state is None):
                self.rest = np.where(self.was_active[:, None], held, self._touching(before))
            try:
                self.tangential_state = state = self._tractions(np.array(forces), state)
            except ValueError as error:
                return replace(
                    solution, newton=replace(solution.newton, reason=f"friction: {error}")
                )
            self.motion[self.free_modes] = state.motion
            largest = self.contact.largest_bound(self.coefficient)
            change = float(np.abs(state.nodal - self.nodal).max()) / largest
            if change <= COUPLING_TOLERANCE or not state.converged:
                break
            self.nodal = mixing.next(self.nodal, state.nodal)
            self.tangential = np.array(self._resultants(state)[0])
            solution = self._press_again(solution)
            if not solution.newton.converged:
                return solution
        if not (self.tangential_state.converged and change <= COUPLING_TOLERANCE):
            reason = "friction: the tractions do not settle"
            return replace(solution, newton=replace(solution.newton, reason=reason))
        if held is not None:
            self.was_active = self.contact.active
        if self.rest is not None:
            self.rest = self.rest + self.tangential_state.slip
        return solution

    def _tractions(self, forces: Array, start: TangentialState | None) -> TangentialState:
        """Tractions and slip of the condensed contact, and with a law of friction `coefficient` as
        it is at that slip. forces (j, 4): as of `CoulombContact`; start: a similar state.
        ValueError: a law does not settle, or has several steady states.
        """

        def solve(coefficient: Array, near: TangentialState | None) -> TangentialState:
            """Tractions under a coefficient."""
            self.coefficient, modes = coefficient, self.rigid_slip[self.free_modes]
            slip, given = self.prescribed_slip, forces.reshape(-1, 4)
            friction = CoulombContact(self.contact, coefficient, slip, modes, given, self.rest)
            return friction.solve(near or start)

        interface = self.settings.interface
        if interface is None or interface.law is None:
            return solve(self.coefficient, None)
        found = settled(self.coefficient, solve, lambda state: self._heated(state)[0])
        kept, slides = self.coefficient, np.full_like(self.coefficient, interface.law.kinetic)
        settled(slides, solve, lambda state: self._heated(state)[0])
        agree(kept, self.coefficient)
        self.coefficient = kept
        return found

    def _heated(self, state: TangentialState) -> tuple[Array, Array | None]:
        """Coefficient (n,) and rises of the surfaces (2, n), K, at the slip of a state, of a
        section that rolls (`Interface.along_line`); else the static coefficient, and None.
        """
        points, interface = self.contact.points, self.settings.interface
        static = self.settings.coefficient(points)
        if interface is None or not self.settings.rolling or state.slip.shape[1] > 1:
            return static, None
        lines = state.pressure, state.traction[:, 0], state.slip[:, 0]
        return interface.along_line(points[:, 0], static, *lines)

    def _touching(self, before: Array) -> Array:
        """Tangential displacement (n, k) of the wheel relative to the rail, mm, at the moment at
        which points come into contact while the load grows: interpolated between the start of the
        load step and the present pressure and tractions. In the first load step it is taken only
        before there are tractions: otherwise points that stick would come to rest where they began.

        The length of the patch is taken to grow evenly: where p = p0 sqrt(1 - r^2), its border
        passes a point at r.

        before: that displacement at the start of the load step. Bodies without load have no other
            than the prescribed slip.
        """
        pressure, active = self.contact.pressure, self.contact.active
        height = np.clip(pressure / pressure[active].max(), 0.0, 1.0)
        r = np.where(active, np.sqrt(1 - height**2), 1.0)
        edge = np.min(r[active & ~self.was_active], initial=1.0)
        came = np.clip((r - edge) / max(1 - edge, TINY), 0.0, 1.0)[:, None]
        return np.asarray(before + came * (self._relative_displacement() - before))

    def _press_again(self, solution: Solution) -> Solution:
        """Solution of the bodies under the present share of the load and the present tractions,
        starting from the active set of `solution`; `contact` is linearised around the result.
        """
        case = self.case.scaled(self.load_share)
        if self.system.setup.moving.rigid:  # it has no nodes at which tractions act
            case = replace(case, load=case.load - self._upwards())
        force = self.condensation.forces(self.nodal, self.contact)
        support = self.condensation.far_displacement(self.tangential)
        case = replace(
            case, active=solution.pressure > 0, force=force, support_displacement=support
        )
        solution = self.response.press_again(solution, case)
        self.contact = self.condensation.linearised(self.contact, solution, self.nodal)
        return solution

    def _relative_displacement(self) -> Array:
        """Tangential displacement of the wheel's surface relative to the rail's (n, k), mm, rigid
        slip included.
        """
        contact = self.contact
        elastic = (contact.displacement_compliance @ self.nodal).reshape(contact.displacement.shape)
        rigid = np.tensordot(self.motion, self.rigid_slip, axes=1)
        return np.asarray(contact.displacement + elastic + rigid)

    def _resultants(self, state: TangentialState) -> tuple[tuple[float, float], float]:
        """Force of the wheel on the rail along and across, N, and moment, N mm, of the whole model
        (`FrictionSettings.resultants`).
        """
        contact, planes = self.contact, self.system.setup.planes
        traction = contact.in_space(state.traction)
        return self.settings.resultants(contact.points, contact.area, traction, planes)

    def _friction_solution(self) -> FrictionSolution:
        """Tractions and slip at the last load step; when rolling, its field `without_creepage` is
        the same contact without any rigid slip, for which the tractions are solved here.
        """
        solution = self._described(self.tangential_state, self.motion)
        if not self.settings.rolling:
            return solution
        slip, forces = np.zeros_like(self.prescribed_slip), np.zeros((0, 4))
        still = CoulombContact(self.contact, self.coefficient, slip, self.rigid_slip[:0], forces)
        without = self._described(still.solve(), np.zeros_like(self.motion))
        return replace(solution, without_creepage=without)

    def _described(self, state: TangentialState, motion: Array) -> FrictionSolution:
        """Friction solution, with vectors in space, of a tangential state; motion: factors (4,) of
        the modes of rigid slip.
        """
        contact = self.contact
        force, moment = self._resultants(state)
        along, across, spin = (float(value) for value in motion[:3])
        _, rises = self._heated(state)
        hot = (None, None) if rises is None else rises
        return FrictionSolution(
            points=contact.points,
            weights=contact.area,
            pressure=state.pressure,
            bound=self.coefficient * state.pressure,
            traction=contact.in_space(state.traction),
            slip=contact.in_space(state.slip),
            sticks=state.sticks,
            rigid_motion=(along, across, spin),
            force=force,
            moment=moment,
            rigid_slip=contact.in_space(np.einsum("m,mnk->nk", motion, self.rigid_slip)),
            rise_rail=hot[0],
            rise_wheel=hot[1],
        )

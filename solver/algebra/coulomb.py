"""Coulomb friction of a condensed contact: a shift from rest, or steady rolling at a creepage.

At every contact point the traction of the wheel on the rail is (Kalker 1990; the method of Chouly
and Hild in the tangent plane)

    lambda = projection of q + tau s on the disc of radius mu p,   c = F^+ lambda

q, p and F are those of `solver.system.condensation`, s is the rigid slip (times d when rolling),
and F^+ the L2 projection on the nodes. Tractions inside the disc stick, those on its border slip.
Semismooth Newton's method starts where all points stick, and no point crosses the disc in one step:
one that would slip the other way round sticks for a step. Without these two rules it does not
converge. Conventions are those of `theory.friction.rolling`.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from numpy.typing import NDArray

from railhead.theory.array_types import Array, Mask

NEWTON_STEPS = 60
TOLERANCE = 1e-8  # change of the tractions over the largest mu p; missing force over mu times load
MOTION_STIFFNESS = 1e-3  # added to free motions where nothing else converges, over that of all
# points sticking
STEP_LENGTHS = 1.0, 0.5  # Every second step takes the one that leaves the smaller residual. A line
# search in all steps would hold Newton's method up, and without any it may cycle.
TINY = 1e-300  # below this length a vector has no direction


def projected(
    trial: Array, bound: Array, slips: NDArray[np.bool_] | None = None
) -> tuple[Array, Array, Array, NDArray[np.bool_]]:
    """Trial tractions q (n, k) projected on discs of the radius b, by Coulomb's law:

        q  where a point sticks,    b q / |q|  where it slips

    bound: b (n,). slips: points that slip (n,); None: those with |q| > b.
    Returns the tractions (n, k), their derivatives by q (n, k, k) and by b (n, k): the direction of
    q at points that slip, zero elsewhere; and the points that slip.
    """
    size = np.maximum(np.linalg.norm(trial, axis=1), TINY)
    slips = size > bound if slips is None else slips
    share = np.where(slips, bound / size, 1.0)
    unit = np.where(slips[:, None], trial / size[:, None], 0.0)
    across = np.eye(trial.shape[1]) - unit[:, :, None] * unit[:, None, :]
    return share[:, None] * trial, share[:, None, None] * across, unit, slips


@dataclass(frozen=True, kw_only=True)
class ContactCompliance:
    """Response of n contact points of all ranks to m components of tractions at nodes of the slave,
    the same on every rank.

    The points lie on facets of which some point touches, and each has k tangents. The tractions
    (MPa) are those of the wheel on the rail, k components a node along the same tangents.
    Compliances are derivatives by them. The last four fields belong to the solution that the
    response is linearised around, without the effect of tractions.

    points: position in space (n, 3), mm.
    area: area of each point (n,) in the whole model, mm2.
    tangents: (n, k, 3) unit vectors in space: in a solid along the rail and across it, in a section
        along the section.
    tau: parameter of the contact law (n,), MPa/mm.
    step: distance d of the upstream differences for rolling, mm; 1 for a shift.
    shape_functions: F (n k, m), tractions at the points per traction at a node.
    trial_compliance: D (n k, m), trial traction per nodal traction.
    displacement_compliance: D_g (n k, m), relative displacement per nodal traction, mm/MPa.
    pressure_compliance: D_p (n, m), pressure per nodal traction.
    active: (n,) whether a point touches.
    trial_traction: q0 (n, k), MPa, without the error of the mesh.
    displacement: g0 (n, k), tangential displacement of the wheel relative to the rail, mm; when
        rolling, -d times its derivative along x.
    pressure: p0 (n,), MPa, also where it is negative.
    """

    points: Array
    area: Array
    tangents: Array
    tau: Array
    step: float
    shape_functions: sp.csr_matrix
    trial_compliance: Array
    displacement_compliance: Array
    pressure_compliance: Array
    active: Mask
    trial_traction: Array
    displacement: Array
    pressure: Array

    def in_space(self, values: Array) -> Array:
        """Vectors in space (n, 3) from their components along the tangents of the n points (n,
        k).
        """
        return np.asarray(np.einsum("nk,nkc->nc", values, self.tangents))

    def largest_bound(self, coefficient: Array) -> float:
        """Largest limit of the traction, mu p, at the active points, MPa; coefficient: of friction,
        mu (n,).
        """
        return float((coefficient * self.pressure)[self.active].max())

    def force(self, axis: Array) -> Array:
        """Derivatives (m,) of the resultant of the tractions by each nodal traction, N/MPa, in the
        whole model; axis: unit vector in space (3,) along which the resultant counts. Points that
        do not touch count, too.
        """
        share = self.area[:, None] * (self.tangents @ axis)
        return np.asarray(self.shape_functions.T @ share.ravel())


@dataclass(frozen=True, kw_only=True)
class TangentialState:
    """Tractions and slip at n contact points with k tangents, from m components of nodal tractions
    and j free rigid motions. Components are along the tangents of `ContactCompliance`.

    traction: traction of the wheel on the rail (n, k), MPa.
    slip: slip of the wheel over the rail (n, k): mm since the surfaces were at rest or, when
        rolling, over rolled distance.
    sticks: (n,) whether a point that touches sticks; False at points that do not touch.
    pressure: contact pressure (n,), MPa, with the effect of the tractions; zero at points that do
        not touch.
    nodal: tractions of the wheel on the rail at the nodes (m,), MPa.
    motion: factors (j,) of the free modes of rigid slip.
    slips: (n,) points that were taken to slip in Newton's last step.
    direction: unit vectors (n, k) of the trial traction at the start of Newton's last step, the
        direction of slip; zero where there is none.
    converged: whether in Newton's last step the set of points that slip stayed, and two numbers
        were below 1e-8 (TOLERANCE): the change of the tractions over the largest mu p, and the
        missing part of prescribed forces over mu times normal force.
    """

    traction: Array
    slip: Array
    sticks: NDArray[np.bool_]
    pressure: Array
    nodal: Array
    motion: Array
    slips: NDArray[np.bool_]
    direction: Array
    converged: bool


class CoulombContact:
    """A condensed contact with friction, under a prescribed rigid slip and prescribed forces. n
    points have k tangents. The equations for m components c of nodal tractions and j motions,
    together x (m + j,), are

        mass c - projection lambda(q, p) = 0,    force_rows c = forces
        q = trial_traction + trial_matrix x,     p = p0 + pressure_matrix x

    lambda is q projected on the disc of radius mu p; zero at points that do not touch.

    contact: compliance of the contact points; it holds the shape functions F and the areas W.
    coefficient: coefficient of friction mu at the points, (n,), also from one number.
    projection: F^T W (m, n k), mm2; mass^-1 projection is the L2 projection of
        tractions at the points on the nodes.
    mass: F^T W F (m, m), mm2.
    trial_traction: (n, k), MPa, prescribed slip included.
    trial_matrix: (n, k, m + j), trial traction per unknown.
    pressure_matrix: (n, m + j), pressure per unknown.
    force_rows: (j, m) forces of the wheel on the rail per nodal traction, whole model, N/MPa.
    forces: prescribed forces (j,) of the wheel on the rail, whole model, N.
    """

    def __init__(
        self,
        contact: ContactCompliance,
        coefficient: Array | float,
        slip: Array,
        modes: Array,
        forces: Array,
        rest: Array | None = None,
    ) -> None:
        """slip: rigid slip of the wheel over the rail (n, k), mm or, when rolling, over rolled
            distance.
        modes: further modes of rigid slip (j, n, k), whose factors follow from the forces.
        forces: (j, 4) rows, one for each mode: unit vector in space (3), and component along it of
            the force of the wheel on the rail, of the whole model, N.
        rest: for a shift, tangential displacement (n, k) of the wheel relative to the rail, rigid
            slip included, at which the surfaces were at rest, mm; None: zero.
        Raises ValueError for coefficients that are not all positive and finite.
        """
        if not (np.greater(coefficient, 0) & np.less(coefficient, np.inf)).all():
            raise ValueError(f"friction must be positive and finite, got {coefficient}")
        n, k = slip.shape
        self.contact = contact
        self.coefficient = np.broadcast_to(coefficient, n)
        weights = sp.diags(np.repeat(contact.area, k))
        self.projection = (contact.shape_functions.T @ weights).tocsr()
        self.mass = (self.projection @ contact.shape_functions).toarray()
        self.trial_traction = contact.trial_traction + contact.tau[:, None] * (contact.step * slip)
        if rest is not None:
            self.trial_traction -= contact.tau[:, None] * rest
        moved = (contact.tau[:, None] * (contact.step * modes)).reshape(-1, n * k).T
        self.trial_matrix = np.hstack([contact.trial_compliance, moved]).reshape(n, k, -1)
        still = np.zeros((n, len(modes)))
        self.pressure_matrix = np.hstack([contact.pressure_compliance, still])
        rows = [contact.force(axis) for axis in forces[:, :3]]
        self.force_rows = np.reshape(rows, (-1, len(self.mass)))
        self.forces = forces[:, 3]

    def solve(self, start: TangentialState | None = None) -> TangentialState:
        """Tractions and slip. start: solution of a similar problem to begin with; None: all points
        stick at first. If Newton's method does not converge from `start`, it is begun from sticking
        points, then with a stiffness on the free motions. The state that is returned may not have
        converged.
        """
        sticking = self.contact.step * float(self.contact.area @ self.contact.tau)
        begun = [(start, 0.0)] if start is not None else []
        freed = [(None, MOTION_STIFFNESS * sticking)] if len(self.forces) else []
        for begin, stiffness in (*begun, (None, 0.0), *freed):
            state = self.newton(begin, stiffness)
            if state.converged:
                break
        return state

    def newton(self, begin: TangentialState | None, motion_stiffness: float) -> TangentialState:
        """Solve the equations by semismooth Newton's method; the state that is returned may not
        have converged.

        begin: solution of a similar problem; None: all points stick at first.
        motion_stiffness: stiffness that is added to the tangent of the motions, N over a unit of
            motion.
        """
        contact, coefficient = self.contact, self.coefficient
        n, k, unknowns = self.trial_matrix.shape
        m, active = len(self.mass), contact.active
        limit = float(contact.area[active] @ (coefficient * contact.pressure)[active])
        largest = contact.largest_bound(coefficient)
        x: Array = np.zeros(unknowns)
        slips: NDArray[np.bool_] = np.zeros(n, dtype=bool)
        direction: Array = np.zeros((n, k))
        if begin is not None:
            x = np.concatenate([begin.nodal, begin.motion])
            slips, direction = begin.slips, begin.direction
        first = begin is None
        converged = False
        for number in range(NEWTON_STEPS):
            _, bound, size, unit = self._trial_state(x)
            now = active & (size > bound) & (not first)
            now &= ~(slips & (np.einsum("nk,nk->n", unit, direction) < 0))
            if k == len(self.forces) == 1 and np.array_equal(now, active):
                step, x = self._slide(x, now)
                unit = self._trial_state(x)[3]
            else:
                residual, tangent = self.linearised(x, now)
                tangent[m:, m:] = motion_stiffness * np.eye(len(self.forces))
                try:
                    step = scipy.linalg.solve(tangent, -residual, check_finite=False)
                except scipy.linalg.LinAlgError:  # all slips the way of the prescribed forces
                    break
                if number % 2 == 0:
                    step *= min(STEP_LENGTHS, key=lambda t: self._squared_residual(x + t * step))
                x = x + step
            missing = float(np.abs(self.force_rows @ x[:m] - self.forces).max(initial=0.0)) / limit
            remaining = max(float(np.abs(step[:m]).max()) / largest, missing)
            same = not first and np.array_equal(now, slips)
            converged = same and remaining <= TOLERANCE
            slips, direction, first = now, unit, False
            if converged:
                break
        q, bound, *_ = self._trial_state(x)
        traction, _, _, slides = projected(q, bound)
        traction = traction * active[:, None]
        return TangentialState(
            traction=traction,
            slip=(q - traction) / (contact.tau[:, None] * contact.step),
            sticks=active & ~slides,
            pressure=np.where(active, bound / coefficient, 0.0),
            nodal=x[:m],
            motion=x[m:],
            slips=slips,
            direction=direction,
            converged=converged,
        )

    def _slide(self, x: Array, slips: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Newton's step (m + 1,), with zero for the motion, and new unknowns x (m + 1,), with the
        motion found, where all points slip along the only tangent.

        The motion then changes no traction, and the tangent is singular, until points change the
        direction of their slip. The function finds the point whose change of direction makes the
        tractions reach the prescribed force.
        """
        contact, m = self.contact, len(self.mass)
        residual, tangent = self.linearised(x, slips)
        step = np.append(scipy.linalg.solve(tangent[:m, :m], -residual[:m]), 0.0)
        x = x + step
        q, bound, _, _ = self._trial_state(x)
        rate = self.trial_matrix[:, 0, -1]
        turns = np.where(contact.active, -q[:, 0] / rate, np.inf)
        order = np.argsort(turns)[: contact.active.sum()]
        along = np.abs(rate) / (contact.tau * contact.step)  # of the tangent along the force
        most = (contact.area * bound * along)[order]
        reached = 2 * np.cumsum(most) - most.sum()
        last = min(np.searchsorted(reached, self.forces[0]), len(order) - 1)
        x[m] += float(turns[order[last]])
        return step, x

    def linearised(self, x: Array, slips: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Residual (m + j,) of the equations at the unknowns x, and its derivative (m + j, m + j).
        The active points in `slips` (n,) slip and the others stick:

            lambda(x + dx) = lambda + (mu p / |q|) (1 - n x n) dq + mu n dp    slip, n = q / |q|
            lambda(x + dx) = q + dq                                            stick
        """
        mass, active = self.mass, self.contact.active
        n, k, unknowns = self.trial_matrix.shape
        m = len(mass)
        q, bound, *_ = self._trial_state(x)
        value, change, unit, _ = projected(q, bound, slips)
        value, change = value * active[:, None], change * active[:, None, None]
        along = self.coefficient[:, None] * unit
        moved = change @ self.trial_matrix + along[:, :, None] * self.pressure_matrix[:, None, :]
        tangent = np.zeros((unknowns, unknowns))
        tangent[:m] = -(self.projection @ moved.reshape(n * k, -1))
        tangent[:m, :m] += mass
        tangent[m:, :m] = self.force_rows
        residual = [
            mass @ x[:m] - self.projection @ value.ravel(),
            self.force_rows @ x[:m] - self.forces,
        ]
        return np.concatenate(residual), tangent

    def _trial_state(self, x: Array) -> tuple[Array, Array, Array, Array]:
        """Trial traction q (n, k) in MPa, limit mu p (n,) in MPa, length of q (n,) in MPa and
        direction of q (n, k), at the unknowns x.
        """
        q = self.trial_traction + self.trial_matrix @ x
        pressure = np.maximum(self.contact.pressure + self.pressure_matrix @ x, 0.0)
        size = np.maximum(np.linalg.norm(q, axis=1), TINY)
        return q, self.coefficient * pressure, size, q / size[:, None]

    def _squared_residual(self, x: Array) -> float:
        """Sum of the squared residuals of the tractions at the unknowns x, each over its diagonal
        entry of the mass, MPa2 mm2. It measures how far the nodal tractions are from the projected
        ones; missing forces do not count.
        """
        q, bound, *_ = self._trial_state(x)
        value = projected(q, bound)[0] * self.contact.active[:, None]
        mass, m = self.mass, len(self.mass)
        residual = mass @ x[:m] - self.projection @ value.ravel()
        return float(residual @ (residual / mass.diagonal()))

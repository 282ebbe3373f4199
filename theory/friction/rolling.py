"""Friction between two half-spaces under a given pressure: rolling at a creepage, or one shift.

Kalker's exact theory (1990) in boundary elements. Conventions, of everything that rolls or slides
here: x points to where the wheel rolls, so that the leading edge of the patch is at its largest x,
y across, and the normal out of the rail. Creepage is the velocity of the wheel's surface relative
to the rail's over the rolling speed; spin turns about that normal:

    rigid slip = (along - spin y, across + spin x)

On a surface that is not flat, or for a spin about another place, rigid slip is a sum of four given
fields, its modes: those of unit creepage along, of unit creepage across and of unit spin, and a
fixed one with the factor 1. The fixed one is that of the wheel's turning about axes in the tangent
plane; it is zero in a plane.
Forces are those of the wheel on the rail and have the creepage's sign (Kalker's have the other
one); each does the work of its creepage, so that the moment acts about the place of the spin.
Lengths in mm, forces in N, stresses in MPa, spin in 1/mm.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass, replace

import numpy as np

from railhead.theory.array_types import Array, Mask
from railhead.theory.bem.grid_patch import Grid, PatchSolution, shares
from railhead.theory.bem.influence import Influence
from railhead.theory.bem.pressure_solver import equilibrium
from railhead.theory.friction.coulomb_solver import CoulombSolver
from railhead.theory.friction.tangential import AHEAD, MaterialPair, TractionInfluence
from railhead.theory.friction_laws import Interface, agree, settled

TOLERANCE = 1e-8  # of the tractions
CELLS = (16, 32, 64)  # of a patch each way, the coarsest first: numbers are extrapolated
COARSEST, FEWEST, MOST = 16, 4, 256  # cells along x or across; least across, most along x
LONGEST = 1.5  # of a cell along x over across; longer ones do not determine the tractions
STUCK = 1e-6  # relative: a traction that is that much below its bound sticks
TURNS, TRACTION_CHANGE = 40, 1e-3  # between pressure and tractions; of the tractions, over mu N
PRESSED = 1e-6  # of the displacement
STEPS, FORCE_TOLERANCE = 40, 1e-6  # of Newton under prescribed forces; over mu N


@dataclass(frozen=True)
class Creepage:
    """Rigid motion of the wheel over the rail: per rolled length in rolling, or one shift.

    along: creepage along x, dimensionless; of a shift, mm.
    across: creepage along y, dimensionless; of a shift, mm.
    spin: rotation about the normal, 1/mm; of a shift, rad.
    """

    along: float = 0.0
    across: float = 0.0
    spin: float = 0.0

    @property
    def motion(self) -> Array:
        """Factors (4,) of the modes of rigid slip: creepage along, across, spin, and 1 for the
        fixed mode.
        """
        return np.array([self.along, self.across, self.spin, 1.0])


@dataclass(frozen=True, kw_only=True)
class TangentialSolution:
    """Tangential tractions of a patch under a rigid motion, cell by cell.

    x: cell centres along the rail, (nx,), mm.
    y: cell centres across, (ny,), mm.
    modes: rigid slip along x and y, (4, 2, nx, ny): of unit creepage along, unit creepage across,
        unit spin, and the fixed mode (zero in a plane); all zero outside of the patch.
    pressure: mean of each cell, (nx, ny), MPa, zero outside of the patch.
    bound: largest traction that friction allows, mu p, (nx, ny), MPa.
    covered: share of each cell in the patch, (nx, ny).
    creepage: the rigid motion.
    traction: of the wheel on the rail along x and y, (2, nx, ny), MPa.
    slip: of the wheel over the rail, (2, nx, ny); dimensionless in rolling, and half a cell ahead
        of the centres; mm of a shift. It is zero to the tolerance where cells stick, and zero
        outside of the patch.
    rise: of the temperatures of the surfaces of rail and wheel above the bulk of each body, (2, nx,
        ny), K; None without heat.
    """

    x: Array
    y: Array
    modes: Array
    pressure: Array
    bound: Array
    covered: Array
    creepage: Creepage
    traction: Array
    slip: Array
    rise: Array | None = None

    @property
    def forces(self) -> tuple[float, float, float]:
        """Forces of the wheel on the rail (along, across, N) and moment about the normal at the
        place of the spin (N mm): each is the work of the tractions on a unit creepage or spin.
        """
        along, across, moment, _ = self._works
        return float(along), float(across), float(moment)

    @property
    def _works(self) -> Array:
        """Work (4,) of the tractions on each mode of rigid slip: N, N, N mm, N."""
        return np.asarray(self.cell * (self.modes * self.traction).sum(axis=(1, 2, 3)))

    @property
    def cell(self) -> float:
        """Area of a cell, mm2."""
        return float((self.x[1] - self.x[0]) * (self.y[1] - self.y[0]))

    @property
    def limit(self) -> float:
        """Largest tangential force that friction allows: sum of the bound over the area, N."""
        return float(self.bound.sum() * self.cell)

    @property
    def central_slip(self) -> Array:
        """Slip (2, nx, ny) of rolling at the cell centres: the mean of that half a cell ahead and
        half a cell behind, which behind the patch follows a straight line. Traction times this slip
        is the power of friction.
        """
        inside = self.pressure > 0
        wider = np.pad(self.slip, ((0, 0), (1, 1), (0, 0)))
        follows = np.pad(inside, ((1, 0), (0, 0)))[:-1]
        behind = np.where(follows, wider[:, :-2], 2 * self.slip - wider[:, 2:])
        return np.asarray(inside * (self.slip + behind) / 2)

    @property
    def sticks(self) -> Mask:
        """Whether a cell sticks (nx, ny): its traction is below the bound by more than 1e-6 of it;
        False outside of the patch.
        """
        return np.linalg.norm(self.traction, axis=0) < (1 - STUCK) * self.bound

    @property
    def areas(self) -> tuple[float, float]:
        """Area that sticks and area of the patch, mm2."""
        touches = self.covered * (self.pressure > 0)
        return self.cell * float((touches * self.sticks).sum()), self.cell * float(touches.sum())

    @property
    def t_gamma(self) -> float:
        """Energy dissipated per rolled length (N), of bodies of the same material that roll: the
        work of the tractions on the rigid slip. Bodies of different materials also slip without
        creepage, which is not in it; of a shift it is no energy.
        """
        return float(self._works @ self.creepage.motion)


class HalfSpaceFriction:
    """Tangential contact of half-spaces whose pressure is given: each cell obeys Coulomb's law. Its
    coefficient may depend on slip and temperature.
    """

    def __init__(
        self,
        x: Array,
        y: Array,
        pressure: Array,
        friction: Array | float,
        pair: MaterialPair,
        *,
        rolling: bool,
        modes: Array | None = None,
        drawn: Array | None = None,
        added: Callable[[Array], Array] | None = None,
        interface: Interface | None = None,
    ) -> None:
        """x (nx,), y (ny,): cell centres, evenly spaced, mm.
        pressure: (nx, ny), MPa, 0 outside of the patch, two cells an axis at least; it does not
            change.
        friction: coefficient above 0, or that of each cell: an array that broadcasts to (nx, ny).
        pair: materials.
        rolling: steady rolling; else one shift.
        modes: rigid slip (4, 2, nx, ny) along x and y of unit creepages, unit spin and the fixed
            mode; None: a plane about x = y = 0.
        drawn: reduction of the slip (2, nx, ny) by other causes; None: zero.
        added: reduction of the slip (2, nx, ny) by tractions (2, nx, ny) beside that of
            half-spaces, linear; None: zero.
        interface: law of the coefficient, heat and layer; None: Coulomb's law alone. All but a
            layer need rolling. `friction` is the static coefficient.
        ValueError: a pressure below zero or zero everywhere, cells too long along x.
        """
        if not (pressure.min() >= 0 and pressure.max() > 0):
            raise ValueError("pressure must be >= 0, and not zero everywhere")
        if rolling and x[1] - x[0] > LONGEST * (y[1] - y[0]):
            raise ValueError("cells that roll must not be longer along x than 1.5 times across")
        self._x, self._y, self._rolling, self._pressure = x, y, rolling, pressure
        if pair.mismatch:  # the pressure of cells is solved for, by turns with tractions
            self._covered = panels = np.where(pressure > 0, 1.0, 0.0)
        else:
            (mean, self._covered), *ahead = shares((x, y), pressure, 0.0, *(AHEAD / 2,) * rolling)
            panels = ahead[0][1] if rolling else self._covered
            mean = np.where(panels > 0, mean, 0.0)
            self._pressure = mean * (pressure.sum() / mean.sum())
        self._interface = interface or Interface()
        self._static = np.broadcast_to(np.asarray(friction, dtype=float), pressure.shape)
        more = None if added is None else lambda traction: self._there(added(traction))
        self._influence = TractionInfluence(
            x,
            y,
            pair,
            rolling=rolling,
            added=more,
            covered=panels,
            layer=self._interface.layer,
        )
        self._tractions = CoulombSolver(self._influence, self._static * self._pressure)
        inside = np.where(self._pressure > 0, 1.0, 0.0)
        every = plane_modes(x, y) if modes is None else modes
        self._modes, self._rigid = inside * every, inside * self._there(every)
        known = np.zeros((2, *pressure.shape)) if drawn is None else self._there(drawn)
        if pair.mismatch:
            known = known + self._influence.of_pressure(pressure)
        self._drawn = inside * known

    def solve(
        self, creepage: Creepage, start: TangentialSolution | None = None
    ) -> TangentialSolution:
        """Tractions at a creepage in steady rolling, or under one shift from rest.

        start: an earlier solution of this patch, from which the iterations begin; None: from the
            tractions that stick everywhere, and the static coefficient.
        A coefficient that depends on slip or temperature is found in turns with the tractions.
        Without a `start` they end a second time, from the coefficient of large slip.
        ValueError: no convergence, or both ends differ as of `agree`.
        """
        if self._interface.law is None:
            return self._at(creepage, start)
        if start is not None:
            coefficient = np.divide(
                start.bound, start.pressure, out=self._static.copy(), where=start.pressure > 0
            )
            return self._by_law(creepage, coefficient * self._pressure, start)
        found = self._by_law(creepage, self._static * self._pressure, None)
        slides = self._interface.law.kinetic * self._pressure
        agree(found.bound, self._by_law(creepage, slides, found).bound)
        return found

    @property
    def limit(self) -> float:
        """Largest tangential force under the largest coefficient of the law, N."""
        bound = self._interface.largest(self._static) * self._pressure
        return float(bound.sum() * (self._x[1] - self._x[0]) * (self._y[1] - self._y[0]))

    @property
    def has_law(self) -> bool:
        """Whether the coefficient depends on slip or temperature."""
        return self._interface.law is not None

    def _by_law(
        self, creepage: Creepage, bound: Array, start: TangentialSolution | None
    ) -> TangentialSolution:
        """Tractions under the bound (nx, ny), MPa, that the law has at their slip, from a first
        bound and a solution near it. ValueError: as of `settled`.
        """

        def solve(bound: Array, near: TangentialSolution | None) -> TangentialSolution:
            """Tractions under a bound."""
            self._tractions.bound = bound
            return self._at(creepage, near or start)

        return settled(bound, solve, self._law_bound)

    def _law_bound(self, found: TangentialSolution) -> Array:
        """Largest traction (nx, ny), MPa, that the law allows at the slip of a solution."""
        inside = self._pressure > 0
        return self._pressure * self._interface.coefficient(
            self._x, self._static, inside, found.slip, found.rise
        )

    def _at(self, creepage: Creepage, start: TangentialSolution | None) -> TangentialSolution:
        """Tractions at a creepage under the present bound; start: as of `solve`."""
        slip = self._slip(creepage)
        guess, bound = None if start is None else start.traction, self._tractions.bound
        if start is not None and not self.has_law:  # with the same share of the bound
            known = start.bound > 0
            guess = start.traction * np.divide(bound, start.bound, out=0 * bound, where=known)
        traction = self._tractions.solve(slip, TOLERANCE, guess)
        left = np.where(self._pressure > 0, slip - self._influence(traction), 0)
        found = TangentialSolution(
            x=self._x,
            y=self._y,
            modes=self._modes,
            pressure=self._pressure,
            bound=self._tractions.bound,
            covered=self._covered,
            creepage=creepage,
            traction=traction,
            slip=left,
        )
        return replace(found, rise=self._interface.rise(self._x, traction, found.central_slip))

    def stiffness(self, found: TangentialSolution) -> Array:
        """Derivatives (2, 2) of the forces along and across by the creepages along and across, N
        (of a shift N/mm), at a solution of this patch; to 1 %, enough for Newton's method.
        """
        slip = self._slip(found.creepage)
        changes = self._tractions.changes(found.traction, slip, self._rigid[:2])
        return np.asarray(np.einsum("fcij,mcij->fm", self._modes[:2], changes) * found.cell)

    def _slip(self, creepage: Creepage) -> Array:
        """Slip (2, nx, ny) of surfaces without tractions at a creepage, less what is `drawn`."""
        return np.asarray(np.tensordot(creepage.motion, self._rigid, axes=1) - self._drawn)

    def _there(self, field: Array) -> Array:
        """A field (..., nx, ny) given at the cell centres, where slip is taken: half a cell ahead
        in rolling (`TractionInfluence`), by the mean with the next cell.
        """
        if not self._rolling:
            return field
        last = 2 * field[..., -1:, :] - field[..., -2:-1, :]
        ahead = np.concatenate([field[..., 1:, :], last], axis=-2)
        return np.asarray((1 - AHEAD) * field + AHEAD * ahead)


def cells_over(half: tuple[float, float], cells: int) -> tuple[int, int]:
    """Numbers of cells along x and across over a patch with half lengths `half`: `cells` each way,
    or as many square ones where it is longer along x. Cells longer along x than across do not
    determine tractions that roll. Numbers are even, as patches may be symmetric, and twice as many
    cells divide each in two.
    """
    ratio = max(half[0] / half[1], 1.0)
    across = max(FEWEST, 2 * math.ceil(COARSEST / math.sqrt(ratio) / 2))
    along = min(max(COARSEST, 2 * round(across * ratio / 2)), MOST)
    return 2 * round(cells / COARSEST * along / 2), 2 * round(cells / COARSEST * across / 2)


def grid_over(
    middle: tuple[float, float], half: tuple[float, float], cells: int, wider: float = 1.0
) -> Grid:
    """Grid in a plane of `cells_over` cells over a patch with its middle (x, y) and half lengths,
    mm, or `wider` times as wide.
    """
    x, y = (
        place + wider * each * ((2 * np.arange(count) + 1) / count - 1)
        for place, each, count in zip(middle, half, cells_over(half, cells), strict=True)
    )
    return Grid(x, y, np.zeros_like(y))


def plane_modes(x: Array, y: Array) -> Array:
    """Modes of rigid slip (4, 2, nx, ny) in a plane, components along x and y at cell centres: unit
    creepage along x, along y, unit spin (-y, x) about x = y = 0, and zeros.
    """
    still = np.zeros((x.size, y.size))
    turned = [still - y, still + x[:, None]]
    return np.array([[still + 1, still], [still, still + 1], turned, [still, still]])


def change(found: Sequence[TangentialSolution], before: Sequence[TangentialSolution]) -> float:
    """Change of the tractions of all patches from one turn to the next, relative: sum over the
    cells of the change, in N, over mu times the normal force. found, before: one for each patch.
    Infinite where there were none before.
    """
    if not before:
        return math.inf
    changed = sum(
        one.cell * float(np.linalg.norm(one.traction - other.traction, axis=0).sum())
        for one, other in zip(found, before, strict=True)
    )
    return changed / sum(each.limit for each in found)


def solve_patches(
    patches: Sequence[PatchSolution],
    pair: MaterialPair,
    friction: Sequence[Array | float],
    creepage: Creepage,
    *,
    along: float | None = None,
    across: float | None = None,
    rolling: bool = True,
    modes: Sequence[Array | None] | None = None,
    interface: Interface | None = None,
    start: Sequence[TangentialSolution] | None = None,
) -> list[TangentialSolution]:
    """Tractions of patches that share one rigid motion, and of different materials the pressure
    beside them, in turns.

    patches: the same contact without friction; of different materials on grids with room beside.
    pair: materials.
    friction: of each patch the coefficient, or that of each cell as of `HalfSpaceFriction`.
    creepage, along, across, start: as of `solve_for_forces`.
    rolling: steady rolling; else one shift.
    modes: of each patch the rigid slip (4, 2, nx, ny) of unit creepages, unit spin and the fixed
        mode; None: a plane.
    interface: as of `HalfSpaceFriction`.
    The load of each patch along its direction stays; the pressure found is that of the result. The
    contact modulus is G/(1 - nu) of the pair. ValueError: as of `solve_for_forces`; no convergence
    in 40 turns.
    """
    modulus, now = pair.shear_modulus / (1 - pair.poisson), [*patches]
    contacts = []
    for each in [] if pair.like else patches:
        moved = Influence([each], modulus)(each.pressure.ravel()).reshape(each.pressure.shape)
        undeformed = each.gap - moved + each.approach * each.upright
        influence = TractionInfluence(each.x, each.s, pair, rolling=False)
        contacts.append((each, undeformed, influence))
    before: list[TangentialSolution] = []
    for _ in range(TURNS):
        bodies = [
            HalfSpaceFriction(
                each.x,
                each.s,
                each.pressure,
                coefficient,
                pair,
                rolling=rolling,
                modes=slips,
                interface=interface,
            )
            for each, coefficient, slips in zip(
                now, friction, modes or [None] * len(now), strict=True
            )
        ]
        found = solve_for_forces(bodies, creepage, along=along, across=across, start=start)
        if pair.like or change(found, before) <= TRACTION_CHANGE:
            return found
        before, now = found, []
        for (each, gap, influence), one in zip(contacts, found, strict=True):
            opened = gap + influence.opening(one.traction)
            now += equilibrium([each], [opened], modulus, each.load, None, PRESSED, None)
    raise ValueError(f"pressure and tractions still change after {TURNS} turns")


def solve_for_forces(
    bodies: Sequence[HalfSpaceFriction],
    creepage: Creepage,
    *,
    along: float | None = None,
    across: float | None = None,
    start: Sequence[TangentialSolution] | None = None,
) -> list[TangentialSolution]:
    """Tractions of patches that share one rigid motion and together carry prescribed forces.

    along, across: prescribed force of the wheel on the rail, all patches together, N; None where
        the creepage is prescribed.
    creepage: prescribed motion; where a force is prescribed, its component is an unknown, and the
        value given has no effect.
    start: solutions of similar patches with the same forces, at whose motion Newton's method
        begins; None: no motion, where all sticks.
    The forces are met to 1e-6 mu N. The force is concave in its creepage, and a step that does not
    reduce the residual is halved. Under a law of the coefficient, `stiffness` lacks the change of
    the bound: Broyden's update follows it (Math. Comp. 19, 1965), and the patches at the creepage
    found are solved again without a start, unless they were. ValueError: forces of mu N or more, mu
    being the largest coefficient of a law; no convergence; several steady states, as of `agree`.
    """
    goals = {k: force for k, force in enumerate((along, across)) if force is not None}
    free, target = list(goals), np.array(list(goals.values()))
    values = np.array(astuple(creepage))
    values[free] = 0.0 if start is None else np.array(astuple(start[0].creepage))[free]
    begins: Sequence[TangentialSolution | None] = start or [None] * len(bodies)
    motion = Creepage(*values)
    now = [body.solve(motion, begin) for body, begin in zip(bodies, begins, strict=True)]
    limit, lawful = sum(each.limit for each in bodies), any(each.has_law for each in bodies)
    if not np.linalg.norm(target) < limit:
        raise ValueError(f"the force must be below mu N = {limit:.6g} N, got {target}")
    missing, slope = target - _forces(now)[free], None
    for _ in range(STEPS):
        if np.linalg.norm(missing) <= FORCE_TOLERANCE * limit:
            for body, each in zip(bodies, now, strict=True) if lawful and (free or start) else ():
                agree(each.bound, body.solve(motion).bound)
            return now
        if slope is None:
            pairs = zip(bodies, now, strict=True)
            stiffness = np.sum([body.stiffness(each) for body, each in pairs], axis=0)
            slope = stiffness[np.ix_(free, free)]
        step = np.linalg.lstsq(slope, missing, rcond=None)[0]
        share = 1.0
        while True:
            trial = values.copy()
            trial[free] += share * step
            motion = Creepage(*trial)
            then = [body.solve(motion, each) for body, each in zip(bodies, now, strict=True)]
            left = target - _forces(then)[free]
            if np.linalg.norm(left) < np.linalg.norm(missing) or share < 1e-6:
                break
            share /= 2
        if share < 1e-6:
            break
        more = missing - left - share * slope @ step
        slope = slope + np.outer(more, step) / (share * step @ step) if lawful else None
        values, now, missing = trial, then, left
    nearest = ", ".join(f"{each:.5g}" for each in _forces(now)[free])
    text = f"no creepage or shift found under the forces {target} N, the nearest is {nearest} N"
    raise ValueError(f"{text}; the largest force of the law may lie below" if lawful else text)


def _forces(found: Sequence[TangentialSolution]) -> Array:
    """Force along (N), force across (N) and moment (N mm) of all patches together, (3,)."""
    return np.sum([each.forces for each in found], axis=0)

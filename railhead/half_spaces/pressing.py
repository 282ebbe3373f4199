"""Half-spaces in the place of a contact's bodies, pressed without friction by boundary elements."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from railhead.contact import closed_forms
from railhead.contact.solid import Contact
from railhead.half_spaces.surface import Developed, Plane, develop, window_of
from railhead.theory.bem import grid_stress, pressure_solver
from railhead.theory.bem.influence import Lines
from railhead.theory.bem.pressure_solver import BoundaryElementSolution
from railhead.theory.elastic.line import Hertz
from railhead.theory.friction.tangential import MaterialPair
from railhead.theory.friction_laws import Interface

FIRST_REACH = 1.2  # closure up to which patches are searched at first, over Hertz's approach
MAX_SOLUTIONS = 5
TOLERANCE = 1e-5
# Of a load: half lengths change by 7 %, and grids leave 10 % beside the patch; no change at all.
NEAR, SAME = 0.2, 1e-7
YIELD_FOUND = 3e-3  # relative error of the load of first yield at which its search ends
MOST_LOADS = 5  # of that search
MARGIN = 1.1  # factor on the patch in which radii are compared
HERTZ = 0.02  # largest deviation from Hertz's gap, over the approach, for exact Hertz as forecast
STRAIGHT = 1e-9  # 1/mm, change of a curvature by rounding
CELLS = 64  # cells along each axis of a patch, before anything is meshed
FINE = 128  # of an answer

Pressed = BoundaryElementSolution | Hertz
"""A known pressure, frictionless."""


@dataclass(frozen=True)
class HalfSpacePair:
    """Both bodies of a contact as elastic half-spaces.

    contact: bodies and first contact.
    hertz: exact Hertz for the first contact, under the load or approach of the scene. Between half-
        spaces and of lines it is the pressure; else its contact modulus and approach are used.
    """

    contact: Contact
    hertz: Hertz
    _solved: dict[tuple[float | None, int], BoundaryElementSolution] = field(
        default_factory=dict, compare=False, repr=False
    )
    _stresses: dict[tuple[float, float], float] = field(
        default_factory=dict, compare=False, repr=False
    )

    @cached_property
    def developed(self) -> Developed:
        """The surface of the rail, or of the heads of a crossing, developed into a plane. Raises
        ValueError between half-spaces.
        """
        return develop(self.contact)

    @property
    def exact(self) -> bool:
        """Whether exact Hertz is the pressure: between half-spaces and of a line."""
        return self.contact.half_space or self.contact.line

    @property
    def surface(self) -> Developed | Plane:
        """The surface on which the bodies meet; of half-spaces and of a line the plane z = 0."""
        return Plane(self.contact) if self.exact else self.developed

    @cached_property
    def materials(self) -> MaterialPair:
        """Both materials of the scene combined for tangential contact."""
        return closed_forms.tangential_pair(self.contact.scene)

    @cached_property
    def interface(self) -> Interface:
        """Heat, law of friction and layer between the surfaces."""
        return closed_forms.interface(self.contact.scene)

    @cached_property
    def gap_deviation(self) -> float:
        """Largest deviation of the gap over the patch from Hertz's parabola, over the approach
        (`closed_forms.gap_deviation`); 0 between half-spaces and in sections.
        """
        curved = self.contact.curved_solid
        return closed_forms.gap_deviation(self.contact, self.hertz) if curved else 0.0

    @property
    def one_radius(self) -> bool:
        """Whether each body has one radius across 1.1 (MARGIN) times Hertz's patch; True between
        half-spaces and in sections.
        """
        touch, reach = self.contact.touch, MARGIN * self.hertz.b
        y = touch.y + reach * math.cos(touch.angle) * np.array([-1.0, 0.0, 1.0])
        curvatures = [each.curvature(y - shift) for _, each, shift in self.contact.cross_profiles]
        return not self.contact.curved_solid or float(np.ptp(curvatures, axis=1).max()) < STRAIGHT

    @cached_property
    def boundary_elements(self) -> BoundaryElementSolution:
        """Boundary elements under the load of the scene or, without one, at its approach. Raises
        ValueError as `solve`.
        """
        return self.pressed(self.contact.scene.load)

    @cached_property
    def elastic(self) -> BoundaryElementSolution | str:
        """Boundary elements where the gap differs from Hertz's parabola by 2 % (HERTZ) or more;
        else text: empty, as exact Hertz gives the patch before anything is solved, or the reason
        why boundary elements find no closed patch.
        """
        if self.gap_deviation < HERTZ:
            return ""
        try:
            return self.boundary_elements
        except ValueError as error:
            return str(error)

    def von_mises(self, poisson: float, under: BoundaryElementSolution | None = None) -> float:
        """Largest von Mises stress, MPa, in a half-space for a Poisson's ratio, elastic and
        frictionless: below another pressure, or where that is None below the one that is known
        before anything is solved.
        """
        now = under or self.elastic
        if isinstance(now, str):
            return self.hertz.axis_extrema(poisson).von_mises_max
        if (key := (now.load, poisson)) not in self._stresses:
            stresses = [grid_stress.largest_von_mises(each, poisson) for each in now.patches]
            self._stresses[key] = max(stresses)
        return self._stresses[key]

    def over_yield(
        self, limits: Sequence[tuple[float, float]], under: BoundaryElementSolution | None = None
    ) -> float:
        """Largest ratio of `von_mises` to the yield stress of a body; 1 without bodies. limits:
        Poisson's ratio and yield stress, MPa, of each.
        """
        ratios = [self.von_mises(poisson, under) / limit for poisson, limit in limits]
        return max(ratios, default=1.0)

    def overload(self, limits: Sequence[tuple[float, float]]) -> float:
        """Load over that of first yield; limits: as of `over_yield`. Hertz's stresses grow as the
        cube root of the load, in a line contact as the square root. Where the patch is not Hertz's,
        the load of first yield is found by boundary elements, to 0.3 % (YIELD_FOUND).
        """
        power, load, now = 1 / self.contact.load_power, self.contact.scene.load, self.elastic
        over, share = math.log(self.over_yield(limits)), 0.0
        for _ in range(MOST_LOADS):
            if isinstance(now, str) or load is None or abs(over) < power * YIELD_FOUND:
                break
            last, share = (share, over), share - over / power
            now = self.pressed(load * math.exp(share))
            over = math.log(self.over_yield(limits, now))
            power = (last[1] - over) / (last[0] - share)
        return math.exp(over / power - share)

    def pressed(self, load: float | None, cells: int = CELLS) -> BoundaryElementSolution:
        """Boundary elements with all patches under a vertical load (N), None for Hertz's approach
        over the cosine of the contact angle; `cells` along each axis of a patch. What was solved is
        remembered; fine grids start from the coarse ones. Raises ValueError as `solve`.
        """
        key = load, cells
        if key not in self._solved:
            known = self.pressed(load) if cells > CELLS else None
            self._solved[key] = self.solve(load, cells, known)
        return self._solved[key]

    def pressure(self, load: float | None) -> Pressed:
        """The pressure of an answer under a vertical load (N), as of `pressed`: boundary elements
        on 128 cells (FINE), or exact Hertz between half-spaces and of a line.
        """
        return self.hertz if self.exact else self.pressed(load, FINE)

    def near(
        self, before: BoundaryElementSolution, load: float, cells: int
    ) -> BoundaryElementSolution:
        """Boundary elements under another vertical load (N): on the grids of a solution `before`
        if that has nearly this load (NEAR), else as `pressed`.
        """
        change = abs(load / before.load - 1)
        if change > NEAR:
            return self.pressed(load, cells)
        return before if change < SAME else pressure_solver.under_load(before, load, TOLERANCE)

    def solve(
        self,
        load: float | None,
        cells: int = CELLS,
        known: BoundaryElementSolution | None = None,
        *,
        lines: Lines | None = None,
        start: BoundaryElementSolution | None = None,
    ) -> BoundaryElementSolution:
        """Boundary elements as of `pressed`, solved anew.
        known: the same on 64 cells (CELLS), from which finer grids start; None: it is solved first.
        lines: compliance of the lines along x, by wear, added to that of the half-spaces; None:
            zero.
        start: a similar solution, in whose windows the patches are searched first; None: around the
            contact points.
        Where the solution leaves a point of the wheel's contact locus inside the rail, a patch was
        missed and is added. Raises ValueError for half-spaces, where there is no closed patch
        within the profiles, and where patches are still missed after five solutions
        (MAX_SOLUTIONS).
        """
        surface, upright = self.developed, self.contact.touch.upright
        rigid = self.hertz.approach / upright
        if load is not None:
            rigid *= (load / self.hertz.load / upright) ** (2 / 3)
        locus = surface.locus(2 * FIRST_REACH * rigid)
        if start is None:
            windows = surface.near(locus, FIRST_REACH * rigid)
        else:
            windows = [window_of(window.x, window.s) for window in start.windows]
        for _ in range(MAX_SOLUTIONS):
            found = pressure_solver.solve_developed(
                surface.gap,
                self.hertz.contact_modulus,
                windows,
                surface.angle,
                cells=cells,
                load=load,
                approach=rigid if load is None else None,
                tolerance=TOLERANCE,
                lines=lines,
                known=known,
                lean=surface.lean,
            )
            known = None
            if not (missed := surface.missed(locus, found)):
                return found
            windows = [window_of(window.x, window.s) for window in found.windows] + missed
        raise ValueError(
            f"after {MAX_SOLUTIONS} solutions the wheel still lies in the rail beside the patches"
        )

"""Largest value of a stress invariant in a body, away from sharp edges.

At the edges of the bodies and of their supports the exact stress is unbounded or has no meaning, so
the computed value depends on the mesh.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from itertools import product

import basix
import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from railhead.postprocess.findings import NO_DEPTH, Array, Peak
from railhead.postprocess.patch.moments import quadratic_fit
from railhead.postprocess.stress.body_geometry import Solid
from railhead.postprocess.stress.recovery import Recovery, StressPolynomial
from railhead.solver.space.cells import tabulate
from railhead.solver.system.fields import Fields
from railhead.theory.array_types import Index

Invariant = Callable[[Array], Array]
EDGE_ELEMENTS = 2.0  # elements next to a sharp edge whose stresses are not used
EDGE_OF_PATCH = 0.3  # the least such distance, over the smaller semi-axis
HILL_SHARE = 0.85  # of the largest nodal average: lower nodes start no search
HILLS = 6  # largest number of searches
HILL_DISTANCE = 0.5  # of the smaller semi-axis: between their starts, and at least two elements
CLIMB_SHARE = 0.95  # of the largest recovered stress at the starts: lower ones are dropped
CLIMB_STEPS = 8  # of each search, by lattice points and by parabolas
LATTICE = 4  # steps along the edge of a cell between the points that are compared
FIT_REACH = 0.25  # of the radius of a fit: how far from its centre it is trusted
STENCIL = 0.05  # of that radius: between the values that the parabola goes through


class Search:
    """Search for the largest value of an invariant of the stress in one body, away from sharp
    edges.

    Nodal averages show the hills of the invariant. From these the search climbs on the recovered
    stress: first from point to point of a lattice in the cells, so that no point lies outside the
    body, then to the top of a fitted parabola.
    """

    def __init__(
        self, fields: Fields, solid: Solid, recovery: Recovery, edges: Array, size: float
    ) -> None:
        """fields: the solution. solid: cells of the body. recovery: smooth stresses of the body.
        edges (n, 3): points on the sharp edges of all bodies, mm. size: smaller semi-axis of the
        patch, mm.
        """
        self._fields, self._solid, self._recovery = fields, solid, recovery
        self._edges, self._size = cKDTree(edges) if len(edges) else None, size
        self._planes = [int(np.argmax(np.abs(normal))) for normal in fields.mirrors]
        nodes, inverse = np.unique(solid.corners, return_inverse=True)
        number: Index = inverse.reshape(solid.corners.shape)
        self._nodes = fields.points[nodes]
        volume = np.repeat(solid.sizes**3, number.shape[1])
        of_cell = np.repeat(np.arange(len(number)), number.shape[1])
        around = sp.csr_matrix((volume, (number.ravel(), of_cell)), (len(nodes), len(number)))
        total = around @ recovery.stress.mean(axis=1)
        self._average = total / np.asarray(around.sum(axis=1))
        sizes = np.zeros(len(nodes))
        np.maximum.at(sizes, number, solid.sizes[:, None])
        self._sizes = sizes
        self._far = self._far_from_edges(self._nodes, sizes)

    @cached_property
    def _lattice(self) -> Array:
        """Values (p, k) of the k shape functions at the p points of a regular lattice in a cell."""
        fields = self._fields
        kind, even = getattr(basix.CellType, fields.cell), basix.LatticeType.equispaced
        points = np.asarray(basix.create_lattice(kind, LATTICE, even, True))
        return tabulate(fields.cell, fields.degree, points)[0]

    def _far_from_edges(self, points: Array, sizes: Array) -> Array:
        """(n,) whether points (n, 3), mm, are far from every sharp edge: farther than two
        elements (EDGE_ELEMENTS) and than 0.3 (EDGE_OF_PATCH) of the smaller semi-axis of the patch.
        sizes (n,): half sizes of the cells that hold them, as `Solid.sizes`, mm.
        """
        if self._edges is None:
            return np.ones(len(points), dtype=bool)
        least = np.maximum(2 * EDGE_ELEMENTS * sizes, EDGE_OF_PATCH * self._size)
        return self._edges.query(points, distance_upper_bound=least.max(initial=0.0))[0] > least

    def _element(self, place: Array) -> float:
        """Largest half size of the cells that may hold a place (3,), mm: distance of a cell's
        farthest corner from its middle; 0 if there is none.
        """
        return float(self._solid.sizes[self._solid.near(place, 0.0)].max(initial=0.0))

    def highest(self, invariant: Invariant, also: Array) -> Peak | None:
        """Largest recovered value of an invariant in the body, as a peak; None if all of the body
        is near sharp edges. Where a body yields it is at most the largest value at a Gauss point:
        the yield condition holds at these points, and a smooth field exceeds it.

        invariant: function that gives values (n,) of stresses (n, 6), MPa. also (n, 3): further
            places, mm, from which the search may start, such as the peak on the depth axis; those
            outside the body are left out.
        """
        also = also[np.array([self._solid.holds(place) for place in also], dtype=bool)]
        sizes = np.array([self._element(place) for place in also])
        hills = self._hills(invariant(self._average))
        hills = np.concatenate([hills, also[self._far_from_edges(also, sizes)]])
        if not len(hills):
            return None
        values = invariant(self._recovery.at(hills))
        starts = hills[values > CLIMB_SHARE * values.max()]
        tops = [self._peak(*self._climb(start, invariant)) for start in starts]
        best = max(tops, key=lambda top: top.value)
        if self._fields.plastic_strain is not None:
            best = replace(best, value=min(best.value, self._largest_sample(invariant)))
        return best

    def _largest_sample(self, invariant: Invariant) -> float:
        """Largest value of an invariant at the Gauss points of cells away from sharp edges, MPa."""
        far = self._far_from_edges(self._recovery.points.mean(axis=1), self._solid.sizes)
        return float(invariant(self._recovery.stress[far].reshape(-1, 6)).max())

    def at_edges(self, invariant: Invariant, value: float) -> Peak | None:
        """Largest nodal average of an invariant near sharp edges, as a peak, if it exceeds `value`,
        MPa; otherwise None.
        """
        values = np.where(self._far, -np.inf, invariant(self._average))
        top = int(np.argmax(values))
        if values[top] <= value:
            return None
        return self._peak(float(values[top]), self._nodes[top])

    def _hills(self, average: Array) -> Array:
        """Up to six nodes (n, 3), mm, with the largest averages, above 0.85 (HILL_SHARE) of the
        largest, at a distance from each other and from sharp edges. average (k,): of an invariant,
        at all k corner nodes of the body, MPa.
        """
        candidates = np.flatnonzero(self._far)
        if not len(candidates):
            return self._nodes[:0]
        candidates = candidates[average[candidates] > HILL_SHARE * average[candidates].max()]
        candidates = candidates[np.argsort(-average[candidates])]
        found: list[int] = []
        while len(candidates) and len(found) < HILLS:
            found.append(int(candidates[0]))
            distance = np.linalg.norm(self._nodes[candidates] - self._nodes[found[-1]], axis=1)
            least = max(4 * self._sizes[found[-1]], HILL_DISTANCE * self._size)
            candidates = candidates[distance > least]
        return self._nodes[found]

    def _climb(self, place: Array, invariant: Invariant) -> tuple[float, Array]:
        """Value (MPa) and place (3,) of the local maximum of an invariant that the search reaches
        from a point (3,), mm.
        """
        around = self._recovery.around(place)
        value = float(invariant(around(place[None]))[0])
        for move in (self._best_point, self._top):
            for _ in range(CLIMB_STEPS):
                moved = move(place, around, invariant)
                fitted = self._recovery.around(moved)
                new = float(invariant(fitted(moved[None]))[0])
                if new <= value * (1 + 1e-9):
                    break
                place, around, value = moved, fitted, new
        return value, place

    def _best_point(self, place: Array, around: StressPolynomial, invariant: Invariant) -> Array:
        """The lattice point (3,) of cells near a place (3,), mm, with the largest value of an
        invariant; the place itself if no lattice point is near. around: stresses as a polynomial
        around the place.
        """
        reach = FIT_REACH * around.radius
        cells = self._solid.near(place, reach)
        points = (self._lattice @ self._fields.points[self._solid.nodes[cells]]).reshape(-1, 3)
        near = ((points - place) ** 2).sum(axis=1) <= reach**2
        sizes = np.repeat(self._solid.sizes[cells], len(self._lattice))[near]
        points = points[near]
        points = points[self._far_from_edges(points, sizes)]
        if not len(points):
            return place
        return np.asarray(points[np.argmax(invariant(around(points)))])

    def _top(self, place: Array, around: StressPolynomial, invariant: Invariant) -> Array:
        """The top (3,) of a parabola through values of an invariant around a place (3,), mm. The
        place itself is returned if the top lies outside the body or near a sharp edge. around:
        stresses as a polynomial around the place.
        """
        step, axes = STENCIL * around.radius, self._fields.kinematics.axes
        steps = np.array(list(product((-1.0, 0.0, 1.0), repeat=len(axes))))
        values = invariant(around(place + step * steps @ axes))
        _, slope, hessian = quadratic_fit(steps, values, np.ones(len(steps)))
        curvature, directions = np.linalg.eigh(hessian)
        along = slope @ directions
        concave = curvature < 0
        move = np.where(concave, -along / np.where(concave, curvature, 1.0), 0.0)
        limit = FIT_REACH / STENCIL
        moved = place + step * (directions @ np.clip(move, -limit, limit)) @ axes
        moved[self._planes] = np.abs(moved[self._planes])
        far = self._far_from_edges(moved[None], np.array([self._element(place)]))[0]
        return moved if far and self._solid.holds(moved) else place

    def _peak(self, value: float, place: Array) -> Peak:
        """Peak of a value (MPa) at a place (3,), mm, with the distance of the place from the
        tangent plane at the nearest contact point as its depth, never negative.
        """
        contact = self._fields.contact
        nearest = int(np.argmin(((contact.points - place) ** 2).sum(axis=1)))
        depth = abs((place - contact.points[nearest]) @ contact.normals[nearest])
        depth = depth if depth > NO_DEPTH * self._size else 0.0
        return Peak(value, float(depth), (float(place[0]), float(place[1]), float(place[2])))

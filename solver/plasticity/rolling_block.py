"""One pass of a load, and passes one after the other, in the frame of the load.

    sigma = sigma_r(y, z) + sigma_e + C (E u - D),    K u = E^T w C D

sigma_r is the residual stress that the earlier passes left, sigma_e the elastic stress of the load,
and u the displacement that the change D of the plastic strain in this pass makes. E takes u to the
strain at the Gauss points, w are their weights, C is the elastic tensor, K the stiffness.
D follows at the Gauss points by radial return from one to the next along x, from upstream, where it
is zero, down. Nothing depends on time (Dang Van and Maitournam, J. Mech. Phys. Solids 41, 1993).
Several blocks may share a load: two bodies that both yield, or one below each of several patches.
The nodes of the outflow have the u_x that D of the last column makes in a slab which does not
change along x.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from railhead.solver.algebra.mixing import Anderson
from railhead.solver.material import Hardening
from railhead.solver.plasticity.block import Block
from railhead.solver.plasticity.radial_return import History, deviator, radial_return
from railhead.theory.array_types import Array, Index

TOLERANCE = 1e-4  # change of the stress in an iteration over the yield stress in shear
ITERATIONS = 250
ALIKE = 1e-6  # of the largest coordinate: points on one line
MOST_AHEAD = 0.67  # of the plastic strain of a step: what BDF2 may take from the step before
DEPTH = 20  # number of iterations that Anderson's mixing combines


@dataclass(frozen=True)
class Streams:
    """Order of n = columns * lines Gauss points: a column holds the points with one x, a line those
    with one (y, z), along which the material flows.

    order: number of the point of each column and line (columns, lines); the first column lies
        farthest upstream, at the largest x.
    x: coordinate of the columns (columns,), mm, descending.
    places: (y, z) of the lines (lines, 2), mm.
    """

    order: Index
    x: Array
    places: Array

    @classmethod
    def of(cls, points: Array) -> Streams:
        """Streams of points (n, 3), mm, that line up along x."""
        step = ALIKE * max(float(np.abs(points).max()), 1e-300)
        keys = np.round(points / step).astype(np.int64)
        order = np.lexsort((keys[:, 2], keys[:, 1], -keys[:, 0]))
        columns = len(np.unique(keys[:, 0]))
        table = order.reshape(columns, -1)
        return cls(table, points[table[:, 0], 0], points[table[0], 1:])

    def gathered(self, values: Array) -> Array:
        """Values (n, ...) of the points as (columns, lines, ...)."""
        return np.asarray(values[self.order])

    def scattered(self, values: Array) -> Array:
        """Values (columns, lines, ...) as those of the points (n, ...)."""
        out = np.empty((self.order.size, *values.shape[2:]))
        out[self.order.ravel()] = values.reshape(self.order.size, *values.shape[2:])
        return out


@dataclass(frozen=True)
class ProfileChange:
    """Displacement of the surface z = 0 at n nodes of the section across the rail.

    y: (n,), mm; a single zero in plane strain.
    along: u_x (n,), mm.
    up: u_z (n,), mm.
    """

    y: Array
    along: Array
    up: Array

    def __add__(self, other: ProfileChange) -> ProfileChange:
        """Sum of both displacements on the same nodes."""
        return ProfileChange(self.y, self.along + other.along, self.up + other.up)


ElasticStress = Callable[[Sequence[Array], Sequence[ProfileChange]], Sequence[Array]]
"""(displacement of the surface of each block in this pass, see `RollingBlock.surface`; its profile
of the passes before) -> elastic stress of the load (columns, lines, m) at the points of each block,
MPa, in Mandel's notation of the block."""


@dataclass(frozen=True, kw_only=True)
class SectionState:
    """What the passes so far left in the section.

    history: plastic state of the lines.
    residual: residual stress (lines, m), MPa, in Mandel's notation of the block.
    profile: displacement of the surface.
    displacement: u (n c,), mm, of the last pass, from which the iterations of the next one start,
        but not those of the second pass; None: zero.
    count: number of passes so far.
    """

    history: History
    residual: Array
    profile: ProfileChange
    displacement: Array | None = None
    count: int = 0


@dataclass(frozen=True, kw_only=True)
class RollingPass:
    """A pass, and the state after it.

    state: what all passes so far left in the section.
    profile: change of the surface in this pass.
    growth: increase of the equivalent plastic strain (lines,) in this pass.
    shear: increase of the plastic shear 2 eps_xz (lines,), z upwards, in this pass.
    work: plastic work of this pass per rolled length, N; in plane strain per mm of width.
    stored: elastic energy per rolled length that this pass adds to what residual stresses store,
        N; in plane strain per mm of width.
    iterations: number of fixed-point iterations.
    change: stress change of the last iteration over the yield stress in shear; not below the
        tolerance of the block: not converged.
    rim: largest `growth` on the lines in the lowest and, in a solid, the outermost cells where
        plastic strain is followed.
    """

    state: SectionState
    profile: ProfileChange
    growth: Array
    shear: Array
    work: float
    stored: float
    iterations: int
    change: float
    rim: float


@dataclass(frozen=True)
class RollingBlock:
    """A block over which a load rolls.

    block: the block; its material has a flow curve.
    law: flow curve in the place of the material's; None: that.
    tolerance: of the fixed point: change of the stress over the yield stress in shear.
    """

    block: Block
    law: Hardening | None = None
    tolerance: float = TOLERANCE

    @cached_property
    def streams(self) -> Streams:
        """Columns and lines of the Gauss points."""
        return Streams.of(self.block.points.points)

    @cached_property
    def points(self) -> Array:
        """Positions in space (columns, lines, 3) of the Gauss points of the block, mm."""
        return self.streams.gathered(self.block.points.points)

    @cached_property
    def _slab_streams(self) -> Streams:
        """Columns and lines of the slab; its lines are those of the block."""
        return Streams.of(self.block.slab.points.points)

    @cached_property
    def _areas(self) -> Array:
        """Area (lines,) of the section that belongs to each line, mm2; in plane strain per mm of
        width.
        """
        weights = self._slab_streams.gathered(self.block.slab.points.weights)
        return np.asarray(weights.sum(axis=0) / self.block.slab.axes[0][-1])

    @property
    def hardening(self) -> Hardening:
        """Flow curve of the steel that flows through the block."""
        law = self.law or self.block.material.hardening
        assert law is not None
        return law

    @property
    def shear_yield(self) -> float:
        """First yield stress in pure shear, MPa."""
        return self.hardening.initial_yield_stress / math.sqrt(3)

    @property
    def start(self) -> SectionState:
        """State without plastic strain or residual stress."""
        lines, size = self.points.shape[1], 3 + len(self.block.kinematics.shears)
        y = self.block.surface[1]
        zero = np.zeros(len(y))
        return SectionState(
            history=History.virgin(lines, size, max(len(self.hardening.backstresses), 1)),
            residual=np.zeros((lines, size)),
            profile=ProfileChange(y, zero, zero),
        )

    def stress(self, strain: Array) -> Array:
        """Stress C : eps (..., m), MPa, of strains (..., m)."""
        lam, mu = self.block.material.lame
        out = 2 * mu * strain
        out[..., :3] += lam * strain[..., :3].sum(axis=-1, keepdims=True)
        return out

    @cached_property
    def _outflow_order(self) -> Array:
        """Number (k,) of the slab's node for each node of the outflow, in their order."""
        slab, block = self.block.slab, self.block
        own = np.flatnonzero(slab.outflow)
        nearest = cKDTree(slab.nodes[own, 1:]).query(block.nodes[block.outflow, 1:])[1]
        return np.asarray(own[nearest])

    def outgoing(self, change: Array) -> tuple[Array, ProfileChange, Array]:
        """Answer of the slab to a change of its plastic strain (lines, m): u_x (k,) of the
        outflow's nodes, mm; displacement of the surface; residual stress (lines, m), MPa.
        """
        slab, streams = self.block.slab, self._slab_streams
        spread = streams.scattered(np.broadcast_to(change, (len(streams.x), *change.shape)))
        moved = slab.solve(slab.plastic_force(spread))
        strain = streams.gathered(slab.strains(moved))[0]
        values = moved.reshape(-1, slab.dim)
        _, y, numbers = slab.surface
        surface = values[numbers[0]]
        profile = ProfileChange(y, surface[:, 0], surface[:, -1])
        return values[self._outflow_order, 0], profile, self.stress(strain - change)

    def stored(self, state: SectionState) -> float:
        """Elastic energy of the residual stresses of a state per rolled length, N, in plane strain
        per mm of width: -1/2 int sigma_r : eps_p dA. Residual stresses do no work on the strains of
        the section.
        """
        product = np.einsum("lm,lm->l", state.residual, state.history.plastic)
        return -0.5 * float(product @ self._areas)

    def surface(self, displacement: Array) -> Array:
        """Displacement (nx, ny, c) of the surface z = 0, mm, at the nodes of `Block.surface`, along
        the c coordinates of the block; displacement: of all dofs (n c,), mm.
        """
        return displacement.reshape(-1, self.block.dim)[self.block.surface[2]]

    @cached_property
    def _rim(self) -> Array:
        """Mask (lines,) of the lines in the lowest and, in a solid, the outermost cells where
        plastic strain is followed.
        """
        y, z = self.streams.places.T
        out = z <= np.unique(z)[2]
        if self.block.dim == 3:
            out |= np.abs(y) >= np.unique(np.abs(y))[-3]
        return np.asarray(out)


class _Iterated:
    """A block in the fixed-point iterations of one pass.

    u: displacement of this pass on all dofs (n c,), mm, of the last iteration.
    change: change of the stress in the last iteration, over the yield stress in shear.
    """

    def __init__(self, rolling: RollingBlock, state: SectionState) -> None:
        """state: what the passes before left."""
        self.rolling, self.state, self.change = rolling, state, np.inf
        self.u: Array = np.zeros(rolling.block.nodes.size)
        if state.displacement is not None and state.count > 1:  # the first pass is unlike the rest
            self.u = state.displacement
        self.strain = self._strained(self.u)

    def _strained(self, u: Array) -> Array:
        """Strain (columns, lines, m) of a displacement."""
        return self.rolling.streams.gathered(self.rolling.block.strains(u))

    def answer(self, elastic: Array) -> Array:
        """Displacement (n c,), mm, that the plastic strain makes which follows from the elastic
        stress of the load (columns, lines, m), MPa, and the displacement so far.
        """
        rolling, streams, incoming = self.rolling, self.rolling.streams, self.state.history
        mu = rolling.block.material.lame[1]
        trial = deviator((self.state.residual + elastic).reshape(-1, elastic.shape[-1]))
        trial = trial.reshape(elastic.shape) / (2 * mu) + self.strain + incoming.plastic
        mus = np.full(elastic.shape[1], mu)
        self.elastic = elastic
        self.plastic, self.after = follow(trial, streams.x, mus, incoming, rolling.hardening)
        grown = self.plastic - incoming.plastic
        pushed, self.profile, self.residual = rolling.outgoing(grown[-1])
        value = rolling.block.solve(rolling.block.plastic_force(streams.scattered(grown)), pushed)
        change = rolling.stress(self._strained(value) - self.strain)
        self.change = float(np.abs(change).max() / rolling.shear_yield)
        return value

    def take(self, u: Array) -> None:
        """Go on from a displacement (n c,), mm."""
        self.u, self.strain = u, self._strained(u)

    def finished(self, iterations: int) -> RollingPass:
        """The pass after its last iteration."""
        rolling, state, after = self.rolling, self.state, self.after
        incoming, kinematics = state.history, rolling.block.kinematics
        grown = self.plastic - incoming.plastic
        total = state.residual + self.elastic + rolling.stress(self.strain - grown)
        before = np.concatenate([incoming.plastic[None], self.plastic[:-1]])
        mean = (total + np.concatenate([total[:1], total[:-1]])) / 2
        gained = after.equivalent - incoming.equivalent
        xz = 3 + kinematics.shears.index((0, kinematics.dim - 1))  # in Mandel's notation
        left = SectionState(
            history=after,
            residual=state.residual + self.residual,
            profile=state.profile + self.profile,
            displacement=self.u,
            count=state.count + 1,
        )
        return RollingPass(
            state=left,
            profile=self.profile,
            growth=gained,
            shear=np.sqrt(2) * (after.plastic - incoming.plastic)[:, xz],
            work=float(np.einsum("clm,clm,l->", mean, self.plastic - before, rolling._areas)),
            stored=rolling.stored(left) - rolling.stored(state),
            iterations=iterations,
            change=self.change,
            rim=float(np.max(gained[rolling._rim], initial=0.0)),
        )


def roll(
    blocks: Sequence[RollingBlock], states: Sequence[SectionState], pressing: ElasticStress
) -> list[RollingPass]:
    """One more pass of a load over the states of blocks that share it, by a fixed-point iteration
    on all displacements together. It ends after 250 iterations (ITERATIONS) even where the
    tolerance of a block is not met, see `RollingPass.change`.

    pressing: gives the elastic stress of the load in each block.
    """
    each = [_Iterated(*pair) for pair in zip(blocks, states, strict=True)]
    ends = np.cumsum([len(one.u) for one in each])[:-1]
    mixing, iterations, met = Anderson(DEPTH), 0, False
    while not met and iterations < ITERATIONS:
        iterations += 1
        surfaces = [one.rolling.surface(one.u) for one in each]
        stresses = pressing(surfaces, [one.state.profile for one in each])
        u = np.concatenate([one.u for one in each])
        pairs = zip(each, stresses, strict=True)
        value = np.concatenate([one.answer(stress) for one, stress in pairs])
        met = all(one.change < one.rolling.tolerance for one in each)
        found = value if met else mixing.next(u, value)
        for one, own in zip(each, np.split(found, ends), strict=True):
            one.take(own)
    return [one.finished(iterations) for one in each]


def follow(
    strain: Array, x: Array, mu: Array, incoming: History, hardening: Hardening
) -> tuple[Array, History]:
    """Radial return from column to column.

    strain: (columns, lines, m) in Mandel's notation: the deviator of the elastic trial stress over
        2 mu, before any plastic strain of the material.
    x: coordinate of the columns (columns,), mm, descending.
    mu: shear modulus (lines,), MPa.
    incoming: state of the lines upstream.
    hardening: flow curve.
    Returns the plastic strain (columns, lines, m) and the outgoing state. Where a line of steel
    with back stresses goes on yielding, plastic strain follows by BDF2 over its last two columns
    (see `solver.system.load_stepping.Response`), with an error of second order in their distance;
    at most 67 % (MOST_AHEAD) of a step is taken from the last one, so that nothing jumps where
    yield ends. Without back stresses it follows by backward Euler.
    """
    plastic, state = np.empty_like(strain), incoming.at(np.arange(len(mu)))
    equivalent, steps, second = np.empty(strain.shape[:2]), -np.diff(x), hardening.backstresses
    for column, each in enumerate(strain):
        excess = state.excess(2 * mu[:, None] * (each - state.plastic), hardening)
        yields = np.flatnonzero(excess > 0)
        if len(yields):
            start = state.at(yields)
            if second and column > 1:
                ratio = steps[column - 1] / steps[column - 2]
                last = start.equivalent - equivalent[column - 2, yields]
                likely = MOST_AHEAD * excess[yields] / (np.sqrt(6) * mu[yields])
                factor = np.minimum(ratio**2 / (1 + 2 * ratio), likely / np.maximum(last, 1e-300))
                start.run_ahead(factor, start.plastic - plastic[column - 2, yields], last)
            after, _ = radial_return(each[yields], mu[yields], start, hardening, tangent=False)
            state.put(yields, after)
        plastic[column], equivalent[column] = state.plastic, state.equivalent
    return plastic, state

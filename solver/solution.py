"""What a contact model finds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from petsc4py import PETSc

from railhead.solver.algebra.newton import NewtonResult
from railhead.solver.algebra.problem import Mask
from railhead.solver.space.cells import Array


@dataclass(frozen=True)
class Plastic:
    """Plastic strain tensors (m, g, 3, 3) in space and equivalent plastic strain (m, g) at the g
    Gauss points of this rank's m cells."""

    strain: Array
    equivalent: Array


@dataclass(frozen=True)
class Yielding:
    """How bodies yielded. over: load over that of first yield; steps: Newton's histories of all
    load steps, of the unloading too; loading: how many of them were taken up to the load for the
    first time; unloaded: the residual state, the bodies apart (None if it was not asked for);
    indentation: by tag of a body, how far its surface stays pushed in at most, mm."""

    over: float
    steps: tuple[NewtonResult, ...]
    loading: int
    unloaded: Solution | None
    indentation: Mapping[int, float]


@dataclass(frozen=True)
class Rubbing:
    """n contact points, of all ranks: points (n, 3) mm, weights (n,) mm2 of the whole model,
    pressure (n,) MPa; traction (n, 3) MPa of the wheel on the rail; slip (n, 3) of the wheel over
    the rail, mm in the last leg, or, rolling, of 1; sticks (n,) of those with pressure; motion:
    creepage, or shift in mm, along and across, and spin (1/mm); force along and across, N; moment
    N mm about the normal at the origin; limit mu N, N; legs (l, 4): force along and across (N) and
    motion along and across at the end of each leg; energy: dissipated by slip after the force
    was reached for the first time, N mm; passes: how often tractions and pressure were found in
    turn; rigid (n, 3): slip of rigid bodies, mm, or, rolling, of 1; history: the longest of
    `solver.friction.Sheared`; still: rolling, the same contact without creepage."""

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
    legs: Array
    energy: float
    passes: int
    rigid: Array
    history: tuple[float, ...]
    still: Rubbing | None = None


@dataclass(frozen=True)
class Solution:
    """One load case. displacement: owned dofs, mm. pressure (n,) MPa at the interface's points.

    load: what the pressure carries against the direction of the approach, of the whole model, N;
    reaction: the same at the support, N; approach: mm; penetration: largest overlap, mm.
    indicator (n,) MPa: the pressure before its negative part is cut off. newton: of the last load
    step, or of the one that failed. plastic: what has yielded. plain: the same without friction,
    or, of a frictionless one, without yield, where there is one.
    """

    displacement: PETSc.Vec
    pressure: Array
    indicator: Array
    approach: float
    load: float
    reaction: float
    penetration: float
    newton: NewtonResult
    plastic: Plastic | None = None
    plain: Solution | None = None
    yielding: Yielding | None = None
    rubbing: Rubbing | None = None

"""State of a model between two solutions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from petsc4py import PETSc

from railhead.solver.algebra.newton import NewtonResult, NewtonStep
from railhead.solver.material.hardening import History
from railhead.solver.space.contact_interface import Interface
from railhead.solver.space.supports import Hub
from railhead.theory.array_types import Array

HubLoads = Mapping[Hub, tuple[float | None, Array]]
"""Of each hub the force along its free direction, None: it is moved; and its motion (c,), of a hub
with a force across the free direction."""


@dataclass(frozen=True, kw_only=True)
class State:
    """State of a model with n contact points on this rank.

    displacement: on all dofs that this process owns.
    loads: of all hubs; motions: of each hub (c,). share: of the bodies' forces that acts.
    nodal: force that each node of this rank needs from outside (nodes, c): of supports and hubs.
    bulk, surface: plastic histories at Gauss points and contact points.
    pairing: contact points; outdated: whether points have slid by too much since they were paired.
    pressure, gap: at the points (n,). traction: along the tangents there (n, k).
    result: Newton's method in the last step; history: all of its steps so far.
    """

    displacement: PETSc.Vec
    loads: HubLoads
    motions: Mapping[Hub, Array]
    share: float
    nodal: Array
    bulk: History
    surface: History
    pairing: Interface
    outdated: bool
    pressure: Array
    gap: Array
    traction: Array
    result: NewtonResult
    history: tuple[NewtonStep, ...] = ()

"""Friction of half-spaces under the scene's own creepages or forces: Kalker's exact theory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhead.planning.effects import interface
from railhead.planning.plan import Plan
from railhead.planning.references import boundary_elements, closed_forms
from railhead.run.references import equal_ellipses, rolling_patches
from railhead.run.references.rolling_patches import Patch
from railhead.run.references.rolling_reference import CELLS, SEVERAL, STRIP_CELLS, by_key
from railhead.solver.solution import FrictionSolution
from railhead.theory.bem.boundary_element import Solution
from railhead.theory.bem.patch import PatchSolution
from railhead.theory.elastic.line import LineContact
from railhead.theory.friction import rolling
from railhead.theory.friction.rolling import HalfSpaceFriction, TangentialSolution, solve_for_forces

Array = NDArray[np.float64]
STUCK = 1e-6  # relative: a traction that is that much below its bound sticks


@dataclass(frozen=True, kw_only=True)
class HalfSpaceFrictionSolution:
    """Friction of half-spaces on grids of cells.

    solution: tractions at the cells that touch, forces and motion.
    windows: pressure on the grids.
    tractions: of the wheel on the rail along x and s in each window, (2, nx, ns), MPa.
    grid_error: change of the forces from a grid of half as many cells each way, over mu N.
    fastsim: forces and stick share by FASTSIM, by the keys of "friction" in summary.json, or
        "reason"; empty where it does not apply.
    """

    solution: FrictionSolution
    windows: Sequence[PatchSolution]
    tractions: Sequence[Array]
    grid_error: float
    fastsim: dict[str, Any]


def solve(plan: Plan, profiles: Solution | None, load: float) -> HalfSpaceFrictionSolution:
    """Tractions of a plan under a vertical load (N) at its creepages or forces.

    profiles: half-space solution of the profiles; None between half-spaces. Raises ValueError where
        patches or tractions are not found.
    """
    shares = []
    for cells in STRIP_CELLS if plan.contact.line else CELLS:
        patches = _patches(plan, profiles, load, cells)
        # The strip of a line contact is longer than the contact, and its forces are as much larger.
        longer = sum(each.pressed.load for each in patches) / load
        sheared = _sheared(plan, patches, longer)
        limit = sum(each.limit for each in sheared)
        shares.append(np.sum([each.forces for each in sheared], axis=0)[:2] / limit)
    solution = _at_points(plan, patches, sheared, 1 / longer)
    return HalfSpaceFrictionSolution(
        solution=solution,
        windows=[each.pressed for each in patches],
        tractions=[each.traction for each in sheared],
        grid_error=float(np.abs(shares[1] - shares[0]).max()),
        fastsim=_fastsim(plan, patches, solution),
    )


def _patches(plan: Plan, profiles: Solution | None, load: float, cells: int) -> list[Patch]:
    """Pressed patches on grids of `cells` cells each way, or of a strip along the rail."""
    hertz = plan.estimate
    if isinstance(hertz, LineContact):
        return rolling_patches.strip(hertz.strip, cells)
    return rolling_patches.patches(
        plan.contact, hertz, hertzian=False, load=load, cells=cells, profiles=profiles
    )


def _sheared(plan: Plan, patches: Sequence[Patch], longer: float) -> list[TangentialSolution]:
    """Tractions of each patch at the creepages of a plan or under its forces, all patches together.
    longer: factor on the forces. Raises ValueError for forces on several patches of unlike bodies.
    """
    scene, pair = plan.scene, closed_forms.tangential_pair(plan.scene)
    coefficient, rolls = scene.friction.coefficient, scene.rolling.prescribed
    table = scene.rolling if rolls else scene.friction
    along, across = (
        None if force is None else longer * force
        for force in (table.force_along, table.force_across)
    )
    moves = interface.creepage(plan.context)

    def shear(bodies: Sequence[HalfSpaceFriction]) -> list[TangentialSolution]:
        """Tractions of some patches."""
        if along is None and across is None:
            return [body.solve(moves) for body in bodies]
        return solve_for_forces(bodies, moves, along=along, across=across)

    if interface.unlike(scene):
        if len(patches) > 1 and not (along is None and across is None):
            raise ValueError(SEVERAL)
        return [
            rolling.solve_dissimilar(
                each.pressed,
                pair,
                coefficient,
                lambda body: shear([body])[0],
                rolling=rolls,
                modes=each.modes,
            )
            for each in patches
        ]
    pressed = [each.pressed for each in patches]
    return shear(
        [
            HalfSpaceFriction(
                on.x, on.s, on.pressure, coefficient, pair, rolling=rolls, modes=each.modes
            )
            for on, each in zip(pressed, patches, strict=True)
        ]
    )


def _at_points(
    plan: Plan, patches: Sequence[Patch], sheared: Sequence[TangentialSolution], share: float
) -> FrictionSolution:
    """Tractions at the cells that touch, in the form of those of finite elements. share: factor on
    areas and forces.
    """
    parts = []
    for patch, each in zip(patches, sheared, strict=True):
        window = patch.pressed
        x, s = (axis.ravel() for axis in np.meshgrid(window.x, window.s, indexing="ij"))
        touches = each.bound.ravel() > 0
        angle = np.tile(window.angle, window.x.size)
        along = np.tile([1.0, 0.0, 0.0], (x.size, 1))
        across = np.column_stack([np.zeros_like(x), np.cos(angle), np.sin(angle)])
        rigid = np.tensordot(each.creepage.motion, each.modes, axes=1)
        vectors = (
            field[0].reshape(-1, 1) * along + field[1].reshape(-1, 1) * across
            for field in (each.traction, each.slip, rigid)
        )
        bound = each.bound.ravel()
        sticks = np.linalg.norm(each.traction, axis=0).ravel() < (1 - STUCK) * bound
        fields = (
            surface(plan, x, s),
            np.full(x.size, each.cell * share),
            bound / plan.scene.friction.coefficient,
            *vectors,
            sticks,
        )
        parts.append([field[touches] for field in fields])
    points, weights, pressure, traction, slip, rigid_slip, stuck = (
        np.concatenate(field) for field in zip(*parts, strict=True)
    )
    along, across, moment = share * np.sum([each.forces for each in sheared], axis=0)
    moved = sheared[0].creepage
    return FrictionSolution(
        points=points,
        weights=weights,
        pressure=pressure,
        traction=traction,
        slip=slip,
        sticks=stuck,
        rigid_motion=(moved.along, moved.across, moved.spin),
        force=(float(along), float(across)),
        moment=float(moment),
        friction_limit=share * sum(each.limit for each in sheared),
        load_steps=np.zeros((0, 4)),
        dissipated_energy=0.0,
        coupling_iterations=0,
        rigid_slip=rigid_slip,
        newton_steps=0,
    )


def surface(plan: Plan, x: Array, s: Array) -> Array:
    """Points (n, 3) on the surface at x, s (n,), mm."""
    if plan.contact.half_space:
        return np.column_stack([x, s, np.zeros_like(x)])
    return boundary_elements.develop(plan.contact).points(x, s)


def _fastsim(plan: Plan, patches: Sequence[Patch], found: FrictionSolution) -> dict[str, Any]:
    """Forces, stick share and T-gamma by FASTSIM at the motion of a solution; empty for a shift,
    lines and unlike bodies.
    """
    scene = plan.scene
    if not scene.rolling.prescribed or plan.contact.line or interface.unlike(scene):
        return {}
    pair = closed_forms.tangential_pair(scene)
    try:
        rolled = equal_ellipses.fastsim(patches, found.friction_limit, pair, found.rigid_motion)
    except ValueError as error:
        return {"reason": str(error)}
    return {**by_key(rolled.forces, rolled.stick_share), "t_gamma_N": rolled.t_gamma}

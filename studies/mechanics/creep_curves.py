"""Creep curves: finite elements beside boundary elements, FASTSIM and linear theory, by motion."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpi4py import MPI

from railhead.planning import plan as planning
from railhead.planning.plan import Plan
from railhead.planning.references import closed_forms
from railhead.run import build
from railhead.run import solid_friction as friction
from railhead.run.references import equal_ellipses, rolling_patches
from railhead.scene import catalogue
from railhead.solver.algebra.contact_system import LoadCase
from railhead.solver.fields import gather
from railhead.theory.elastic.hertz import Ellipse
from railhead.theory.friction.rolling import Creepage, HalfSpaceFriction

COEFFICIENT = 0.3
CELLS = 64  # each way, of the boundary elements
COARSE, COARSER = 4.0, 3.0  # elements a semi-axis of whole models, which lateral motion needs
ALONG = tuple(Creepage(xi) for xi in (1e-4, 2e-4, 4e-4, 7e-4, 1e-3, 1.4e-3, 2e-3, 3e-3, 5e-3, 1e-2))
ASIDE = (
    *(Creepage(0.0, xi) for xi in (2e-4, 5e-4, 1e-3, 2e-3, 3e-3, 6e-3)),
    *(Creepage(0.0, 0.0, spin) for spin in (5e-5, 1e-4, 2e-4, 4e-4, 8e-4)),
    Creepage(5e-4, 1e-3),
    Creepage(5e-4, -5e-4, 3e-4),
)
PROFILES = (
    *(Creepage(xi) for xi in (1e-4, 2e-4, 5e-4, 1e-3, 2e-3)),
    *(Creepage(0.0, xi) for xi in (1e-4, 2e-4, 5e-4, 1e-3, 2e-3)),
    *(Creepage(0.0, 0.0, spin) for spin in (2e-5, 5e-5, 1e-4, 2e-4, 4e-4)),
    Creepage(5e-4, 5e-4),
    Creepage(5e-4, -5e-4, 1e-4),
)


@dataclass(frozen=True)
class Curve:
    """Motions of one model; resolution: elements a semi-axis, None as planned; shift of
    the wheelset, mm."""

    name: str
    motions: Sequence[Creepage]
    resolution: float | None
    shift: float = 0.0

    @property
    def case(self) -> str:
        """What tables call it."""
        return f"{self.name}, {self.shift:g} mm" if self.shift else self.name


CURVES = (
    Curve("hertz_ellipse", ALONG, None),
    Curve("hertz_ellipse", ASIDE, COARSE),
    Curve("s1002_60e1", PROFILES, COARSER, 4.0),
)
QUICK = (Curve("hertz_ellipse", ALONG[2:5:2], COARSE),)


Point = dict[str, Any]
"""Forces over mu N of a case at a motion (along, across, spin), by a method (by); stick: share of
the patch."""
Cost = dict[str, Any]
"""Of a curve: unknowns, and processor seconds of assembly (gmsh is a process of its own), of
pressing without friction, of sampling what finite bodies add and, on the average, of a point with
its own pressing."""


def rolled(curve: Curve) -> tuple[list[Point], Cost]:
    """All methods at each motion."""
    plan = _plan(curve)
    clock = [time.process_time()]
    model = build.model(plan, build.generate(plan, plan.grading(), MPI.COMM_WORLD))
    settings = model.setup.friction
    assert settings is not None
    clock.append(time.process_time())
    touching = plan.forecast.touching(model.interface.points)
    case = LoadCase(load=plan.scene.load or 0.0, active=touching)
    pressed = model.press(case)
    clock.append(time.process_time())
    smooth = friction.shared_patches(
        model, gather(model, pressed), parabolic=plan.contact.half_space
    )
    solid = friction.SolidFriction(model, settings, pressed, smooth, lambda name: None)
    solid.sample()
    clock.append(time.process_time())
    points = []
    limit = COEFFICIENT * sum(each.force for each in smooth)
    for motion in curve.motions:
        solid.press_again(case, solid.tractions(motion))
        found = solid.tractions(motion)
        along, across, _ = np.sum([each.forces for each in found], axis=0) / limit
        sticks, touches = np.sum([each.areas for each in found], axis=0)
        points.append(_point(curve, motion, "railhead", along, across, float(sticks / touches)))
    spent = np.diff([*clock, time.process_time()])
    spent[3] /= len(curve.motions)
    cost = {
        "case": curve.case,
        "model": "half" if plan.half_y else "whole",
        "unknowns": model.unknowns,
        **dict(zip(("built", "pressed", "sampled", "point"), spent.tolist(), strict=True)),
    }
    return [*points, *_others(plan, curve)], cost


def _point(
    curve: Curve,
    motion: Creepage,
    by: str,
    along: float,
    across: float,
    stick: float | None,
) -> Point:
    return {
        "case": curve.case,
        "along": motion.along,
        "across": motion.across,
        "spin": motion.spin,
        "by": by,
        "force_along": along,
        "force_across": across,
        "stick": stick,
    }


def _plan(curve: Curve) -> Plan:
    across = any(each.across or each.spin for each in curve.motions)
    scene = catalogue.find(curve.name).replace(
        friction={"coefficient": COEFFICIENT},
        rolling={"creepage_along": 1e-3, "creepage_across": 1e-3 if across else None},
        effects={"plasticity": "off"},
        wheelset={"shift": curve.shift},
    )
    plan = planning.make(scene)
    return plan if curve.resolution is None else plan.at_resolution(curve.resolution)


def _others(plan: Plan, curve: Curve) -> Iterator[Point]:
    scene, ellipse = plan.scene, plan.estimate
    assert isinstance(ellipse, Ellipse) and scene.load is not None
    pair = closed_forms.tangential_pair(scene)
    hertzian = plan.forecast.hertzian
    patches = rolling_patches.patches(
        plan.contact, ellipse, hertzian=hertzian, load=scene.load, cells=CELLS
    )
    bodies = [
        HalfSpaceFriction(
            p.pressed.x,
            p.pressed.s,
            p.pressed.pressure,
            COEFFICIENT,
            pair,
            rolling=True,
            modes=p.modes,
        )
        for p in patches
    ]
    limit = COEFFICIENT * sum(each.pressed.force for each in patches)
    for motion in curve.motions:
        given = motion.along, motion.across, motion.spin
        sheared = [body.solve(motion) for body in bodies]
        exactly = np.sum([each.forces for each in sheared], axis=0)
        sticks, touches = np.sum([each.areas for each in sheared], axis=0)
        quick, stick, _ = equal_ellipses.fastsim(patches, limit, pair, given)
        straight = equal_ellipses.linear(patches, pair, given)
        for by, forces, sticking in (
            ("boundary elements", exactly, float(sticks / touches)),
            ("FASTSIM", quick, stick),
            ("linear theory", straight, None),
        ):
            along, across, _ = forces / limit
            yield _point(curve, motion, by, along, across, sticking)

"""Runs with friction: creep curves of finite elements beside boundary elements, FASTSIM and linear
theory; what leaving friction out changes; the largest stresses under full sliding;
creep curves over speed under a coefficient of friction that falls with slip."""

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpi4py import MPI

import railhead as rh
from railhead.half_spaces import shearing
from railhead.planning import simulation_plan as planning
from railhead.run import mesh_solution, solid_friction
from railhead.scene import catalogue
from railhead.solver.system.contact_system import LoadCase
from railhead.solver.system.fields import gather
from railhead.theory.elastic.hertz import Ellipse
from railhead.theory.elastic.line import Hertz
from railhead.theory.friction import sliding
from railhead.theory.friction.rolling import Creepage, TangentialSolution
from studies.mechanics import fastsim
from studies.tables import Row

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
class CreepCurve:
    """Motions for which one shipped scene is solved.

    name: name of the scene.
    motions: creepages and spins (1/mm).
    resolution: elements per smaller semi-axis; None: as planned.
    shift: lateral shift of the wheelset, mm.
    """

    name: str
    motions: Sequence[Creepage]
    resolution: float | None
    shift: float = 0.0

    @property
    def case(self) -> str:
        """Name of the scene in tables, with the shift if there is one."""
        return f"{self.name}, {self.shift:g} mm" if self.shift else self.name


CURVES = (
    CreepCurve("hertz_ellipse", ALONG, None),
    CreepCurve("hertz_ellipse", ASIDE, COARSE),
    CreepCurve("s1002_60e1", PROFILES, COARSER, 4.0),
)
QUICK = (CreepCurve("hertz_ellipse", ALONG[2:5:2], COARSE),)


Point = dict[str, Any]
"""Forces over mu N of a case at a motion (along, across, spin), by a method (by); stick: share of
the patch that sticks, None by linear theory."""
Cost = dict[str, Any]
"""Cost of a curve: unknowns, and processor seconds of assembly (without gmsh, a process of its
own), of pressing without friction, of sampling what finite bodies add and, on the average, of a
point with its own pressing."""


@dataclass(frozen=True)
class Sampled:
    """Friction of solids, ready for any motion.

    friction: friction of the solids, sampled.
    case: load case under which they are pressed.
    force: normal force of all patches, N.
    unknowns: number of unknowns of the model.
    clock: processor seconds at the start, and after assembly, pressing and sampling.
    """

    friction: solid_friction.SolidFriction
    case: LoadCase
    force: float
    unknowns: int
    clock: tuple[float, ...]


def sampled(plan: planning.Plan) -> Sampled:
    """Friction of the solids of a plan, pressed on its mesh."""
    start = time.process_time()
    model = mesh_solution.assemble(plan, mesh_solution.generate(plan, plan.grading, MPI.COMM_WORLD))
    built = time.process_time()
    case = LoadCase(
        load=plan.scene.load or 0.0, active=plan.forecast.touching(model.interface.points)
    )
    solution = model.press(case)
    pressed = time.process_time()
    smooth = solid_friction.shared_patches(
        model, gather(model, solution), parabolic=plan.contact.half_space
    )
    friction = solid_friction.SolidFriction(model, solution, smooth, lambda name: None)
    friction.sample()
    clock = start, built, pressed, time.process_time()
    return Sampled(friction, case, sum(each.force for each in smooth), model.unknowns, clock)


def rolled(curve: CreepCurve) -> tuple[list[Point], Cost]:
    """Forces by all methods at each motion of a curve, and the cost of the curve."""
    plan = _plan(curve)
    solid = sampled(plan)
    points, limit = [], COEFFICIENT * solid.force
    for motion in curve.motions:
        solid.friction.press_again(solid.case, solid.friction.tractions(motion))
        found = solid.friction.tractions(motion)
        along, across, _ = np.sum([each.forces for each in found], axis=0) / limit
        sticks, touches = np.sum([each.areas for each in found], axis=0)
        points.append(_point(curve, motion, "railhead", along, across, float(sticks / touches)))
    spent = np.diff([*solid.clock, time.process_time()])
    spent[3] /= len(curve.motions)
    cost = {
        "case": curve.case,
        "model": "half" if plan.half_y else "whole",
        "unknowns": solid.unknowns,
        **dict(zip(("built", "pressed", "sampled", "point"), spent.tolist(), strict=True)),
    }
    return [*points, *_others(plan, curve)], cost


def _point(
    curve: CreepCurve,
    motion: Creepage,
    by: str,
    along: float,
    across: float,
    stick: float | None,
) -> Point:
    """Point of a curve; along and across: forces over mu N."""
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


def _plan(curve: CreepCurve) -> planning.Plan:
    """Elastic plan of a curve's scene, of a whole model where a motion is lateral or spins."""
    across = any(each.across or each.spin for each in curve.motions)
    scene = catalogue.find(curve.name).replace(
        friction={"coefficient": COEFFICIENT},
        rolling={"creepage_along": 1e-3, "creepage_across": 1e-3 if across else None},
        effects={"plasticity": "off"},
        wheelset={"shift": curve.shift},
    )
    plan = planning.make(scene)
    return plan if curve.resolution is None else plan.at_resolution(curve.resolution)


def _others(plan: planning.Plan, curve: CreepCurve) -> Iterator[Point]:
    """Points by boundary elements, FASTSIM and linear theory, at each motion of a curve."""
    scene, ellipse = plan.scene, plan.hertz
    assert isinstance(ellipse, Ellipse) and scene.load is not None
    half_spaces = plan.context.half_spaces
    patches = shearing.patches(half_spaces, half_spaces.pressure(scene.load), CELLS)
    limit = sum(each.limit for each in patches)
    for motion in curve.motions:
        given = motion.along, motion.across, motion.spin
        sheared = shearing.shear(half_spaces, patches, shearing.Motion(creepage=motion))
        sticks, touches = np.sum([each.areas for each in sheared.found], axis=0)
        quick, stuck = fastsim.of_patches(patches, limit, half_spaces, given)
        straight = fastsim.linear(patches, half_spaces, given)
        for by, forces, sticking in (
            ("boundary elements", sheared.forces, sticks / touches),
            ("FASTSIM", quick, stuck),
            ("linear theory", straight, None),
        ):
            along, across, _ = forces / limit
            yield _point(curve, motion, by, along, across, sticking)


POISSON = 0.3
SLIDES = 0.5  # creepage under which all slips
FOUR: dict[str, Any] = {"mesh": {"patch_size": 0.87}}  # four elements a semi-axis
HALF_SPACE: dict[str, Any] = {"rail": {"extent": "half-space", "width": 70.0}}
RIGID: dict[str, Any] = {"young_modulus": math.inf}
SCENES: tuple[tuple[str, dict[str, Any], float], ...] = (
    ("long_roller", {}, 4e-4),
    ("long_roller", {}, 1.5e-3),
    ("long_roller", {}, 1e-2),
    ("hertz_ellipse", FOUR, 1e-3),
    ("hertz_ellipse", FOUR, 1e-2),
    ("hertz_ellipse", {**FOUR, "wheel": RIGID}, 1e-3),
)
STRIP, SLIDING = (0.1, 0.2, 0.3, 0.4, 0.5), (0.1, 0.3, 0.5)  # coefficients of sections and solids
EXACT = tuple(float(mu) for mu in np.linspace(0, 0.6, 13))


JUDGED = {
    "pressure": ("pressure", "max_MPa"),
    "area": ("patch", "area_mm2"),
    "tau": ("stress", "tau_max_MPa"),
    "von_mises": ("stress", "von_mises_max_MPa"),
    "depth": ("stress", "von_mises_max_depth_mm"),
}
"""Columns with friction and (plain_*) without, and where a summary has them."""


Slid = dict[str, Any]
"""The largest von Mises stress over Hertz's p0, and its depth over the smaller half length, of a
case at a coefficient of friction, by finite elements or the exact field."""


def left_out(name: str, changes: dict[str, Any], creepage: float) -> dict[str, Any]:
    """What leaving friction out changes: the columns of JUDGED with and without friction, both from
    one run; force: over mu N. changes: changed keys of the scene."""
    found = rh.solve(_rolling(name, COEFFICIENT, creepage).replace(**changes), quiet=True).as_dict()
    forces = found["result"]["friction"]
    row = {
        "case": f"{name}, rigid wheel" if "wheel" in changes else name,
        "creepage": creepage,
        "force": forces["force_along_N"] / forces["limit_N"],
    }
    for column, (table, key) in JUDGED.items():
        row[f"plain_{column}"] = found["frictionless"][table][key]
        row[column] = found["result"][table][key]
    return row


def slid(name: str, coefficients: Sequence[float], given: dict[str, Any]) -> Iterator[Slid]:
    """Rows of finite elements in full sliding at each coefficient, then of the exact field under
    Hertz's pressure at those of EXACT. given: changed keys of the scene.
    """

    def row(mu: float, by: str, ellipse: Hertz, von_mises: float, depth: float) -> Slid:
        return {
            "case": name,
            "coefficient": mu,
            "by": by,
            "von_mises": von_mises / ellipse.p0,
            "depth": depth / min(ellipse.half_lengths),
        }

    for mu in coefficients:
        result = rh.solve(_rolling(name, mu, SLIDES).replace(**given), quiet=True)
        stress = result.as_dict()["result"]["stress"]
        yield row(
            mu,
            "railhead",
            result.ellipse,
            stress["von_mises_max_MPa"],
            stress["von_mises_max_depth_mm"],
        )
    for mu in EXACT:
        for by, place in sliding.peaks(result.ellipse, mu, POISSON).items():
            yield row(mu, by, result.ellipse, place.von_mises, place.depth)


def crossover(slid: Sequence[Slid]) -> float:
    """Coefficient of friction above which the exact largest von Mises stress lies at the surface,
    interpolated; the first or last coefficient where there is no change between them."""
    below, surface = ([s for s in slid if s["by"] == by] for by in ("below", "surface"))
    ahead = [t["von_mises"] - s["von_mises"] for s, t in zip(below, surface, strict=True)]
    return float(np.interp(0.0, ahead, [s["coefficient"] for s in below]))


def _rolling(name: str, friction: float, creepage: float) -> rh.Scene:
    """A shipped scene that rolls with a coefficient of friction and a creepage along the rail."""
    return rh.find(name).replace(
        friction={"coefficient": friction}, rolling={"creepage_along": creepage}
    )


# A coefficient that falls with slip, over speed.

LAW: dict[str, Any] = {
    "coefficient": 0.33,
    "law": "exponential",
    "kinetic": 0.14,
    "slip_half": 1250.0,
    "memory": 0.5,
}
SPEEDS = (5.0, 10.0, 30.0)  # m/s
SPEED_CREEPAGES = (5e-4, 1e-3, 2e-3, 3e-3, 5e-3, 1e-2, 3e-2, 1e-1)
MESHED = (1e-3, 3e-3, 1e-2, 1e-1)  # creepages of finite elements, at the middle speed
SPEED_CELLS = 32  # each way, of the boundary elements


def _falling_plan(speed: float) -> planning.Plan:
    """Elastic plan of the thesis's ellipse that rolls with the law at a speed, m/s."""
    scene = catalogue.find("hertz_ellipse").replace(
        friction=LAW,
        rolling={"creepage_along": 1e-3, "speed": speed},
        effects={"plasticity": "off"},
    )
    return planning.make(scene)


def _falling_row(speed: float, creepage: float, by: str, found: TangentialSolution) -> Row:
    """Row of a creepage: force over the static mu N, and least coefficient."""
    inside = found.pressure > 0
    normal = found.pressure.sum() * found.cell
    return {
        "speed": speed,
        "creepage": creepage,
        "by": by,
        "force": found.forces[0] / (LAW["coefficient"] * normal),
        "least": float((found.bound[inside] / found.pressure[inside]).min()),
    }


def half_spaces(speed: float, creepages: tuple[float, ...]) -> list[Row]:
    """Rows of half-spaces, upwards and then downwards, each from the one before."""
    of = _falling_plan(speed)
    assert of.scene.load is not None
    patches = shearing.patches(of.context.half_spaces, of.hertz, SPEED_CELLS)
    found: Sequence[TangentialSolution] | None = None
    rows = []
    for way, values in (("upwards", creepages), ("downwards", creepages[::-1])):
        for value in values:
            motion = shearing.Motion(creepage=Creepage(value))
            found = shearing.shear(of.context.half_spaces, patches, motion, found).found
            rows.append(_falling_row(speed, value, way, found[0]))
    return rows


def solids(speed: float, creepages: tuple[float, ...]) -> list[Row]:
    """Rows of finite elements, under the pressure without friction."""
    friction = sampled(_falling_plan(speed)).friction
    return [
        _falling_row(speed, v, "railhead", friction.tractions(Creepage(v))[0]) for v in creepages
    ]


def falling(*, quick: bool) -> list[Row]:
    """Rows of all speeds; quick: two creepages of half-spaces at one speed."""
    if quick:
        return half_spaces(SPEEDS[1], SPEED_CREEPAGES[2:7:4])
    found = [each for speed in SPEEDS for each in half_spaces(speed, SPEED_CREEPAGES)]
    return found + solids(SPEEDS[1], MESHED)


def speed_table(found: Sequence[Row]) -> tuple[list[str], list[list[str]], float]:
    """Head and rows of a table, forces by creepage, speed and method; and the largest difference
    of forces between both ways."""
    forces = {(each["by"], each["speed"], each["creepage"]): each["force"] for each in found}
    columns = sorted({(by, speed) for by, speed, _ in forces if by != "downwards"})
    apart = max(
        abs(forces["downwards", speed, creepage] - force)
        for (by, speed, creepage), force in forces.items()
        if by == "upwards"
    )
    head = [
        f"{'finite elements, ' if by == 'railhead' else ''}{speed:g} m/s" for by, speed in columns
    ]
    text = {key: f"{force:.4f}" for key, force in forces.items()}
    lines = [
        [f"{creepage:g}", *(text.get((*each, creepage), "") for each in columns)]
        for creepage in sorted({each["creepage"] for each in found})
    ]
    return ["creepage", *head], lines, apart

"""The list of hard cases; the study runs all of it, the tests what is marked quick."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from scipy.spatial.transform import Rotation

from railhead.solver.interface.laws import ContactLaw
from studies.hard import contacts, ranks
from studies.hard.awkward import iterations, meshes, places, positions, stalled, thin
from studies.hard.case import Case, Measured
from studies.hard.contacts import near, random
from studies.hard.maps import LAWS, factor_cases, material_cases
from studies.hard.random_cases import plan_cases, run_cases
from studies.hard.rubbing import rubbing
from studies.hard.scenes import (
    ELLIPSE,
    HEAD,
    against_finer,
    against_half_space,
    against_hertz,
    outgrown,
)
from studies.hard.worn import worn
from studies.hard.yielding import yielding

BOUNDARY, HERTZ, FINER, SAME = "boundary elements", "exact Hertz", "own finer mesh", "invariance"


def loads() -> Iterator[Case]:
    """From a newton to meganewtons."""
    for load in (1.0, 1e3, 2e5):
        yield Case(
            "load", f"{load:g} N on 54E1", "patches from 0.15 mm to 9 mm", BOUNDARY,
            against_half_space(HEAD.replace([f"load={load!r}"])), quick=load == 1,
        )  # fmt: skip
    yield Case(
        "load", "2 MN on 54E1", "the patch runs across R300, R80 and R13", FINER,
        against_finer(HEAD.replace(["load=2e6"]), 4.0, 7.0), seconds=300,
    )  # fmt: skip
    for heavy, meshed, why in (
        ("1", "25e3", "patch far smaller than the first mesh's elements"),
        ("2e6", "1e3", "patch far larger than what was meshed finely"),
    ):
        small = heavy == "1"  # a larger patch runs across the gauge corner: no half-space
        yield Case(
            "load", f"{heavy} N on a mesh for {meshed} N", why, BOUNDARY if small else FINER,
            outgrown(HEAD.replace([f"load={heavy}"]), HEAD.replace([f"load={meshed}"]),
                     fine=0.0 if small else 7.0),
            seconds=300, quick=small,
        )  # fmt: skip
    yield Case(
        "load", "up and down on one mesh", "300 N to 12 kN and back: no memory of the path", SAME,
        partial(contacts.path, [300.0, 1e3, 3e3, 6e3, 12e3, 3e3, 300.0]), quick=True,
    )  # fmt: skip
    yield Case(
        "load", "off and on again", "3 kN, 1 mN, 3 kN", SAME,
        partial(contacts.path, [3e3, 1e-3, 3e3]), newton=15, quick=True,
    )  # fmt: skip


def starts() -> Iterator[Case]:
    """Newton's method from the wrong place."""
    nothing, everything = random(0.0), random(1.0)
    for name, start, distance in (
        ("nothing touches", nothing, 0.0),
        ("everything touches", everything, 0.0),
        ("random half touches", random(0.5), 0.0),
        ("gap of 1 mm, free wheel", nothing, 1.0),
        ("overlap of 1 mm", everything, -1.0),
        ("gap of 100 mm, free wheel", near(), 100.0),
    ):
        yield Case(
            "start", name, "wrong active set or position; only contact holds the wheel", SAME,
            partial(contacts.start_from, start, distance), newton=15, quick=True,
        )  # fmt: skip
    for name, law in (("theta 0", ContactLaw(theta=0)), ("theta -1", ContactLaw(theta=-1)),
                      ("penalty", ContactLaw("penalty"))):  # fmt: skip
        yield Case(
            "start", f"random half touches, {name}", "wrong active set, other laws", SAME,
            partial(contacts.start_from, random(0.5), law=law), newton=30,
        )  # fmt: skip


def shapes() -> Iterator[Case]:
    """Needles, lines, conformal pairs."""
    for crown, ratio in ((420, 1), (60, 4), (12, 10), (1.5, 33), (0.75, 50)):
        yield Case(
            "shape", f"axis ratio {ratio}", "a needle of a patch", HERTZ,
            against_hertz(ELLIPSE.replace([f"rail.crown_radius={crown}"])), quick=ratio == 4,
        )  # fmt: skip
    widths = [float(b) for b in np.linspace(0.8, 1.0, 6)]
    for cell, h, limit, why in (
        ("tetrahedron", 0.2, 0.01, "no curvature along"),
        ("hexahedron", 0.1, 0.02, "the edge passes along rows of elements"),
    ):
        yield Case(
            "shape", f"line contact, {cell}", why, "line Hertz",
            partial(contacts.line_contact, cell, h, widths, limit), quick=True,
        )  # fmt: skip
    arcs = HEAD.replace(["rail.profile=arc", "rail.crown_radius=300", "wheel.profile=arc",
                         "wheel.transverse_radius=-330"])  # fmt: skip
    for radius in (330, 320, 310, 305, 301):
        edge = radius == 301
        yield Case(
            "shape", f"conformal R300 in R{radius}",
            "the patch is as wide as the rail: edges" if edge else "nearly the same radii across",
            FINER,
            against_finer(arcs.replace([f"wheel.transverse_radius=-{radius}"])),
            known="edge_distance" if edge else "", seconds=300,
        )  # fmt: skip


def stiffness() -> Iterator[Case]:
    """Stiffness ratios and incompressible bodies."""
    for power in (-4, -2, 2, 4):
        yield Case(
            "stiffness", f"E ratio 1e{power}", "towards a rigid body", HERTZ,
            against_hertz(ELLIPSE.replace([f"rail.young_modulus={207e3 * 10.0**power}"])),
            quick=abs(power) == 4,
        )  # fmt: skip
    for body in ("rail", "wheel"):
        yield Case(
            "stiffness", f"rigid {body}", "only its surface takes part", HERTZ,
            against_hertz(ELLIPSE.replace([f"{body}.young_modulus=inf"])), quick=body == "wheel",
        )  # fmt: skip
    for ratio in (0.0, 0.45, 0.49, 0.499, 0.4999):
        keys = [f"{body}.poisson_ratio={ratio}" for body in ("rail", "wheel")]
        yield Case(
            "stiffness", f"nu {ratio}", "volumetric locking", HERTZ,
            against_hertz(ELLIPSE.replace(keys)), quick=ratio == 0.49,
        )  # fmt: skip
    yield Case(
        "stiffness", "nu 0.49, linear cells", "linear tetrahedra lock", HERTZ,
        against_hertz(ELLIPSE.replace(["rail.poisson_ratio=0.49", "wheel.poisson_ratio=0.49",
                                       "mesh.order=1"]), 8.0), known="second_opinion_max_MPa",
    )  # fmt: skip


def invariances() -> Iterator[Case]:
    """The same scene said otherwise."""
    turn = Rotation.from_euler("xyz", [0.5, -0.8, 1.1]).as_matrix()
    for name, arguments in (
        ("rotated", (turn,)),
        ("mirrored", (np.diag([1.0, 1.0, -1.0]),)),
        ("in m and Pa", (np.eye(3), 1e-3, 1e6)),
        ("in GPa", (np.eye(3), 1.0, 1e-3)),
        ("a thousand times larger", (np.eye(3), 1e3, 1.0)),
    ):
        yield Case(
            "invariance", name, "the numbers must not depend on the frame or the units", SAME,
            partial(contacts.transformed, *arguments), quick=True,
        )  # fmt: skip
    for count in (2, 3):
        yield Case(
            "invariance", f"{count} ranks", "distributed as on one rank", SAME,
            partial(ranks.against_one, count), seconds=300,
        )  # fmt: skip


PARTS = (
    loads, starts, shapes, stiffness, yielding, rubbing, meshes, stalled, thin, places, positions,
    worn, invariances, iterations, factor_cases, material_cases, plan_cases, run_cases,
)  # fmt: skip
CASES: dict[str, Case] = {case.key: case for part in PARTS for case in part()}
QUICK = [case for case in CASES.values() if case.quick]
__all__ = ["CASES", "LAWS", "QUICK"]


def solve(key: str) -> Measured:
    """Solve one case, in a process that knows its key only."""
    return CASES[key].solve()

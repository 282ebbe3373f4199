"""The list of hard cases; the study runs all of it, the tests what is marked quick."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from scipy.spatial.transform import Rotation

from cases.hard import contacts, ranks
from cases.hard.case import Case
from cases.hard.contacts import EXACTLY, near, random
from cases.hard.maps import LAWS, factor_cases, material_cases
from cases.hard.random_cases import plan_cases, run_cases
from cases.hard.scenes import (
    ELLIPSE,
    HEAD,
    PATCH,
    against_finer,
    against_hertz,
    krylov_growth,
    outgrown,
    resolved,
)
from solver.laws import Law

HERTZ, FINER, SAME = "exact Hertz", "own finer mesh", "invariance"


def loads() -> Iterator[Case]:
    """From a newton to meganewtons."""
    for load in (1.0, 1e3, 2e5):
        yield Case(
            "load", f"{load:g} N on 54E1", "patches from 0.15 mm to 9 mm", HERTZ, 0.01,
            against_hertz(HEAD.replace([f"load={load!r}"]), 4.0, PATCH), quick=load == 1,
        )  # fmt: skip
    yield Case(
        "load", "2 MN on 54E1", "the patch runs across R300, R80 and R13", FINER, 0.02,
        against_finer(HEAD.replace(["load=2e6"]), 4.0, 8.0), seconds=120,
    )  # fmt: skip
    yield Case(
        "load", "1 N on a mesh for 25 kN", "patch far smaller than the first mesh's elements",
        HERTZ, 0.01, outgrown(HEAD.replace(["load=1"]), HEAD), quick=True,
    )  # fmt: skip
    yield Case(
        "load", "2 MN on a mesh for 1 kN", "patch far larger than what was meshed finely",
        FINER, 0.02, outgrown(HEAD.replace(["load=2e6"]), HEAD.replace(["load=1e3"]), fine=8.0),
        seconds=120,
    )  # fmt: skip
    yield Case(
        "load", "up and down on one mesh", "300 N to 12 kN and back: no memory of the path", SAME,
        EXACTLY, partial(contacts.path, [300.0, 1e3, 3e3, 6e3, 12e3, 3e3, 300.0]), quick=True,
    )  # fmt: skip
    yield Case(
        "load", "off and on again", "3 kN, 1 mN, 3 kN", SAME, EXACTLY,
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
            EXACTLY, partial(contacts.start_from, start, distance), newton=15, quick=True,
        )  # fmt: skip
    for name, law in (("theta 0", Law(theta=0)), ("theta -1", Law(theta=-1)),
                      ("penalty", Law("penalty"))):  # fmt: skip
        yield Case(
            "start", f"random half touches, {name}", "wrong active set, other laws", SAME, EXACTLY,
            partial(contacts.start_from, random(0.5), law=law), newton=30,
        )  # fmt: skip


def shapes() -> Iterator[Case]:
    """Needles, lines, conformal pairs."""
    for crown, ratio, n in ((420, 1, 4), (60, 4, 4), (12, 10, 3), (1.5, 33, 3), (0.75, 50, 2.5)):
        yield Case(
            "shape", f"axis ratio {ratio}", "a needle of a patch", HERTZ, 0.01,
            against_hertz(ELLIPSE.replace([f"rail.crown_radius={crown}"]), n), quick=ratio == 4,
            seconds=120,
        )  # fmt: skip
    widths = [float(b) for b in np.linspace(0.8, 1.0, 6)]
    yield Case(
        "shape", "line contact, tetrahedra", "no curvature along", "line Hertz", 0.01,
        partial(contacts.line_contact, "tetrahedron", 0.2, widths), quick=True,
    )  # fmt: skip
    yield Case(
        "shape", "line contact, hexahedra", "the edge passes along rows of elements", "line Hertz",
        0.02, partial(contacts.line_contact, "hexahedron", 0.1, widths), quick=True,
    )  # fmt: skip
    for radius in (330, 320, 310, 305):
        scene = HEAD.replace(
            ["rail.profile=arc", "rail.crown_radius=300", "wheel.profile=arc",
             f"wheel.transverse_radius=-{radius}"]
        )  # fmt: skip
        yield Case(
            "shape", f"conformal R300 in R{radius}", "nearly the same radii across", FINER, 0.02,
            against_finer(scene), seconds=240,
        )  # fmt: skip

    yield Case(
        "shape", "conformal R300 in R301", "the patch is as wide as the rail: edges", FINER, 0.02,
        against_finer(HEAD.replace(["rail.profile=arc", "rail.crown_radius=300",
                                    "wheel.profile=arc", "wheel.transverse_radius=-301"]),
                      names=("area_mm2", "max_MPa", "approach_mm")), seconds=240,
    )  # fmt: skip


def stiffness() -> Iterator[Case]:
    """Stiffness ratios and incompressible bodies."""
    for power in (-4, -2, 2, 4):
        yield Case(
            "stiffness", f"E ratio 1e{power}", "towards a rigid body", HERTZ, 0.01,
            against_hertz(ELLIPSE.replace([f"rail.young_modulus={207e3 * 10.0**power}"])),
            quick=abs(power) == 4,
        )  # fmt: skip
    for body in ("rail", "wheel"):
        yield Case(
            "stiffness", f"rigid {body}", "only its surface takes part", HERTZ, 0.01,
            against_hertz(ELLIPSE.replace([f"{body}.young_modulus=inf"])), quick=body == "wheel",
        )  # fmt: skip
    for ratio in (0.0, 0.45, 0.49, 0.499, 0.4999):
        keys = [f"{body}.poisson_ratio={ratio}" for body in ("rail", "wheel")]
        yield Case(
            "stiffness", f"nu {ratio}", "volumetric locking", HERTZ, 0.01,
            against_hertz(ELLIPSE.replace(keys)), quick=ratio == 0.49,
        )  # fmt: skip
    yield Case(
        "stiffness", "nu 0.49, linear cells", "linear tetrahedra lock", HERTZ, 0.05,
        against_hertz(ELLIPSE.replace(["rail.poisson_ratio=0.49",
                                       "wheel.poisson_ratio=0.49", "mesh.order=1"]), 8.0),
        known="linear tetrahedra lock in volume; the default is quadratic",
    )  # fmt: skip


def meshes() -> Iterator[Case]:
    """Coarse, mismatched and poor meshes."""
    yield Case(
        "mesh", "2 elements across the patch", "the coarsest mesh that sees it", HERTZ, 0.05,
        against_hertz(ELLIPSE, 1.0, ("max_MPa", "approach_mm")), quick=True,
    )  # fmt: skip
    yield Case(
        "mesh", "slave ten times finer", "element sizes of the two bodies", "matched mesh", 0.02,
        partial(contacts.against_matched, 0.2, 10.0), seconds=120,
    )  # fmt: skip
    yield Case(
        "mesh", "master ten times finer", "element sizes of the two bodies", "matched mesh", 0.05,
        partial(contacts.against_matched, 2.0, 0.1), seconds=120,
        known="the contact points of a coarse slave are too few for a master ten times finer; "
        "scenes mesh both bodies alike",
    )  # fmt: skip
    yield Case(
        "mesh", "slivers", "scaled Jacobian 0.02 at the contact face", "regular mesh", 0.02,
        partial(contacts.slivers, 0.02, 10), quick=True,
    )  # fmt: skip


def places() -> Iterator[Case]:
    """Awkward places of the contact."""
    corner = ["wheel.profile=arc", "wheel.transverse_radius=-80"]
    for shift in (10, 25):
        yield Case(
            "place", f"gauge corner, shift {shift} mm", "contact on R13 at 0.5 and 0.8 rad", FINER,
            0.02, against_finer(HEAD.replace([*corner, f"wheelset.shift={shift}"]), names=PATCH),
            seconds=240,
        )  # fmt: skip
    yield Case(
        "place", "wheel 20 mm wide, 500 kN", "patch ends at the edge: singular pressure", FINER,
        0.05, against_finer(HEAD.replace(["wheel.width=20", "load=5e5",
                                          "wheel.segment_length=120"])), seconds=120,
        known="the pressure at the edge grows with refinement without end",
    )  # fmt: skip
    yield Case(
        "place", "S1002 shift 5 mm, 1:40", "contact on the gauge face at 1.2 rad", FINER, 0.02,
        against_finer(HEAD.replace(["wheel.profile=S1002", "wheelset.shift=5",
                                    "rail.inclination=1:40"]), names=PATCH),
        known="two contacts, one of them at the gauge face: the iterations crawl",
    )  # fmt: skip
    yield Case(
        "place", "two patches", "bumps 12 mm apart, one 1 um lower", FINER, 0.02,
        partial(contacts.two_patches, 0.001, 2.0, 1.4), newton=15, seconds=120, quick=True,
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
            EXACTLY, partial(contacts.transformed, *arguments), quick=True,
        )  # fmt: skip
    for count in (2, 3):
        yield Case(
            "invariance", f"{count} ranks", "distributed as on one rank", SAME, 1e-6,
            partial(ranks.against_one, count), seconds=240,
        )  # fmt: skip


def iterations() -> Iterator[Case]:
    """Growth of the Krylov iterations."""
    yield Case(
        "Krylov", "four refinements", "patch elements from b/3 to b/10, multigrid", "first mesh",
        0.3, krylov_growth(lambda: [
            resolved(ELLIPSE.replace(["solver.linear=multigrid"]), n) for n in (3, 4, 5.5, 7.5, 10)
        ], ordered=True), seconds=240,
    )  # fmt: skip
    yield Case(
        "Krylov", "E ratios 1 to 1e4", "both ways, multigrid", "ratio 1", 0.5,
        krylov_growth(lambda: [
            resolved(ELLIPSE.replace(["solver.linear=multigrid",
                                      f"rail.young_modulus={207e3 * ratio}"]), 4.0)
            for ratio in (1.0, 1e-4, 1e-2, 1e2, 1e4)
        ], ordered=False), seconds=120, quick=True,
    )  # fmt: skip


PARTS = (
    loads, starts, shapes, stiffness, meshes, places, invariances, iterations, factor_cases,
    material_cases, plan_cases, run_cases,
)  # fmt: skip
CASES: dict[str, Case] = {case.key: case for part in PARTS for case in part()}
QUICK = [case for case in CASES.values() if case.quick and case.ruled]
__all__ = ["CASES", "LAWS", "QUICK"]

"""Poor meshes, stalled solvers, thin bodies, awkward places."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from railhead.scene import catalogue
from railhead.scene.scene import Scene
from studies.hard import contacts
from studies.hard.case import KRYLOV, Case
from studies.hard.maps import EITHER
from studies.hard.scenes import (
    ELLIPSE,
    HEAD,
    LIMIT,
    against_finer,
    against_half_space,
    against_hertz,
    positioned,
)

COARSE = "elements_across"
SINGLE, SEVERAL = 0.015, 0.03  # of the largest pressure against boundary elements, as asked for
BLOCK = Scene.from_mapping(
    {"name": "block", "load": 25e3, "rail": {"profile": "arc", "crown_radius": 300}}
)


def meshes() -> Iterator[Case]:
    """Coarse, mismatched and poor meshes."""
    sphere = catalogue.find("sphere_on_plane")
    for name, scene in (
        ("2 elements across the patch", None),
        ("patch_size 5 mm", ELLIPSE.replace(["mesh.patch_size=5"])),
        ("patch_size 1 km", ELLIPSE.replace(["mesh.patch_size=1e6"])),
        ("sphere, patch_size 1 mm", sphere.replace(["mesh.patch_size=1"])),
        ("sphere, patch_size 1 km", sphere.replace(["mesh.patch_size=1e6"])),
    ):
        yield Case(
            "mesh", name, "too coarse to see the patch", "exact Hertz",
            against_hertz(scene, None) if scene else against_hertz(ELLIPSE, 1.0),
            known=COARSE, quick=True,
        )  # fmt: skip
    yield Case(
        "mesh", "slave ten times finer", "element sizes of the two bodies", "matched mesh",
        partial(contacts.against_matched, 0.2, 10.0, 0.02), seconds=240,
    )  # fmt: skip
    yield Case(
        "mesh", "master ten times finer", "element sizes of the two bodies", "matched mesh",
        partial(contacts.against_matched, 2.0, 0.1, 0.05), seconds=240,
    )  # fmt: skip
    yield Case(
        "mesh", "slivers", "scaled Jacobian 0.02 at the contact face", "regular mesh",
        partial(contacts.slivers, 0.02, 10, 0.02), quick=True,
    )  # fmt: skip


def stalled() -> Iterator[Case]:
    """Scenes on which iterative solves stall and a factorisation takes over."""
    soft = [f"{body}.poisson_ratio=0.4999" for body in ("rail", "wheel")]
    multigrid, far = "solver.linear=multigrid", "solver.gamma_factor=1e4"
    for name, keys, known, limit in (
        ("gamma_factor 1e4", [far], "pressure_noise", LIMIT),
        ("gamma_factor 1e4, multigrid", [far, multigrid], "pressure_noise", LIMIT),
        ("nu 0.4999, multigrid", [*soft, multigrid], "", LIMIT),
        ("nu 0.4999, multigrid, penalty", [*soft, multigrid, "solver.method=penalty"], "", EITHER),
    ):
        yield Case(
            "stalled solve", name, "Krylov iterations stall", "exact Hertz",
            against_hertz(ELLIPSE.replace(keys), limit=limit), newton=30, seconds=240, known=known,
            quick=name == "gamma_factor 1e4",
        )  # fmt: skip


def thin() -> Iterator[Case]:
    """Bodies no thicker than the patch is long: no half-spaces."""
    for name, keys in (
        ("rail 5 mm deep", ["rail.depth=5"]),
        ("rail 20 mm deep", ["rail.depth=20"]),
        ("rim 3 mm deep", ["wheel.rim_depth=3"]),
        ("rail 12 mm wide", ["rail.width=12"]),
        ("wheel 12 mm wide", ["wheel.width=12", "wheel.segment_length=100"]),
        ("strip 10 mm wide and 5 mm deep", ["load=100e3", "rail.crown_radius=inf",
                                            "rail.width=10", "rail.depth=5", "wheel.width=10"]),
    ):  # fmt: skip
        yield Case(
            "thin body", name, "the bodies end near the patch", "own finer mesh",
            against_finer(BLOCK.replace(keys)), seconds=240,
        )  # fmt: skip


def places() -> Iterator[Case]:
    """Awkward places of the contact."""
    corner = ["wheel.profile=arc", "wheel.transverse_radius=-80"]
    for shift in (10, 25):
        yield Case(
            "place", f"gauge corner, shift {shift} mm", "contact on R13 at 0.5 and 0.8 rad",
            "boundary elements",
            against_half_space(HEAD.replace([*corner, f"wheelset.shift={shift}"])), seconds=300,
        )  # fmt: skip
    for name, keys, known in (
        ("wheel 20 mm wide, 500 kN", ["wheel.width=20", "load=5e5", "wheel.segment_length=120"],
         "edge_distance"),
        ("wheel 8 mm wide, 50 kN", ["wheel.width=8", "load=5e4", "wheel.segment_length=70"],
         "edge_distance"),
        ("wheel 1 um wide", ["wheel.width=0.001"], "wheel.width"),
    ):  # fmt: skip
        yield Case(
            "place", name, "patch ends at the edge: singular pressure", "own finer mesh",
            against_finer(HEAD.replace(keys)), seconds=240, known=known,
        )  # fmt: skip
    yield Case(
        "place", "S1002 shift 5 mm, 1:40", "contact on the gauge face at 1.2 rad",
        "boundary elements",
        against_half_space(HEAD.replace(["wheel.profile=S1002", "wheelset.shift=5",
                                         "rail.inclination=1:40"])), seconds=400,
    )  # fmt: skip
    yield Case(
        "place", "two patches", "bumps 12 mm apart, one 1 um lower", "own finer mesh",
        partial(contacts.two_patches, 0.001, 2.0, 1.4, 0.02), newton=15, quick=True, seconds=240,
    )  # fmt: skip


def positions() -> Iterator[Case]:
    """The Manchester benchmark's pair across the tread, at default settings."""
    scene = catalogue.find("s1002_60e1").replace(["effects.plasticity=off"])
    for half in range(21):
        yield Case(
            "S1002 on 60E1", f"shift {half / 2:g} mm", "one patch or two, tread to flange",
            "boundary elements",
            positioned(scene.replace([f"wheelset.shift={half / 2}"]), SINGLE, SEVERAL),
            newton=15, seconds=400,
        )  # fmt: skip


def iterations() -> Iterator[Case]:
    """Krylov iterations of p-multigrid must not grow with the mesh or the stiffness."""
    multigrid = ELLIPSE.replace(["solver.linear=multigrid"])
    for n in (3.5, 5.0, 7.5, 10.0):
        yield Case(
            "Krylov", f"{n:g} elements per semi-axis", "finer meshes, multigrid", "exact Hertz",
            against_hertz(multigrid, n), krylov=KRYLOV, seconds=300, quick=n == 5,
        )  # fmt: skip
    for ratio in (1e-4, 1e-2, 1e2, 1e4):
        yield Case(
            "Krylov", f"E ratio {ratio:g}", "stiffness, multigrid", "exact Hertz",
            against_hertz(multigrid.replace([f"rail.young_modulus={207e3 * ratio}"])),
            krylov=KRYLOV, seconds=120,
        )  # fmt: skip

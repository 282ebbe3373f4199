"""Bodies that yield, far beyond first yield and over and over again.

The limits against a finer mesh with more load steps, or against another way of saying the same
scene, are those within which an independent program's spheres are met
(tests/verification/test_plasticity.py).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from mpi4py import MPI

from railhead.planning import plan as planning
from railhead.results import pipeline
from railhead.results.summary import summarise
from railhead.run.mesh_solution import mesh_and_solve
from railhead.run.progress import Progress
from railhead.run.refinement import Ending
from railhead.scene.scene import Rail, Scene, Wheel
from railhead.theory.elastic import indentation
from studies.hard.case import Case, Deviation, Measured
from studies.hard.scenes import measure, off, refusals

YIELD, RADIUS, YOUNG, POISSON = 480.0, 100.0, 207e3, 0.3
STEEL = {"yield_stress": YIELD}
LIMITS = {"approach_mm": 0.012, "area_mm2": 0.03, "max_MPa": 0.04, "strain_max": 0.08}
AGAIN = dict.fromkeys(LIMITS, 0.01)  # the same scene said otherwise, or pressed again
FINE = 1.6  # times the elements per semi-axis, and twice the load steps


def pressed(multiple: float, rail: Mapping[str, Any] = STEEL, **changes: Any) -> Scene:
    """A rigid sphere on a half-space at a multiple of its load of first yield (Johnson, Contact
    Mechanics, 6.8)."""
    pressure = indentation.yield_pressure(POISSON) * rail["yield_stress"]
    first = math.pi**3 * RADIUS**2 * pressure**3 / (6 * (YOUNG / (1 - POISSON**2)) ** 2)
    return Scene(
        load=multiple * first,
        rail=Rail(profile="arc", crown_radius=RADIUS, extent="half-space", **rail),
        wheel=Wheel(rolling_radius=RADIUS, young_modulus=math.inf),
    ).replace(**changes)


def quantities(summary: Mapping[str, Any]) -> dict[str, float]:
    """What is held, by name."""
    result = summary["result"]
    return {
        "approach_mm": result["approach_mm"],
        "area_mm2": result["patch"]["area_mm2"],
        "max_MPa": result["pressure"]["max_MPa"],
        "strain_max": result["plastic"]["strain_max"],
    }


def _against(
    scene: Scene,
    other: Callable[[], Mapping[str, float]],
    limits: Mapping[str, float],
) -> Callable[[], Measured]:
    def solve() -> Measured:
        result = pipeline.run(scene)
        if "plastic" not in (result.summary["result"] or {}):
            return Measured(failed=("no plastic answer", *result.summary["checks"]["failed"]))
        found, reference = quantities(result.summary), other()
        return measure(
            result,
            {name: Deviation(off(found[name], value), limits[name])
             for name, value in reference.items()},
        )  # fmt: skip

    return refusals(solve)


def _finer(scene: Scene) -> dict[str, float]:
    plan = planning.make(scene)
    plan = plan.at_resolution(FINE * plan.sizing.resolution)
    plan = replace(plan, load_steps=2 * plan.load_steps)
    solved = mesh_and_solve(plan, None, Progress(quiet=True), MPI.COMM_WORLD)
    return quantities(summarise([solved], Ending("one mesh")))


def _same(scene: Scene, length: float = 1.0) -> dict[str, float]:
    """In another unit of length."""
    found = quantities(pipeline.run(scene).summary)
    scale = {"approach_mm": length, "area_mm2": length**2}
    return {name: value / scale.get(name, 1.0) for name, value in found.items()}


def yielding() -> Iterator[Case]:
    """Perfect plasticity, one body, small yields, cycles, tiny and huge loads."""
    for name, scene, why, quick in (
        ("perfect plasticity, 20 times first yield", pressed(20), "no hardening holds it", True),
        ("perfect plasticity, 50 times first yield", pressed(50), "the surface yields", False),
        ("yield a thousandth of E", pressed(20, {"yield_stress": YOUNG / 1000}), "large patch",
         False),
        ("kinematic hardening", pressed(20, {**STEEL, "hardening_modulus": 5e3,
                                             "kinematic_fraction": 1.0}), "reverse yield", False),
    ):  # fmt: skip
        yield Case("yield", name, why, "own finer mesh", _against(scene, partial(_finer, scene),
                   LIMITS), seconds=300, quick=quick)  # fmt: skip
    for cycles in (2, 5):
        scene = pressed(10)
        yield Case(
            "yield", f"pressed {cycles} times", "what is left must carry the load again",
            "invariance",
            _against(scene.replace(cycles=cycles), partial(_same, scene), AGAIN),
            seconds=300, quick=cycles == 2,
        )  # fmt: skip
    small = pressed(5)
    scaled = small.replace(
        load=float(small.load or 0.0) * 1e-8,
        rail={"crown_radius": RADIUS * 1e-4},
        wheel={"rolling_radius": RADIUS * 1e-4},
    )
    yield Case(
        "yield", "a sphere of 10 um", "tiny loads and lengths", "invariance",
        _against(scaled, partial(_same, small, 1e4), AGAIN), seconds=300,
    )  # fmt: skip
    yield Case(
        "yield", "200 times first yield", "strains are no longer small", "own finer mesh",
        _against(pressed(200), partial(_finer, pressed(200)), LIMITS),
        seconds=300, known="load_over_first_yield",
    )  # fmt: skip
    bodies = Scene(load=60e3, rail=Rail(profile="arc", crown_radius=300, extent="half-space"))
    for body in ("rail", "wheel"):
        scene = bodies.replace([f"{body}.yield_stress=400", "mesh.patch_size=1.2"])
        yield Case(
            "yield", f"the {body} alone", "the elastic body carries the contact stress",
            "own finer mesh", _against(scene, partial(_finer, scene), LIMITS),
            seconds=300,
        )  # fmt: skip

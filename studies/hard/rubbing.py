"""Surfaces that rub: little and much friction, creepage and spin, unlike bodies, two patches.

Deviations of forces are shares of mu N, those of half widths shares of the patch. The limits are
what closed forms and boundary elements are met within (tests/verification/test_friction.py).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from railhead.results import pipeline
from railhead.results.result import Result
from railhead.scene.scene import Rail, Scene, Wheel
from railhead.theory.elastic.line import LineContact
from railhead.theory.friction import carter, cattaneo
from studies.hard.case import Case, Deviation, Measured
from studies.hard.scenes import ELLIPSE, measure, refusals

MU, LOAD, WIDTH = 0.3, 1e5, 100.0
FORCE, STICK = 0.012, 0.03
SOLID = 0.02  # of mu N, on the coarse meshes of solids
SOFT = -0.72  # mu P at creepage 0 with a rail 69 times softer: two other programs, -0.72 and -0.75

Friction = Mapping[str, Any]


def strip(coefficient: float = MU, **changes: Any) -> Scene:
    """R 420 mm on a flat, as half-planes."""
    return Scene(
        load=LOAD,
        rail=Rail(profile="arc", crown_radius=math.inf, extent="half-space", width=WIDTH),
        wheel=Wheel(rolling_radius=420, width=WIDTH),
        friction={"coefficient": coefficient},
    ).replace(**changes)


def _held(
    scene: Scene, deviations: Callable[[Result, Friction], dict[str, Deviation]]
) -> Callable[[], Measured]:
    def solve() -> Measured:
        result = pipeline.run(scene)
        found = (result.summary["result"] or {}).get("friction")
        if found is None:
            return Measured(failed=("no friction", *result.summary["checks"]["failed"]))
        return measure(result, deviations(result, found))

    return refusals(solve)


def _shift(coefficient: float) -> Case:
    scene = strip(coefficient, friction={"force_along": 0.5 * coefficient * LOAD})

    def off(result: Result, found: Friction) -> dict[str, Deviation]:
        exact = cattaneo.strip_stick_ratio(0.5)
        return {"stick_share": Deviation(abs(found["stick_share"] - exact), STICK)}

    return Case("friction", f"a shift at a coefficient of {coefficient:g}",
                "tractions far below, or as large as, the pressure", "Cattaneo",
                _held(scene, off), seconds=60, quick=coefficient < MU)  # fmt: skip


def _rolls(creepage: float) -> Case:
    scene = strip(rolling={"creepage_along": creepage})

    def off(result: Result, found: Friction) -> dict[str, Deviation]:
        line = result.ellipse
        assert isinstance(line, LineContact)
        exact = carter.from_creepage(line.strip, MU, creepage).share
        share = found["force_along_N"] / found["limit_N"]
        return {"force_along_N": Deviation(abs(share - exact), FORCE)}

    return Case("friction", f"rolling at a creepage of {creepage:g}",
                "everything sticks, or slips", "Carter", _held(scene, off), seconds=60,
                quick=creepage < 1)  # fmt: skip


def _against_half_spaces(result: Result, found: Friction) -> dict[str, Deviation]:
    other = result.summary["half_space_friction"]["boundary elements"]
    return {
        name: Deviation(abs(found[name] - other[name]) / found["limit_N"], SOLID)
        for name in ("force_along_N", "force_across_N")
    }


def _soft(result: Result, found: Friction) -> dict[str, Deviation]:
    share = found["force_along_N"] / found["limit_N"]
    return {"force_along_N": Deviation(abs(share - SOFT), STICK)}


def _met(result: Result, found: Friction) -> dict[str, Deviation]:
    share = abs(found["force_along_N"] - MU * LOAD / 3) / found["limit_N"]
    return {"force_along_N": Deviation(share, 1e-6)}


def rubbing() -> Iterator[Case]:
    """From a coefficient of 0.001 to 1 and a creepage of 1e-7 to 1."""
    yield from map(_shift, (1e-3, 1e-2, 1.0))
    yield from map(_rolls, (1e-7, 1e-4, 1.0))
    yield Case(
        "friction", "a rail 69 times softer than the wheel", "it drives without creepage",
        "other programs",
        _held(strip(rail={"young_modulus": 3e3}, rolling={"creepage_along": 0.0}), _soft),
        seconds=60, quick=True,
    )  # fmt: skip
    for body in ("rail", "wheel"):
        scene = strip(friction={"force_along": MU * LOAD / 3}).replace(
            [f"{body}.young_modulus=inf"]
        )
        yield Case(
            "friction", f"a rigid {body} that is shifted", "the patch grows with friction",
            "the given force", _held(scene, _met), seconds=60, quick=body == "wheel",
        )  # fmt: skip
    spun = ELLIPSE.replace(friction={"coefficient": MU}, rolling={"spin": 8e-4})
    yield Case(
        "friction", "pure spin", "slip turns about the middle", "boundary elements",
        _held(spun, _against_half_spaces), seconds=300,
    )  # fmt: skip
    two = Scene(
        load=1e4,
        rail=Rail(profile="60E1", inclination=1 / 40, gauge=1435),
        wheel=Wheel(profile="S1002", rolling_radius=460),
        wheelset={"shift": 5.0},
        mesh={"patch_size": 0.6},
        friction={"coefficient": MU},
        rolling={"creepage_along": 1e-3, "creepage_across": 5e-4, "spin": 1e-4},
    )
    yield Case(
        "friction", "two patches of different angles", "each has its own slip and radius",
        "boundary elements", _held(two, _against_half_spaces), seconds=600,
    )  # fmt: skip

"""Estimates of friction of random ellipses that roll, beside finer grids of another scheme.

The other scheme takes slips at the centres of whole cells, -du/dx by upstream differences of second
order, and the mean pressure of each cell. Its errors are of the first order: its numbers on two
grids are extrapolated, and their change from a coarser pair is its own error. It shares Cerruti's
kernels and the iteration of Coulomb's law with the program.
"""

import math
import statistics
import sys
from pathlib import Path

import numpy as np

import railhead as rh
from railhead.theory.array_types import Array
from railhead.theory.friction.coulomb_solver import CoulombSolver
from railhead.theory.friction.rolling import TOLERANCE, plane_modes
from railhead.theory.friction.tangential import MaterialPair, TractionInfluence
from studies.tables import Row, beside_errors, groups, publish, render, told

SEED, SCENES = 20261206, 100
GRIDS = (48, 96, 192)  # cells each way of the other scheme
UPSTREAM = ((0.0, 3.0), (0.5, -4.0), (1.0, 1.0))  # (distance upstream in cells, weight)
PARTS = 8  # of a cell each way, over which the pressure is averaged
STEEPEST = 2.0  # ratio of the numbers of cells along and across to those of a square
NUMBERS = (
    "force_along_N",
    "force_across_N",
    "moment_Nmm",
    "t_gamma_N",
    "traction_max_MPa",
    "stick_share",
)


class Upstream(TractionInfluence):
    """Influence of tractions in rolling on slips at the centres of whole cells."""

    def _slopes(self) -> Array:
        """Upstream differences of Cerruti's displacements over half a cell, times 1/cell."""
        kernels = [w * self._displacements(self._cerruti, ahead) for ahead, w in UPSTREAM]
        return np.asarray(np.sum(kernels, axis=0) / self._steps[0])


def main(out: Path, *, quick: bool) -> None:
    """Write friction_bounds.csv and page.md; quick: three scenes on coarser grids."""
    count, grids = (3, (16, 32, 64)) if quick else (SCENES, GRIDS)
    indices = told(range(count), lambda index: f"scene {index + 1} of {count}")
    records = [row for index in indices for row in measure(index, grids)]
    publish(out, page(records, grids), friction_bounds=records)


def scene(index: int) -> rh.Scene:
    """A random ellipse of half-spaces that roll: semi-axes to 1:8, creepages 1e-6 to 1e-2, mostly
    with spin, coefficients 0.05 to 2.
    """
    rng = np.random.default_rng([SEED, index])

    def between(low: float, high: float) -> float:
        """A number whose logarithm is evenly distributed."""
        return float(np.exp(rng.uniform(math.log(low), math.log(high))))

    ratio, creepage = between(1 / 8, 8), between(1e-6, 1e-2)
    angle, spins = rng.uniform(0, 2 * math.pi), rng.random() < 0.7
    crown = 420 * ratio ** (-1.65 if ratio > 1 else -1.5)
    poisson = float(rng.choice([0.25, 0.3, 0.4]))
    return rh.find("hertz_ellipse").replace(
        rail={"crown_radius": crown, "poisson_ratio": poisson},
        wheel={"poisson_ratio": poisson},
        load=25e3 if crown > 150 else 4e3,
        friction={"coefficient": between(0.05, 2)},
        rolling={
            "creepage_along": creepage * math.cos(angle),
            "creepage_across": creepage * math.sin(angle),
            "spin": creepage * float(rng.normal()) / 5 if spins else 0.0,
        },
        effects={"finite_bodies": "off", "plasticity": "off"},
    )


def measure(index: int, grids: tuple[int, ...]) -> list[Row]:
    """Estimates and errors of a scene, a row a number that is not below resolution: forces over mu
    N, the stick share as it is, others relative. No rows without a truth.
    """
    result = rh.solve(scene(index), quiet=True)
    found, bound = result.summary["result"]["friction"], result.summary["accuracy"]["bound"]
    try:
        rough, middle, fine = (np.array(_other_scheme(result, cells)) for cells in grids)
    except ValueError as error:  # the other scheme does not converge
        print(f"scene {index + 1} is left out: {error}", file=sys.stderr)
        return []
    truth, before = 2 * fine - middle, 2 * middle - rough
    rows = []
    for number, exact, other in zip(NUMBERS, truth, before, strict=True):
        if number in bound and number not in found["below_resolution"]:
            forces, share = number.startswith("force"), number == "stick_share"
            over = found["limit_N"] if forces else 1.0 if share else abs(found[number])
            rows.append(
                {
                    "scene": index,
                    "axis_ratio": result.ellipse.a / result.ellipse.b,
                    "coefficient": found["coefficient"],
                    "stick": found["stick_share"],
                    "number": number,
                    "value": found[number] / over,
                    "estimate": bound[number],
                    "error": abs(found[number] - exact) / over,
                    "truth_error": abs(exact - other) / over,
                }
            )
    return rows


def _other_scheme(result: rh.Result, cells: int) -> list[float]:
    """The `NUMBERS` of the scene of a result by the other scheme on about cells x cells cells."""
    ellipse, given = result.ellipse, result.solved.plan.scene
    wider = min(max(math.sqrt(ellipse.a / ellipse.b), 1 / STEEPEST), STEEPEST)
    counts = 2 * round(cells * wider / 2), 2 * round(cells / wider / 2)
    u, v = ((2 * np.arange(PARTS * n) + 1) / (PARTS * n) - 1 for n in counts)
    pressure = np.sqrt(np.clip(1 - u[:, None] ** 2 - v**2, 0.0, None))
    pressure = pressure.reshape(counts[0], PARTS, counts[1], PARTS).mean(axis=(1, 3))
    x, y = (
        half * ((2 * np.arange(n) + 1) / n - 1)
        for half, n in zip((ellipse.a, ellipse.b), counts, strict=True)
    )
    cell = (x[1] - x[0]) * (y[1] - y[0])
    bound = given.friction.coefficient * pressure * ellipse.load / (pressure.sum() * cell)
    steel = given.rail
    pair = MaterialPair(steel.young_modulus / (2 + 2 * steel.poisson_ratio), steel.poisson_ratio)
    influence = Upstream(x, y, pair, rolling=True)
    along, across, spin = (
        getattr(given.rolling, key) for key in ("creepage_along", "creepage_across", "spin")
    )
    inside = bound > 0
    slip = inside * np.tensordot([along, across, spin, 0.0], plane_modes(x, y), axes=1)
    traction = CoulombSolver(influence, bound).solve(slip, TOLERANCE)
    sticks = inside & (np.hypot(*traction) < bound * (1 - 1e-6))
    return [
        float(each)
        for each in (
            cell * traction[0].sum(),
            cell * traction[1].sum(),
            cell * (x[:, None] * traction[1] - y * traction[0]).sum(),
            cell * (traction * slip).sum(),
            np.hypot(*traction).max(),
            sticks.sum() / inside.sum(),
        )
    ]


def page(records: list[Row], grids: tuple[int, ...]) -> str:
    """Text of the page: a row a number."""
    rows = [
        (
            f"`{number}`",
            *beside_errors(
                own, [each["error"] <= each["estimate"] + each["truth_error"] for each in own]
            ),
            f"{statistics.median(each['truth_error'] for each in own):.1g}",
        )
        for number, own in [*groups(records, "number").items(), ("all", records)]
    ]
    count = len({each["scene"] for each in records})
    return render("friction_bounds", rows=rows, scenes=count, seed=SEED, grids=grids)

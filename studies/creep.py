"""Creep curves of the thesis's ellipse beside boundary elements, FASTSIM and linear theory."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mpi4py import MPI

from railhead import build, catalogue, study
from railhead.planning import exact
from railhead.planning import plan as planning
from railhead.postprocess.plots import FE, HERTZ, THESIS, new_figure
from railhead.solver.condensed import Condenser
from railhead.solver.contact import ContactModel
from railhead.solver.friction import Friction
from railhead.solver.rubbing import RubbingModel, slips
from railhead.studies import tables
from railhead.theory import kalker
from railhead.theory.fastsim import fastsim
from railhead.theory.hertz import Ellipse
from railhead.theory.rolling import Creepage, HalfSpaceFriction

STUDY = "creep curves along, across and with spin against boundary elements, FASTSIM, linear theory"
COEFFICIENT = 0.3
ALONG = (1e-4, 2e-4, 4e-4, 7e-4, 1e-3, 1.4e-3, 2e-3, 3e-3, 5e-3, 1e-2)
ASIDE = (
    *(Creepage(0.0, xi) for xi in (2e-4, 1e-3, 3e-3)),
    *(Creepage(0.0, 0.0, spin) for spin in (5e-5, 2e-4, 8e-4)),
    Creepage(5e-4, 1e-3), Creepage(5e-4, -5e-4, 3e-4),
)  # fmt: skip
COARSE = 4.0  # elements a semi-axis of the whole model, which lateral motion needs


@dataclass(frozen=True)
class Point:
    """Forces over mu N at a motion, by a method (by); stick: share of the patch; seconds: of the
    finite elements, the first point of a mesh with all that comes before it."""

    along: float
    across: float
    spin: float
    by: str
    force_along: float
    force_across: float
    stick: float | None = None
    seconds: float | None = None
    steps: int | None = None


def rolled(motions: Sequence[Creepage], resolution: float | None) -> Iterator[Point]:
    """All methods at each motion, from one condensed model."""
    across = any(each.across or each.spin for each in motions)
    scene = catalogue.find("hertz_ellipse").replace(
        friction={"coefficient": COEFFICIENT},
        rolling={"creepage_along": 1e-3, "creepage_across": 1e-3 if across else None},
    )
    start = time.perf_counter()
    plan = planning.make(scene)
    plan = plan if resolution is None else plan.at_resolution(resolution)
    model = build.model(plan, build.generate(plan, plan.grading(), MPI.COMM_WORLD))
    assert isinstance(model, RubbingModel) and model.setup.rub is not None
    model.tangential = np.zeros(2)
    touching = plan.forecast.touching(model.setup.kinematics.lift(model.interface.points))
    pressed = ContactModel.solve(model, load=scene.load or 0.0, active=touching)
    contact = Condenser(model, pressed).condense(rolling=True)
    problem, rigid = Friction(contact, COEFFICIENT), slips(model.setup.rub, contact)
    ellipse = plan.estimate
    assert isinstance(ellipse, Ellipse)
    pair = exact.tangential_pair(scene)
    linear = kalker.coefficients(ellipse.a / ellipse.b, pair.poisson)
    other = HalfSpaceFriction.hertz(ellipse, COEFFICIENT, pair, rolling=True)
    axes = model.setup.rub.axes
    for motion in motions:
        given = (motion.along, motion.across, motion.spin)
        found = problem.solve(np.asarray(np.tensordot(given, rigid, axes=1)))
        seconds = time.perf_counter() - start
        along, aside = (
            float(contact.force(axis) @ found.nodal) / problem.limit for axis in axes[:2]
        )
        touches = found.pressure > 0
        stick = contact.weights[found.sticks].sum() / contact.weights[touches].sum()
        yield Point(
            *given, "railhead", along, 0.0 if plan.half_y else aside, float(stick), seconds,
            len(found.history),
        )  # fmt: skip
        rolling = other.at(motion)
        one, two, _ = (force / rolling.limit for force in rolling.forces)
        yield Point(*given, "boundary elements", one, two, rolling.stick_share)
        limit = COEFFICIENT * ellipse.load
        quick = fastsim(ellipse.a, ellipse.b, limit, pair.shear_modulus, linear, motion)
        yield Point(*given, "FASTSIM", quick.along / limit, quick.across / limit, quick.stick_share)
        straight = linear.forces(ellipse.a, ellipse.b, pair.shear_modulus, motion)
        yield Point(*given, "linear theory", straight[0] / limit, straight[1] / limit)
        start = time.perf_counter()


def main(out: Path, *, quick: bool) -> None:
    """Write creep.csv, creep.png and page.md; quick: two points of a coarse mesh."""
    points = []
    plans: list[tuple[Sequence[Creepage], float | None]] = [
        ([Creepage(xi) for xi in (ALONG[2:5:2] if quick else ALONG)], COARSE if quick else None)
    ]
    if not quick:
        plans.append((ASIDE, COARSE))
    for motions, resolution in plans:
        for point in rolled(motions, resolution):
            if point.by == "railhead":
                text = f"creepage {point.along:g}, {point.across:g}, spin {point.spin:g}"
                print(text, file=sys.stderr)
            points.append(point)
    tables.write_csv(out / "creep.csv", points, {"spin": "per_mm", "seconds": "s"})
    draw(points, out / "creep.png")
    (out / study.PAGE).write_text(page(points), encoding="utf-8")


def page(points: Sequence[Point]) -> str:
    """Forces of each motion side by side, and the largest differences."""
    rows, off = [], {"boundary elements": 0.0, "FASTSIM": 0.0}
    own = [point for point in points if point.by == "railhead"]
    for found in own:
        same = [
            p
            for p in points
            if (p.along, p.across, p.spin) == (found.along, found.across, found.spin)
        ]
        others = {p.by: p for p in same}
        for by in off:
            gap = math.hypot(found.force_along - others[by].force_along,
                             found.force_across - others[by].force_across)  # fmt: skip
            off[by] = max(off[by], gap)
        exact, quick, straight = (
            others[by] for by in ("boundary elements", "FASTSIM", "linear theory")
        )
        rows.append((
            f"{found.along:g}", f"{found.across:g}", f"{found.spin:g}",
            *(f"{p.force_along:.4f}, {p.force_across:.4f}"
              for p in (found, exact, quick, straight)),
            f"{found.stick:.2f}, {exact.stick:.2f}", found.steps, f"{found.seconds:.1f}",
        ))  # fmt: skip
    return tables.render("creep", points=rows, off=off, coefficient=COEFFICIENT)


def draw(points: Sequence[Point], path: Path) -> None:
    """Force over creepage along the rail."""
    looks = {"railhead": (FE, "o"), "boundary elements": (HERTZ, "-"), "FASTSIM": (THESIS, "--"),
             "linear theory": (THESIS, ":")}  # fmt: skip
    with new_figure(path, 7, 4.4) as figure:
        axes = figure.subplots()
        for by, (colour, look) in looks.items():
            own = [p for p in points if p.by == by and p.along and not (p.across or p.spin)]
            axes.plot(
                [p.along for p in own], [p.force_along for p in own], look, color=colour, label=by
            )
        axes.set(
            xscale="log", ylim=(0, 1.1), xlabel="creepage along the rail", ylabel="force over mu N"
        )
        axes.legend()

"""Estimates of passes over random lines, beside passes on twice the elements."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from railhead.half_spaces.pass_contact import Below, line_contact
from railhead.postprocess.pass_rows import PASS_ERRORS, RATES, Passes
from railhead.run.passes_of_scene import COARSER, estimated, roll, rolling_block
from railhead.solver.material import Hardening, Material
from studies.processes import values
from studies.tables import Row, beside_errors, groups, publish, render

SEED, LINES, PASSES, FINER = 20261129, 16, 5, 2.0


def main(out: Path, *, quick: bool) -> None:
    """Write pass_bounds.csv and page.md; quick: one line, on few elements."""
    count = 1 if quick else LINES
    records = values(measure, [(index, quick) for index in range(count)])
    publish(out, page(records, count), pass_bounds=records)


def steel(rng: np.random.Generator) -> Hardening:
    """A random law: perfect, kinematic or isotropic, or one or two back stresses by both rules."""
    law = Hardening.linear(rng.uniform(300, 600))
    kind = rng.integers(4)
    if kind < 2:
        slope = float(rng.choice([0.0, rng.uniform(0.01, 0.05)])) * 207e3
        return replace(law, final_hardening_modulus=slope, kinematic=float(kind))
    pairs = np.exp(rng.uniform(np.log([1e4, 50]), np.log([1e5, 500]), (rng.integers(1, 3), 2)))
    return law.cyclic(pairs.tolist(), 0.0 if kind == 2 else rng.uniform(1, 5))


def measure(index: int, quick: bool) -> list[Row]:
    """Estimates and errors of a random line, a row a number: of the rail, and of a wheel that
    yields. Moduli of both may differ, and either is the softer; pressure kept or in contact; a
    third has tractions.
    """
    rng = np.random.default_rng([SEED, index])
    both, keeps = rng.random() < 0.5, rng.random() < 0.5
    young = rng.choice([207e3, rng.uniform(100e3, 400e3)], 2)
    laws = [steel(rng), steel(rng)]
    k = min(law.stress[0] for law in laws[: 1 + both]) / math.sqrt(3)
    slips = float(rng.choice([0, 0, 1]) * rng.uniform(-0.3, 0.3))
    p0 = k * rng.uniform(3.1, 4.6 if slips else 5.4)
    modulus = 1 / sum((1 - 0.3**2) / each for each in young)
    contact = line_contact(
        1.0, math.pi * p0 / 2, 2 * p0 / modulus, modulus, keeps=keeps, slips=slips
    )

    def rolled(per_length: float, coarser: float = 1.0) -> list[Passes]:
        """Passes of each body on a block with these elements."""
        below = [
            Below(
                rolling_block(
                    Material(e, 0.3, law), (1.0, 1.0), line=True, half=False, coarser=coarser,
                    per_length=per_length,
                ),
                contact,
                wheel=wheel,
            )
            for e, law, wheel in zip(young[: 1 + both], laws, (False, True), strict=False)
        ]  # fmt: skip
        return roll(below, contact, PASSES)

    size = 3.0 if quick else 8.0
    pairs = zip(rolled(size), rolled(size, COARSER), strict=True)
    own, rows = [estimated(*each, asked=True) for each in pairs], []
    for body, found, truth in zip(("rail", "wheel"), own, rolled(FINER * size), strict=False):
        known = {PASS_ERRORS[key]: (key, error) for key, error in found.errors.items()}
        if found.rate is not None and found.rate["estimate"] is not None:
            known |= {RATES[key]: (key, found.rate["estimate"]) for key in RATES}
        for number, (key, estimate) in known.items():
            error = abs(truth.rows[-1][key] / found.rows[-1][key] - 1)
            told = {"line": index, "body": body, "both": both, "keeps": keeps, "number": number}
            converged = found.converged and truth.converged
            rows.append(told | {"estimate": estimate, "error": error, "converged": converged})
    return rows


def page(records: list[Row], lines: int) -> str:
    """Text of the page: a row a number."""
    rows = [
        (number, *beside_errors(own, [each["error"] <= each["estimate"] for each in own]))
        for number, own in [*groups(records, "number").items(), ("all", records)]
    ]
    return render("pass_bounds", rows=rows, lines=lines, seed=SEED, passes=PASSES)

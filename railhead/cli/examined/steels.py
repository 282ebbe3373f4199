"""The command `railhead steel`: what a steel does in tension, under cycles of strain, and under a
mean stress; and constants of a steel from a test.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
from rich.console import Console

from railhead.cli.examined.examined import Examined
from railhead.postprocess.findings import BASE_UNITS, Drawing, Subject, Units
from railhead.postprocess.pass_rows import rule
from railhead.results.report import terminal
from railhead.run.model_setup import hardening
from railhead.scene import catalogue, files
from railhead.scene.bodies import steels
from railhead.scene.scene import Scene, SceneError
from railhead.solver.material import Hardening, Material
from railhead.solver.plasticity.specimen import Bar, fitted, stresses
from railhead.theory.array_types import Array

CARRIER = "long_roller"  # case whose rail is of a steel that no scene has
PLASTIC = (0.002, 0.01)  # plastic strains of proof stresses
TENSION = np.append(0.0, np.geomspace(1e-3, 0.04, 80))  # strains on the way to them
CURVE = np.linspace(0.0, 0.02, 101)  # strains of the curve in tension
RANGE, LOOPS, STEPS = 0.006, 3, 30  # largest strain of the loops, their number, steps each way
SHARE = 0.1  # of the amplitude: the mean stress that is not asked for; and less than the loop
POOR = 0.1  # of the largest stress: misfit from which the keys do not describe the test
ROUNDED = 1e-9  # of a plastic strain
ROUNDING = 12  # decimals of strains that cycles add
SHORT = "no proof stress, as test or curve end below 0.2% of plastic strain"
TABLES = (".csv", ".txt", ".dat")


@dataclass(frozen=True, eq=False)
class SteelTests(Examined):
    """A bar of the steel of a rail or, if that does not yield, of the wheel of a scene.

    scene: the scene. name: what pictures call the steel.
    mean, amplitude: of cycles of stress, MPa; None: a tenth of the amplitude, and nine tenths of
        the stress of the last loop.
    cycles: number of cycles of stress.
    measured: strain and stress (MPa) of a test (n, 2), to which the steel was fitted; None: none.
    errors: relative standard errors of its constants, as of `fitted`; None: of no fit.
    """

    command = "steel"
    scene: Scene
    name: str
    mean: float | None = None
    amplitude: float | None = None
    cycles: int = 50
    measured: Array | None = None
    errors: Array | None = None

    @cached_property
    def steel(self) -> Material:
        """Elastic constants and flow curve. Raises SceneError where no body yields."""
        for part in (self.scene.rail, self.scene.wheel):
            if part.yields:
                return Material(part.young_modulus, part.poisson_ratio, hardening(part))
        raise SceneError("rail.steel", "is not given; give it, or rail.yield_stress")

    @cached_property
    def curve(self) -> Array:
        """Strain and stress (MPa) of the model, as in the test or in tension (n, 2)."""
        strain = CURVE if self.measured is None else self.measured[:, 0]
        return np.column_stack([strain, stresses(self.steel, strain)])

    @cached_property
    def loops(self) -> Array:
        """Strain and stress (MPa) under cycles of strain (n, 2)."""
        up = np.linspace(-RANGE, RANGE, STEPS + 1)[1:]
        start = np.linspace(0.0, RANGE, STEPS // 2 + 1)
        strain = np.concatenate([start, *[np.concatenate([-up, up])] * LOOPS])
        return np.column_stack([strain, stresses(self.steel, strain)])

    @cached_property
    def stress(self) -> tuple[float, float]:
        """Mean and amplitude of the cycles of stress, MPa."""
        amplitude = self.amplitude or (1 - SHARE) * float(self.loops[-2 * STEPS :, 1].max())
        return SHARE * amplitude if self.mean is None else self.mean, amplitude

    @cached_property
    def rates(self) -> Array:
        """Strain that each cycle of stress adds (c,). Raises SceneError for a stress that the steel
        does not carry.
        """
        mean, amplitude = self.stress
        bar, ends = Bar(self.steel), []
        way = np.cos(np.linspace(0.0, np.pi, STEPS // 2 + 1)[1:])
        try:
            bar.to_stress(mean + amplitude)
            for _ in range(self.cycles):
                begun = bar.strain
                for share in (*way, *-way):
                    bar.to_stress(mean + share * amplitude)
                ends.append(bar.strain - begun)
        except ValueError as error:
            raise SceneError("--mean", f"{error}; give a smaller one, or --amplitude") from None
        return np.round(ends, ROUNDING) + 0.0

    @property
    def proof(self) -> dict[str, float]:
        """Stress of the bar in tension, MPa, by the plastic strain: of those (PLASTIC) that 4 % of
        strain, the test and the points of the flow curve reach.
        """
        stress, young, law = stresses(self.steel, TENSION), self.steel.young_modulus, self.law
        plastic = TENSION - stress / young
        ends = [plastic[-1], *([law.strain[-1]] if len(law.strain) > 1 else [])]
        if self.measured is not None:
            ends.append((self.measured @ [1.0, -1 / young]).max())
        reached = (each for each in PLASTIC if each <= min(ends) + ROUNDED)
        return {f"{each:g}": float(np.interp(each, plastic, stress)) for each in reached}

    @property
    def law(self) -> Hardening:
        """Its flow curve."""
        assert self.steel.hardening is not None
        return self.steel.hardening

    @property
    def misfit(self) -> dict[str, float]:
        """Largest difference of the model's stress from the test, MPa, its share of the largest
        stress of the test, and the strain there; empty without a test.
        """
        if self.measured is None:
            return {}
        wrong = np.abs(self.curve[:, 1] - self.measured[:, 1])
        return {
            "misfit_MPa": float(wrong.max()),
            "misfit_share": float(wrong.max() / np.abs(self.measured[:, 1]).max()),
            "misfit_strain": float(self.measured[np.argmax(wrong), 0]),
        }

    @property
    def fits(self) -> bool:
        """Whether the model is within a tenth (POOR) of the largest stress of the test, if any."""
        return self.misfit.get("misfit_share", 0.0) <= POOR

    def summary(self) -> dict[str, Any]:
        """Content of summary.json: "steel" (its keys), "rule", "proof_MPa" at 0.2 and 1 % of
        plastic strain, "loop_MPa", "ratchetting", and of a test `misfit`, and
        "standard_errors", relative, of yield stress, all C, all g, and Q and b.
        """
        mean, amplitude = self.stress
        cycles = {
            "mean_MPa": mean,
            "amplitude_MPa": amplitude,
            "strain_per_cycle": self.rates.tolist(),
        }
        return {
            "case": self.scene.name,
            "scene": catalogue.portable(self.scene),
            "steel": _keys(self.steel),
            "rule": rule(self.law),
            "proof_MPa": self.proof,
            "loop_MPa": float(self.loops[-2 * STEPS :, 1].max()),
            "ratchetting": cycles,
            **self.misfit,
            **({} if self.errors is None else {"standard_errors": self.errors.tolist()}),
        }

    def tables(self) -> dict[str, list[dict[str, Any]]]:
        """Rows of curve.csv, loops.csv and cycles.csv by name of the file."""
        return {
            **{
                f"{name}.csv": [{"strain": e, "stress [MPa]": s} for e, s in points.tolist()]
                for name, points in (("curve", self.curve), ("loops", self.loops))
            },
            "cycles.csv": [
                {"cycle": number, "strain": each} for number, each in enumerate(self.rates, 1)
            ],
        }

    def drawings(self, units: Units = BASE_UNITS) -> dict[str, Drawing]:
        """Function that draws steel.png. units: of its numbers."""
        from railhead.postprocess.pictures import steel_plots

        mean, amplitude = (units.text(each, "MPa") for each in self.stress)
        title = f"{self.name}: curve, loops, and strain of cycles of {mean} +- {amplitude}"
        subject = Subject(title, units=units)
        points = self.curve, self.loops, self.rates, self.measured
        return {"steel.png": partial(steel_plots.draw_steel, *points, subject)}

    @staticmethod
    def shown(summary: Mapping[str, Any], console: Console, units: Units) -> None:
        """Print keys of the steel, and what the bar does. units: of the numbers but of the keys."""
        for key, value in summary["steel"].items():
            console.print(f"{key} = {value}", markup=False, highlight=False, soft_wrap=True)
        proof = ", ".join(
            f"{units.text(stress, 'MPa')} at {float(plastic):.1%}"
            for plastic, stress in summary["proof_MPa"].items()
        )
        cycles = summary["ratchetting"]
        mean, amplitude = (units.text(cycles[key], "MPa") for key in ("mean_MPa", "amplitude_MPa"))
        rates = cycles["strain_per_cycle"]
        lines = [
            f"tension    {proof} of plastic strain" if proof else f"tension    {SHORT}",
            f"loops      {units.text(summary['loop_MPa'], 'MPa')} at {RANGE:.1%} of strain",
            f"ratchets   by {rates[0]:.3g} in the first cycle of {mean} +- {amplitude}, by "
            f"{rates[-1]:.3g} in cycle {len(rates)} ({summary['rule']})",
        ]
        if "misfit_MPa" in summary:
            share, most = summary["misfit_share"], units.text(summary["misfit_MPa"], "MPa")
            text = f"{most} at most, {share:.1%} of the largest stress, at the"
            poor = "" if share <= POOR else ": THESE KEYS DO NOT DESCRIBE THE TEST"
            lines.append(f"misfit     {text} strain {summary['misfit_strain']:.4g}{poor}")
        if "standard_errors" in summary:
            said = ", ".join(f"{each:.1%}" for each in summary["standard_errors"])
            lines.append(f"errors     {said} of yield stress, each C, each g, and Q and b if given")
        for line in lines:
            terminal.labelled(console, line)


def steel_tests(
    source: str, assignments: Sequence[str], count: int, exponent: float, **stress: Any
) -> SteelTests:
    """A bar of a steel.

    source: name of a steel, of a case or of a scene's file; or a table of a test, to which a steel
        with `count` back stresses of this recall exponent is fitted.
    assignments: KEY=VALUE of the scene. stress: cycles of stress, as in `SteelTests`.
    Raises SceneError for what is none of these, and a test that tells no constants.
    """
    scene, measured = catalogue.find(CARRIER), None
    errors: Array | None = None
    if source in steels():
        scene = scene.replace([f"rail.steel={source}"])
    elif source.lower().endswith(TABLES):
        try:
            measured = np.array(files.read_test(source))
            steel, errors = fitted(measured[:, 0], measured[:, 1], count, exponent)
        except OSError as error:
            raise SceneError(source, f"cannot be read: {error.strerror}") from None
        except ValueError as error:
            raise SceneError("FILE", " ".join(str(error).split())) from None
        scene = scene.replace(rail=_keys(steel))
    elif source.endswith(".toml") or source in catalogue.shipped():
        scene = catalogue.find(source)
    else:
        what = f"a steel ({', '.join(steels())}), a case, a .toml file, or a .csv table of a test"
        raise SceneError("steel", f"{source!r} is unknown; give {what}")
    scene = scene.replace(list(assignments))
    return SteelTests(scene, source, measured=measured, errors=errors, **stress)


def _keys(steel: Material) -> dict[str, Any]:
    """Keys and values of a steel in [rail] or [wheel], with six digits."""
    law = steel.hardening
    assert law is not None
    parts = [(each.modulus, each.recall) for each in law.backstresses]
    found: dict[str, Any] = {
        "young_modulus": _short(steel.young_modulus),
        "yield_stress": _short(law.initial_yield_stress),
        "backstress": [[_short(each) for each in pair] for pair in parts],
        "recall_exponent": law.recall_exponent,
        "isotropic": [_short(each) for each in law.isotropic] if law.isotropic[0] else [],
    }
    return {key: value for key, value in found.items() if value}


def _short(value: float) -> float:
    """A value with six digits."""
    return float(f"{value:.6g}")

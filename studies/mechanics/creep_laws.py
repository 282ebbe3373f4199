"""Creep curves over speed under a coefficient of friction that falls with slip."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from railhead.planning import simulation_plan as planning
from railhead.planning.references import closed_forms, pressed_patches
from railhead.postprocess.pictures.diagrams import FE, GREY, HERTZ, new_figure
from railhead.scene import catalogue
from railhead.theory.friction.rolling import Creepage, TangentialSolution
from studies.mechanics import creep_runs
from studies.tables import Row

LAW: dict[str, Any] = {
    "coefficient": 0.33,
    "law": "exponential",
    "kinetic": 0.14,
    "slip_half": 1250.0,
    "memory": 0.5,
}
SPEEDS = (5.0, 10.0, 30.0)  # m/s
CREEPAGES = (5e-4, 1e-3, 2e-3, 3e-3, 5e-3, 1e-2, 3e-2, 1e-1)
MESHED = (1e-3, 3e-3, 1e-2, 1e-1)  # creepages of finite elements, at the middle speed
CELLS = 32  # each way, of the boundary elements
LOOKS = dict(zip(SPEEDS, (GREY, HERTZ, FE), strict=True))


def plan(speed: float) -> planning.Plan:
    """Elastic plan of the thesis's ellipse that rolls with the law at a speed, m/s."""
    scene = catalogue.find("hertz_ellipse").replace(
        friction=LAW,
        rolling={"creepage_along": 1e-3, "speed": speed},
        effects={"plasticity": "off"},
    )
    return planning.make(scene)


def row(speed: float, creepage: float, by: str, found: TangentialSolution) -> Row:
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
    of = plan(speed)
    assert of.scene.load is not None
    patches = pressed_patches.patches(
        of.contact, of.hertz, hertzian=True, load=of.scene.load, cells=CELLS
    )
    found: list[TangentialSolution] | None = None
    rows = []
    for way, values in (("upwards", creepages), ("downwards", creepages[::-1])):
        for value in values:
            found = pressed_patches.shear(
                patches,
                of.context.tangential_pair,
                Creepage(value),
                (None, None),
                rolling=True,
                interface=closed_forms.interface(of.scene),
                start=found,
            )
            rows.append(row(speed, value, way, found[0]))
    return rows


def solids(speed: float, creepages: tuple[float, ...]) -> list[Row]:
    """Rows of finite elements, under the pressure without friction."""
    friction = creep_runs.sampled(plan(speed)).friction
    return [row(speed, v, "railhead", friction.tractions(Creepage(v))[0]) for v in creepages]


def rows(*, quick: bool) -> list[Row]:
    """Rows of all speeds; quick: two creepages of half-spaces at one speed."""
    if quick:
        return half_spaces(SPEEDS[1], CREEPAGES[2:7:4])
    found = [each for speed in SPEEDS for each in half_spaces(speed, CREEPAGES)]
    return found + solids(SPEEDS[1], MESHED)


def table(found: Sequence[Row]) -> tuple[list[str], list[list[str]], float]:
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


def draw(found: Sequence[Row], path: Path) -> None:
    """Draw forces over creepage, a curve for each speed."""
    with new_figure(path, 6.4, 4.2) as figure:
        axes = figure.subplots()
        for speed in sorted({each["speed"] for each in found}):
            for by, look, label in (
                ("upwards", "-", f"{speed:g} m/s, half-spaces"),
                ("railhead", "o", f"{speed:g} m/s, finite elements"),
            ):
                own = [each for each in found if (each["speed"], each["by"]) == (speed, by)]
                if own:
                    x, y = ([each[key] for each in own] for key in ("creepage", "force"))
                    axes.plot(x, y, look, color=LOOKS[speed], label=label)
        axes.set(xscale="log", ylim=(0, 1.1), xlabel="creepage along", ylabel="force over mu_0 N")
        axes.legend()

"""report.html: one file with all of a result, for a reader who has nothing else."""

import base64
import platform
from collections.abc import Sequence
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from railhead.planning.effects import in_words
from railhead.postprocess.findings import Units, keyed
from railhead.results import quantity_rows, result_folder
from railhead.results.checks import SECOND
from railhead.results.report import terminal
from railhead.run.half_space_answer import Solved
from railhead.scene.catalogue import portable
from railhead.scene.keys import dotted
from railhead.scene.scene import Scene

NAME = "report.html"
CAPTIONS = {
    "patch": "Contact pressure over the patch, seen from above.",
    "friction": "Where the patch sticks and slips, and the tractions.",
    "passes": "Residual stress and strain below the patch by pass, and increments by pass.",
    "plastic": "What yields, and the stress that stays after the load.",
    "pressure": "Contact pressure along both axes; where each cut lies is said over it. "
    "Of finite elements, waves that are two elements long come from the mesh.",
    "stress_cut": "Stresses in a cut through the contact.",
    "stress_cut_along": "Stresses in a cut along the rail, through the largest pressure.",
    "depth": "Stresses below the contact.",
    "passes_section": "Plastic strain and residual stress across the rail after the last pass.",
    "wheel_rail": "The bodies that were solved, cut open, and their mesh at the contact.",
    "fatigue": "Stresses of two criteria of fatigue over the depth, while the wheel rolls on.",
    "shakedown": "Pressure and traction against the limits of repeated rolling.",
}
"""Captions by name of the picture; a report of one page has the first two of these pictures that
there are."""
CHECKS = {
    "effects_left_out": "effects that are called for are simulated",
    "converged": "the solver converged",
    "force_balance": "forces are in balance",
    "approach_reached": "the solution has the approach that the scene gives",
    "patch_settled": "the mesh is fine where the patch is",
    "unloaded": "the bodies were unloaded",
    "elements_across": "elements across the patch",
    "pressure_noise": "noise of the pressure",
    "pressure_force": "the pressure that is shown carries the load",
    "penetration": "overlap of the bodies",
    "flux_rail": "the stresses below the patch carry the load, rail",
    "flux_wheel": "the stresses above the patch carry the load, wheel",
    "stress_misfit": "smooth stresses against the elements' own",
    "shear_over_pressure": "largest shear stress over pressure, at most",
    "shear_over_pressure_least": "largest shear stress over pressure, at least",
    "load_over_first_yield": "the load over the load of first yield",
    "small_strain": "strains are small: pressure over modulus",
    "pressure_of_steel": "a pressure that some steel bears, MPa",
    "axle_torque": "no torque on the axle",
    "edge_distance": "patch away from edges",
    "estimates": "all estimates are at most 25 %",
    "grid_error": "the cells of half-spaces are small enough",
    "tangential_flux_rail": "the stresses below the patch carry the tangential force, rail",
    "tangential_flux_wheel": "the stresses above the patch carry the tangential force, wheel",
    "accuracy": "the asked accuracy",
    "passes_converged": "every pass converged",
    "passes_rim": "no yield at the rim of the region where it is followed",
    "passes_energy": "resistance to rolling against plastic work",
    "passes_steady": "passes steady enough for many wheels",
}
PACKAGES = (
    "fenics-dolfinx",
    "petsc4py",
    "numpy",
    "scipy",
    "gmsh",
    "pyvista",
    "matplotlib",
)


def render(
    solved: Solved,
    summary: dict[str, Any],
    units: Units,
    folder: Path,
    title: str,
    *,
    brief: bool = False,
) -> str:
    """HTML text of the report, with those pictures of the folder in it that have a caption
    (CAPTIONS), and its scene.toml, which must be there.

    title: of the page.
    brief: whether it is one page: verdict, answer, two pictures, failed checks, what was asked.
    Raises OSError for a file that cannot be read.
    """
    scene = solved.plan.scene
    passes = list(quantity_rows.passes(summary["result"] or {}, units, 3 if brief else 10))
    drawn = [name for name in CAPTIONS if (folder / f"{name}.png").exists()]
    effects = summary["plan"]["effects"]
    names = "contact", "yield", "friction", "steel"
    contact, plastic, friction, steel = (quantity_rows.rows(summary, name) for name in names)
    patches_title, patches = quantity_rows.patches(summary, units)
    return template("report.html.j2").render(
        summary=summary,
        units=units,
        effect=in_words,
        check=check,
        title=title,
        scene_rows=scene_rows(scene),
        scene_toml=(folder / "scene.toml").read_text(encoding="utf-8"),
        answer=_table(contact, units),
        plastic=_table(plastic, units),
        friction=_table([*friction, *steel], units),
        files=[path.name for path in scene.files],
        left_out_after=terminal.left_out(summary),
        patches=patches,
        error_parts=quantity_rows.error_parts(summary),
        yields=terminal.yields(summary["result"] or {}),
        side_force=terminal.side_force(summary["result"] or {}, units),
        patches_title=patches_title,
        left_out={name: each for name, each in effects.items() if not each["on"]},
        passes=passes,
        pictures=[
            (CAPTIONS[name], picture((folder / f"{name}.png").read_bytes()))
            for name in (drawn[:2] if brief else drawn)
        ],
        brief=brief,
        versions=versions(),
    )


def _table(rows: Sequence[quantity_rows.Row], units: Units) -> dict[str, Any]:
    """Columns that have a value, and rows (quantity, unit, cells as text), of a table."""
    columns = quantity_rows.filled(rows)
    return {"columns": columns, "rows": quantity_rows.texts(rows, columns, units)}


def scene_rows(scene: Scene) -> list[tuple[str, Any]]:
    """Pairs (dotted key, value in N, mm, MPa, rad, s) of all keys of a scene whose value is not the
    default; files by their places in a result folder.
    """
    values = dict(dotted(portable(scene)))
    given = scene.model_dump(exclude_defaults=True, exclude_none=True)
    return [(key, keyed(key, values[key])) for key, _ in dotted(given)]


def check(name: str) -> str:
    """Words for the name of a check; an unknown name with blanks for underscores."""
    if name.startswith(SECOND):
        bare = name.removeprefix(f"{SECOND}_").rsplit("_", 1)[0].replace("_", " ")
        return f"second method (half-spaces): {'pressure' if bare == 'max' else bare}"
    return CHECKS.get(name, name.replace("_", " "))


def versions() -> dict[str, str]:
    """Versions by name of Python and of those used packages that state theirs."""
    found = {}
    for name in PACKAGES:
        with suppress(ImportError):  # Debian's have no metadata
            found[name] = version(name)
    return {"railhead": result_folder.VERSION} | found | {"Python": platform.python_version()}


def picture(png: bytes) -> str:
    """Base64 text of a PNG picture."""
    return base64.b64encode(png).decode()


def template(name: str) -> Any:
    """The Jinja template `name` of the report."""
    loader = PackageLoader("railhead.results.report", "templates")
    environment = Environment(loader=loader, undefined=StrictUndefined, autoescape=True)
    return environment.get_template(name)

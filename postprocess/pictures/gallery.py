"""The pictures of one result: what they show, the file that keeps it, and all that are drawn."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from railhead.theory.elastic.line import Hertz, LineContact

if TYPE_CHECKING:
    import meshio

    from railhead.postprocess.findings import Findings
    from railhead.postprocess.pass_rows import Passes
    from railhead.postprocess.pictures.diagrams import Drawing
    from railhead.postprocess.pictures.plastic_plots import Yielded
    from railhead.postprocess.symmetry import Planes
    from railhead.theory.friction.solution import FrictionSolution

MODULES = (
    "postprocess.findings",
    "postprocess.pass_rows",
    "postprocess.pictures.gallery",
    "postprocess.pictures.plastic_plots",
    "theory.elastic.hertz",
    "theory.elastic.line",
    "theory.friction.solution",
)
"""Modules whose dataclasses a file of `save` may hold."""
WITHOUT_STRESSES = "pressure.png", "patch.png"


@dataclass(frozen=True, kw_only=True)
class Shown:
    """What the pictures of one result show, but for the cells of the bodies.

    found: findings with the whole contact surface of one body, title, units and notes.
    exact: exact Hertz contact, or None; of finite elements a line contact only with a section.
    poisson: Poisson's ratio of the body of `found.axis`.
    axes: those along which the pressure of finite elements varies, 0 for x, 1 for s: both of a
        solid, one of a section.
    cut: unit normals of the symmetry planes at which the cells of solution.vtu were cut; none where
        that file holds the images.
    friction: tractions at contact points of the whole model; None without friction.
    yielded: what yield left; None where nothing yields.
    passes: passes over a rail that yields; None where there are none.
    """

    found: Findings
    exact: Hertz | None
    poisson: float
    axes: Sequence[int] = (0, 1)
    cut: Planes = ()
    friction: FrictionSolution | None = None
    yielded: Yielded | None = None
    passes: Passes | None = None


def save(shown: Shown, path: Path) -> None:
    """Write what pictures show into a .npz file: its arrays by their place in `Shown`, as
    "found.surface.pressure", and all else as JSON. OSError: it cannot be written.
    """
    arrays: dict[str, Any] = {}
    plain = json.dumps(_plain(shown, "", arrays), default=lambda value: value.item())  # of numpy
    np.savez_compressed(path, **arrays, plain=plain)


def load(path: Path) -> Shown:
    """Read what `save` wrote; tuples come back as lists. Raises ValueError (one line) for a
    file that is missing, damaged, or of another version of the program.
    """
    known = {
        name: value
        for module in MODULES
        for name, value in vars(import_module(f"railhead.{module}")).items()
        if is_dataclass(value)
    }
    try:
        with np.load(path) as file:
            shown = _restored(json.loads(str(file["plain"])), file, known)
        if not isinstance(shown, Shown):
            raise TypeError
    except Exception:  # the kind of error depends on the damaged part
        text = "is missing, damaged, or of another version; run the scene again for its pictures"
        raise ValueError(f"{path.name} {text}") from None
    return shown


def _plain(value: Any, place: str, arrays: dict[str, Any]) -> Any:
    """A value as JSON knows it: an array by its name in `arrays`, to which it is added, an object
    of a dataclass as a table of its fields and its class. place: names and numbers that lead to the
    value, a point behind each.
    """
    if isinstance(value, np.ndarray):
        arrays[place[:-1]] = value
        return {"array": place[:-1]}
    if is_dataclass(value):
        table = {each.name: getattr(value, each.name) for each in fields(value)}
        return {"class": type(value).__name__, **_plain(table, place, arrays)}
    if isinstance(value, list | tuple):
        return list(_plain(dict(enumerate(value)), place, arrays).values())
    if isinstance(value, Mapping):
        return {key: _plain(each, f"{place}{key}.", arrays) for key, each in value.items()}
    return value


def _restored(value: Any, arrays: Mapping[str, Any], known: Mapping[str, Any]) -> Any:
    """The value that `_plain` made this of, with tuples as lists. known: classes by name."""
    if isinstance(value, list):
        return [_restored(each, arrays, known) for each in value]
    if not isinstance(value, dict):
        return value
    if "array" in value:
        return arrays[value["array"]]
    held = {key: _restored(each, arrays, known) for key, each in value.items() if key != "class"}
    return known[value["class"]](**held) if "class" in value else held


def drawings(
    shown: Shown, cells: Callable[[], meshio.Mesh], friction: Mapping[str, Any]
) -> dict[str, Drawing]:
    """The pictures of one result by name of their PNG file. Nothing is drawn here. Pictures of the
    patch from above are those of a solid and of half-spaces that are no line contact.

    cells: returns the grid of the cells, with nodal stresses, images of what symmetry left out
        included; called by the pictures that need it. friction: "friction" of the result in
        summary.json, empty without friction.
    """
    from railhead.postprocess.pictures import diagrams, friction_plots, plastic_plots

    found, exact = shown.found, shown.exact
    every: dict[str, Drawing]
    if found.subject.method != "half-spaces":
        every = _of_bodies(shown, cells)
        if shown.yielded is not None:
            every["plastic.png"] = partial(plastic_plots.draw, shown.yielded, found, exact)
        if "p0_over_k" in friction:
            every["shakedown.png"] = partial(
                friction_plots.draw_shakedown, friction, shown.poisson, found.subject
            )
    elif isinstance(exact, LineContact):
        every = {"pressure.png": partial(diagrams.pressure, found, exact)}
    else:
        every = {"patch.png": partial(diagrams.patch, found, exact)}
    if shown.passes is not None:
        every["passes.png"] = partial(plastic_plots.draw_passes, shown.passes, found)
        if len(shown.passes.sections[-1].y) > 1:
            every["passes_section.png"] = partial(
                plastic_plots.draw_passes_section, shown.passes, found
            )
    if not found.largest:  # stresses were left out
        every = {name: draw for name, draw in every.items() if name in WITHOUT_STRESSES}
    if shown.friction is not None:
        every["friction.png"] = partial(friction_plots.draw_tractions, shown.friction, found)
    return every


def _of_bodies(shown: Shown, cells: Callable[[], meshio.Mesh]) -> dict[str, Drawing]:
    """Pictures of pressure and stress in meshed bodies; arguments as of `drawings`."""
    from railhead.postprocess.pictures import diagrams, render

    found, exact = shown.found, shown.exact

    def in_cells(draw: Callable[..., Any], *given: Any) -> Drawing:
        """A picture of the cells: draw(cells, *given, target)."""
        return lambda target: draw(cells(), *given, target)

    every: dict[str, Drawing] = {
        "pressure.png": partial(diagrams.pressure, found, exact),
        "depth.png": partial(diagrams.depth, found, exact, shown.poisson),
    }
    if len(shown.axes) == 1:
        (axis,) = shown.axes
        return every | {
            "wheel_rail.png": in_cells(render.section, axis, found),
            "stress_cut.png": in_cells(render.stresses_of_section, axis, found),
        }
    if found.subject.rolls:
        every["stress_cut_along.png"] = in_cells(render.stresses_of_solid, 0, found)
    return every | {
        "patch.png": partial(diagrams.patch, found, exact),
        "wheel_rail.png": in_cells(render.wheel_rail, found),
        "stress_cut.png": in_cells(render.stresses_of_solid, 1, found),
    }

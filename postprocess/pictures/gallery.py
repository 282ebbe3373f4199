"""The pictures of one result: what they show, the file of its arrays, and all that are drawn."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from railhead.theory.array_types import packed
from railhead.theory.elastic.line import Hertz, LineContact

if TYPE_CHECKING:
    import meshio

    from railhead.postprocess.findings import Array, Drawing, Findings
    from railhead.postprocess.pass_rows import Passes
    from railhead.theory.friction.solution import FrictionSolution


@dataclass(frozen=True, kw_only=True)
class Shown:
    """What the pictures of one result show, but for the cells of the bodies.

    found: findings with the whole contact surface of one body, title, units and notes.
    exact: exact Hertz contact, or None; of finite elements a line contact only with a section.
    poisson: Poisson's ratio of the body of `found.axis`.
    axes: those along which the pressure of finite elements varies, 0 for x, 1 for s: both of a
        solid, one of a section.
    friction: tractions at contact points of the whole model; None without friction.
    unloaded: whether bodies that yield were unloaded.
    passes: passes over a rail that yields; None where there are none.
    """

    found: Findings
    exact: Hertz | None
    poisson: float
    axes: Sequence[int] = (0, 1)
    friction: FrictionSolution | None = None
    unloaded: bool = False
    passes: Passes | None = None


def save(shown: Shown, path: Path) -> None:
    """Write the arrays of what pictures show into a .npz file, by their place in `Shown`, as
    "found.surface.pressure". OSError: it cannot be written.
    """
    path.write_bytes(packed(dict(_arrays(shown, ""))))


def _arrays(value: Any, place: str) -> Iterator[tuple[str, Array]]:
    """Names and arrays in a value: an array itself, or those in a dataclass, a table or a sequence.
    place: names and numbers that lead to the value, a point behind each.
    """
    parts: Mapping[Any, Any] = {}
    if isinstance(value, np.ndarray):
        yield place[:-1], value
    elif is_dataclass(value):
        parts = {each.name: getattr(value, each.name) for each in fields(value)}
    elif isinstance(value, list | tuple):
        parts = dict(enumerate(value))
    elif isinstance(value, Mapping):
        parts = value
    for name, part in parts.items():
        yield from _arrays(part, f"{place}{name}.")


def drawings(
    shown: Shown, cells: Callable[[], meshio.Mesh], friction: Mapping[str, Any]
) -> dict[str, Drawing]:
    """The pictures of one result by name of their PNG file. Nothing is drawn here. Pictures of the
    patch from above are those of a solid and of half-spaces that are no line contact.

    cells: returns the grid of the cells, with nodal stresses and, if they were unloaded, the von
        Mises stress that is left ("residual_von_mises"), images of what symmetry left out included;
        called by the pictures that need it. friction: "friction" and "yield" of the result in
        summary.json, and "fatigue" by its name.
    """
    from railhead.postprocess.pictures import diagrams, friction_plots, pass_plots

    found, exact, passes = shown.found, shown.exact, shown.passes
    meshed = found.subject.method != "half-spaces"
    line = isinstance(exact, LineContact) and not meshed
    every: dict[str, Drawing] = {}
    if meshed or line:
        every["pressure.png"] = partial(diagrams.pressure, found, exact)
    if len(shown.axes) == 2 and not line:
        every["patch.png"] = partial(diagrams.patch, found, exact)
    if meshed and found.largest:
        every |= _of_stresses(shown, cells)
    if "p0_over_k" in friction:
        every["shakedown.png"] = partial(
            friction_plots.draw_shakedown, friction, shown.poisson, found.subject
        )
    if "fatigue" in friction:
        every["fatigue.png"] = partial(
            friction_plots.draw_fatigue, friction["fatigue"], found.subject
        )
    rolled = passes.files if passes is not None and found.largest else {}
    for suffix, each in rolled.items():
        every[f"passes{suffix}.png"] = partial(pass_plots.draw_passes, each, found)
        if len(each.sections[-1].y) > 1:
            name = f"passes_section{suffix}.png"
            every[name] = partial(pass_plots.draw_passes_section, each, found)
    if shown.friction is not None:
        every["friction.png"] = partial(friction_plots.draw_tractions, shown.friction, found)
    return every


def _of_stresses(shown: Shown, cells: Callable[[], meshio.Mesh]) -> dict[str, Drawing]:
    """Pictures of meshed bodies and of the stresses in them; arguments as of `drawings`."""
    from railhead.postprocess.pictures import diagrams, render

    found, axis = shown.found, shown.axes[-1]

    def fringes(axis: int, shades: Sequence[render.Shade]) -> Drawing:
        """A picture of fields in a cut along an axis."""
        return lambda target: render.fringes(cells(), axis, shades, found, target)

    every: dict[str, Drawing] = {
        "depth.png": partial(diagrams.depth, found, shown.exact, shown.poisson),
        "wheel_rail.png": lambda target: render.bodies(cells(), axis, found, target),
        "stress_cut.png": fringes(axis, render.STRESSES),
    }
    if shown.unloaded:
        every["plastic.png"] = fringes(axis, render.YIELD)
    if found.subject.rolls and len(shown.axes) == 2:
        every["stress_cut_along.png"] = fringes(0, render.STRESSES)
    return every

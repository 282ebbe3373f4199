"""All pictures of one result."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

from railhead.meshing.bodies import RAIL
from railhead.postprocess.pictures.kept import Shown
from railhead.postprocess.pictures.plots import (
    diagrams,
    friction_plots,
    passes_plots,
    plastic_plots,
)
from railhead.postprocess.pictures.plots.diagrams import Drawing
from railhead.theory.elastic.line import LineContact

if TYPE_CHECKING:
    import meshio


def drawings(
    shown: Shown, cells: Callable[[], meshio.Mesh], steel: Mapping[str, Any]
) -> dict[str, Drawing]:
    """The pictures of one result by name of their PNG file. Nothing is drawn here. Pictures of the
    patch from above are those of a solid and of half-spaces that are no line contact.

    cells: returns the grid of the cells, with nodal stresses, images of what symmetry left out
        included; called by the pictures that need it. steel: "friction" of the result in
        summary.json, empty without friction.
    """
    found, exact = shown.found, shown.exact
    every: dict[str, Drawing]
    if found.subject.method != "half-spaces":
        every = _of_bodies(shown, cells)
        if shown.yielded is not None:
            every["plastic.png"] = partial(plastic_plots.draw, shown.yielded, found, exact)
        if "p0_over_k" in steel:
            given = steel, shown.poisson, found.subject
            every["shakedown.png"] = partial(friction_plots.draw_shakedown, *given)
    elif isinstance(exact, LineContact):
        every = {"pressure.png": partial(diagrams.pressure, found, exact)}
    else:
        every = {"patch.png": partial(diagrams.patch, found, exact)}
    if shown.passes is not None:
        every["passes.png"] = partial(passes_plots.draw, shown.passes, found)
        if len(shown.passes.sections[-1].y) > 1:
            every["passes_section.png"] = partial(passes_plots.draw_section, shown.passes, found)
    if shown.friction is not None:
        every["friction.png"] = partial(
            friction_plots.draw_tractions,
            shown.friction,
            found,
            shown.coefficient,
            planes=shown.planes,
        )
    return every


def _of_bodies(shown: Shown, cells: Callable[[], meshio.Mesh]) -> dict[str, Drawing]:
    """Pictures of pressure and stress in meshed bodies; arguments as of `drawings`."""
    from railhead.postprocess import vtu
    from railhead.postprocess.pictures.views import render, section_views

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
            "wheel_rail.png": in_cells(section_views.bodies, axis, found),
            "stress_cut.png": in_cells(section_views.stress_cut, axis, found),
        }
    if found.subject.rolls:
        every["stress_cut_along.png"] = in_cells(render.stress_cut, 0, found)
    contact = vtu.contact_grid({RAIL: found.surface})  # of any body: it is drawn without light
    return every | {
        "patch.png": partial(diagrams.patch, found, exact),
        "wheel_rail.png": in_cells(render.wheel_rail, found),
        "stress_cut.png": in_cells(render.stress_cut, 1, found),
        "patch_on_rail.png": partial(render.patch_on_rail, contact, found, exact),
    }

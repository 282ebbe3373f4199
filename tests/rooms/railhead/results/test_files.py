"""The files of a solved scene, and what they call it."""

from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from matplotlib.figure import Figure
from matplotlib.text import Text
from scipy.spatial import cKDTree
from solved import solved

from railhead.planning import simulation_plan
from railhead.results.subject import subject
from railhead.scene.catalogue import find


def saved(folder, case: str, *keys: str):
    solved(case, *keys).save(folder, pictures=False)
    return folder


def surfaces(folder):
    """By body."""
    file = pv.read(folder / "contact.vtu")
    return {
        int(body): file.extract_cells(file["body"] == body).extract_surface(
            nonlinear_subdivision=0, algorithm="dataset_surface"
        )
        for body in np.unique(file["body"])
    }


def carried(surface) -> float:
    """N, down."""
    cells = surface.point_data_to_cell_data().compute_cell_sizes(length=False, volume=False)
    down = np.abs(surface.compute_normals(point_normals=False)["Normals"][:, 2])
    return float(cells["pressure"] @ (cells["Area"] * down))


def test_both_surfaces_meet_under_the_same_pressure(tmp_path) -> None:
    """A 54E1 head and a wheel, warped by their displacement: 22 um apart before."""
    found = surfaces(saved(tmp_path / "out", "uic54_thesis", "mesh.patch_size=1.2"))
    assert set(found) == {1, 2}
    rail, wheel = (found[body].warp_by_vector("displacement") for body in (1, 2))
    for surface in (rail, wheel):
        assert carried(surface) == pytest.approx(25e3, rel=0.02)
        on = surface["status"] == 1
        assert np.array_equal(on, surface["pressure"] > 0)
        assert np.abs(surface["gap"][on]).max() < 3e-4
        assert surface["gap"].min() > -3e-4
    assert rail["pressure"].max() == pytest.approx(wheel["pressure"].max(), rel=0.01)
    for one, other in ((rail, wheel), (wheel, rail)):
        near = one["gap"] < 0.05
        apart = pv.PolyData(one.points[near]).compute_implicit_distance(other)
        assert np.abs(apart["implicit_distance"]) == pytest.approx(one["gap"][near], abs=1e-3)


def test_gaps_far_from_the_contact_are_those_of_the_surfaces(tmp_path) -> None:
    """Of two cylinders side on, whose surfaces turn away from each other: no gap is less than the
    distance to the other cylinder, nor falls away from the contact."""
    found = pv.read(saved(tmp_path / "out", "two_cylinders") / "contact.vtu")
    moved = (found.points + found["displacement"])[:, 1:]
    for body, other in ((1, 2), (2, 1)):
        parts = [found.extract_cells(found["body"] == each) for each in (body, other)]
        own, opposite = (np.unique(part["vtkOriginalPointIds"]) for part in parts)
        line = moved[opposite[np.argsort(moved[opposite, 0])]]
        y = np.linspace(line[0, 0], line[-1, 0], 4001)
        apart = cKDTree(np.column_stack([y, np.interp(y, *line.T)])).query(moved[own])[0]
        gap, away = found["gap"][own], np.abs(moved[own, 0])
        assert (gap > 0.98 * apart - 0.01).all()
        assert np.diff(gap[np.argsort(away)]).min() > -0.02 and away.max() > {1: 5.0, 2: 6.5}[body]


def test_a_section_is_written_as_two_lines_and_a_rigid_body_not_at_all(tmp_path) -> None:
    """A section has two lines; of a rigid plane there is no surface."""
    strip = pv.read(saved(tmp_path / "strip", "long_roller") / "contact.vtu")
    parts = [strip.extract_cells(strip["body"] == body) for body in (1, 2)]
    assert strip.celltypes.tolist() == [pv.CellType.LINE] * strip.n_cells
    tops = [part["pressure"].max() for part in parts]
    assert tops[0] == pytest.approx(tops[1], rel=1e-3)
    for part in parts:
        assert part.bounds[0] == pytest.approx(-part.bounds[1])
        assert np.abs(part["gap"][part["status"] == 1]).max() < 1e-4 < part["gap"].max()
    sphere = saved(tmp_path / "sphere", "sphere_on_plane")
    assert set(pv.read(sphere / "contact.vtu")["body"]) == {2}


ROLLS = ("friction.coefficient=0.3", "rolling.creepage_along=0.1%")


@pytest.mark.parametrize(
    ("case", "assignments", "pictures"),
    [
        ("sphere_on_plane", (), {"patch.png"}),
        ("long_roller", ("rail.extent=half-space",), {"pressure.png"}),
        pytest.param("hertz_ellipse", ROLLS, {"patch.png", "friction.png"}, marks=pytest.mark.slow),
    ],
)
def test_half_spaces_are_drawn_without_bodies(
    case: str,
    assignments: tuple[str, ...],
    pictures: set[str],
    tmp_path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """And no word in their pictures names finite elements."""
    words: list[str] = []
    own = Figure.savefig

    def spy(self: Figure, *args: object, **options: object) -> None:
        own(self, *args, **options)
        words.extend(text.get_text() for text in self.findobj(Text))

    monkeypatch.setattr(Figure, "savefig", spy)
    solved(case, "effects.finite_bodies=off", *assignments).save(tmp_path / "out", report=False)
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {name for name in names if name.endswith(".png")} == pictures
    assert not [name for name in names if name.endswith(".vtu")]
    said = " ".join(words)
    assert "half-spaces" in said
    assert "finite element" not in said and "FE" not in said.split()


BAN = str(Path(__file__).parents[1] / "geometry" / "data" / "MBench_UIC60_v3.ban")
TITLES = {
    "rolls with friction": (
        "uic54_thesis", ("friction.coefficient=0.3", "rolling.creepage_along=0.1%"),
        "25 kN, wheel R 420 mm, tread cylinder, on rail 54E1, friction 0.3",
    ),
    "a file": ("s1002_60e1", (f"rail.profile={BAN}", "rail.inclination=0"),
               "tread S1002, on rail MBench_UIC60_v3.ban"),
    "arcs": ("sphere_on_plane", (),
             "wheel R 8 mm, tread R 8 mm, on rail R inf mm, as half-spaces"),
}  # fmt: skip


@pytest.mark.parametrize(("case", "keys", "end"), TITLES.values(), ids=TITLES)
def test_a_title_says_load_pair_and_friction(case: str, keys: tuple[str, ...], end: str) -> None:
    found = subject(simulation_plan.make(find(case).replace(keys)), 25e3)
    assert found.title.replace("\N{NO-BREAK SPACE}", " ").endswith(end)
    assert found.gauge == found.label(1).endswith("field side)") == (case != "sphere_on_plane")
    assert (found.rolls and found.has_friction) == ("friction" in end)

"""The files of a solved scene, and what they call it."""

from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from matplotlib.figure import Figure
from matplotlib.text import Text
from solved import solved

from railhead.planning import simulation_plan
from railhead.results.files import subject
from railhead.scene.catalogue import find


def saved(folder, case: str, *keys: str):
    solved(case, *keys).save(folder, pictures=False)
    return folder


def carried(surface) -> float:
    """N, down."""
    cells = surface.point_data_to_cell_data().compute_cell_sizes(length=False, volume=False)
    down = np.abs(surface.compute_normals(point_normals=False)["Normals"][:, 2])
    return float(cells["pressure"] @ (cells["Area"] * down))


def test_the_surface_carries_the_load_and_meets_the_other(tmp_path) -> None:
    """A 54E1 head under a wheel; of the body that `plan.slave` names."""
    folder = saved(tmp_path / "out", "uic54_thesis", "mesh.patch_size=1.2")
    surface = pv.read(folder / "contact.vtu").extract_surface(
        nonlinear_subdivision=0, algorithm="dataset_surface"
    )
    assert carried(surface) == pytest.approx(25e3, rel=0.02)
    on = surface["status"] == 1
    assert np.array_equal(on, surface["pressure"] > 0) and np.abs(surface["gap"][on]).max() < 3e-4
    assert surface["gap"].min() > -3e-4


def test_gaps_do_not_fall_away_from_the_contact(tmp_path) -> None:
    """Of two cylinders side on, whose surfaces turn away from each other; on a line."""
    found = pv.read(saved(tmp_path / "out", "two_cylinders") / "contact.vtu")
    assert found.celltypes.tolist() == [pv.CellType.LINE] * found.n_cells
    assert found.bounds[2] == pytest.approx(-found.bounds[3])
    away = np.abs((found.points + found["displacement"])[:, 1])
    assert np.diff(found["gap"][np.argsort(away)]).min() > -0.02 and away.max() > 5.0
    assert np.abs(found["gap"][found["status"] == 1]).max() < 1e-3 < found["gap"].max()


ROLLS = ("friction.coefficient=0.3", "rolling.creepage_along=0.1%")


@pytest.mark.parametrize(
    ("case", "assignments", "pictures"),
    [
        ("sphere_on_plane", (), {"patch.png"}),
        ("long_roller", ("rail.extent=half-space",), {"fatigue.png", "pressure.png"}),
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
    assert "half-spaces" in said and "finite element" not in said and "FE" not in said.split()


BAN = str(Path(__file__).parents[1] / "geometry" / "data" / "MBench_UIC60_v3.ban")
TITLES = {
    "rolls with friction": (
        "uic54_thesis", ("friction.coefficient=0.3", "rolling.creepage_along=0.1%"),
        "25 kN, wheel R 420 mm, tread cylinder, on rail 54E1, friction 0.3",
    ),
    "a file": ("s1002_60e1", (f"rail.profile={BAN}", "rail.inclination=0"),
               "tread S1002, on rail MBench_UIC60_v3.ban"),
    "arcs": ("sphere_on_plane", (),
             "wheel R 8 mm, tread R 8 mm, on rail flat, as half-spaces"),
}  # fmt: skip


@pytest.mark.parametrize(("case", "keys", "end"), TITLES.values(), ids=TITLES)
def test_a_title_says_load_pair_and_friction(case: str, keys: tuple[str, ...], end: str) -> None:
    found = subject(simulation_plan.make(find(case).replace(keys)), 25e3)
    assert found.title.replace("\N{NO-BREAK SPACE}", " ").endswith(end)
    assert found.gauge == found.label(1).endswith("field side)") == (case != "sphere_on_plane")
    assert (found.rolls and found.has_friction) == ("friction" in end)

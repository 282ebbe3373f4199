"""Pictures as an engineer reads them: all of it within the sheet, numbers and places true."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.quiver import QuiverKey
from matplotlib.text import Text

from railhead.postprocess.findings import OnePatch, Subject, Units
from railhead.postprocess.pictures import diagrams, friction_plots, render, sweep_plots

TITLE = "a case of many words: 110.3 kN, wheel R 420 mm, tread cone20, on rail 54E1, half-spaces"


@pytest.fixture()
def sheets(laid_out: None, monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    """Every figure that would be written, laid out."""
    seen: list[Figure] = []

    def spy(self: Figure, *_: Any, **__: Any) -> None:
        self.draw_without_rendering()
        seen.append(self)

    monkeypatch.setattr(Figure, "savefig", spy)
    return seen


def cut_off(figure: Figure) -> list[str]:
    """Texts that are not within the figure."""
    renderer = FigureCanvasAgg(figure).get_renderer()
    page = figure.bbox
    found = []
    for text in cast("list[Text]", figure.findobj(Text)):
        number = not text.get_text().strip("\N{MINUS SIGN}-.0123456789 ")
        if number or not text.get_visible():  # ticks beyond the limits of axes stay undrawn
            continue
        axes = text.axes
        if axes is not None and text in axes.texts and text.get_clip_on():
            continue  # what is left of it is the picture's
        box = text.get_window_extent(renderer)
        within = box.x0 > -1 and box.y0 > -1 and box.x1 < page.x1 + 1 and box.y1 < page.y1 + 1
        if not within:
            found.append(text.get_text())
    return found


def two_patches(case: Any) -> Any:
    """The same findings with a second, higher loaded patch 14 mm towards the gauge."""
    patch = case.findings.patch
    first = patch.outlines[0]
    second = first * [1.0, 0.15] - [0.0, 14.0]
    each = [
        OnePatch(
            centre=(0.0, s, 0.0),
            angle=0.0,
            a=patch.a,
            b=b,
            area=patch.area,
            max_pressure=p,
            share=0.5,
        )
        for s, b, p in ((0.0, patch.b, patch.max_pressure), (-14.0, 0.15 * patch.b, 2000.0))
    ]
    subject = Subject(TITLE, gauge=True)
    several = replace(patch, outlines=[first, second], each=tuple(each), max_pressure=2000.0)
    return replace(case.findings, patch=several, subject=subject)


def test_all_patches_are_in_every_picture(blocks, sheets: list[Figure], tmp_path) -> None:
    case = blocks(cut=False)
    found = two_patches(case)
    volume = case.volume
    render.bodies(volume, 1, found, tmp_path / "w.png")
    render.fringes(volume, 1, render.STRESSES, found, tmp_path / "s.png")
    diagrams.patch(found, None, tmp_path / "p.png")
    diagrams.depth(found, case.ellipse, 0.3, tmp_path / "d.png")
    assert not any(map(cut_off, sheets))
    places = (1, 0, 0)  # of the panel
    for figure, place in zip(sheets[:3], places, strict=True):
        axes = figure.axes[place]
        lines = [line for line in axes.lines if len(line.get_xydata()) > 1]
        assert len(lines) >= 2
        for line in lines:
            x, y = np.asarray(line.get_xydata()).T
            (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
            assert left <= x.min() and x.max() <= right and low <= y.min() and y.max() <= high


def test_a_cut_along_the_rail_says_where_it_is(blocks, sheets: list[Figure], tmp_path) -> None:
    case = blocks(cut=False)
    found = two_patches(case)
    found = replace(found, along=replace(found.along, at=0.5))
    render.fringes(case.volume, 0, render.STRESSES, found, tmp_path / "s.png")
    (figure,) = sheets
    assert figure.axes[0].get_xlabel() == found.subject.label(0)
    edges = [line for line in figure.axes[0].lines if line.get_gid() == "contact patch"]
    assert len(edges) == 1  # of the patch that is cut
    legend = figure.subfigs[1].legends[0] if figure.subfigs else figure.legends[0]
    assert legend.get_texts()[-1].get_text().endswith("cut at s = 0.5 mm") and not cut_off(figure)


@pytest.mark.parametrize(
    ("values", "ends"),
    [
        ((-300.0, 0.0), (-300, 0)), ((-300.0, -120.0), (-300, 0)), ((110.0, 428.0), (0, 440)),
        ((-100.0, 200.0), (-100, 200)), ((0.0, 0.0), (0, 1)),
    ],
)  # fmt: skip
def test_bands_hold_zero_and_all_values_and_little_more(values, ends) -> None:
    levels = diagrams.levels(Units(), "MPa", np.array(values), 12)
    assert np.all(np.diff(levels) > 0) and np.abs(levels).min() < 1e-9
    assert (levels[0], levels[-1]) == pytest.approx(ends, abs=1e-9)


def test_the_cross_of_the_largest_shear_is_whole_and_explained(blocks) -> None:
    case = blocks()
    axes = diagrams.depth(case.findings, case.ellipse, 0.3).axes[1]
    assert axes.get_xlim()[1] > 1.05 * 0.3 * case.ellipse.p0 and "+ its peak" in axes.get_xlabel()


def rubbed(case: Any, centre: float) -> tuple[Any, Any]:
    """Points of a patch whose middle is at s = centre, half of them sliding, and its findings."""
    a, b = case.ellipse.a, case.ellipse.b
    grid = np.stack(np.meshgrid(np.linspace(-1, 1, 60), np.linspace(-1, 1, 60)), axis=-1)
    local = grid.reshape(-1, 2)
    local = local[np.hypot(*local.T) < 1] * [a, b] + [0.0, centre]
    points = np.column_stack([local, np.zeros(len(local))])
    pressure = np.asarray(case.ellipse.pressure(local[:, 0], local[:, 1] - centre))
    traction = np.column_stack([0.1 * pressure, np.zeros_like(pressure), np.zeros_like(pressure)])
    patch = case.findings.patch
    moved = replace(patch, centre=(0.0, centre), outlines=[patch.outlines[0] + [0.0, centre]])
    rubbing = SimpleNamespace(
        points=points,
        pressure=pressure,
        bound=0.3 * pressure,
        traction=traction,
        sticks=local[:, 0] > 0,
        rise_rail=None,
    )
    return rubbing, replace(case.findings, patch=moved, subject=Subject(TITLE, gauge=True))


def test_tractions_are_where_they_act_and_have_a_scale(
    blocks,
    sheets: list[Figure],
    tmp_path,
) -> None:
    rubbing, found = rubbed(blocks(), centre=-1.7)
    friction_plots.draw_tractions(rubbing, found, tmp_path / "f.png")
    axes = sheets[0].axes[0]
    (key,) = axes.findobj(QuiverKey)
    slips, sticks = (path.vertices for path in axes.collections[0].get_paths())
    s = np.concatenate([slips, sticks])[:, 1]
    assert (s.min() + s.max()) / 2 == pytest.approx(-1.7, abs=0.05)
    assert slips[:, 0].mean() < 0 < sticks[:, 0].mean()
    dark, light = (color[:3].mean() for color in axes.collections[0].get_facecolor())
    assert light > dark + 0.2  # told apart without colours
    lines = sheets[0].axes[1].get_lines()
    assert len(lines) == 4 and {line.get_marker() for line in lines} == {"None"}
    for largest in (np.nanmax(np.abs(lines[2].get_ydata())), 0.1 * found.patch.max_pressure):
        assert largest == pytest.approx(key.U, rel=0.5)
    assert "MPa" in key.label and not cut_off(sheets[0])


def test_what_yields_is_drawn_in_percent_and_nothing_as_none(blocks) -> None:
    """The data of cells is drawn at nodes; a field of zeros has the lowest colour."""
    case = blocks(cut=False)
    grid = case.volume
    middles = grid.points[grid.cells[0].data].mean(axis=1)
    grid.cell_data["equivalent_plastic_strain"] = [np.where(middles[:, 2] < 0, 0.02, 0.0)]
    grid.point_data["residual_von_mises"] = np.zeros(len(grid.points))
    strain, stress, *bars = render.fringes(grid, 1, render.YIELD, case.findings).axes
    assert [axes.collections[0].get_clim()[0] for axes in (strain, stress)] == [0.0, 0.0]
    assert [text.get_text() for text in strain.texts] == ["rail", "wheel"]
    assert bars[0].get_xlabel() == "equivalent plastic strain, %"
    assert bars[0].get_xlim()[1] == pytest.approx(2.0, rel=0.1)


def test_sweeps_and_the_shakedown_map_say_what_they_are_of(sheets: list[Figure], tmp_path) -> None:
    rows = [
        {"load [N]": n, "checks": "passed"} | dict.fromkeys(sweep_plots.PANELS, float(n))
        for n in (1, 2)
    ]
    subject = Subject(TITLE)
    sweep_plots.curves(["load [N]"], rows, subject, tmp_path / "c.png")
    friction = {
        "traction_coefficient": 0.1,
        "p0_over_k": 3.0,
        "first_yield_p0_over_k": 3.2,
        "shakedown_limit_p0_over_k": 3.5,
        "shakedown": "elastic",
        "load_N": 1e4,
        "load_over_first_yield": (3.0 / 3.2) ** 3,
    }
    friction_plots.draw_shakedown(friction, 0.3, subject, tmp_path / "s.png")
    for figure in sheets:
        said = " ".join(text.get_text() for part in figure.subfigs for text in part.texts)
        assert " ".join(said.split()) in (TITLE, f"{TITLE} bars: estimated errors")
        assert not cut_off(figure)


def test_dollars_in_a_title_are_no_formula(tmp_path) -> None:
    """Names of files may have them; as a formula $_$ is an error of matplotlib."""
    with diagrams.new_figure(tmp_path / "a.png", 4, 3, Subject("r$_$2.csv on a rail")):
        pass
    assert (tmp_path / "a.png").is_file()
    assert sweep_plots._word({"file": "r$_$.csv"}, "file", Units()) == r"r\$_\$.csv"


def test_axes_and_numbers_are_in_the_readers_units(blocks) -> None:
    """Ticks at round inches and ksi, over curves that stay where they are in mm and MPa."""
    case = blocks()
    units = Units({"mm": "in", "MPa": "ksi", "um": "in"})
    found = replace(case.findings, subject=Subject(TITLE, units=units))
    plain, shown = (diagrams.pressure(each, case.ellipse) for each in (case.findings, found))
    left, other = plain.axes[0], shown.axes[0]
    assert np.array_equal(left.lines[0].get_xydata(), other.lines[0].get_xydata())
    assert other.get_xlabel() == "x, along the rail, in"
    assert other.get_ylabel() == "contact pressure, ksi"
    place = other.yaxis.get_major_locator()()[1]
    text = other.yaxis.get_major_formatter()(place, 1)
    assert float(text) == pytest.approx(place * 0.1450377377, rel=1e-6) and len(text) < 5
    label = other.get_legend_handles_labels()[1][1]
    assert f"largest pressure {case.ellipse.p0 * 0.1450377377:.4g} ksi" in label
    limits = diagrams.levels(units, "MPa", np.array([1000.0])) * 0.1450377377
    assert limits == pytest.approx(np.round(limits, 6))

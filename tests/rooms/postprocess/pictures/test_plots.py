"""The diagrams: what they show, that they are whole, and that no state leaks."""

from dataclasses import replace

import matplotlib
import numpy as np
import pytest
from matplotlib.image import imread
from solved import solved

import railhead as rh
from railhead.postprocess.findings import OnePatch
from railhead.postprocess.pictures import diagrams


def test_pictures_show_hertz_only_where_there_is_one(blocks) -> None:
    case = blocks(cut=False)
    for hertz in (case.ellipse, None):
        figures = (
            diagrams.pressure(case.findings, hertz),
            diagrams.depth(case.findings, hertz, 0.3),
            diagrams.patch(case.findings, hertz),
        )
        for figure, exact in zip(figures, (diagrams.HERTZ, diagrams.HERTZ, "black"), strict=True):
            colours = {line.get_color() for axes in figure.axes for line in axes.lines}
            assert diagrams.FE in colours and (exact in colours) == (hertz is not None)


@pytest.mark.parametrize(("radii", "wide"), [((420.0, 33.0), True), ((33.0, 420.0), False)])
def test_slender_patches_shape_the_picture(blocks, radii: tuple[float, float], wide: bool) -> None:
    case = blocks(radii=radii)
    width, height = diagrams.patch(case.findings, case.ellipse).figure.get_size_inches()
    assert (width > 1.8 * height) if wide else (height > 1.2 * width)


def test_nothing_touches_the_edge_and_no_setting_stays(blocks, tmp_path, laid_out: None) -> None:
    before = dict(matplotlib.rcParams)
    case = blocks(load=5.0)
    diagrams.pressure(case.findings, case.ellipse, tmp_path / "1.png")
    diagrams.depth(case.findings, case.ellipse, 0.3, tmp_path / "2.png")
    diagrams.patch(case.findings, case.ellipse, tmp_path / "3.png")
    assert dict(matplotlib.rcParams) == before
    for path in tmp_path.glob("*.png"):
        picture = imread(path)[:, :, :3]
        picture[2:-2, 2:-2] = 1.0  # all but the rim
        assert picture.min() == 1.0


def test_a_cut_through_one_of_several_patches_says_so(blocks) -> None:
    case = blocks()
    patch = case.findings.patch
    of = {"centre": (0.0, 0.0, 0.0), "angle": 0.0, "a": 1.0, "b": 1.0, "area": 1.0}
    one = OnePatch(**of, max_pressure=patch.max_pressure, share=0.5)
    below = (case.findings.depth["rail"],)  # the other patch
    two = replace(case.findings, patch=replace(patch, each=(one, one)), also=below)
    for shown, count, place in ((case.findings, 0, "patch"), (two, 2, "most loaded patch")):
        titles = [axes.get_title() for axes in diagrams.pressure(shown, None).axes]
        assert sum("most loaded of 2 patches" in title for title in titles) == count
        panel = diagrams.depth(shown, case.ellipse, 0.3).axes[0]
        assert f"below the middle of the {place}, mm" in panel.get_ylabel()


FLAT = ("hertz_ellipse", "friction.coefficient=0.3", "friction.force_along=1kN",
        "mesh.patch_size=0.9", "effects.finite_bodies=off")  # fmt: skip


@pytest.mark.parametrize("scene", [FLAT, ("long_roller", "mesh.patch_size=1.2")])
def test_arrays_have_names_and_are_of_the_whole_patch(scene: tuple[str, ...], tmp_path) -> None:
    solved(*scene).save(tmp_path / "out", pictures=False)
    arrays, result = np.load(tmp_path / "out" / "pictures.npz"), rh.load(tmp_path / "out")
    assert arrays["found.surface.pressure"].max() == pytest.approx(result.pressure.max, rel=0.02)
    low, high = (getattr(arrays["found.surface.points"][:, 0], end)() for end in ("min", "max"))
    assert low == pytest.approx(-high) and high > result.patch.a
    assert ("friction.traction" in arrays) == (scene is FLAT)
    with pytest.raises(ValueError, match="loaded"):
        result.plot("pressure")

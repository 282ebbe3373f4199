"""Pictures of a run that are drawn again from its folder."""

import shutil
from pathlib import Path

import command
import matplotlib.image
import numpy as np
import pytest
from solved import solved

import railhead as rh
from railhead.results.report import output_units

YIELDS = ("sphere_on_plane", "wheel.yield_stress=20")  # a meridian section
SOLID = ("hertz_ellipse", "mesh.patch_size=2")
FLAT = ("hertz_ellipse", "friction.coefficient=0.3", "friction.force_along=1kN",
        "mesh.patch_size=0.9", "effects.finite_bodies=off")  # fmt: skip
LINE = ("long_roller", "mesh.patch_size=1.2")
KINDS = {"yields": YIELDS, "solid": SOLID, "half-spaces": FLAT, "line": LINE}


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(
            given, id=kind, marks=[pytest.mark.slow] if kind in ("yields", "solid") else []
        )
        for kind, given in KINDS.items()
    ],
)
def kept(request: pytest.FixtureRequest, tmp_path_factory) -> Path:
    """The folder of a result with its pictures."""
    folder = tmp_path_factory.mktemp("kept") / "out"
    solved(*request.param).save(folder, report=False)
    return folder


def test_pictures_are_drawn_again_as_they_were(kept: Path, tmp_path: Path, capsys) -> None:
    """Pixel by pixel, by the names that the run had; a later run may replace them."""
    out = tmp_path / "out"
    shutil.copytree(kept, out)
    names = sorted(path.name for path in out.glob("*.png"))
    for path in out.glob("*.png"):
        path.unlink()
    listed = (out / ".railhead").read_text()
    (out / ".railhead").write_text(listed.replace(names[0], ""))
    assert command.status("show", str(out), "--pictures") == 0
    assert f"drawn: {', '.join(names)}" in " ".join(capsys.readouterr().out.split())
    assert len(names) >= 2
    for name in names:
        first, again = (matplotlib.image.imread(folder / name) for folder in (kept, out))
        assert np.array_equal(first, again), name
    assert set((out / ".railhead").read_text().split()) == set(listed.split())


def test_a_loaded_result_draws_in_units(kept: Path) -> None:
    """Labels have the other unit, curves stay where they are."""
    loaded = rh.load(kept)
    name = "friction" if "friction.png" in loaded.drawings() else "depth"
    plain = loaded.plot(name)
    inches = loaded.drawings(output_units.parse("in,ksi"))[f"{name}.png"](None)
    for axes, other in zip(plain.axes, inches.figure.axes, strict=True):
        assert axes.get_xlabel().replace("MPa", "ksi").replace("mm", "in") == other.get_xlabel()
        for line, same in zip(axes.lines, other.lines, strict=True):
            assert np.array_equal(line.get_xydata(), same.get_xydata(), equal_nan=True)


def test_arrays_of_the_file_have_names_and_are_of_the_whole_patch(kept: Path) -> None:
    arrays, result = np.load(kept / "pictures.npz"), rh.load(kept)
    assert arrays["found.surface.pressure"].max() == pytest.approx(result.pressure.max, rel=0.02)
    low, high = (getattr(arrays["found.surface.points"][:, 0], end)() for end in ("min", "max"))
    assert low == pytest.approx(-high) and high > result.patch.a
    assert not [name for name in arrays.files if name.startswith("arr_")]


def test_what_cannot_be_drawn_is_a_line(tmp_path: Path, capsys) -> None:
    """A file that is gone takes the pictures that need it; a damaged one all of them."""
    out = tmp_path / "out"
    solved(*LINE).save(out, pictures=False)
    for spoil in (lambda path: path.write_bytes(b""), Path.unlink):
        spoil(out / "solution.vtu")
        assert command.status("show", str(out), "--pictures", "--json") == 1
        lines = capsys.readouterr().err.splitlines()
        assert len(lines) == 2 and all("NOT WRITTEN: " in line for line in lines)
    assert {path.stem for path in out.glob("*.png")} == {"depth", "pressure"}
    content = (out / "pictures.npz").read_bytes()
    for damaged in (content[: len(content) // 2], b"", content[:99] + b"?" * 99 + content[198:]):
        (out / "pictures.npz").write_bytes(damaged)
        line = command.refused(capsys, "show", str(out), "--pictures")
        assert "--pictures: pictures.npz is missing, damaged, or of another version; run" in line
    (out / "pictures.npz").unlink()
    assert "is missing" in command.refused(capsys, "show", str(out), "--pictures")
    with pytest.raises(ValueError, match="pictures.npz is missing"):
        rh.load(out).plot("pressure")

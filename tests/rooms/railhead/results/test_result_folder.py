"""The result folder: only what railhead wrote is ever replaced."""

import os
from pathlib import Path

import command
import numpy as np
import pytest
from one_line import refusal
from solved import solved

import railhead as rh
from railhead.postprocess import vtu
from railhead.postprocess.pictures import gallery
from railhead.results import files, result_folder

FAST = ["--set", "mesh.patch_size=1.2", "--no-pictures", "--quiet"]


def write(folder: Path, text: str, *names: str) -> None:
    with result_folder.replacing(folder) as work:
        for name in names or ("summary.json", "scene.toml"):
            (work / name).write_text(text)


def refused(folder: Path) -> str:
    line = refusal(lambda: result_folder.check_folder(folder))
    assert line.startswith("folder: ")
    return line


def run(*arguments: str) -> int:
    return command.status("run", *arguments, *FAST)


def test_a_scene_beside_its_result_survives(tmp_path: Path, capsys) -> None:
    """Refused before anything is computed; nothing is touched."""
    folder = tmp_path / "r1"
    write(folder, "old")
    scene = folder / "mine.toml"
    scene.write_text("load = 25000\n")
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    line = command.refused(capsys, "run", str(scene), "--out", str(folder), *FAST)
    assert "'mine.toml'" in line
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


def test_what_comes_while_it_computes_is_kept(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    write(folder, "old")
    with result_folder.replacing(folder) as work:
        (work / "summary.json").write_text("new")
        (folder / "mine.txt").write_text("mine")
    assert (folder / "mine.txt").read_text() == "mine"
    assert (folder / "summary.json").read_text() == "new" and os.listdir(tmp_path) == ["out"]


@pytest.mark.parametrize(
    "names", [("summary.json", "scene.toml", "depth.png"), ("page.md", "scaling.csv"),
              ("summary.json",)],
)  # fmt: skip
def test_known_names_alone_are_no_result(names: tuple[str, ...], tmp_path: Path) -> None:
    """Nothing that this program did not list in a manifest of its own is replaced."""
    folder = tmp_path / "out"
    write(folder, "mine", *names)
    (folder / result_folder.MANIFEST).unlink()
    assert repr(sorted(names)[0]) in refused(folder) and sorted(os.listdir(folder)) == sorted(names)


def test_the_working_directory_stays(here: Path, capsys) -> None:
    number = here.stat().st_ino
    for name in (".", str(here), f"../{here.name}"):
        assert run("hertz_ellipse", "--out", name) == 2
        assert "working directory" in capsys.readouterr().err
    assert "mount point" in refused(Path("/proc"))
    assert here.stat().st_ino == number and os.listdir(".") == []


def test_a_link_is_followed(tmp_path: Path) -> None:
    (tmp_path / "disk").mkdir()
    target, link = tmp_path / "disk" / "target", tmp_path / "link"
    target.mkdir()
    link.symlink_to("disk/target")
    for _ in range(2):
        result_folder.check_folder(link)
        write(link, "new")
        assert os.readlink(link) == "disk/target" and (target / "summary.json").read_text() == "new"
    assert os.listdir(tmp_path / "disk") == ["target"]


def test_links_to_nothing_and_folders_in_files_are_refused(tmp_path: Path) -> None:
    link, loop, file = tmp_path / "link", tmp_path / "loop", tmp_path / "file"
    link.symlink_to("gone")
    loop.symlink_to("loop")
    file.write_text("")
    assert "is a link to nothing" in refused(link) and "is a link to nothing" in refused(loop)
    assert "is a file" in refused(file) and "cannot be written to" in refused(file / "out")
    assert "File name too long" in refused(tmp_path / ("x" * 300))


def fails(*given, **_) -> None:
    """Writes half of a file, if it gets one."""
    if isinstance(given[0], Path):
        given[0].write_text("half")
    raise RuntimeError("no\nroom")


@pytest.mark.parametrize(
    ("module", "name", "said", "gone", "kept"),
    [
        (None, "", "depth.png", {"depth.png"}, {"summary.json", "pressure.png"}),
        (vtu, "write", "*.vtu", {"solution.vtu"}, {"summary.json", "pressure.png"}),
        (files, "subject", "pictures.npz", {"pictures.npz", "pressure.png"},
         {"summary.json", "solution.vtu"}),
    ],
    ids=["a picture", "fields", "what pictures show"],
)  # fmt: skip
def test_a_file_that_fails_takes_no_other(
    module, name, said, gone, kept, tmp_path: Path, monkeypatch
) -> None:
    """A disk too full for .vtu files has room for pictures."""
    drawn = {"depth.png": Path.touch if module else fails, "pressure.png": Path.touch}
    monkeypatch.setattr(gallery, "drawings", lambda *_: drawn)
    if module:
        monkeypatch.setattr(module, name, fails)
    line = refusal(lambda: solved("sphere_on_plane").save(tmp_path / "out", report=False), OSError)
    assert line.endswith(f"out/{said}: RuntimeError: no room")
    names = set(os.listdir(tmp_path / "out"))
    assert kept < names and not gone & names


def test_another_result_is_never_replaced_unasked(here: Path, capsys) -> None:
    """Another scene, another command, a scene.toml edited inside, a sweep."""
    result, out = solved("sphere_on_plane"), Path("out")
    for _ in range(2):
        result.save(out, pictures=False)
    kept = (out / "scene.toml").read_text()
    assert kept.startswith(f"# railhead run {rh.__version__}, 20") and "N, mm, MPa" in kept
    assert "another kind of result" in refusal(
        lambda: result_folder.check_free(out, "locate", result.plan.scene, force=False)
    )
    # Another size of the elements.
    line = command.refused(capsys, "run", "sphere_on_plane", "--out", "out", *FAST)
    assert "--out: 'out' holds a result of another scene" in line and "--force" in line
    (out / "scene.toml").write_text(kept.replace("[rail]", "# mine\n[rail]"))
    assert "or an edited scene.toml" in refusal(lambda: result.save(out, pictures=False))
    result.save(out, pictures=False, force=True)
    assert "mine" not in (out / "scene.toml").read_text()
    write(Path("swept"), "{}", "sweep.json")
    assert "another kind of result" in refusal(lambda: result.save("swept", pictures=False))


def test_without_out_another_result_is_moved(here: Path, capsys) -> None:
    solved("sphere_on_plane").save("results/sphere_on_plane", pictures=False)
    assert run("sphere_on_plane") in (0, 1)  # other elements
    assert capsys.readouterr().err.splitlines()[0].endswith("now results/sphere_on_plane.1/")
    assert "patch_size" in Path("results/sphere_on_plane/scene.toml").read_text()
    assert "patch_size" not in Path("results/sphere_on_plane.1/scene.toml").read_text()


def test_a_folder_stands_alone(here: Path) -> None:
    """With copies of its files, it can be sent and run again."""
    y = np.linspace(-35.0, 35.0, 141)
    np.savetxt("worn.csv", np.column_stack([y, -(y**2) / 600]), delimiter=",")
    given = ["profile", "worn.csv", "--body", "rail", "--out", "out"]
    for _ in range(2):
        assert command.status(*given) == 0
    (copy,) = Path("out").glob("input/*/worn.csv")
    assert copy.read_bytes() == Path("worn.csv").read_bytes()
    assert str(here) not in Path("out/scene.toml").read_text()
    assert str(here) not in Path("out/summary.json").read_text()
    Path("out").rename("sent")
    Path("worn.csv").unlink()
    scene = rh.find("sent/scene.toml")
    assert scene.rail.profile == str(here / "sent" / copy.relative_to("out"))
    assert not result_folder.other_result(Path("sent"), "profile", scene)


def test_no_text_of_a_table_is_a_formula_of_a_spreadsheet() -> None:
    cells = {"a": "=cmd|' /C calc'!A0", "b": "@x", "c": "-1+1", "d": "-0.5", "e": -0.5, "f": None}
    line = result_folder.encoded([cells]).decode("utf-8-sig").splitlines()[1]
    assert line == "'=cmd|' /C calc'!A0,'@x,'-1+1,-0.5,-0.5,"


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity"])
def test_a_number_that_json_does_not_know_is_a_broken_result(tmp_path, number: str) -> None:
    said = result_folder.to_json(solved("sphere_on_plane").summary | {"note": 12345})
    (tmp_path / "summary.json").write_text(said)
    assert rh.load(tmp_path).summary["note"] == 12345
    (tmp_path / "summary.json").write_text(said.replace("12345", number))
    assert "a broken one" in refusal(lambda: rh.load(tmp_path))


def test_a_summary_that_waits_for_a_writer_is_a_broken_result(tmp_path) -> None:
    os.mkfifo(tmp_path / "summary.json")
    assert "a broken one" in refusal(lambda: rh.load(tmp_path))

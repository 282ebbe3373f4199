"""Sweeps: which combinations, what is refused, what the command leaves behind."""

import csv
import io
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import outside
import pytest
import pyvista
from solved import solved

import railhead as rh
from railhead.cli import commands
from railhead.planning import plan as planning
from railhead.planning.cost import price
from railhead.run import mesh_solution, refinement
from railhead.run.progress import Progress
from railhead.scene.scene import unit
from railhead.sweeps import grid, parallel, shared_mesh, store, sweep_table, worker_pool

SHIFTS = "wheelset.shift=0:10:0.5mm"
ROLLER = ("long_roller", "--set", "mesh.patch_size=0.4", "--quiet")
COMMAND = [sys.executable, "-c", "from railhead.cli import main; main()", "sweep"]
KEYS = {"load": "load [N]", "wheel.rolling_radius": "wheel.rolling_radius [mm]"}


def sweep(*arguments: str) -> int:
    with pytest.raises(SystemExit) as ended:
        commands.main(["sweep", *arguments])
    return int(ended.value.code or 0)


def refused(capsys, folder: Path, *arguments: str) -> str:
    """One line on standard error, status 2, nothing solved or written."""
    assert sweep(*arguments, "--out", str(folder)) == 2
    out, err = capsys.readouterr()
    *before, line = err.splitlines()
    assert out == "" and all("planning" in each for each in before) and not folder.exists()
    return line


def rows(folder: Path) -> list[dict[str, str]]:
    raw = (folder / "sweep.csv").read_bytes()
    assert raw.startswith(b"\xef\xbb\xbf") and raw.count(b"\r\n") == raw.count(b"\n")
    return list(csv.DictReader(io.StringIO(raw.decode("utf-8-sig"))))


def values(*texts: str, case: str = "s1002_60e1") -> list[tuple[object, ...]]:
    over = grid.written(texts)
    scenes = grid.scenes(rh.find(case), over)
    grid.distinct(scenes, list(over))
    return [tuple(scene.value(key) for key in over) for scene in scenes]


def test_the_manchester_positions_are_one_command() -> None:
    """All 21 scenes make a plan, each with a mesh of its own."""
    over = grid.written([SHIFTS])
    scenes = grid.scenes(rh.find("s1002_60e1"), over)
    assert [scene.wheelset.shift for scene in scenes] == [number / 2 for number in range(21)]
    plans = [planning.make(scene) for scene in scenes]
    assert shared_mesh.groups(plans) == [[number] for number in range(21)]
    assert len({round(plan.contact.touch.y, 3) for plan in plans}) == 21


def test_lists_and_ranges_multiply_the_last_fastest() -> None:
    found = values("load=25kN,50000 N", "wheelset.shift=0,1:2:.5mm")
    assert found == [(p, s) for p in (25e3, 50e3) for s in (0, 1, 1.5, 2)]
    assert values("wheelset.shift=2:0:-1 mm") == [(2,), (1,), (0,)]
    assert values("wheelset.shift=0:1:0.3mm") == [(0,), (0.3,), (0.6,), (0.9,)]
    assert values("rail.inclination=1:20,1:40") == [(0.05,), (0.025,)]
    assert values("rail.profile=54E1,60E1") == [("54E1",), ("60E1",)]
    assert values("wheelset.yaw=0:2:1mrad") == [(0,), (0.001,), (0.002,)]


@pytest.mark.parametrize(
    "over, said",
    [
        ("load=25kN,3mm", r"load: '3mm' is not a force"),
        ("wheelset.shift=0:40:10mm", r"wheelset.shift: '40mm' is not allowed"),
        ("wheelset.shift=0mm:1mm:1mm", "wheelset.shift: '0mm:1mm:1mm' is no range"),
        ("wheelset.shift=0:1:0mm", "never gets to its end"),
        ("wheelset.shift=0:1:-1mm", "never gets to its end"),
        ("wheelset.shift=0:1:1e-9mm", "too many values; give at most 10000"),
        ("load=1:2:1e-9999kN", "too many values; give at most 10000"),
        ("load=1:2:1e-9999999kN", "too many values; give at most 10000"),
        ("load=25,50kN", "load: '25' has no unit and others have one"),
        ("load=25kN,,50kN", "load: a value between two commas is missing"),
        ("load=25kN,0.025MN", "gives load=25000.0 twice"),
        ("loadd=3", "loadd: unknown key; did you mean load"),
        ("load", "--over: 'load' is not key=values"),
        ("=3", "--over: '=3' is not key=values"),
    ],
)
def test_wrong_values_are_one_line(over: str, said: str, capsys, tmp_path) -> None:
    line = refused(capsys, tmp_path / "out", "s1002_60e1", "--over", over)
    assert line.startswith("railhead: ") and said in line


def test_wrong_combinations_are_one_line(capsys, tmp_path) -> None:
    out, case = tmp_path / "out", "s1002_60e1"
    twice = refused(capsys, out, case, "--over", "load=1kN", "--over", "load=2kN")
    assert "load: is given twice" in twice
    both = refused(capsys, out, case, "--over", "load=1kN", "--over", "approach=0.1mm")
    assert "load, approach: both are given" in both
    many = refused(capsys, out, case, "--over", "load=1:200:1kN", "--over", SHIFTS[:-5] + "0.1mm")
    assert "20200 combinations" in many
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes").write_text("kept")
    assert sweep(case, "--over", "load=1kN", "--out", str(tmp_path / "mine")) == 2
    assert "holds 'notes'" in capsys.readouterr().err


def test_what_makes_no_contact_is_refused_before_anything_runs(capsys, tmp_path) -> None:
    """The last of three: it is named with its values."""
    line = refused(
        capsys, tmp_path / "out", "s1002_60e1", "--over", "wheelset.shift=0,30mm",
        "--set", "wheelset.back_to_back=1300",
    )  # fmt: skip
    assert "wheelset.shift [mm] = 30.0" in line


def test_units_of_keys() -> None:
    known = {"load": "N", "rail.smoothing": "mm", "wheelset.yaw": "rad", "rail.profile": "",
             "rail.yield_stress": "MPa", "rail.inclination": "", "rolling.spin": "1/mm",
             "friction.tangential_load": "N", "no.key": ""}  # fmt: skip
    assert {key: unit(key) for key in known} == known


@pytest.fixture(scope="module")
def swept(tmp_path_factory) -> Path:
    """Six combinations, two meshes, with pictures."""
    folder = tmp_path_factory.mktemp("sweep") / "out"
    over = ("--over", "load=50kN,80kN,110kN", "--over", "wheel.rolling_radius=420mm,460mm")
    assert sweep(*ROLLER, *over, "--out", str(folder)) == 0
    return folder


def test_a_row_for_each_combination(swept: Path) -> None:
    found = rows(swept)
    given = [(float(row[KEYS["load"]]), float(row[KEYS["wheel.rolling_radius"]])) for row in found]
    assert given == [(p, r) for p in (5e4, 8e4, 11e4) for r in (420, 460)]
    assert {row["checks"] for row in found} == {"passed"}
    assert sorted(os.listdir(swept)) == sorted(
        [".railhead", "patches.png", "records", "sweep.csv", "sweep.json", "sweep.png"]
    )
    for row in found:
        assert float(row["found load [N]"]) == pytest.approx(float(row["load [N]"]))


def test_loads_share_a_mesh(swept: Path) -> None:
    """One for each radius."""
    unknowns = [row["unknowns"] for row in rows(swept)]
    assert unknowns[0::2] == unknowns[:1] * 3 and unknowns[1::2] == unknowns[1:2] * 3


def test_the_mesh_of_several_loads_is_no_coarser_than_their_own() -> None:
    """So numbers differ from those of single runs by what the meshes differ: within the estimates
    of both."""
    table = rh.sweep(rh.find("long_roller"), load=["25kN", "110kN"], quiet=True)
    for result in table:
        one = solved(rh.find("long_roller").replace(load=result.load))
        assert result.passed and one.passed
        assert result.as_dict()["cost"]["dofs"] > one.as_dict()["cost"]["dofs"]
        off = abs(result.pressure.max / one.pressure.max - 1)
        assert 0 < off < result.estimate.pressure_max + one.estimate.pressure_max
        off = abs(result.patch.a / one.patch.a - 1)
        assert 0 < off < result.estimate.a + one.estimate.a


def test_loads_far_apart_have_meshes_of_their_own() -> None:
    """Within a patch, elements are at most about twice as long here as there."""
    given = ["100N", "1kN", "799N", "801N", "10kN", "8kN"]
    plans = [planning.make(rh.find("s1002_60e1").replace(load=load)) for load in given]
    assert shared_mesh.groups(plans) == [[0, 2], [3, 1], [5, 4]]


@pytest.mark.parametrize(
    ("case", "key", "given"),
    [("s1002_60e1", "wheelset.shift=6mm", ["1kN", "2kN"]),
     ("uic54_22t5_axle", "rail.inclination=1:40", ["4kN", "8kN"])],
    ids=["elements of another stretch", "the whole section"],
)  # fmt: skip
def test_loads_that_want_unlike_meshes_share_none(case: str, key: str, given: list[str]) -> None:
    scene = rh.find(case).replace([key, "effects.plasticity=off"])
    assert shared_mesh.groups([planning.make(scene.replace(load=load)) for load in given]) == [
        [0],
        [1],
    ]


@pytest.mark.parametrize(
    ("module", "name", "found"),
    [(refinement, "unplanned_yield", lambda level, comm: "it yields"),
     (mesh_solution, "_remesh_for_found_patch", lambda plan, grading, fields, frame: grading),
     (price, "fits", lambda plan, free: False)],
    ids=["it yields", "another patch than the forecast one", "no memory"],
)  # fmt: skip
def test_what_the_shared_mesh_does_not_suit_is_solved_alone(
    module, name: str, found, monkeypatch
) -> None:
    scene = rh.find("long_roller").replace(["mesh.patch_size=0.4"])
    scenes = [scene.replace(load=load) for load in ("25kN", "50kN")]
    monkeypatch.setattr(refinement, "run", lambda *_: "alone")
    assert "alone" not in [
        found for _, found in shared_mesh.run(scenes, [0, 1], Progress(quiet=True))
    ]
    monkeypatch.setattr(module, name, found)
    assert [*shared_mesh.run(scenes, [0, 1], Progress(quiet=True))] == [(0, "alone"), (1, "alone")]


def test_loads_share_a_mesh_smaller_than_their_own_together() -> None:
    """The largest element follows the bodies, which are those of the largest load."""
    scene, asked = rh.find("hertz_ellipse"), ["12.5kN", "100kN"]
    small, large = rh.sweep(scene, load=asked, quiet=True)
    assert small.passed and large.passed
    own = [planning.make(scene.replace(load=load)).unknowns for load in asked]
    assert small.as_dict()["cost"]["dofs"] < 0.85 * sum(own)
    ratio = large.pressure.max / small.pressure.max  # Hertz: load^(1/3)
    assert ratio == pytest.approx(2, rel=small.estimate.pressure_max + large.estimate.pressure_max)


def test_combinations_with_a_mesh_of_their_own_are_single_runs(tmp_path: Path) -> None:
    over = ("--over", "wheel.rolling_radius=420mm,460mm", "--no-pictures")
    assert sweep(*ROLLER, *over, "--out", str(tmp_path / "out")) == 0
    for row in rows(tmp_path / "out"):
        radius = float(row[KEYS["wheel.rolling_radius"]])
        scene = rh.find("long_roller").replace(["mesh.patch_size=0.4"])
        one = solved(scene.replace(wheel={"rolling_radius": radius}))
        for name, value in (("p_max [MPa]", one.pressure.max), ("a [mm]", one.patch.a),
                            ("tau_max [MPa]", one.stress.tau_max),
                            ("found approach [mm]", one.approach)):  # fmt: skip
            assert float(row[name]) == pytest.approx(value, rel=1e-9), name


def test_the_public_sweep_gives_the_same(swept: Path) -> None:
    scene = rh.find("long_roller").replace(["mesh.patch_size=0.4"])
    table = rh.sweep(scene, {"load": ["50kN", "80kN", "110kN"]}, quiet=True)
    for row, result in zip(rows(swept)[::2], table, strict=True):
        assert float(row["p_max [MPa]"]) == pytest.approx(result.pressure.max, rel=1e-9)


def test_one_group_of_loads_is_shared_among_idle_processes() -> None:
    """Every load once; where there is a group for each process, none is split."""
    assert parallel.shares([0, 1, 2, 3, 4], groups=1, workers=2) == [[0, 2, 4], [1, 3]]
    assert parallel.shares([3, 4], groups=1, workers=8) == [[3], [4]]
    assert parallel.shares([0, 1, 2], groups=2, workers=3) == [[0, 1, 2]]
    assert parallel.shares([0, 1, 2], groups=3, workers=1) == [[0, 1, 2]]


def test_shared_loads_give_the_same_numbers(swept: Path, tmp_path: Path, monkeypatch) -> None:
    """The mesh is made again in each process: three of them here, one a group in `swept`."""
    monkeypatch.setattr(worker_pool, "workers", lambda ranks: 3)
    over = ("--over", "load=50kN,80kN,110kN", "--set", "wheel.rolling_radius=420mm")
    out = ("--no-pictures", "--out", str(tmp_path / "out"))
    assert sweep(*ROLLER, *over, *out) == 0
    alone = [row for row in rows(swept) if row[KEYS["wheel.rolling_radius"]] == "420.0"]
    for one, other in zip(alone, rows(tmp_path / "out"), strict=True):
        assert one["unknowns"] == other["unknowns"]
        for name in ("p_max [MPa]", "area [mm2]", "a [mm]", "tau_max [MPa]", "found approach [mm]"):
            assert float(one[name]) == pytest.approx(float(other[name]), rel=1e-10), name


def steps(collection: Path) -> dict[float, Path]:
    """Files by time, as ParaView reads a .pvd file."""
    sets = ElementTree.parse(collection).getroot().findall("Collection/DataSet")
    return {float(each.attrib["timestep"]): collection.parent / each.attrib["file"]
            for each in sets}  # fmt: skip


def test_a_sweep_opens_as_time_steps(tmp_path: Path) -> None:
    """Meshes that differ; what does not pass is left out, also after --resume."""
    out, over = tmp_path / "out", ("--over", "wheel.rolling_radius=420mm,460mm,500mm", "--vtu")
    command = (*ROLLER, *over, "--no-pictures", "--out", str(out))
    assert sweep(*command) == 0
    for name in ("solution", "contact"):
        reader = pyvista.PVDReader(out / f"{name}.pvd")
        assert reader.time_values == [420.0, 460.0, 500.0]
        files = steps(out / f"{name}.pvd")
        sizes = {pyvista.read(file).n_points for file in files.values()}
        assert len(sizes) > 1 or name == "contact"
        for radius, file in files.items():
            number = [420.0, 460.0, 500.0].index(radius)
            top = float(rows(out)[number]["p_max [MPa]"])
            if name == "contact":
                assert pyvista.read(file)["pressure"].max() == pytest.approx(top, rel=0.01)
    fault = {"over": {"wheel.rolling_radius": 460.0}, "fault": "gmsh: no"}
    (out / "records" / "00001.json").write_text(json.dumps(fault))
    (out / "records" / "00002.json").unlink()
    (out / "vtu" / "00000" / "contact.vtu").unlink()
    assert sweep(*command, "--resume") == 1
    assert list(steps(out / "contact.pvd")) == [420.0, 500.0]
    assert all(Path(file).is_file() for file in steps(out / "contact.pvd").values())
    assert sorted(os.listdir(out)) == sorted(
        [".railhead", "contact.pvd", "records", "solution.pvd", "sweep.csv", "sweep.json", "vtu"]
    )
    assert sweep(*command) == 0  # again, in its place


def test_files_for_paraview_are_part_of_what_was_asked(swept: Path, capsys) -> None:
    same = ("--over", "load=50kN,80kN,110kN", "--over", "wheel.rolling_radius=420mm,460mm")
    assert sweep(*ROLLER, *same, "--vtu", "--out", str(swept), "--resume") == 2
    assert "vtu not given and not True" in capsys.readouterr().err


def test_several_keys_are_counted(tmp_path: Path) -> None:
    scene = rh.find("long_roller")

    def times(*texts: str) -> list[float]:
        over = grid.written(texts)
        made = grid.scenes(scene, over)
        return parallel.Campaign(scene, made, list(over), tmp_path).times

    assert times("load=25kN,50kN") == [25e3, 50e3]
    assert times("load=25kN,50kN", "wheel.rolling_radius=420,460") == [0, 1, 2, 3]
    assert times("wheel.rolling_radius=420,inf") == [0, 1]
    assert times("solver.method=penalty,nitsche") == [0, 1]


def test_another_sweep_is_not_gone_on_with(swept: Path, capsys, tmp_path: Path) -> None:
    before = (swept / "sweep.csv").read_bytes()
    out = ("--out", str(swept), "--resume")
    other = ("--over", "load=50kN,80kN,111kN", "--over", "wheel.rolling_radius=420mm,460mm")
    assert sweep(*ROLLER, *other, *out) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "--resume: " in line and "over.load [50000.0, 80000.0, 110000.0]" in line
    same = ("--over", "load=50kN,80kN,110kN", "--over", "wheel.rolling_radius=420mm,460mm")
    assert sweep(*ROLLER, *same, *out, "--set", "solver.max_newton=20") == 2
    assert "scene.solver.max_newton 30 and not 20" in capsys.readouterr().err
    assert (swept / "sweep.csv").read_bytes() == before
    swapped = (*same[2:], *same[:2])
    assert sweep(*ROLLER, *swapped, *out) == 2
    assert "holds this sweep with --over in another order" in capsys.readouterr().err
    single = tmp_path / "single"
    solved("sphere_on_plane").save(single, pictures=False)
    assert sweep(*ROLLER, *same, "--out", str(single), "--resume") == 2
    assert "holds no sweep" in capsys.readouterr().err


@pytest.mark.parametrize("content", [
    None, "{}", '{"fault": ""}', "[]", '{"fault": "", "summary": {}}',
    '{"fault": "", "summary": null}', '{"fault": "", "summary": {"checks": {"converged": true}}}',
    '{"fault": "gmsh: no"}', '{"over": {}, "fault": "gmsh: no"}',
])  # fmt: skip
@pytest.mark.parametrize("name", ["sweep.json", "records/00000.json"])
def test_a_broken_file_is_said(
    swept: Path, name: str, content: str | None, capsys, tmp_path: Path
) -> None:
    folder = tmp_path / "sweep"
    shutil.copytree(swept, folder)
    half = (folder / name).read_text(encoding="utf-8")[:100]
    (folder / name).write_text(half if content is None else content, encoding="utf-8")
    over = ("--over", "load=50kN,80kN,110kN", "--over", "wheel.rolling_radius=420mm,460mm")
    assert sweep(*ROLLER, *over, "--out", str(folder), "--resume") == 2
    err = capsys.readouterr().err
    assert len(err.splitlines()) == 1
    if name.startswith("records") or content in (None, "[]"):
        assert f"{name}' is broken; delete it and resume again" in err
    else:
        assert "holds another sweep" in err


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("outlines",), "abc"), (("outlines",), [[[0.0, 1.0, 2.0]]]),
        (("summary", "result", "pressure", "max_MPa"), "abc"),
        (("summary", "result", "contact_point_mm"), [0.0]), (("over", "load"), 80000.0),
    ],
)  # fmt: skip
def test_a_record_that_is_none_of_its_combination_is_said(
    swept: Path, place: tuple[str, ...], value: object, capsys, tmp_path: Path
) -> None:
    """As it would be by a hand, or copied from another combination."""
    folder = tmp_path / "sweep"
    shutil.copytree(swept, folder)
    record = folder / "records" / "00000.json"
    kept = json.loads(record.read_text())
    inner = kept
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = value
    record.write_text(json.dumps(kept))
    over = ("--over", "load=50kN,80kN,110kN", "--over", "wheel.rolling_radius=420mm,460mm")
    assert sweep(*ROLLER, *over, "--out", str(folder), "--resume") == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "00000.json' is broken; delete it and resume again" in line


def test_the_angle_of_a_row_is_that_of_its_patch(swept: Path) -> None:
    """Of several patches the most loaded one, which need not be where the plan saw the first."""
    kept = store.read(swept, 0)
    planned = sweep_table.row({}, kept)["contact angle [rad]"]
    assert planned == kept["summary"]["plan"]["contact_angle_rad"]
    kept["summary"]["result"]["patches"] = [{"contact_angle_rad": 0.1}, {"contact_angle_rad": 0.3}]
    line = sweep_table.row({}, kept)
    assert line["contact angle [rad]"] == 0.1 and line["patches"] == 2


def test_what_else_lies_among_the_records_is_left_alone(swept: Path, tmp_path: Path) -> None:
    folder = tmp_path / "sweep"
    shutil.copytree(swept, folder)
    shutil.copy(folder / "records" / "00001.json", folder / "records" / "00001 (copy).json")
    assert len(store.done(folder)) == 6
    store.check(folder, lambda number: store.read(folder, number)["over"], sweep_table.check)


def test_a_lost_folder_of_records_is_made_again(tmp_path: Path) -> None:
    asked = {"vtu": True}
    store.begin(tmp_path / "sweep", asked, resume=False)
    shutil.rmtree(tmp_path / "sweep" / "records")
    shutil.rmtree(tmp_path / "sweep" / "vtu")
    store.begin(tmp_path / "sweep", asked, resume=True)
    assert store.done(tmp_path / "sweep") == set()
    store.write(tmp_path / "sweep", 0, {"fault": "gmsh: no"})
    assert (tmp_path / "sweep" / "vtu").is_dir()


@pytest.mark.parametrize("more", [(), ("--resume",)])
def test_a_folder_in_use_is_left_alone(swept: Path, more: tuple, capsys, tmp_path: Path) -> None:
    """The second sweep threw the first one's records away."""
    folder = tmp_path / "sweep"
    shutil.copytree(swept, folder)
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    over = ("--over", "load=50kN,80kN,110kN", "--over", "wheel.rolling_radius=420mm,460mm")
    with store.claimed(folder):
        assert sweep(*ROLLER, *over, "--out", str(folder), *more) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "--out: " in line and "in use by a sweep that runs; wait for it" in line
    assert before == {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    with store.claimed(folder):
        pass


def test_a_record_that_goes_while_a_sweep_runs_is_said(tmp_path: Path, monkeypatch) -> None:
    scenes = [rh.find("long_roller").replace(load=load) for load in (50e3, 80e3)]
    made = parallel.Campaign(scenes[0], scenes, ["load"], tmp_path / "sweep")
    monkeypatch.setattr(parallel, "_solve", _nothing)
    found = parallel.run(made, resume=False, pictures=False, quiet=True)
    assert found == [f"NOT SOLVED: {parallel.GONE}"] * 2


def _nothing(*_: object) -> dict[int, str]:
    return {}


def test_another_profile_under_the_same_name_is_another_sweep(capsys, tmp_path: Path) -> None:
    """Else old numbers and new ones would stand in one table."""
    y = np.linspace(-30.0, 30.0, 121)
    file, out = tmp_path / "p.csv", tmp_path / "out"
    scene = tmp_path / "scene.toml"
    scene.write_text('load = "25 kN"\n[rail]\nprofile = "p.csv"\n')
    asked = (str(scene), "--over", "load=25kN,30kN", "--set", "mesh.patch_size=2mm", "--quiet",
             "--no-pictures", "--out", str(out))  # fmt: skip
    np.savetxt(file, np.column_stack([y, -(y**2) / 600]), delimiter=",")
    assert sweep(*asked) in (0, 1)
    capsys.readouterr()
    np.savetxt(file, np.column_stack([y, -(y**2) / 400]), delimiter=",")
    assert sweep(*asked, "--resume") == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "holds another sweep, with files." in line and "p.csv" in line


def test_one_that_does_not_converge_leaves_the_others(tmp_path: Path, capsys) -> None:
    out = tmp_path / "out"
    over = ("--over", "solver.max_newton=1,30", "--no-pictures")
    assert (
        sweep("hertz_ellipse", "--set", "mesh.patch_size=1", "--quiet", *over, "--out", str(out))
        == 1
    )
    one, other = rows(out)
    assert one["checks"].startswith("NOT CONVERGED: too many Newton steps")
    assert one["p_max [MPa]"] == "" and one["solver.max_newton"] == "1"
    assert other["checks"] == "passed" and float(other["p_max [MPa]"]) > 700
    assert "solver.max_newton = 1: NOT CONVERGED" in capsys.readouterr().err


def test_a_process_that_crashes_leaves_the_others(tmp_path: Path, monkeypatch) -> None:
    """Its row says so, and it is tried again by --resume."""
    made = parallel.Campaign(
        rh.find("sphere_on_plane"),
        [rh.find("sphere_on_plane").replace(load=load) for load in (100, 200)],
        ["load"],
        tmp_path / "out",
    )
    store.begin(made.folder, made.asked, resume=False)
    store.write(made.folder, 1, {"fault": "gmsh: no"})
    found = parallel._write(made, {0: "the process crashed"}, "y, mm", pictures=True)
    assert found == ["NOT SOLVED: the process crashed", "NOT SOLVED: gmsh: no"]
    assert store.done(made.folder) == {1}
    assert [row["load [N]"] for row in rows(made.folder)] == ["100.0", "200.0"]


def test_what_a_crash_takes_with_it_is_solved_by_itself(tmp_path: Path, monkeypatch) -> None:
    """The process dies at the second of three loads on one mesh, and again alone."""
    scenes = [rh.find("sphere_on_plane").replace(load=load) for load in (100, 200, 300)]
    made = parallel.Campaign(scenes[0], scenes, ["load"], tmp_path / "out")
    asked: list[list[int]] = []

    @contextmanager
    def one_process(ranks: int) -> Iterator[worker_pool.Submit]:
        def submit(work, folder, keys, group, scenes, wanted, vtu) -> Future:
            asked.append([group[each] for each in wanted])
            future: Future = Future()
            if group[0] != 1:
                over = {"load": scenes[0].load}
                store.write(folder, group[0], {"over": over, "fault": "none of a test"})
            lost = "the process crashed" if 1 in group else ""
            future.set_result(worker_pool.Attempt(None, 0.0, lost))
            return future

        yield submit

    monkeypatch.setattr(worker_pool, "submitting", one_process)
    monkeypatch.setattr(worker_pool, "workers", lambda ranks: 1)
    found = parallel.run(made, resume=False, pictures=False, quiet=True)
    assert asked == [[0, 1, 2], [1], [2]]
    assert found == [f"NOT SOLVED: {why}" for why in
                     ("none of a test", "the process crashed", "none of a test")]  # fmt: skip
    asked.clear()
    parallel.run(made, resume=True, pictures=False, quiet=True)
    assert asked == [[1], [1]]  # on the mesh of all three, and by itself


def test_what_has_no_memory_now_is_tried_again_by_resume(tmp_path: Path, monkeypatch) -> None:
    """It has a row that says why, and no record."""
    scene = rh.find("sphere_on_plane")
    (tmp_path / "records").mkdir()
    monkeypatch.setattr("railhead.run.refinement.machine.free_memory", lambda: 0)
    short = parallel._solve(tmp_path, [], [7], [scene], [0], False)
    assert list(short) == [7] and "GB free" in short[7]
    assert store.done(tmp_path) == set()
    monkeypatch.undo()
    assert parallel._solve(tmp_path, [], [7], [scene], [0], False) == {}
    assert store.done(tmp_path) == {7}


def test_the_bar_says_how_long_it_takes(capsys) -> None:
    with Progress(quiet=False) as progress:
        progress.jobs(1, 4)
        time.sleep(0.05)
        progress.jobs(2, 4)
        progress.jobs(2, 4)
        progress.jobs(4, 4)
    first, second, last = capsys.readouterr().err.splitlines()
    assert "1 of 4 done" in first
    assert "2 of 4 done, 0:00:00 left" in second and "4 of 4 done" in last


@pytest.mark.system
def test_a_kill_loses_only_what_was_running(tmp_path: Path) -> None:
    """SIGKILL after the first records; --resume leaves these as they are."""
    out = tmp_path / "out"
    arguments = ["--over", "load=60:80:10kN", "--over", "wheel.rolling_radius=420mm,460mm",
                 "--no-pictures", "--out", str(out)]  # fmt: skip
    started = subprocess.Popen([*COMMAND, *ROLLER, *arguments], stderr=subprocess.DEVNULL)
    while not store.done(out):
        assert started.poll() is None
        time.sleep(0.02)
    started.send_signal(signal.SIGKILL)
    started.wait()
    time.sleep(1.0)  # processes of the sweep die with it
    done = {path.name: path.stat().st_mtime_ns for path in (out / "records").glob("[0-9]*")}
    assert 1 <= len(done) < 6 and not (out / "sweep.csv").exists()
    stamp = json.loads((out / "records" / min(done)).read_text())
    stamp["summary"]["result"]["pressure"]["max_MPa"] = 1234.5  # to be found in the table
    (out / "records" / min(done)).write_text(json.dumps(stamp))
    solved = subprocess.run(
        [*COMMAND, *ROLLER, *arguments, "--resume"], check=False, capture_output=True, text=True
    )
    assert solved.returncode == 0, solved.stderr
    found = rows(out)
    assert len(found) == 6 and {row["checks"] for row in found} == {"passed"}
    assert [row["p_max [MPa]"] for row in found].count("1234.5") == 1
    assert not list((out / "records").glob(".*"))


@pytest.mark.system
def test_two_ranks_give_the_same_table(swept: Path, tmp_path: Path) -> None:
    """The first gives the work, the other does it."""
    over = ("--over", "load=50kN,80kN,110kN", "--over", "wheel.rolling_radius=420mm,460mm")
    done = subprocess.run(
        ["mpirun", "--oversubscribe", "-n", "2", *COMMAND, *ROLLER, *over, "--no-pictures",
         "--out", str(tmp_path / "out")],
        env=outside.environment() | outside.ROOT, capture_output=True, text=True, timeout=300,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    for one, two in zip(rows(swept), rows(tmp_path / "out"), strict=True):
        assert one.keys() == two.keys()
        for name, value in one.items():
            if name in ("checks", "tau_max body") or not value:
                assert two[name] == value, name
            else:
                assert float(two[name]) == pytest.approx(float(value), rel=1e-9, abs=1e-12), name


def test_a_row_holds_what_its_columns_say() -> None:
    """Each number of a summary is another one."""
    numbers = {
        "max_MPa": 1.0, "mean_MPa": 2.0, "area_mm2": 3.0, "a_mm": 4.0, "b_mm": 5.0,
        "tau_max_MPa": 6.0, "tau_max_depth_mm": 7.0, "von_mises_max_MPa": 8.0,
    }  # fmt: skip
    forces = (
        "force_along_N", "force_across_N", "moment_Nmm", "limit_N", "creepage_along",
        "creepage_across", "spin_per_mm", "shift_along_mm", "shift_across_mm", "stick_share",
        "t_gamma_N",
    )  # fmt: skip
    bounds = ("max_MPa", "area_mm2", "a_mm", "b_mm", "tau_max_MPa", "approach_mm")
    result = {
        "pressure": numbers, "patch": numbers, "stress": {**numbers, "tau_max_body": "rail"},
        "approach_mm": 9.0, "load_N": 10.0, "contact_point_mm": [11.0, 12.0, 13.0],
        "patches": [{"contact_angle_rad": 14.0}, {}],
        "friction": {key: 20.0 + i for i, key in enumerate(forces)},
    }  # fmt: skip
    summary = {
        "checks": {"converged": True, "passed": True}, "result": result,
        "plan": {"contact_angle_rad": 17.0}, "cost": {"dofs": 15},
        "accuracy": {"bound": {key: 40.0 + i for i, key in enumerate(bounds)}},
    }  # fmt: skip
    assert sweep_table.row({"load": 16.0}, {"fault": "", "summary": summary}) == {
        "load [N]": 16.0, "checks": "passed", "p_max [MPa]": 1.0, "p_mean [MPa]": 2.0,
        "area [mm2]": 3.0, "a [mm]": 4.0, "b [mm]": 5.0, "tau_max [MPa]": 6.0,
        "tau_max depth [mm]": 7.0, "tau_max body": "rail", "von_mises_max [MPa]": 8.0,
        "found approach [mm]": 9.0, "found load [N]": 10.0, "contact angle [rad]": 14.0,
        "unknowns": 15, "patch x [mm]": 11.0, "patch y [mm]": 12.0, "patch z [mm]": 13.0,
        "patches": 2, "force along [N]": 20.0, "force across [N]": 21.0, "moment [N mm]": 22.0,
        "mu N [N]": 23.0, "creepage along": 24.0, "creepage across": 25.0, "spin [1/mm]": 26.0,
        "shift along [mm]": 27.0, "shift across [mm]": 28.0, "stick share": 29.0,
        "T-gamma [N]": 30.0, "p_max estimate": 40.0, "area estimate": 41.0, "a estimate": 42.0,
        "b estimate": 43.0, "tau_max estimate": 44.0, "approach estimate": 45.0,
    }  # fmt: skip


def test_a_record_appears_whole_or_not_at_all(tmp_path: Path, monkeypatch) -> None:
    """The disk is full after half of it."""
    store.begin(tmp_path / "sweep", {"case": "a"}, resume=False)
    whole = Path.write_text

    def half(path: Path, text: str, **options: str) -> int:
        whole(path, text[: len(text) // 2], **options)
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_text", half)
    with pytest.raises(OSError, match="No space"):
        store.write(tmp_path / "sweep", 3, {"fault": "", "summary": {}})
    assert store.done(tmp_path / "sweep") == set()

"""The folder of a sweep: resumed, broken, in use."""

import functools
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from sweep_command import ROLLER, SIX, sweep

import railhead as rh
from railhead.results import result_folder
from railhead.scene.scene import SceneError
from railhead.sweeps import parallel, store


def test_another_sweep_is_not_gone_on_with(swept: Path, capsys) -> None:
    before = (swept / "sweep.csv").read_bytes()
    out = ("--out", str(swept), "--resume")
    other = ("--over", "load=50kN,80kN,111kN", "--over", "wheel.rolling_radius=420mm,460mm")
    assert sweep(*ROLLER, *other, *out) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "--out: " in line and "over.load [50000.0, 80000.0, 110000.0]" in line
    assert sweep(*ROLLER, *SIX, *out, "--set", "solver.max_newton=20") == 2
    assert "scene.solver.max_newton 30 and not 20" in capsys.readouterr().err
    assert (swept / "sweep.csv").read_bytes() == before
    swapped = (*SIX[2:], *SIX[:2])
    assert sweep(*ROLLER, *swapped, *out) == 2
    assert "holds this sweep with --over in another order" in capsys.readouterr().err


@pytest.mark.parametrize("content", [
    None, "{}", '{"fault": ""}', "[]", '{"fault": "", "summary": {}}',
    '{"fault": "", "summary": null}', '{"fault": "", "summary": {"checks": {"converged": true}}}',
    '{"fault": "gmsh: no"}', '{"over": {}, "names": {}, "fault": "gmsh: no"}',
])  # fmt: skip
@pytest.mark.parametrize("name", ["sweep.json", "records/00000.json"])
def test_a_broken_file_is_said(copied: Path, name: str, content: str | None, capsys) -> None:
    half = (copied / name).read_text(encoding="utf-8")[:100]
    (copied / name).write_text(half if content is None else content, encoding="utf-8")
    assert sweep(*ROLLER, *SIX, "--out", str(copied), "--resume") == 2
    err = capsys.readouterr().err
    assert len(err.splitlines()) == 1
    if name.startswith("records") or content in (None, "[]"):
        assert f"{name}' is broken; delete it and start again" in err
        if "names" not in (content or ""):  # of another combination
            with pytest.raises(SceneError, match="is broken"):
                rh.load(copied)
    else:
        assert "holds another sweep" in err


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("summary", "result", "contact_point_mm"), [0.0]), (("over", "load"), 80000.0),
    ],
)  # fmt: skip
def test_a_record_that_is_none_of_its_combination_is_said(
    copied: Path, place: tuple[str, ...], value: object, capsys
) -> None:
    """As it would be by a hand, or copied from another combination."""
    record = copied / "records" / "00000.json"
    kept = json.loads(record.read_text())
    functools.reduce(dict.get, place[:-1], kept)[place[-1]] = value
    record.write_text(json.dumps(kept))
    assert sweep(*ROLLER, *SIX, "--out", str(copied), "--resume") == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "00000.json' is broken; delete it and start again" in line


def test_what_else_lies_among_the_records_is_left_alone(copied: Path) -> None:
    shutil.copy(copied / "records" / "00001.json", copied / "records" / "00001 (copy).json")
    assert len(store.done(copied)) == len(rh.load(copied).rows()) == 6


def test_records_beyond_five_digits_count(tmp_path: Path) -> None:
    """Job 100000 was done, and nobody saw it."""
    store.write(tmp_path, 100000, {}, {"pressure": np.ones(1)})
    assert store.done(tmp_path) == set(store.arrays(tmp_path)) == {100000}


def test_wear_and_creep_tables_are_no_broken_sweeps(tmp_path: Path) -> None:
    """Their records, which are whole, were said to be broken, and to be deleted."""
    store.begin(tmp_path / "table", {"table": {"cells": 12}})
    store.write(tmp_path / "table", 0, {"forces": []})
    with pytest.raises(SceneError, match="holds no run and no sweep"):
        rh.load(tmp_path / "table")


def test_arrays_that_a_combination_lacks_are_nan(tmp_path: Path) -> None:
    """One without friction took the tractions of all others with it."""
    rubs = {"pressure": np.ones(2), "traction": np.ones((2, 3)), "sticks": np.array([True, False])}
    store.write(tmp_path, 0, {}, rubs)
    store.write(tmp_path, 2, {}, {"pressure": np.array([5.0])})
    parallel._join_fields(tmp_path)
    with np.load(tmp_path / "fields.npz") as found:
        assert found["row"].tolist() == [0, 0, 2] and found["pressure"].tolist() == [1, 1, 5]
        np.testing.assert_array_equal(found["traction"], [[1] * 3, [1] * 3, [np.nan] * 3])
        np.testing.assert_array_equal(found["sticks"], [1, 0, np.nan])


@pytest.mark.parametrize("more", [(), ("--resume",)])
def test_a_folder_in_use_is_left_alone(copied: Path, more: tuple, capsys) -> None:
    """The second sweep threw the first one's records away."""
    before = {path: path.stat().st_mtime_ns for path in copied.rglob("*")}
    with result_folder.claimed(copied):
        assert sweep(*ROLLER, *SIX, "--out", str(copied), *more) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "--out: " in line and "in use by another command; wait for it" in line
    assert before == {path: path.stat().st_mtime_ns for path in copied.rglob("*")}


def test_a_record_appears_whole_or_not_at_all(tmp_path: Path, monkeypatch) -> None:
    """The disk is full after half of it."""
    store.begin(tmp_path / "sweep", {"case": "a"})
    whole = Path.write_bytes

    def half(path: Path, content: bytes) -> int:
        whole(path, content[: len(content) // 2])
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", half)
    with pytest.raises(OSError, match="No space"):
        store.write(tmp_path / "sweep", 3, {"fault": "", "summary": {}})
    assert store.done(tmp_path / "sweep") == set()


def test_a_sweep_goes_on_with_its_own_folder_and_leaves_others(tmp_path: Path, capsys) -> None:
    folder, mine, other = tmp_path / "sweep", {"case": "a"}, {"case": "b"}
    store.begin(folder, mine)
    store.write(folder, 3, {"fault": "gmsh: no"})
    store.begin(folder, mine, "move")
    assert store.done(folder) == {3} and not capsys.readouterr().err
    with pytest.raises(SceneError, match="case a and not b; give another folder, or --force"):
        store.begin(folder, other)
    store.begin(folder, other, "move")
    assert store.done(folder) == set() and store.done(tmp_path / "sweep.1") == {3}
    assert capsys.readouterr().err.endswith("sweep.1/\n")
    store.write(folder, 3, {"fault": "gmsh: no"})
    store.begin(folder, other, "replace")
    assert store.done(folder) == set() and not result_folder.foreign(folder)
    (folder / "sweep.json").unlink()
    with pytest.raises(SceneError, match="holds another kind of result"):
        store.begin(folder, mine)

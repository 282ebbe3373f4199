"""Scenes that share a mesh, and those that do not."""

import pytest
from solved import planned, solved
from sweep_command import refused, rows

import railhead as rh
from railhead.planning import simulation_plan as planning
from railhead.results import pipeline
from railhead.run import mesh_solution, refinement
from railhead.run.progress import Progress
from railhead.sweeps import runner
from railhead.sweeps.grid import ParameterGrid, parse_values


def test_the_manchester_positions_are_one_command() -> None:
    """All scenes make a plan, each with a mesh of its own."""
    over = parse_values(["wheelset.shift=0:10:5mm"])
    scenes = ParameterGrid.combine(rh.find("s1002_60e1"), over).scenes
    assert [scene.wheelset.shift for scene in scenes] == [0, 5, 10]
    plans = [planning.make(scene) for scene in scenes]
    assert runner.group_by_mesh(plans) == [[0], [1], [2]]
    assert len({round(plan.contact.touch.y, 3) for plan in plans}) == 3


def test_a_sweep_has_one_datum_of_the_approach() -> None:
    """The whole rail is called for at 1 and 2 mm alone."""
    given = rh.find("s1002_60e1").replace(["load=40kN", "effects.plasticity=off"])
    grid = ParameterGrid.combine(given, parse_values(["wheelset.shift=1mm,2mm,3mm"]))
    alone = [planning.make(scene).effects["rail_section"].on for scene in grid.scenes]
    plans = runner.plan_all(grid, Progress(quiet=True))
    assert alone == [True, True, False]
    assert [plan.effects["rail_section"].on for plan in plans] == [True, True, True]
    assert [scene.effects.rail_section for scene in grid.scenes] == ["auto", "auto", "on"]


def test_what_makes_no_contact_is_refused_before_anything_runs(capsys, tmp_path) -> None:
    """The last of three: it is named with its values."""
    line = refused(
        capsys, tmp_path / "out", "s1002_60e1", "--over", "wheelset.shift=0,30mm",
        "--set", "wheelset.back_to_back=1250",
    )  # fmt: skip
    assert "wheelset.shift [mm] = 30.0" in line


def test_loads_share_a_mesh(swept) -> None:
    """One for each radius."""
    unknowns = [row["unknowns"] for row in rows(swept)]
    assert unknowns[0::2] == unknowns[:1] * 3 and unknowns[1::2] == unknowns[1:2] * 3


def test_the_mesh_of_several_loads_is_no_coarser_than_their_own(in_this_process) -> None:
    """So numbers differ from those of single runs by what the meshes differ: within the estimates
    of both."""
    table = rh.sweep(rh.find("sphere_on_plane"), load=["50N", "200N"], quiet=True)
    for result in table:
        one = solved(rh.find("sphere_on_plane").replace(load=result.load))
        assert result.passed and one.passed
        assert result.as_dict()["cost"]["dofs"] > one.as_dict()["cost"]["dofs"]
        off = abs(result.pressure.max / one.pressure.max - 1)
        assert 0 < off < result.estimate.pressure_max + one.estimate.pressure_max
        off = abs(result.patch.a / one.patch.a - 1)
        assert 0 < off < result.estimate.a + one.estimate.a


def test_loads_far_apart_have_meshes_of_their_own() -> None:
    """Within a patch, elements are at most about twice as long here as there."""
    given = ["100N", "1kN", "799N", "801N", "10kN", "8kN"]
    plans = [planned("hertz_ellipse", f"load={load}") for load in given]
    assert runner.group_by_mesh(plans) == [[0, 2], [3, 1], [5, 4]]


@pytest.mark.parametrize(
    ("case", "key", "given"),
    [("s1002_60e1", "wheelset.shift=6mm", ["1kN", "2kN"]),
     ("uic54_22t5_axle", "rail.inclination=1:40", ["4kN", "8kN"])],
    ids=["elements of another stretch", "the whole section"],
)  # fmt: skip
def test_loads_that_want_unlike_meshes_share_none(case: str, key: str, given: list[str]) -> None:
    scene = rh.find(case).replace([key, "effects.plasticity=off"])
    assert runner.group_by_mesh([planning.make(scene.replace(load=load)) for load in given]) == [
        [0],
        [1],
    ]


@pytest.fixture
def two_loads(monkeypatch):
    """Plans of two loads that suit one mesh, by number; what is solved alone says so."""
    monkeypatch.setattr(pipeline, "solve", lambda *_: "alone")
    scene = rh.find("long_roller").replace(["mesh.patch_size=0.4"])
    loads = {4: "25kN", 2: "50kN"}
    return {number: planning.make(scene.replace(load=load)) for number, load in loads.items()}


def test_what_the_shared_mesh_suits_is_solved_on_it(two_loads) -> None:
    shared = dict(runner.solve_group(two_loads, [4, 2], Progress(quiet=True)))
    assert list(shared) == [4, 2] and "alone" not in shared.values()


@pytest.mark.parametrize(
    ("module", "name", "found"),
    [(refinement, "unplanned_yield", lambda level, comm: "it yields"),
     (mesh_solution, "_remesh_for_found_patch", lambda plan, fields: plan),
     (planning.Plan, "fits", lambda plan, free: False)],
    ids=["it yields", "another patch than the forecast one", "no memory"],
)  # fmt: skip
def test_what_the_shared_mesh_does_not_suit_is_solved_alone(
    module, name: str, found, two_loads, monkeypatch
) -> None:
    monkeypatch.setattr(module, name, found)
    alone = runner.solve_group(two_loads, [4, 2], Progress(quiet=True))
    assert [*alone] == [(4, "alone"), (2, "alone")]

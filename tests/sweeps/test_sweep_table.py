"""Rows of sweep.csv."""

from pathlib import Path

from railhead.sweeps import store, sweep_table


def test_the_angle_of_a_row_is_that_of_its_patch(swept: Path) -> None:
    """Of several patches the most loaded one, which need not be where the plan saw the first."""
    kept = store.read(swept, 0)
    planned = sweep_table.row({}, kept)["contact angle [rad]"]
    assert planned == kept["summary"]["plan"]["contact_angle_rad"]
    kept["summary"]["result"]["patches"] = [{"contact_angle_rad": 0.1}, {"contact_angle_rad": 0.3}]
    line = sweep_table.row({}, kept)
    assert line["contact angle [rad]"] == 0.1 and line["patches"] == 2


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
        "railhead": "0", "date": "now", "result": result,
        "checks": {"converged": True, "passed": True},
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
        "tau_max depth estimate": None, "von_mises_max estimate": None, "program": "railhead 0",
        "date": "now",
    }  # fmt: skip

"""Sections against exact line contact, published benchmarks and the solid model."""

import numpy as np
import pytest
from solved import passed, solved

from railhead.scene import catalogue
from railhead.scene.scene import Scene


def test_nafems_roller_on_block() -> None:
    """p0 3585.4 MPa and half width 6.215 mm by Hertz, within 1 % (a/R = 0.124)."""
    nafems = passed("roller_on_block").summary
    result = nafems["result"]
    assert (result["patch"]["a_mm"], result["pressure"]["max_MPa"]) == pytest.approx(
        (6.2146278668664685, 3585.362230884501), rel=0.01
    )
    assert nafems["hertz"]["pressure"]["max_MPa"] == pytest.approx(3585.362230884501, rel=1e-9)
    assert nafems["checks"]["force_balance"] < 1e-8


@pytest.mark.parametrize(
    ("case", "changes"),
    [
        ("long_roller", ["rail.length=40", "wheel.segment_length=40"]),
        ("two_cylinders", []),  # its supports meet the arcs that touch
    ],
)
def test_approach_of_a_short_body_is_within_its_estimate(case: str, changes: list[str]) -> None:
    """Beside a mesh three times as fine, which leaves a sixth of the error. Stresses are singular
    where a support ends: without fine elements there the error was 6 and 2 times the estimate.
    """
    usual = solved(case, *changes)
    size = min(usual.solved.plan.zone) / 36
    fine = solved(case, *changes, f"mesh.patch_size={size}")
    estimate = usual.summary["accuracy"]["bound"]["approach_mm"]
    assert usual.approach == pytest.approx(fine.approach, rel=estimate)


HALF_SPACES = {
    "long roller": ("long_roller", []),
    "two cylinders": ("two_cylinders", []),
    "quadrilaterals": ("long_roller", ["mesh.cell=hexahedron", "mesh.order=2"]),
    "penalty": ("long_roller", ["solver.method=penalty"]),
    "theta -1": ("long_roller", ["solver.theta=-1"]),
    "by approach": ("long_roller", ["approach=0.03"]),
    "rigid roller": ("long_roller", ["wheel.young_modulus=inf"]),
    "soft rail": ("long_roller", ["rail.young_modulus=3000", "rail.poisson_ratio=0.45"]),
    "whole section": ("two_cylinders", ["effects.symmetry=off"]),
    "circle": ("sphere_on_plane", []),
    "circle of two bodies": ("sphere_on_plane", ["rail.young_modulus=3000"]),
    "circle of quadrilaterals": ("sphere_on_plane", ["mesh.cell=hexahedron", "mesh.order=2"]),
    "nearly incompressible roller": (
        "long_roller", ["rail.poisson_ratio=0.4995", "wheel.poisson_ratio=0.4995"],
    ),
    "incompressible on compressible": (
        "sphere_on_plane", ["rail.young_modulus=2000", "rail.poisson_ratio=0",
        "wheel.poisson_ratio=0.4999"],
    ),
    **{f"circle at {nu}": ("sphere_on_plane", [f"wheel.poisson_ratio={nu}"])
       for nu in (0.45, 0.4999)},
}  # fmt: skip
MORE = "two cylinders", "circle of two bodies", "circle at 0.45"


@pytest.mark.parametrize(
    "case, assignments",
    [
        pytest.param(*given, id=name, marks=[pytest.mark.slow] if name in MORE else [])
        for name, given in HALF_SPACES.items()
    ],
)
def test_half_spaces_give_exact_hertz(case: str, assignments: list[str]) -> None:
    """0.2 %, twice that of the mean pressure, which is over an area; 3 % at the surface, where the
    stress is extrapolated. The depth of the largest shear, which is flat there: 0.5 %, 1 % of
    nearly incompressible bodies, that is within 2e-5 of it."""
    scene = catalogue.find(case).replace(["rail.extent=half-space", *assignments])
    off = passed(scene).summary["difference"]
    found = [off["patch"]["a_mm"], off["patch"]["b_mm"], off["pressure"]["max_MPa"]]
    assert np.abs([*found, off["approach_mm"]]).max() < 0.002
    assert abs(off["pressure"]["mean_MPa"]) < 0.004 and abs(off["stress"]["tau_max_MPa"]) < 0.002
    nu = max(scene.rail.poisson_ratio, scene.wheel.poisson_ratio)
    assert abs(off["stress"]["tau_max_depth_mm"]) < (0.01 if nu > 0.45 else 0.005)
    assert np.abs(off["stress"]["surface_centre_MPa"]).max() < 0.03


@pytest.mark.parametrize("nu", [0.3, pytest.param(0.495, marks=pytest.mark.slow), 0.4999])
def test_stresses_are_alike_around_the_axis(nu: float) -> None:
    """s_x = s_y below the centre of a circle, within 0.5 % of the largest pressure, with the mean
    dilatation on as well."""
    keys = [f"wheel.poisson_ratio={nu}", "effects.mean_dilatation=on"]
    found = solved("sphere_on_plane", *keys).findings
    s_x, s_y = found.axis.stress[:, :2].T
    assert np.abs(s_x - s_y).max() < 0.005 * found.patch.max_pressure


@pytest.mark.parametrize("cell", ["tetrahedron", "hexahedron"])
def test_linear_cells_reach_one_per_cent(cell: str) -> None:
    keys = "rail.extent=half-space", f"mesh.cell={cell}", "mesh.order=1"
    off = passed("long_roller", *keys).summary["difference"]
    assert np.abs([off["patch"]["a_mm"], off["pressure"]["max_MPa"]]).max() < 0.01


def test_two_cylinders_in_plane_stress_meet_roark() -> None:
    """ANSYS solves VM191 in plane stress and meets Roark's approach, 0.4174 mm, a formula of plane
    strain. So do we: plane strain with E (1 + 2 nu)/(1 + nu)^2 and nu/(1 + nu) is plane stress."""
    case = catalogue.find("two_cylinders")
    keys = [
        f"{part}.{key}={value!r}"
        for part, body in (("rail", case.rail), ("wheel", case.wheel))
        for key, value in {
            "young_modulus": body.young_modulus
            * (1 + 2 * body.poisson_ratio)
            / (1 + body.poisson_ratio) ** 2,
            "poisson_ratio": body.poisson_ratio / (1 + body.poisson_ratio),
        }.items()
    ]
    assert passed(case.replace(keys)).summary["result"]["approach_mm"] == pytest.approx(
        0.41739, rel=0.01
    )


def test_bar_on_a_canted_rail_head() -> None:
    """Section of a straight bar on 54E1 inclined 1:20: touches beside the crown. The head is 35 mm
    to either side of a patch 4 mm wide, so Hertz holds to a few per cent."""
    keys = ("wheel.rolling_radius=inf", "rail.length=100", "rail.inclination=1:40")
    summary = passed(Scene(load=5e5), *keys, "mesh.patch_size=0.6").summary
    assert abs(summary["difference"]["patch"]["b_mm"]) < 0.05
    assert abs(summary["difference"]["pressure"]["max_MPa"]) < 0.03
    assert summary["difference"]["patch"]["a_mm"] == 0.0

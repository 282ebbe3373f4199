"""Friction that falls with slip or temperature, and an elastic layer, between half-spaces."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from one_line import refusal
from scipy.integrate import quad
from solved import friction, passed, solved

import railhead as rh
from railhead.planning import simulation_plan
from railhead.sweeps.wear import wear, wear_run
from railhead.theory.friction.rolling import (
    Creepage,
    HalfSpaceFriction,
    TangentialSolution,
    grid_over,
    solve_for_forces,
)
from railhead.theory.friction.tangential import pair
from railhead.theory.friction_laws import ByTemperature, Falling, Heat, Interface

A, B, LOAD = 5.88, 10.54, 1e5
STEEL = 209920.0  # G = 82 GPa with nu = 0.28


def ellipse(
    friction: float, interface: Interface | None, *, cells: int = 32, young: float = STEEL
) -> HalfSpaceFriction:
    """Ertz and Knothe's ellipse, a = 5.88, b = 10.54 mm, under 100 kN."""
    grid = grid_over((0.0, 0.0), (A, B), cells)
    u, v = grid.x / A, grid.s / B
    pressure = np.sqrt(np.maximum(1 - u[:, None] ** 2 - v**2, 0))
    pressure *= LOAD / (pressure.sum() * grid.cell)
    materials = pair(young, 0.28, young, 0.28)
    return HalfSpaceFriction(
        grid.x, grid.s, pressure, friction, materials, rolling=True, interface=interface
    )


def slips(law, *, young: float) -> tuple[float, float]:
    """Largest temperature and force (kN) at 30 m/s and a creepage of 1 m/s, extrapolated."""
    coarse, fine = (
        (found.rise.max(), 1e-3 * found.forces[0])
        for found in (
            ellipse(0.3, Interface(heat=Heat(speed=30.0), law=law), cells=n, young=young).solve(
                Creepage(1 / 30)
            )
            for n in (16, 32)
        )
    )
    return 2 * fine[0] - coarse[0], 2 * fine[1] - coarse[1]


@pytest.mark.parametrize(
    ("hot", "kelvin", "force"), [(0.3, 150.3, 30.0), (0.12, 126.9, 26.38), (0.48, 182.3, 34.66)]
)
def test_a_coefficient_of_the_temperature_where_all_slips_alike(hot, kelvin, force) -> None:
    """Integrals of the heat equation along each line, with a slip of 1 m/s everywhere: nearly rigid
    bodies. Steel's own slip is larger behind the middle, and its surface 1.5 % hotter."""
    law = ByTemperature(((0.0, 0.3), (400.0, hot)))
    rigid, carried = slips(law, young=1e4 * STEEL)
    assert rigid == pytest.approx(kelvin, rel=0.004) and carried == pytest.approx(force, rel=0.001)
    steel, carried = slips(law, young=STEEL)
    assert (steel, carried) == pytest.approx((1.015 * kelvin, force), rel=0.005)


def test_contact_counts_the_heat_of_each_element_on_itself_twice() -> None:
    """So, on cells of 0.2 by 0.5 mm, its 166.8 K comes out (examples/ertz_temperature.ref_out). It
    takes the slip of the step from one cell to the next; at the centres it is a little larger."""
    x, y = 0.2 * np.arange(60) - 5.9, 0.5 * np.arange(43) - 10.5
    pressure = np.sqrt(np.maximum(1 - (x[:, None] / A) ** 2 - (y / B) ** 2, 0))
    pressure *= LOAD / (pressure.sum() * 0.1)
    surfaces = Interface(heat=Heat(speed=30.0))
    found = HalfSpaceFriction(
        x, y, pressure, 0.3, pair(STEEL, 0.28, STEEL, 0.28), rolling=True, interface=surfaces
    ).solve(Creepage(0.03333))
    flux = 30.0 * (found.traction * found.slip).sum(axis=0)
    own = 1e6 * flux / math.sqrt(math.pi * 50 * 7850 * 450 * 30) * math.sqrt(1e-4)
    assert found.rise.max() == pytest.approx(152.6, rel=0.004)
    rise = Heat(speed=30.0).temperatures(x, flux)
    assert (rise + own).max() == pytest.approx(166.8, rel=0.001)


def exponential(**more) -> Interface:
    return Interface(heat=Heat(speed=10.0), law=Falling(0.14, 1250.0), **more)


@pytest.mark.parametrize(("creepage", "share"), [(0.05, 0.8606), (0.1, 0.7549), (0.25, 0.5682)])
def test_full_slip_has_the_coefficient_of_its_slip(creepage: float, share: float) -> None:
    coarse, fine = (
        ellipse(0.33, exponential(), cells=n).solve(Creepage(creepage)).forces[0] / (0.33 * LOAD)
        for n in (16, 32)
    )
    assert 2 * fine - coarse == pytest.approx(share, abs=0.003)


@pytest.mark.parametrize("law", [Falling(0.3, 100.0), ByTemperature(((0.0, 0.3), (9.0, 0.3)))])
def test_a_law_that_does_not_fall_has_coulombs_answer(law) -> None:
    creepage = Creepage(0.002, -0.001, 1e-4)
    plain = ellipse(0.3, None).solve(creepage)
    found = ellipse(0.3, Interface(heat=Heat(speed=20.0), law=law, memory=0.3)).solve(creepage)
    np.testing.assert_allclose(found.traction, plain.traction, atol=1e-8 * plain.bound.max())


CREEPAGES = [0.0005, 0.001, 0.002, 0.003, 0.004, 0.006, 0.01]


@pytest.mark.parametrize("memory", [None, 0.5, 2.0])
def test_a_falling_creep_curve_has_one_value_from_both_sides(memory) -> None:
    """A steep law: from 0.3 to 0.18, half at 100 mm/s, 45 m/s. Each point starts from the one
    before, upwards and downwards, and from the kinetic coefficient everywhere."""
    law = Falling(0.18, 100.0)
    body = ellipse(0.3, Interface(heat=Heat(speed=45.0), law=law, memory=memory), cells=16)

    def curve(values: list[float]) -> dict[float, float]:
        found: TangentialSolution | None = None
        out = {}
        for value in values:
            found = body.solve(Creepage(value), found)
            out[value] = found.forces[0] / (0.3 * LOAD)
        return out

    up, down = curve(CREEPAGES), curve(CREEPAGES[::-1])
    low = body.solve(Creepage(0.003))
    low = replace(low, bound=0.18 * low.pressure, traction=0.6 * low.traction)
    below = body.solve(Creepage(0.003), low).forces[0] / (0.3 * LOAD)
    for value in CREEPAGES:
        assert up[value] == pytest.approx(down[value], abs=3e-6)
    assert below == pytest.approx(up[0.003], abs=3e-6)
    top = max(up.values())
    assert top == up[0.003] and up[0.01] < 0.9 * top


@pytest.mark.parametrize(
    ("law", "speed", "creepage", "why"),
    [
        (Falling(0.02, 1.0), 100.0, 0.002, "several steady states"),
        (Falling(0.1, 20.0), 80.0, 0.003, "do not settle"),
    ],
)
def test_a_law_too_steep_is_refused_and_not_answered(law, speed, creepage, why) -> None:
    steep = Interface(heat=Heat(speed=speed), law=law)
    with pytest.raises(ValueError, match=f"{why}.*longer memory"):
        ellipse(0.6, steep, cells=16).solve(Creepage(creepage))


def test_a_given_force_is_met_on_the_rising_branch() -> None:
    body = ellipse(0.33, exponential())
    (found,) = solve_for_forces([body], Creepage(), along=0.9 * 0.33 * LOAD)
    assert found.forces[0] == pytest.approx(0.9 * 0.33 * LOAD, rel=2e-6)
    assert 0 < found.creepage.along < 0.003


@pytest.mark.parametrize(
    ("static", "law"),
    [(0.3, ByTemperature(((0.0, 0.3), (400.0, 0.48)))), (0.2, Falling(0.4, 300.0))],
)
def test_a_rising_law_carries_a_force_beyond_that_at_rest(static, law) -> None:
    body = ellipse(static, Interface(heat=Heat(speed=30.0), law=law), cells=16)
    force = 1.05 * static * LOAD
    for across in (None, 0.0):
        (found,) = solve_for_forces([body], Creepage(), along=force, across=across)
        assert found.forces[0] == pytest.approx(force, rel=1e-5)
    most = 0.48 if static == 0.3 else 0.4
    with pytest.raises(ValueError, match=f"below mu N = {most * LOAD:.6g} N"):
        solve_for_forces([body], Creepage(), along=most * LOAD)


@pytest.mark.parametrize(
    ("speed", "law", "share", "why"),
    [
        (100.0, Falling(0.1, 1.0), 0.2, "several steady states.*longer memory"),
        # the creep curve of the ellipse has its maximum near 0.843 mu N
        (30.0, Falling(0.3, 300.0), 0.9, "the largest force of the law may lie below"),
    ],
)
def test_a_given_force_that_a_falling_law_does_not_carry_is_refused(speed, law, share, why) -> None:
    body = ellipse(0.6, Interface(heat=Heat(speed=speed), law=law), cells=16)
    with pytest.raises(ValueError, match=why):
        solve_for_forces([body], Creepage(), along=share * 0.6 * LOAD)


def test_a_soft_layer_is_kalkers_simplified_theory() -> None:
    """Tractions xi s/L, s behind the leading edge, where all sticks: F = xi 8 a^2 b/(3 L)."""
    layer, creepage = 1.0, 1e-6
    coarse, fine = (
        ellipse(0.3, Interface(layer=layer), cells=n).solve(Creepage(creepage)) for n in (32, 64)
    )
    exact = creepage * 8 * A**2 * B / (3 * layer)
    assert 2 * fine.forces[0] - coarse.forces[0] == pytest.approx(exact, rel=0.01)
    across = ellipse(0.3, Interface(layer=layer), cells=64).solve(Creepage(0, creepage))
    assert across.forces[1] == pytest.approx(fine.forces[0], rel=0.003)


FAST = "effects.finite_bodies=off"
ROLLS = "rolling.creepage_along=3.33333%", "rolling.speed=30"
SLIP_LAW = (
    "friction.coefficient=0.3", "friction.law=exponential", "friction.kinetic=0.15",
    "friction.slip_half=0.3 m/s",
)  # fmt: skip


def ertz(*assignments: str, young: float = STEEL) -> rh.Scene:
    """The ellipse as a scene of half-spaces; radii grow with the moduli."""
    radii = [f"wheel.{key}={young / STEEL * r}" for key, r in (
        ("rolling_radius", 492.61), ("transverse_radius", 1186.2))]  # fmt: skip
    moduli = [f"{body}.{key}" for body in ("rail", "wheel")
              for key in (f"young_modulus={young}", "poisson_ratio=0.28")]  # fmt: skip
    bodies = ["rail.profile=arc", "rail.crown_radius=inf", "wheel.profile=arc"]
    assignments = (*bodies, *radii, *moduli, *assignments)
    scene = rh.Scene(
        load=LOAD, rail={"extent": "half-space", "profile": "arc", "crown_radius": 1e9}
    )
    return scene.replace([FAST, "heat.density=7850", *assignments])


@pytest.mark.parametrize(("young", "kelvin"), [(1e3 * STEEL, 150.3), (STEEL, 152.6)])
def test_a_scene_has_the_temperatures_of_its_surfaces(young: float, kelvin: float) -> None:
    keys = ("heat.conductivity=50.0001",) if young > STEEL else ()
    found = friction(passed(ertz("friction.coefficient=0.3", *ROLLS, *keys, young=young)))
    rises = found["temperature_rise_max_K"]
    assert rises["rail"] == rises["wheel"] == pytest.approx(kelvin, rel=0.003)
    assert found["power_W"] == pytest.approx(30e3, rel=1e-3) and "coefficient_least" not in found


def test_a_scene_of_unlike_warmth_that_does_not_slip() -> None:
    keys = "friction.coefficient=0.3", "rolling.creepage_along=0", "rolling.speed=30"
    rises = friction(solved(ertz(*keys, "heat.bulk_wheel=150")))["temperature_rise_max_K"]
    assert rises == {"rail": pytest.approx(75.0), "wheel": pytest.approx(-75.0)}


def test_a_scene_with_a_table_needs_no_other_coefficient() -> None:
    table = "friction.law=temperature", "friction.table=[[0, 0.3], [400, 0.12]]"
    found = friction(passed(ertz(*table, *ROLLS)))
    assert found["force_along_N"] == pytest.approx(26.38e3, rel=0.005)
    least = 0.3 - 0.18 * found["temperature_rise_max_K"]["rail"] / 400
    assert found["coefficient_least"] == pytest.approx(least, rel=1e-3)
    same = friction(passed(ertz(*table, *ROLLS, "friction.coefficient=0.3")))
    assert same["force_along_N"] == found["force_along_N"]


@pytest.mark.parametrize(
    ("pairs", "bulk", "least", "most"),
    [
        ("[[-50, 0.6], [0, 0.3], [400, 0.12]]", 0, 0.2, 0.3),
        ("[[0, 0.3], [200, 0.1]]", 200, 0.1, 0.1),
    ],
)
@pytest.mark.parametrize("effect", ["auto", "off"])
def test_lines_start_at_the_bulk_temperatures_coefficient(pairs, bulk, least, most, effect) -> None:
    """The mean bulk of both bodies; without the law it is the coefficient everywhere. It is a
    quotient of two sums, mu p and p, so that each bound allows four units of its last bit."""
    keys = "friction.law=temperature", f"friction.table={pairs}", "friction.memory=5"
    warm = f"heat.bulk_rail={bulk + 20}", f"heat.bulk_wheel={bulk - 20}"
    scene = ertz(*keys, *warm, *ROLLS, f"effects.falling_friction={effect}")
    found = friction(passed(scene))["coefficient"]
    assert least - 4 * np.spacing(least) <= found <= most + 4 * np.spacing(most)
    if effect == "off":
        assert found == pytest.approx(most)


def test_wear_has_the_coefficient_of_its_slip(tmp_path, monkeypatch) -> None:
    """A crown that slips at 0.1 m/s everywhere wears by mu, 0.225 of 0.3."""
    monkeypatch.setattr(wear_run, "RUNS", dict.fromkeys(wear_run.RUNS, (24, 5.0)))
    monkeypatch.setattr(wear.worker_pool, "workers", lambda ranks: 1)
    keys = (*SLIP_LAW[:3], "friction.slip_half=100", "friction.memory=0.01")
    bodies = "rail.profile=arc", "rail.crown_radius=300", "wheel.profile=cylinder"
    rolls = "rolling.creepage_along=1%", "rolling.speed=10"
    given = [FAST, *bodies, *keys, *rolls, "wear.axles=20", "wear.step=1"]
    worn = []
    for effect in ("auto", "off"):
        scene = rh.Scene(load=80e3).replace([*given, f"effects.falling_friction={effect}"])
        worn.append(wear.wear(scene, tmp_path / effect).summary["worn_mm2"]["rail"])
    assert worn[0] / worn[1] == pytest.approx(0.75, rel=0.01)


@pytest.mark.parametrize(("creepage", "share"), [("5%", 0.8606), ("25%", 0.5682)])
def test_a_section_has_the_coefficient_of_its_slip(creepage: str, share: float) -> None:
    keys = "friction.law=exponential", "friction.kinetic=0.14", "friction.slip_half=1.25 m/s"
    rolls = "friction.coefficient=0.33", f"rolling.creepage_along={creepage}", "rolling.speed=10"
    found = friction(passed("long_roller", *keys, *rolls))
    assert found["coefficient"] == pytest.approx(0.33 * share, rel=0.003)


@pytest.mark.parametrize("wheel", [(), ("wheel.young_modulus=1e5",)])
def test_a_section_of_which_a_part_sticks_has_the_force_of_half_spaces(wheel) -> None:
    """Boundary elements have their own turns, on a grid. The law falls to 0.8 of mu N there."""
    keys = SLIP_LAW[:3] + ("friction.slip_half=100", "friction.memory=0.5", *wheel)
    result = passed("long_roller", *keys, "rolling.creepage_along=0.15%", "rolling.speed=10")
    found = friction(result)
    other = result.summary["half_space_friction"]["boundary elements"]
    assert found["coefficient_least"] < 0.29 and found["stick_share"] > 0.05
    assert other["force_along_N"] == pytest.approx(found["force_along_N"], rel=0.003)


def test_a_section_that_slips_has_the_heat_of_its_line() -> None:
    """T(s) of Hertz's half ellipse in full slip, by quadrature: the largest of all places."""
    keys = "friction.coefficient=0.3", "rolling.creepage_along=3%", "rolling.speed=60"
    result = passed("long_roller", *keys)
    strip = result.ellipse
    length, flux = 2e-3 * strip.half_lengths[0], 0.5 * 0.3 * 1e6 * strip.p0 * 0.03 * 60

    def root(t: float, s: float) -> float:
        """Heat at s - t^2, by which the singular end is gone."""
        u = 2 * (s - t * t) / length - 1
        return 2 * math.sqrt(max(1 - u * u, 0.0))

    hottest = max(
        quad(root, 0, math.sqrt(s), args=(s,))[0] for s in np.linspace(0.5, 1.0, 51) * length
    )
    exact = flux * hottest / math.sqrt(math.pi * 50 * 7850 * 450 * 60)
    rises = friction(result)["temperature_rise_max_K"]
    assert rises["rail"] == rises["wheel"] == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize(
    "keys",
    [
        ("friction.coefficient=0.2", "friction.law=exponential", "friction.kinetic=0.5",
         "friction.slip_half=300"),
        ("friction.law=temperature", "friction.table=[[-50, 0.6], [0, 0.2], [400, 0.5]]"),
    ],
)  # fmt: skip
def test_a_force_above_the_static_limit_is_refused_where_the_law_is_off(keys) -> None:
    """mu N = 5000 N; with the law the force is below that of its largest coefficient."""
    scene = rh.find("hertz_ellipse").replace(
        [FAST, *keys, "rolling.force_along=7000", "rolling.speed=30"]
    )
    simulation_plan.make(scene)
    line = refusal(lambda: simulation_plan.make(scene.replace(["effects.falling_friction=off"])))
    assert "force_along: 7000 N would slide; give less than" in line and "5000 N" in line


def test_the_coefficient_of_what_slips_is_below_the_mean() -> None:
    """What sticks keeps the static coefficient, and the mean of all is above that of what slips."""
    keys = "rolling.creepage_along=0.2%", "rolling.speed=45", "friction.memory=0.3"
    found = friction(solved("hertz_ellipse", FAST, *SLIP_LAW, *keys))
    slipping = found["coefficient_slipping"]
    assert found["coefficient_least"] < slipping < 0.98 * found["coefficient"]


@pytest.mark.parametrize("effect", ["falling_friction", "layer"])
def test_an_effect_that_is_off_leaves_coulombs_answer(effect: str) -> None:
    keys = {
        "falling_friction": SLIP_LAW[1:],
        "layer": ("friction.layer_thickness=0.02", "friction.layer_modulus=300"),
    }[effect]
    rolls = "friction.coefficient=0.3", "rolling.creepage_along=0.2%", "rolling.speed=30", FAST
    plain = friction(solved("hertz_ellipse", *rolls))
    off = friction(solved("hertz_ellipse", *rolls, *keys, f"effects.{effect}=off"))
    assert off["force_along_N"] == plain["force_along_N"]
    with_it = friction(solved("hertz_ellipse", *rolls, *keys))
    assert with_it["force_along_N"] < 0.97 * plain["force_along_N"]


@pytest.mark.parametrize(
    ("case", "keys", "expected"),
    [
        (
            "long_roller",
            ("friction.layer_thickness=1", "friction.layer_modulus=9"),
            "layer_thickness: 1 mm is not allowed with a section.*; give effects.layer=off$",
        ),
        ("hertz_ellipse", ("wheel.young_modulus=7e4",), "friction.law: .* of unlike materials"),
        ("hertz_ellipse", ("rolling.speed=none",), "rolling.speed: is missing; friction.law"),
        ("hertz_ellipse", ("friction.slip_half=none",), "friction.slip_half: is missing; law"),
        ("hertz_ellipse", ("friction.law=coulomb",), "friction.kinetic: has no use in law coulomb"),
        ("hertz_ellipse", ("friction.layer_modulus=9",), "friction.layer_thickness: is missing"),
        ("hertz_ellipse", ("rolling.passes=2",), "friction.law: .* beside rolling.passes"),
        ("hertz_ellipse", ("friction.table=[[0, 0.3], [400, 0.1]]",), "friction.table: has no use"),
    ],
)
def test_what_cannot_take_a_law_says_so_in_one_line(case, keys, expected) -> None:
    given = dict(each.split("=", 1) for each in (
        *SLIP_LAW, "rolling.creepage_along=1%", "rolling.speed=30", *keys))  # fmt: skip
    scene = [f"{key}={value}" for key, value in given.items()]
    line = refusal(lambda: simulation_plan.make(rh.find(case).replace(scene)))
    assert re.search(expected, line)


def test_a_law_that_does_not_settle_is_no_answer() -> None:
    steep = "friction.coefficient=0.6", "friction.kinetic=0.1", "friction.slip_half=20"
    keys = (SLIP_LAW[1], *steep, "rolling.creepage_along=0.3%", "rolling.speed=80", FAST)
    result = solved("hertz_ellipse", *keys)
    assert not result.passed and "longer memory" in str(result.summary)
    assert "--fast" not in result.summary["checks"]["advice"]["converged"]

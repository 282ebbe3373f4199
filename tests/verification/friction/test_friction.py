"""Friction: Carter's strip, Cattaneo and Mindlin's patch, Kalker's rolling, and what must hold."""

import math

import coupled_punch
import meshio
import numpy as np
import pytest
from friction_data import ENTRIES
from one_line import refusal
from scipy.integrate import quad
from solved import assembled, draw_only, friction, passed, solved

import railhead as rh
from railhead.planning import simulation_plan as planning
from railhead.run import mesh_solution
from railhead.solver.system.pressed_surfaces import surface_tangents
from railhead.sweeps import sweep_table
from railhead.theory.friction import partial_slip

MU = 0.3
SLOW = pytest.mark.slow
CARTER = [ENTRIES[f"carter_q{share}"] for share in (0.36, 0.64, 0.84, 0.96)]


def roller(**changes: object) -> rh.Scene:
    """R 420 on a flat, 110 kN over 70 mm."""
    return rh.find("long_roller").replace(friction={"coefficient": MU}).replace(**changes)


def ellipse(**changes: object) -> rh.Scene:
    """R 420 on 300 mm, on four elements a semi-axis."""
    scene = rh.find("hertz_ellipse").replace(friction={"coefficient": MU})
    return scene.replace(mesh={"patch_size": 0.87}).replace(**changes)


@pytest.mark.parametrize("entry", [CARTER[0], pytest.param(CARTER[3], marks=SLOW)],
                         ids=lambda entry: entry["id"])  # fmt: skip
def test_a_strip_that_rolls_is_carter_s(entry) -> None:
    creepage, share = entry["creepage_xi"], entry["Q_over_muP"]
    answer = friction(passed(roller(rolling={"creepage_along": creepage, "speed": "72 km/h"})))
    assert answer["force_along_N"] / answer["limit_N"] == pytest.approx(share, abs=0.012)
    assert answer["stick_share"] == pytest.approx(entry["stick_half_width_over_a"], abs=0.03)
    assert (answer["t_gamma_N"], answer["power_W"]) == pytest.approx(
        (creepage * answer["force_along_N"], 20 * answer["t_gamma_N"])
    )


def test_blocks_are_half_planes_also_for_friction() -> None:
    """The creepage of a force is Carter's: mu a/R (1 - sqrt(1 - Q/mu P)); blocks of eight half
    widths were 1.3 % off on any mesh, three times what an accuracy of 5 % said."""
    rolling, mesh = {"force_along": 0.22 * MU * 110e3}, {"patch_size": 0.15}
    found = passed(roller(rail={"extent": "half-space"}, rolling=rolling, mesh=mesh))
    half_width = math.sqrt(4 * 110e3 / 70 * 420 / (math.pi * 207e3 / (2 * (1 - 0.3**2))))
    exact = MU * half_width / 420 * (1 - math.sqrt(1 - 0.22))
    assert friction(found)["creepage_along"] == pytest.approx(exact, rel=0.005)


@pytest.mark.parametrize("share", [0.3, pytest.param(0.9, marks=SLOW)])
def test_a_strip_that_is_shifted_is_cattaneo_s(share: float) -> None:
    found = passed(roller(friction={"force_along": share * MU * 110e3}))
    stick = ENTRIES[f"cattaneo_strip_q{share}"]["stick_half_width_over_a"]
    assert friction(found)["stick_share"] == pytest.approx(stick, abs=0.03)


def test_a_patch_that_is_shifted_is_mindlin_s() -> None:
    """With the far field of Cerruti the displacement is that of half-spaces."""
    force = 0.5 * MU * 25e3
    found = passed(ellipse(friction={"force_along": force}))
    along, _ = partial_slip.initial_compliance(found.ellipse.a, found.ellipse.b, 207e3 / 2.6, 0.3)
    limit = MU * found.ellipse.load
    exact = partial_slip.ellipse_shift(along, limit, force / limit)
    answer, checks = friction(found), found.as_dict()["checks"]
    assert checks["second_opinion_shift"] < 0.02
    assert answer["shift_along_mm"] == pytest.approx(exact, rel=0.001)
    assert math.sqrt(answer["stick_share"]) == pytest.approx(
        partial_slip.ellipse_stick_ratio(force / limit), abs=0.005
    )


@pytest.mark.parametrize(
    ("poisson", "coefficient"),
    [(0.3, 0.3), *(pytest.param(*given, marks=SLOW) for given in ((0.09, 0.52), (0.3, 0.15)))],
)
def test_unlike_bodies_stick_where_a_growing_punch_does(poisson: float, coefficient: float) -> None:
    """A rigid roller, whose tractions raise the pressure in the middle. Spence's formula, which
    leaves that out, has 0.74, 0.81 and 0.20."""
    rail = {"poisson_ratio": poisson, "extent": "half-space"}
    scene = roller(friction={"coefficient": coefficient}, load=20e3, rail=rail)
    found = passed(scene.replace(wheel={"young_modulus": math.inf}))
    beta = (1 - 2 * poisson) / (2 - 2 * poisson)
    expected = coupled_punch.stick_half_width(coefficient, beta)
    assert friction(found)["stick_share"] == pytest.approx(expected, abs=0.01)


STEEL = {"yield_stress": 300.0, "hardening_modulus": 5e3}


def yielding(**changes: object) -> rh.Scene:
    """The roller at three times its load of first yield, on a coarse mesh, shifted by mu N / 3."""
    scene = roller(load=600e3, friction={"force_along": 60e3}, mesh={"patch_size": 2.0})
    return scene.replace(rail=STEEL, wheel=STEEL, unload=False).replace(**changes)


@pytest.fixture(scope="module")
def yielded():
    """Half-spaces of which one yields, on a coarse mesh."""
    plan = planning.make(yielding(rail=STEEL | {"extent": "half-space"}, unload=True))
    model = assembled(plan)
    return model, mesh_solution.solve(plan, model)


def test_a_shift_makes_bodies_yield_further(yielded) -> None:
    _, found = yielded
    assert found.newton.converged
    rubbing, plain = found.friction, found.reference
    assert rubbing.force[0] == pytest.approx(60e3, rel=1e-3)
    assert np.all(np.linalg.norm(rubbing.traction, axis=1) <= MU * rubbing.pressure * (1 + 1e-9))
    shear = found.plastic_strain.equivalent.max() / plain.plastic_strain.equivalent.max()
    assert shear > 1.05  # the shift adds to what the load has done


def test_unloaded_half_spaces_are_pulled_by_nothing(yielded) -> None:
    """What lies beyond them followed the shift, and is back where it was."""
    model, found = yielded
    left = found.plasticity.residual_state
    assert left.newton.converged
    held = model.masks[model.clamp]
    for state, least, most in ((found, 1e-4, 1.0), (left, 0.0, 0.0)):
        assert least <= abs(state.displacement.array.reshape(-1, 2)[held, 0]).max() <= most


def test_yield_takes_shear_stress_at_the_surface() -> None:
    """Where contact points have the plastic strain eps_xz = 1e-3: 2 mu t . eps . n on level
    surfaces, t along x and the slave's normal up or down."""
    model = assembled(planning.make(yielding()))
    response = model.response()
    response.problem.surface.history.plastic[:, 3] = np.sqrt(2) * 1e-3  # Mandel's notation
    normals, setup = model.interface.normals, model.setup
    out = normals if setup.slave == setup.fixed.tag else -normals
    every = np.arange(len(normals))
    lost = response.plastic_shear_stress(every, surface_tangents(out), normals)[:, 0]
    middle = np.abs(model.interface.points[:, 0]) < 3.0
    expected = np.sign(normals[middle, 1]) * 2 * 207e3 / 2.6 * 1e-3
    assert middle.sum() > 5 and lost[middle] == pytest.approx(expected, rel=0.01)


def test_nothing_pushes_a_sphere_aside_that_is_pressed() -> None:
    """A meridian section has no motion along: tractions vanish on the axis and point inwards."""
    found = passed(rh.find("sphere_on_plane").replace(friction={"coefficient": MU}))
    rubbing = found.mesh_solution.solution.friction
    assert friction(found)["shift_along_mm"] == 0 and 0.65 < friction(found)["stick_share"] < 0.85
    radius, along = rubbing.points[:, 0], rubbing.traction[:, 0]
    size = np.abs(along).max()
    assert rubbing.weights @ np.maximum(along, 0.0) < 0.05 * rubbing.weights @ np.abs(along)
    assert np.abs(along[radius < 0.03 * radius.max()]).max() < 0.3 * size
    whole = found.tractions
    assert whole.weights.sum() == pytest.approx(rubbing.weights.sum())
    assert abs(whole.weights @ whole.traction[:, 0]) < 1e-9 * (rubbing.weights @ np.abs(along))


def test_tractions_on_a_curved_surface_carry_their_part_of_the_load() -> None:
    """A soft ball on a rigid plane: they are inclined by up to 0.2, and push by 2 % of the load."""
    ball = rh.Wheel(profile="arc", rolling_radius=20, transverse_radius=20, young_modulus=3000)
    plane = rh.Rail(profile="arc", crown_radius=math.inf, young_modulus=math.inf)
    scene = rh.Scene(load=1e4, rail=plane, wheel=ball, mesh={"patch_size": 0.5})
    solution = passed(scene.replace(friction={"coefficient": MU})).mesh_solution.solution
    push = -solution.friction.weights @ solution.friction.traction[:, 2]
    assert 200 < push < 300 and solution.load == pytest.approx(solution.reaction, rel=1e-9)


@pytest.mark.parametrize("method", ["nitsche", pytest.param("penalty", marks=SLOW)])
def test_bodies_of_different_shape_drive_without_creepage_whatever_the_law(method: str) -> None:
    """A disc and a block of one steel are pressed differently: 0.0032 mu P on meshes three times as
    fine."""
    answer = friction(solved(roller(rolling={"creepage_along": 0.0}, solver={"method": method})))
    assert answer["force_along_N"] / answer["limit_N"] == pytest.approx(0.0032, abs=8e-4)


def test_friction_that_nothing_calls_for_changes_no_bit() -> None:
    plain = solved(rh.find("long_roller")).as_dict()
    idle = solved(roller()).as_dict()
    assert idle["result"] == plain["result"] and idle["newton"] == plain["newton"]
    assert "frictionless" not in idle
    without = roller(rolling={"creepage_along": 1e-3}, effects={"friction": "off"})
    assert solved(without).as_dict()["result"] == plain["result"]


def test_unlike_bodies_dissipate_what_slips() -> None:
    """A rigid wheel is driven at a creepage above 0: forces times creepages would be a gain."""
    found = solved(
        roller(rolling={"creepage_along": 5e-4}, mesh={"patch_size": 0.6}),
        "wheel.young_modulus=inf",
    )
    answer = friction(found)
    assert answer["force_along_N"] < 0 < answer["t_gamma_N"]
    assert sweep_table.row(sweep_table.record({}, {}, found))["T-gamma [N]"] == answer["t_gamma_N"]


def test_forces_on_a_rigid_wheel_balance_on_an_inclined_surface() -> None:
    """Pressing shears a crown outwards, so tractions carry 6 N of 10 kN beside the pressure."""
    block = {"width": 40, "depth": 15, "length": 30}
    scene = rh.Scene(
        load=10e3,
        quantities="patch,forces",
        rail=rh.Rail(profile="arc", crown_radius=80, **block),
        wheel=rh.Wheel(rolling_radius=200, young_modulus=math.inf),
        friction=rh.Friction(coefficient=0.3),
        rolling=rh.Rolling(creepage_along=1e-3),
        mesh=rh.Mesh(patch_size=1.0),
    )
    found = solved(scene)
    assert found.summary["checks"]["force_balance"] < 1e-9
    assert found.load == pytest.approx(10e3, rel=1e-9)


@pytest.mark.parametrize(
    "keys, line",
    [
        ({"friction": {"force_along": 40e3}}, "friction.force_along: 40000 N would slide"),
        ({"rolling": {"force_along": 40e3}}, "rolling.force_along: 40000 N would slide"),
        ({"rolling": {"creepage_along": 1e-3, "force_along": 1e3}}, "rolling.force_along: is not"),
        ({"rolling": {"speed": 20}}, "rolling.speed: is not allowed without"),
        ({"rolling": {"creepage_across": 1e-3}}, "rolling: across the rail is not allowed"),
        ({"rolling": {"creepage_along": 2}}, "rolling.creepage_along: 2 is not allowed"),
        ({"friction": {"force_along": 1e3}, "rolling": {"spin": 1e-4}}, "rolling: is not allowed"),
        ({"rolling": {"creepage_along": 1e-3}, "mesh": {"order": 1}}, "mesh.order: 1 is not"),
        (
            {
                "rolling": {"creepage_along": 1e-3},
                "rail": STEEL,
                "load": 600e3,
                "effects": {"plasticity": "on"},
            },
            "effects.plasticity: 'on' is not allowed: rolling is solved elastically",
        ),
    ],
)
def test_what_cannot_be_is_one_line(keys, line: str) -> None:
    assert line in refusal(lambda: rh.plan(roller(**keys)))


def test_the_files_show_stick_slip_and_tractions(tmp_path, monkeypatch) -> None:
    draw_only(monkeypatch, "friction")
    force = CARTER[1]["Q_over_muP"] * MU * CARTER[1]["load_N"]
    solved(roller(rolling={"force_along": force})).save(tmp_path / "out", report=False)
    points = meshio.read(tmp_path / "out" / "traction.vtu").point_data
    size = np.linalg.norm(points["traction"], axis=1)
    assert (size <= MU * points["pressure"] * (1 + 1e-9)).all()
    slips = points["sticks"] == 0
    assert size[slips] == pytest.approx(MU * points["pressure"][slips])
    assert (
        np.abs(points["slip"][slips, 0]) > 10 * np.abs(points["slip"][~slips, 0]).max()
    ).mean() > 0.5
    assert (tmp_path / "out" / "friction.png").is_file()


# A coefficient that depends on the angle of the rail's surface.

CROWN = 80.0
PAIRS = [[0, 0.2], [4, 0.6]]
KINDS = {
    "half-spaces": {"effects.finite_bodies": "off"},
    "solids": {"mesh.patch_size": "2 mm"},
    "unlike solids": {"mesh.patch_size": "2.5 mm", "wheel.poisson_ratio": 0.25},
}


def slides(kind: str, coefficient: object) -> rh.Result:
    """A wheel that slips everywhere on the middle of a round rail."""
    scene = rh.Scene(
        load=60e3,
        rail=rh.Rail(profile="arc", crown_radius=CROWN),
        wheel=rh.Wheel(profile="arc", rolling_radius=420, transverse_radius=-120),
        friction={"coefficient": coefficient},
        rolling={"creepage_along": 0.2},
    )
    return solved(scene.replace(**KINDS[kind]))


@pytest.mark.parametrize("kind", KINDS)
def test_what_slips_everywhere_carries_the_integral_over_hertz_s_pressure(kind: str) -> None:
    """p over the chords is 3 N/(4 b) (1 - y^2/b^2), the angle at y on the circle -asin(y/R); only
    the side of the gauge, y < 0, has more than 0.2."""
    found = slides(kind, PAIRS)
    b = found.as_dict()["hertz"]["patch"]["b_mm"]

    def integral(arm: float) -> float:
        """Of mu p (1 - arm + arm y) over N."""

        def share(t: float) -> float:
            angle = -math.asin(t * b / CROWN)
            mu = np.interp(math.degrees(angle), *zip(*PAIRS, strict=True))
            return float(0.75 * (1 - t * t) * mu * (1 - arm - arm * CROWN * angle))

        return float(quad(share, -1, 1)[0])

    answer, within = friction(found), 2e-3 if kind == "half-spaces" else 0.01
    assert (answer["force_along_N"] / 60000.0, answer["coefficient"]) == pytest.approx(
        (integral(0), integral(0)), rel=within
    )
    assert answer["moment_Nmm"] / 60e3 == pytest.approx(-integral(1), rel=10 * within)

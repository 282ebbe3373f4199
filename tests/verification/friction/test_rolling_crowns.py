"""Rolling of crowned bodies against a solver of its own: cells on the chords of Hertz's ellipse."""

import math

import numpy as np
import pytest
from friction_cases import MU, friction_found

import railhead as rh
from railhead.contact import wheelset_kinematics
from railhead.half_spaces.surface import develop
from railhead.planning import simulation_plan as planning
from railhead.run.half_spaces.second_method import solve_by_boundary_elements

YOUNG, POISSON, RADIUS, CREEPAGE = 207e3, 0.3, 420.0, (1e-3, 4e-4, 1e-4)


def plan(crown: float, tread: float = math.inf, **more: object) -> planning.Plan:
    """Plan of a crown under a tread that rolls; a radius of the tread is positive outwards."""
    wheel = {"profile": "cylinder", "rolling_radius": RADIUS}
    if math.isfinite(tread):
        wheel |= {"profile": "arc", "transverse_radius": tread}
    young = {key: more.pop(key, YOUNG) for key in ("rail", "wheel")}
    given = rh.Scene(
        load=25e3,
        rail={"profile": "arc", "crown_radius": crown, "young_modulus": young["rail"]},
        wheel=wheel | {"young_modulus": young["wheel"]},
        friction={"coefficient": MU},
        rolling=dict(zip(("creepage_along", "creepage_across", "spin"), CREEPAGE, strict=True)),
        effects={"plasticity": "off"},
    )
    return planning.make(given.replace(**more))


def rolled(a: float, b: float, load: float, bend: float, cells: int) -> np.ndarray:
    """Forces along and across, N, and T-gamma, N, of a steel ellipse whose pressed surfaces lie at
    bend y^2: each line along x has cells of its own from edge to edge, with forces in their middles
    and slip half a cell ahead (Cerruti); Coulomb's law by Newton's method on the projection."""
    width, part = 2 * b / cells, (np.arange(9) + 0.5) / 9 - 0.5
    y = (np.arange(cells) + 0.5) * width - b
    beside = 1 - ((y[:, None] + width * part) / b) ** 2
    chord, ends = np.sqrt(beside).mean(axis=1), np.linspace(-1, 1, cells + 1)
    shape = np.diff(ends * np.sqrt(1 - ends**2) + np.arcsin(ends)) * cells / 4
    x = (a * chord[:, None] * (ends[1:] + ends[:-1]) / 2).ravel()
    half, y = np.repeat(a * chord / cells, cells), np.repeat(y, cells)
    pressure, area = (beside.mean(axis=1) / chord)[:, None] * shape, 2 * half * width
    pressure = pressure.ravel() * load / (pressure.ravel() @ area)
    ahead, kernel = x[:, None] + half[:, None] - x, np.zeros((3, x.size, x.size))
    for sign in (1, -1):
        edge = y[:, None] - y + sign * width / 2
        r = np.hypot(ahead, edge)
        whole, bent = edge / (ahead * r), POISSON * ahead * edge / r**3
        kernel += sign * np.array(
            [(1 - POISSON) * whole + bent, POISSON * edge**2 / r**3, whole - bent]
        )
    xx, xy, yy = kernel * 4 * half * (1 + POISSON) / (math.pi * YOUNG)
    response = np.block([[xx, xy], [xy, yy]])

    def slip(x: np.ndarray) -> np.ndarray:
        along, across, spin = CREEPAGE
        return np.concatenate(
            [along - spin * y + bend * y**2 / RADIUS, across + (spin - 2 * bend * y / RADIUS) * x]
        )

    bound, given, scale = MU * pressure, slip(x + half), 1 / np.diag(xx)[:, None]
    scale = np.tile(scale.ravel(), 2)
    traction = given * np.tile(bound / np.hypot(*given.reshape(2, -1)), 2)
    for _ in range(60):
        trial = traction + scale * (given - response @ traction)
        size = np.hypot(*trial.reshape(2, -1))
        slides, share = size > bound, bound / size
        left = traction - trial * np.tile(np.where(slides, share, 1.0), 2)
        if abs(left).max() < 1e-7 * bound.max():
            break
        unit = trial.reshape(2, -1) / size
        kept = np.where(slides, share * (np.eye(2)[..., None] - unit[:, None] * unit), 0.0)
        kept += np.where(slides, 0.0, np.eye(2)[..., None])
        kept = np.block([[np.diag(kept[i, j]) for j in (0, 1)] for i in (0, 1)])
        change = np.eye(2 * x.size) - kept + (kept * scale) @ response
        traction = traction - np.linalg.solve(change, left)
        over = np.tile(np.maximum(np.hypot(*traction.reshape(2, -1)) / bound, 1.0), 2)
        traction /= over
    else:
        raise AssertionError("tractions do not settle")
    tractions = traction.reshape(2, -1)
    return np.array([*(tractions @ area), area @ (tractions * slip(x).reshape(2, -1)).sum(axis=0)])


@pytest.mark.parametrize("crown, tread", [(300.0, math.inf), (150.0, -400.0), (1e4, 250.0)])
def test_crowns_roll_by_the_wheels_radius_when_pressed(crown: float, tread: float) -> None:
    """Forces within 0.1 % of mu N, T-gamma within 0.2 %: half way between both surfaces."""
    made = plan(crown, tread)
    a, b, load = made.hertz.a, made.hertz.b, made.hertz.load
    bend = (1 / tread - 1 / crown) / 4
    coarse, fine = (rolled(a, b, load, bend, cells) for cells in (8, 16))
    expected = 2 * fine - coarse
    answer = solve_by_boundary_elements(
        made,
        friction_found(MU * load, CREEPAGE),
        made.hertz,
        (16, 32),
    )
    assert answer["force_along_N"] == pytest.approx(expected[0], abs=1e-3 * MU * load)
    assert answer["force_across_N"] == pytest.approx(expected[1], abs=1e-3 * MU * load)
    assert answer["t_gamma_N"] == pytest.approx(expected[2], rel=2e-3)


@pytest.mark.parametrize("rail, wheel, share", [
    (YOUNG, YOUNG, 0.5), (YOUNG, math.inf, 0.0), (math.inf, YOUNG, 1.0), (YOUNG, 3 * YOUNG, 0.25),
])  # fmt: skip
def test_the_wheels_own_displacement_moves_its_points(
    rail: float, wheel: float, share: float
) -> None:
    """Along h/R and across -x h'/R, with h between the tread and the crown by the wheel's share of
    the compliance. Finite elements, whose strains hold that displacement, have the tread's h."""
    made = plan(300.0, -900.0, rail=rail, wheel=wheel)
    x, s = np.array([-3.0, 0.0, 2.0]), np.linspace(-4, 4, 161)
    slip = develop(made.contact).slip(x, s)
    lower, upper = (math.copysign(1, r) * (r**2 - s**2) ** 0.5 - r for r in (300.0, 900.0))
    height = share * lower + (1 - share) * upper
    bent = np.gradient(height, s)
    np.testing.assert_allclose(slip[3, 0, 1], height / RADIUS, atol=2e-8)
    np.testing.assert_allclose(slip[3, 1], -x[:, None] * bent / RADIUS, atol=1e-6)
    points = develop(made.contact).points(0 * s, s)
    still = wheelset_kinematics.rigid_slip(made.contact)(points)
    np.testing.assert_allclose(still[3, :, 0], upper / RADIUS, atol=2e-8)

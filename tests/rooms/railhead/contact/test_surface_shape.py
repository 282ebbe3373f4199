"""First contact of surfaces that vary along the rail."""

import math
from pathlib import Path

import numpy as np
import pytest
from one_line import refusal
from scipy.optimize import minimize_scalar

from railhead.contact import solid
from railhead.half_spaces.surface import develop
from railhead.planning import simulation_plan
from railhead.scene.scene import Scene, SceneError

BASE = Scene(
    load=10e3,
    rail={"profile": "arc", "crown_radius": 300.0},
    wheel={"rolling_radius": 450.0},
    effects={"finite_bodies": "off"},
)
FLAT = {"wheel.surface.kind": "flat", "wheel.surface.length": 100.18, "wheel.surface.depth": 0.9}
WAVES = {"rail.surface.kind": "cosine", "rail.surface.length": 60.0, "rail.surface.amplitude": 0.05}


@pytest.mark.parametrize("degrees", [5.0, 3.0, 1.0, -3.0])
def test_a_flat_wheel_stands_on_its_lowest_point(degrees: float) -> None:
    """Its height is the least depth of the flat's own curve below the axle."""
    contact = solid.locate(BASE.replace(**FLAT, **{"wheel.surface.position": f"{degrees} deg"}))

    def depth(turn: float) -> float:
        """Negative depth below the axle of the tread at an angle ahead of the lowest line."""
        s = 450.0 * (turn + math.radians(degrees))
        hollow = 0.45 * (1 + math.cos(math.pi * s / 50.09)) if abs(s) < 50.09 else 0.0
        return -(450.0 - hollow) * math.cos(turn)

    side = math.copysign(1.0, degrees)
    found = minimize_scalar(
        depth, bounds=sorted((0.0, 0.05 * side)), method="bounded", options={"xatol": 1e-9}
    )
    assert contact.pose.origin[2] - contact.shape.pose.origin[2] == pytest.approx(
        450.0 + found.fun, abs=1e-9
    )
    ahead = -found.fun * math.tan(found.x)
    assert contact.shape.first == pytest.approx((ahead, 0.0), abs=1e-4)


def test_the_gap_is_nowhere_negative_and_touches() -> None:
    contact = solid.locate(BASE.replace(**WAVES, **{"rail.surface.position": 11.0}))
    surface = develop(contact)
    x, s, height = surface.locus(0.02)
    assert -1e-10 < height.min() < 1e-4
    at = np.array(contact.shape.first)
    assert surface.gap(at[:1], np.interp(at[1:], surface.y, surface.s)) == pytest.approx(
        0, abs=1e-9
    )


@pytest.mark.parametrize(
    "keys, odd",
    [
        ({}, (False, False)),
        ({"rail.surface.position": 30.0}, (False, False)),
        ({"rail.surface.position": 7.0}, (True, False)),
        ({"wheelset.yaw": 0.01}, (False, False)),
    ],
)
def test_symmetry_goes_where_the_shape_takes_it(keys: dict, odd: tuple[bool, bool]) -> None:
    contact = solid.locate(BASE.replace(**WAVES, **keys))
    assert contact.shape.odd == odd
    assert (contact.why_asymmetric_in_x() is None) == (not odd[0] and not keys.get("wheelset.yaw"))


def test_a_dent_beside_the_middle_takes_the_symmetry_across(tmp_path: Path) -> None:
    x, y = np.linspace(-10, 10, 21), np.linspace(-8, 12, 21)
    dent = -0.05 * np.exp(-((x[:, None] / 4) ** 2) - ((y - 2) / 4) ** 2)
    np.savez(tmp_path / "dent.npz", x=x, y=y, height=dent)
    keys = {"rail.surface.kind": "map", "rail.surface.file": str(tmp_path / "dent.npz")}
    contact = solid.locate(BASE.replace(**keys))
    assert contact.shape.odd == (False, True)
    assert contact.why_asymmetric_in_y() == "the surface differs at y and -y"
    np.savez(tmp_path / "dent.npz", x=x[:2], y=y, height=dent[:2])
    line = refusal(lambda: solid.locate(BASE.replace(**keys)))
    assert line.startswith("rail.surface.file: dent.npz has 2 places along")


@pytest.mark.parametrize("keys", [{"wheel.surface.depth": 0.0}, {"wheel.surface.position": 60.0}])
def test_what_adds_nothing_changes_nothing(keys: dict) -> None:
    """A height of 0, and a flat that is out of reach."""
    smooth = simulation_plan.make(BASE)
    made = simulation_plan.make(BASE.replace(**(FLAT | keys)))
    assert made.contact.shape is None and not made.effects["surface_shape"].called_for
    assert made.forecast.zones == smooth.forecast.zones
    assert made.hertz == smooth.hertz and made.contact.touch == smooth.contact.touch


@pytest.mark.parametrize("amplitude, called", [(1e-3, False), (4e-3, True)])
def test_heights_below_half_of_the_accuracy_are_left_out(amplitude: float, called: bool) -> None:
    """The bodies would overlap 4.5 mm either way, where waves of 60 mm fall by 0.11 of their
    amplitude; the approach is 0.023 mm. What is left out counts as an error."""
    made = simulation_plan.make(BASE.replace(**(WAVES | {"rail.surface.amplitude": amplitude})))
    assert made.effects["surface_shape"].called_for == called == (made.contact.shape is not None)
    change = 0.11 * amplitude / 0.023
    assert made.effects["surface_shape"].error == pytest.approx(0 if called else change, abs=5e-4)


STEEP = {**WAVES, "rail.surface.length": 10.0, "rail.surface.amplitude": 0.2}
PIT = {"rail.surface.kind": "flat", "rail.surface.length": 0.01, "rail.surface.depth": 100.0}


@pytest.mark.parametrize(
    "keys, words",
    [
        ({**STEEP, "rail.surface.position": 2.5}, "its slope is up to 0.12"),
        (PIT, "its height changes within 0.01 mm, as roughness does"),
    ],
)
def test_steep_slopes_and_roughness_are_no_shape(keys: dict, words: str) -> None:
    """The slope of waves is 2 pi times amplitude over length; what changes between the places that
    are looked at is refused, not overlooked."""
    line = refusal(lambda: simulation_plan.make(BASE.replace(**keys)))
    assert line.startswith(f"rail.surface: {words}")


@pytest.mark.parametrize("load", [1e-6, 1.0, 10e3])
def test_the_patch_is_forecast_where_the_surfaces_touch(load: float) -> None:
    """Whatever its size beside the steps of the search."""
    keys = {"load": load, "wheel.surface.position": "3 deg"}
    made = simulation_plan.make(BASE.replace(**(FLAT | keys)))
    (zone,) = made.forecast.zones
    assert zone.centre[0] == pytest.approx(made.contact.shape.first[0], abs=0.1 * zone.a)
    assert made.forecast.reason == ""


def test_the_effect_may_be_switched_off() -> None:
    made = simulation_plan.make(BASE.replace(**WAVES, **{"effects.surface_shape": "off"}))
    assert made.effects["surface_shape"].called_for and made.contact.shape is None
    with pytest.raises(SceneError, match=r"effects\.surface_shape: 'on' is not allowed"):
        simulation_plan.make(BASE.replace(**{"effects.surface_shape": "on"}))

"""Half-spaces beside a solved mesh: what they take from its solution."""

from types import SimpleNamespace

import pytest

from railhead.meshing.bodies import RAIL, WHEEL
from railhead.postprocess.patch import body_motion
from railhead.run.half_spaces import normal_contact


def test_motion_takes_the_normal_force_and_not_the_load(monkeypatch: pytest.MonkeyPatch) -> None:
    """At a contact inclined by 60 degrees the normal force is twice the load."""
    forces = []

    def motion(fields, body: int, patches, load: float) -> tuple[float, float]:
        forces.append(load)
        return (3e-4, 0.02) if body == RAIL else (1e-4, 0.05)

    monkeypatch.setattr(body_motion, "motion", motion)
    patch = SimpleNamespace(
        mean_pressure=500.0, area=100.0, each=(SimpleNamespace(centre=(0.0, 30.0, -10.0)),)
    )
    solved = SimpleNamespace(
        plan=SimpleNamespace(plane_model=False, deformable=(RAIL, WHEEL)),
        findings=SimpleNamespace(patch=patch),
        fields=SimpleNamespace(),
        solution=SimpleNamespace(load=25e3),
    )
    angle, aside = normal_contact.motion(solved)
    assert forces == [50e3, 50e3]
    assert angle == pytest.approx(3e-4 - 1e-4)
    assert aside == pytest.approx(0.05 - 0.02 + angle * 10.0)

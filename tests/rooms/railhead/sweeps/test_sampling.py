"""Laws of samples, quantiles, shares of variance and their errors against closed forms."""

import math

import numpy as np
import pytest
from scipy.special import ndtri

from railhead.scene.scene import SceneError
from railhead.sweeps import sampling

LOAD, RADIUS = 0.2, 0.3  # standard deviations of the logarithms


def laws(**texts: str) -> dict[str, sampling.Law]:
    """Laws by key."""
    found = {key: sampling.law(key, text) for key, text in texts.items()}
    assert None not in found.values()
    return found  # type: ignore[return-value]


@pytest.mark.parametrize(
    ("text", "quantiles"),
    [
        ("normal(25kN, 2kN)", [25e3 + 2e3 * ndtri(0.05), 25e3, 25e3 + 2e3 * ndtri(0.95)]),
        ("lognormal(25kN, 0.2)", [25e3 * math.exp(0.2 * ndtri(0.05)), 25e3,
                                  25e3 * math.exp(0.2 * ndtri(0.95))]),
        ("uniform(20kN,30kN)", [20.5e3, 25e3, 29.5e3]),
    ],
)  # fmt: skip
def test_a_sample_has_the_quantiles_of_its_law(text, quantiles) -> None:
    drawn = [row["load"] for row in sampling.draw(laws(load=text), 4096, sobol=False)]
    assert np.quantile(drawn, [0.05, 0.5, 0.95]) == pytest.approx(quantiles, rel=1e-3)


def test_a_choice_has_its_weights_and_its_texts() -> None:
    chosen = {"rail.profile": sampling.law("rail.profile", "choice(a.csv*3, b.csv, 54E1*4)")}
    drawn = [row["rail.profile"] for row in sampling.draw(chosen, 1024, sobol=False)]
    shares = [drawn.count(name) / 1024 for name in ("a.csv", "b.csv", "54E1")]
    assert shares == pytest.approx([3 / 8, 1 / 8, 4 / 8], abs=2e-3)


@pytest.mark.parametrize("sobol", [False, True])
def test_more_samples_keep_the_first_ones(sobol) -> None:
    both = laws(load="lognormal(25kN, 0.2)", approach="uniform(1, 2)")
    assert (
        sampling.draw(both, 37, sobol=sobol)
        == sampling.draw(both, 100, sobol=sobol)[: 37 * (4 if sobol else 1)]
    )


@pytest.mark.parametrize(
    "text",
    ["normal(25kN)", "normal(25kN, 0)", "normal(25kN, 2mm)", "uniform(2kN, 1kN)", "lognormal(0, 1)",
     "lognormal(25kN, 2kN)", "choice()", "choice(1kN*0, 2kN)", "choice(1kN*x)",
     "choice(1kN*nan)", "choice(1kN*inf)", "normal(25kN, inf)"],
)  # fmt: skip
def test_a_wrong_law_is_one_line(text) -> None:
    with pytest.raises(SceneError, match=r"^load: .*is no law; give"):
        sampling.law("load", text)
    assert sampling.law("load", "25kN,50kN") is None


@pytest.mark.parametrize("text", ["normal(25kN, 2)", "uniform(2, 1kN)", "choice(1kN*2, 2*3)"])
def test_a_number_without_unit_beside_one_with_unit_is_refused(text) -> None:
    with pytest.raises(SceneError, match="has no unit and others have one"):
        sampling.law("load", text)


def pressures(count: int) -> np.ndarray:
    """p0 = N^(1/3) R^(-2/3) of samples in groups."""
    both = laws(load=f"lognormal(1, {LOAD})", approach=f"lognormal(1, {RADIUS})")
    rows = sampling.draw(both, count, sobol=True)
    return np.array([row["load"] ** (1 / 3) * row["approach"] ** (-2 / 3) for row in rows])


def test_shares_and_quantiles_of_a_lognormal_pressure() -> None:
    """With s1 = 0.2/3, s2 = 0.4 / 2: the share of one key is (exp(s^2) - 1)/(exp(s1^2 + s2^2) - 1),
    the total share one less that of the other."""
    one, two = (math.expm1((LOAD / 3) ** 2), math.expm1((RADIUS * 2 / 3) ** 2))
    all_ = math.expm1((LOAD / 3) ** 2 + (RADIUS * 2 / 3) ** 2)
    values = pressures(1024)
    found = sampling.summary({"p": (values, 0.01 * values)}, {}, ["load", "radius"])
    for key, first, other in (("load", one, two), ("radius", two, one)):
        own = found["sobol"]["p"][key]
        assert (own["first"], own["total"]) == pytest.approx(
            (first / all_, 1 - other / all_), abs=0.02
        )
        assert abs(own["first"] - first / all_) < own["error"] < 0.1
    sigma = math.hypot(LOAD / 3, RADIUS * 2 / 3)
    for share, own in found["quantiles"]["p"].items():
        exact = math.exp(sigma * ndtri(float(share)))
        assert abs(own["value"] - exact) < own["error"] < 0.1 * exact
        assert own["estimate"] == pytest.approx(0.01 * own["value"], rel=1e-9)
    assert found["quantiles"]["p"]["0.5"]["value"] == pytest.approx(1.0, rel=5e-3)


def test_errors_of_sampling_hold_in_19_of_20_samples() -> None:
    """Of 400 samples of 300 normal values."""
    chance, held = np.random.default_rng(5), dict.fromkeys(map(str, sampling.SHARES), 0)
    for _ in range(400):
        drawn = chance.normal(size=300)
        found = sampling.summary({"x": (drawn, 0 * drawn)}, {}, [])["quantiles"]["x"]
        for share, own in found.items():
            wide = math.inf if own["error"] is None else own["error"]
            held[share] += abs(own["value"] - ndtri(float(share))) <= wide
    assert all(number >= 0.93 * 400 for number in held.values()), held


def test_too_few_samples_and_missing_ones_are_said() -> None:
    values = np.array([1.0, 2.0, math.nan, 4.0])
    found = sampling.summary({"x": (values, np.array([0.1, math.nan, 0, 0]))}, {2: "no"}, [])
    assert found["samples"] == 4 and found["failed"] == {"count": 1, "names": {"2": "no"}}
    assert found["quantiles"]["x"]["0.5"] == {"value": 2.0, "error": None, "estimate": None}

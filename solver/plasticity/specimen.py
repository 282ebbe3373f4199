"""A bar of steel in tension and compression, driven by its strain or by its stress, and the
constants of a steel from measured bars.

The radial return of a solid with the shear modulus E/3 and the strains eps (1, -1/2, -1/2) is that
of a bar: its trial stress is E (eps - eps_p), its plastic strains are eps_p (1, -1/2, -1/2).
"""

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import find_peaks

from railhead.solver.material import Hardening, Material, backs
from railhead.solver.plasticity.radial_return import History, radial_return
from railhead.theory.array_types import Array

ALONG = np.array([1.0, -0.5, -0.5])
EXACT = 1e-9  # of the yield stress: error of a given stress
STEPS = 60  # most steps of Newton's method
SOFT = 1e-7  # slope over Young's modulus from which a bar carries no more
LINEAR = 0.4  # of the largest stress, up to which the start of a test is elastic
RECALLS = 2.0, 200.0  # over 1/(range of plastic strain): between these a fit's recalls start
YIELDS = 0.6  # of the largest stress: yield stress from which a fit starts
SOLUTIONS = 25  # most evaluations of a fit, without those of derivatives
MOST = 100  # rows of a test that count in a fit
SAME = 1e-4  # relative change of misfit and constants at which a fit ends
FAR = 4.0  # of a fit's logarithms from where it starts
WORTH = 1e-2  # of the largest stress: Voce's part is left out below
LEAST = 1e-5  # plastic strain of a test that goes beyond yield
ZERO = 0.05  # of the largest stress: what a test may start with
STIFF = 1e4, 1e6  # MPa, Young's moduli of metals: others are tests in other units


class Bar:
    """A bar that remembers what it went through.

    material: elastic constants and flow curve.
    strain, stress: where it is; stress in MPa.
    """

    def __init__(self, material: Material) -> None:
        """A bar without strain, stress and history."""
        assert material.hardening is not None
        self.young, self.law = material.young_modulus, material.hardening
        self.state = History.virgin(1, 3, backs([material]))
        self.strain = self.stress = 0.0

    def strained(self, strain: float) -> tuple[History, float, float]:
        """State, stress (MPa) and slope of the stress (MPa) of the bar at a strain; it stays where
        it is.
        """
        shear = np.array([self.young / 3])
        after, less = radial_return(strain * ALONG[None], shear, self.state, self.law)
        slope = self.young - sum(1.5 * float((each @ ALONG)[0]) for each in less.matrix)
        return after, self.young * (strain - float(after.plastic[0, 0])), slope

    def to_strain(self, strain: float) -> float:
        """Stress, MPa, after the way to a strain in one step, which the bar takes."""
        self.state, self.stress, _ = self.strained(strain)
        self.strain = strain
        return self.stress

    def to_stress(self, stress: float) -> float:
        """Strain after the way to a stress (MPa) in one step, which the bar takes. Raises
        ValueError (one line) for a stress that the steel does not carry.
        """
        strain = self.strain + (stress - self.stress) / self.young
        for _ in range(STEPS):
            state, found, slope = self.strained(strain)
            if abs(stress - found) <= EXACT * self.law.initial_yield_stress:
                self.state, self.strain, self.stress = state, strain, stress
                return strain
            if slope < SOFT * self.young:
                break
            strain += (stress - found) / slope
        raise ValueError(f"the steel does not carry {stress:.4g} MPa")


def stresses(material: Material, strains: Array) -> Array:
    """Stresses (n,), MPa, of a new bar at strains (n,), one after the other."""
    bar = Bar(material)
    return np.array([bar.to_strain(float(each)) for each in strains])


def fitted(
    strain: Array, stress: Array, count: int, exponent: float = 0.0
) -> tuple[Material, Array]:
    """Elastic constants and flow curve with `count` back stresses of a recall exponent, and with
    Voce's part where the strain turns back, which fit a measured bar best: least squares of its
    stresses (n,), MPa, at its strains (n,), of which some 100 (MOST) count, the turns among them.
    Also the relative standard errors (u,) of yield stress, moduli, recalls, and Voce's Q and b if
    these are worth it, as if the misfits were independent noise.

    Raises ValueError (one line) for a test that does not start at zero stress, that stays elastic,
    that has fewer rows than constants, or whose Young's modulus is not that of a metal (STIFF).
    """
    top = float(np.abs(stress).max())
    if abs(stress[0]) > ZERO * top:
        raise ValueError(f"the test starts at {stress[0]:.4g} MPa; give it from zero stress on")
    if len(strain) < 2 * count + 4:
        text = f"give {2 * count + 4} or more for {count} back stresses"
        raise ValueError(f"the test has {len(strain)} rows; {text}")
    start = slice(0, max(int(np.argmax(np.abs(stress) > LINEAR * top)), 2))
    flat = not np.ptp(strain[start])
    young = 0.0 if flat else float(np.polyfit(strain[start], stress[start], 1)[0])
    if not STIFF[0] <= young <= STIFF[1]:
        text = "give strain and stress in MPa, or name the units in the header: strain [%]"
        raise ValueError(f"the test starts with a Young's modulus of {young:.4g} MPa; {text}")
    plastic = strain - stress / young
    if np.ptp(plastic) <= LEAST:
        raise ValueError("the test stays elastic; give one that goes beyond yield")
    least = ZERO * float(np.ptp(strain))
    back = np.concatenate([find_peaks(way * strain, prominence=least)[0] for way in (1, -1)])
    recalls = np.geomspace(*RECALLS, count + 2)[1:-1] / np.ptp(plastic)
    first = [YIELDS * top, *(1 - YIELDS) * top / count * recalls, *recalls]
    voce = [ZERO * top, 3 / np.abs(np.diff(plastic)).sum()] if len(back) else []
    begin = np.log(first + voce)

    def made(logarithms: Array) -> Material:
        """The steel with these logarithms of constants."""
        least, *rest = np.exp(logarithms)
        pairs = list(zip(rest[:count], rest[count : 2 * count], strict=True))
        isotropic = rest[2 * count :] or (0.0, 0.0)
        law = Hardening.linear(least).cyclic(pairs, exponent, isotropic)
        return Material(young, 0.3, law)

    some = np.union1d(np.linspace(0, len(strain) - 1, min(len(strain), MOST)).astype(int), back)
    best = least_squares(
        lambda values: (stresses(made(values), strain[some]) - stress[some]) / top,
        begin,
        bounds=(begin - FAR, begin + FAR),
        max_nfev=SOLUTIONS,
        ftol=SAME,
        xtol=SAME,
    )
    worth = not voce or np.exp(best.x[-2]) > WORTH * top
    kept = slice(len(begin) if worth else len(first))
    variance, jacobian = 2 * best.cost / (len(some) - len(begin)), best.jac[:, kept]
    errors = np.sqrt(variance * np.diag(np.linalg.pinv(jacobian.T @ jacobian)))
    return made(best.x[kept]), errors

"""The running text of the page of the study thesis; every number in it is computed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from railhead.studies.tables import table
from railhead.studies.thesis.claims import Facts
from railhead.studies.thesis.hertz import PRINTED_LOAD, under
from railhead.studies.thesis.results import YIELD
from railhead.studies.thesis.runs import DEFAULT, HEXAHEDRA, WHEEL
from railhead.studies.thesis.stresses import P0, exact_stress, thesis_shear
from railhead.theory import subsurface

INTRODUCTION = """\
A. Negash, *Analysis of Wheel/Rail Contact Geometry and Applied Load Conditions on the Rail Head
Surface*, M.Sc. thesis, Addis Ababa University, 2012: wheel R 420, rail UIC54, 25 kN, with Hertz's
formulas, ANSYS SOLID185 and MATLAB. Each of 89 statements and equations is held against exact
theory, the real profiles and our finite elements. The verdicts are computed from the checks in the
tables at the end: a number must agree with exact theory, and with finite elements where there are
any (to 1 % more, as real bodies are no half-spaces). Why a claim is not computable, and the
remarks, are typed. The reference is an independent reading of the thesis; it was known when the
checks were chosen, so that agreement says that numbers bear it out, no more.
Made by `railhead study thesis`."""

CIRCLE_SHAKEDOWN = 4.7  # p0/k, circular patch
STRIP_SHAKEDOWN = 4.0  # p0/k, line contact


def findings(facts: Facts) -> str:
    """The five most important ones."""
    c, profile = facts.ellipse, facts.profiles
    real = under(c, WHEEL)
    extrema = subsurface.axis_extrema(c, facts.poisson)
    shear = (exact_stress(facts, 0.0).max() + c.p0) / 2
    mises = subsurface.axis_extrema(real, facts.poisson).von_mises_max
    return f"""\
1. **The contact point is not a result.** s2r = 0 is a fraction whose numerator is zero for every
   geometry, and s2w = 90 degrees puts the contact at the height of the axle: the rail's normal was
   used as its lateral tangent (12, 13, 27, 28). On the real 54E1 a 1:20 cone touches
   {-profile["y cone20 0"]:.2f} mm to the gauge side of the centre line of an upright rail,
   {-profile["y cone20 1:40"]:.2f} mm on one inclined 1:40, and on the centre line only at 1:20.
2. **The load is not that of a railway wheel.** 25 kN is 2.55 t; half a 22.5 t axle is
   {WHEEL / 1e3:.1f} kN. Then p0 is {real.p0:.0f} instead of {c.p0:.0f} MPa and the von Mises stress
   {mises:.0f} MPa, beyond the yield of R260: linear elasticity ends (38, 39, 75, 89).
3. **The headline is right.** p_max = {P0} MPa is {P0 / c.p0 - 1:+.3%} off, though two roundings had
   to cancel; K, K3, K4, theta, m, n and a are right, and table 5.3 is good from 1 degree on
   (42 to 56).
4. **The stresses below belong to another contact.** Formulas for a circle were put on an ellipse:
   the largest shear comes out as {thesis_shear(facts)[1]:.1f} instead of {extrema.tau_max:.1f} MPa
   and is said to lie 2.17 instead of {extrema.tau_max_depth:.2f} mm deep; at the surface it is
   {shear:.0f} MPa, not zero; s_1 = s_2 holds for circles only (61 to 68, 71, 72).
5. **The conclusions misread the pressure.** It is no uniform average but the peak of a
   semi-ellipsoid with mean {c.p_mean:.0f} MPa, and 600-800 MPa are the pressures of a laboratory
   test, not what a rail can carry (75, 84, 85)."""


def equations(facts: Facts) -> str:
    """The corrected geometry; m, A = cos, sin of yaw, n, B = cos, sin of bank."""
    profile = facts.profiles
    rows = [
        (tread, *(f"{profile[f'y {tread} {name}'] + 0.0:.2f}" for name in ("0", "1:40", "1:20")))
        for tread in ("cylinder", "cone40", "cone20")
    ]
    return rf"""A turn about x keeps x, and the three turns of eq 3.9 make a proper rotation:

$$A_\phi = \begin{{bmatrix}} 1 & 0 & 0 \\ 0 & \cos\phi & -\sin\phi \\ 0 & \sin\phi & \cos\phi
\end{{bmatrix}}, \qquad A^r = A_\varphi A_\phi A_\theta, \qquad \det A^r = 1 .$$

With the crown $z = f(s_2^r)$ swept along the rail, the tangents are the columns 1 and 2 of $A^r$,
the second one following the profile; column 3 is near the normal, not a tangent:

$$t_1^r = A^r \begin{{bmatrix}} 1 \\ 0 \\ 0 \end{{bmatrix}}, \quad
t_2^r = A^r \begin{{bmatrix}} 0 \\ 1 \\ f' \end{{bmatrix}}, \quad
n^r = t_1^r \times t_2^r = A^r \begin{{bmatrix}} 0 \\ -f' \\ 1 \end{{bmatrix}} .$$

The wheel's surface (eq 3.27, correct) has the derivatives and the normal

$$t_1^w = \begin{{bmatrix}} g' \sin s_2^w \\ 1 \\ g' \cos s_2^w \end{{bmatrix}}, \quad
t_2^w = \begin{{bmatrix}} g \cos s_2^w \\ 0 \\ -g \sin s_2^w \end{{bmatrix}}, \quad
t_2^w \times t_1^w = g \begin{{bmatrix}} \sin s_2^w \\ -g' \\ \cos s_2^w \end{{bmatrix}} .$$

The angle after a length of spiral (eq 3.20) needs the exponent 1 in its last term:

$$\varphi = \varphi_0 + \frac{{C_1 (S-S_0)^2 - C_0 (S-S_1)^2}}{{2 (S_1-S_0)}}
+ \frac{{C_0}}{{2}} (S_1 - S_0) .$$

The contact takes five equations, for two parameters of each surface and the height of the axle:

$$t_1^r \cdot r = 0, \quad t_2^r \cdot r = 0, \quad n^r \cdot r = 0, \quad
t_1^w \cdot n^r = 0, \quad t_2^w \cdot n^r = 0, \qquad r = r^w - u^r .$$

Without yaw the last one reads $-g \sin s_2^w = 0$: the contact is at the bottom of the wheel,
$s_2^w = 180^\circ$, instead of eq 4.30. The one before it then says that the slopes agree,
$f'(s_2^r) = -g'(s_1^w)$, and this gives the place across the rail.

Why the thesis finds $s_2^r = 0$: its "lateral tangent" $(-AB, mB, n)$ is the rail's normal, and
$u^r = t_2 s_2^r$ a straight line along it, so that both surfaces pass through one point whatever
their shape. With $\cos s_2^w = 0$ eqs 4.23 and 4.25 become

$$b_2 (s_1^w - L) + b_3 s_2^r = 0, \qquad a_2 (s_1^w - L) + a_3 s_2^r = 0,$$

homogeneous equations with the one solution $s_1^w = L$, $s_2^r = 0$: the numerator of eq 4.31,
$a_2 p_2 - b_2 p_1 = L a_2 b_2 - L b_2 a_2$, vanishes identically. No profile, inclination or cone
enters.

Where the wheel does touch the 54E1, mm from the centre of its crown (negative: gauge side):

{table(("tread", "upright", "inclined 1:40", "inclined 1:20"), rows)}"""


def elements(facts: Facts, runs: Sequence[Mapping[str, Any]]) -> str:
    """Linear hexahedra with a penalty beside the default, at 25 kN."""
    if not runs:
        return "Not run: closed forms only."
    own = [r for r in runs if r["elements"] == HEXAHEDRA]
    best = next(r for r in runs if r["elements"] == DEFAULT and abs(r["load"] - PRINTED_LOAD) < 1)
    names = ("a", "b", "p0", "tau_max", "tau_depth", "tau_surface")
    lines = []
    for row in (*own, best):
        errors = [f"{row[f'error_{name}']:+.1%}" for name in names]
        cost = row["unknowns"], f"{row['seconds'] / best['seconds']:.2f}"
        size = f"b/{row['per_semi_axis']:.0f}"
        lines.append((row["elements"], size, *cost, *errors, f"{row['surface_ratio']:.3f}"))
    header = ("elements", "size", "unknowns", "time", "a", "b", "p0", "tau_max", "its depth",
              "tau at the surface", "s_x / s_y")  # fmt: skip
    coarse = own[0]
    ratio = exact_stress(facts, 0.0)[0] / exact_stress(facts, 0.0)[1]
    return f"""\
The thesis gives neither mesh nor numbers of its SOLID185 model with node-to-node contact. Its
nearest relative here, linear hexahedra with a penalty (on meshes that need not match), shows what
such elements see; errors against exact Hertz, time relative to the last line:

{table(header, lines)}

With two elements across the smaller semi-axis, the largest shear is {coarse["error_tau_max"]:+.0%}
off and its depth {coarse["error_tau_depth"]:+.0%}. s_x/s_y at the centre is {ratio:.3f} exactly:
the difference between s_1 and s_2 that the thesis saw, and put down to the growth of a point, is of
the size of the errors of coarse linear elements. What no mesh could have shown: where the wheel
touches, as the contact was placed on the centre line by eq 4.32; the pressure between nodes, as
node-to-node contact knows forces at nodes only; and the error itself, as no result was compared
with a second mesh or with theory."""


def strength(facts: Facts, runs: Sequence[Mapping[str, Any]]) -> str:
    """25 kN and a real wheel against yield and shakedown."""
    c = facts.ellipse
    lines = []
    for load in (PRINTED_LOAD, WHEEL):
        contact = under(c, load)
        mises = subsurface.axis_extrema(contact, facts.poisson).von_mises_max
        fe = next((r for r in runs if r["elements"] == DEFAULT and abs(r["load"] - load) < 1), None)
        ours = ("-", "-") if fe is None else (f"{fe['p0']:.0f}", f"{fe['mises_max']:.0f}")
        lines.append((f"{load / 1e3:.1f}", f"{contact.p0:.0f}", ours[0], f"{mises:.0f}", ours[1]))
    share = subsurface.axis_extrema(c, facts.poisson).von_mises_max / c.p0
    onset = [c.load * (sigma / (share * c.p0)) ** 3 / 1e3 for sigma in YIELD]
    strip, circle = (
        [factor * sigma / math.sqrt(3) for sigma in YIELD]
        for factor in (STRIP_SHAKEDOWN, CIRCLE_SHAKEDOWN)
    )
    header = ("load, kN", "p0, MPa", "p0, FE", "von Mises, MPa", "von Mises, FE")
    return f"""\
{table(header, lines)}

The largest von Mises stress is {share:.3f} p0, below the surface. R260 rail steel, with a yield
stress of {YIELD[0]:g} to {YIELD[1]:g} MPa, begins to yield at {onset[0]:.1f} to {onset[1]:.1f} kN:
the thesis's 25 kN is just there, a real wheel {WHEEL / PRINTED_LOAD:.1f} times beyond it. Under
repeated rolling residual stresses help. Without friction the response stays elastic up to
p0 = {STRIP_SHAKEDOWN:g} k for a strip ({strip[0]:.0f} to {strip[1]:.0f} MPa, k being the yield
stress in shear; Johnson, Contact Mechanics, 9.2) and {CIRCLE_SHAKEDOWN} k for a circle
({circle[0]:.0f} to {circle[1]:.0f} MPa; Ponter, Hearle and Johnson 1985). The
{under(c, WHEEL).p0:.0f} MPa of a real wheel lie above the first and at the lower end of the second;
friction lowers both. Elastic stresses of a real wheel measure the load; they are not the stresses
in the rail."""

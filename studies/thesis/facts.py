"""What the rules of the claims compute with: exact Hertz contact, the profiles, finite elements."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.optimize import minimize_scalar

from railhead.contact import solid
from railhead.geometry import profiles, wheelset
from railhead.geometry.placement import Pair
from railhead.planning.references import closed_forms
from railhead.scene.scene import Scene
from railhead.theory.bem import boundary_element
from railhead.theory.elastic import subsurface
from railhead.theory.elastic.hertz import Ellipse, general_orientation, point_contact
from studies.thesis.formulas import Array, ThesisContact, thesis_axis_stress, thesis_contact

LOAD, P0, A = 25000.0, 794.9, 4.34  # N, MPa, mm as printed; P0 and A go into eqs 5.2 and 5.3
WHEEL = 22.5e3 * 9.80665 / 2  # N, of half a 22.5 t axle, as on a UIC54 main line
YIELD = (480.0, 520.0)  # MPa, of R260 rail steel
TREADS, INCLINATIONS = ("cylinder", "cone40", "cone20"), {"0": 0.0, "1:40": 1 / 40, "1:20": 1 / 20}


@dataclass(frozen=True)
class Facts:
    """Exact Hertz contact and the thesis's route for its case, and what follows from them.

    profiles: numbers of the rail and wheel profiles, see `profile_facts`.
    boundary_element_p0: largest pressure in MPa on the profiles, by boundary elements.
    fe: finite-element results by name (empty: none were made).
    """

    ellipse: Ellipse
    poisson: float
    route: ThesisContact
    profiles: Mapping[str, float]
    boundary_element_p0: float
    fe: Mapping[str, float] = field(default_factory=dict)

    def under(self, load: float) -> Ellipse:
        """The contact of the same bodies under another load in N."""
        c = self.ellipse
        return point_contact(c.curvature_x, c.curvature_y, c.contact_modulus, load)

    @cached_property
    def real(self) -> Ellipse:
        """The contact under WHEEL."""
        return self.under(WHEEL)

    @cached_property
    def circle(self) -> Ellipse:
        """A circular contact of the same bodies' mean curvature."""
        mean = (self.ellipse.curvature_x + self.ellipse.curvature_y) / 2
        return point_contact(mean, mean, self.ellipse.contact_modulus, self.ellipse.load)

    @property
    def curvatures(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """(1/R_1, 1/R_2) of the wheel and of the rail, 1/mm."""
        return (self.ellipse.curvature_x, 0.0), (0.0, self.ellipse.curvature_y)

    def at_angle(self, angle: float) -> tuple[float, float, float, float]:
        """K_3 and K_4 (half the sum and half the difference of the relative curvatures, 1/mm, by
        the eigenvalues of the curvature tensor), theta in degrees with cosine K_4 over the route's
        K_3, and p0 in MPa; angle: between the principal planes of both bodies, rad."""
        found = general_orientation(*self.curvatures, angle)
        k3, k4 = ((found.curvature_y + sign * found.curvature_x) / 2 for sign in (1, -1))
        c = self.ellipse
        contact = point_contact(found.curvature_x, found.curvature_y, c.contact_modulus, c.load)
        return k3, k4, math.degrees(math.acos(k4 / self.route.k3)), contact.p0

    def stress(self, depth: float) -> Array:
        """Exact s_x, s_y, s_z (3,) in MPa on the axis at a depth in mm."""
        return np.asarray(subsurface.axis_stress(self.ellipse, self.poisson, depth)[0])

    def printed_stress(self, depth: float) -> tuple[float, float]:
        """s_x = s_y and s_z in MPa by eqs 5.2 and 5.3 with the printed p_max and a."""
        s_x, _, s_z = thesis_axis_stress(P0, A, self.poisson, depth)[0]
        return float(s_x), float(s_z)

    @cached_property
    def extrema(self) -> subsurface.AxisExtrema:
        """Largest shear and von Mises stresses on the axis, with their depths."""
        return subsurface.axis_extrema(self.ellipse, self.poisson)

    @cached_property
    def surface_shear(self) -> float:
        """Largest shear stress at the centre of the patch, MPa."""
        return float(np.ptp(self.stress(0.0))) / 2

    @cached_property
    def printed_shear(self) -> tuple[float, float]:
        """Depth in mm and value in MPa of the largest shear by eqs 5.2 and 5.3."""
        best = minimize_scalar(
            lambda depth: float(np.subtract(*self.printed_stress(depth)[::-1])) / 2,
            bounds=(0, A),
            method="bounded",
            options={"xatol": 1e-9},
        )
        return float(best.x), -float(best.fun)


def facts(scene: Scene) -> Facts:
    """Those of a scene, without finite elements."""
    contact = solid.locate(scene)
    ellipse = closed_forms.ellipse(scene, contact)
    curvatures = (ellipse.curvature_x, 0.0), (0.0, ellipse.curvature_y)
    numerical = boundary_element.solve(
        contact.half_space_gap(contact.touch),
        ellipse.contact_modulus,
        load=ellipse.load,
        half_size=(2 * ellipse.a, 2 * ellipse.b),
    )
    return Facts(
        ellipse,
        scene.rail.poisson_ratio,
        thesis_contact(*curvatures, ellipse.contact_modulus, ellipse.load),
        profile_facts(),
        numerical.max_pressure,
    )


def profile_facts() -> dict[str, float]:
    """Where treads touch the rail (y in its own section, mm), the crown, the S1002 tread."""
    found = {}
    for tread in TREADS:
        wheel = profiles.cone(profiles.CONES[tread], solid.TREAD_HALF_WIDTH, tread)
        for name, slope in INCLINATIONS.items():
            pair = Pair(profiles.rail_head("54E1", slope), wheel, 420.0)
            touch = wheelset.place(pair, wheelset.Track()).right.touches[0]
            angle = math.atan(slope)
            found[f"y {tread} {name}"] = touch.y * math.cos(angle) + touch.z * math.sin(angle)
    head, s1002 = profiles.rail_head("54E1"), profiles.s1002()
    hollow = np.flatnonzero(s1002.curvature(np.arange(0.0, 30.0, 0.01)) < 0)[-1] / 100
    return found | {
        "crown_radius": 1 / float(head.curvature(0.0)),
        "crown_half_width": head.joints[len(head.joints) // 2],
        "head_half_width": head.domain[1],
        "s1002_radius": 1 / float(s1002.curvature(0.0)),
        "s1002_convex_from": float(hollow),
    }

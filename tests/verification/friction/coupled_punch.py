"""Where a flat rigid punch on a half-plane sticks: pressure and traction coupled, without the
program's code."""

import numpy as np
from scipy.optimize import brentq

ELEMENTS = 60  # of the half of the punch, in what sticks and in what slips
FINE = 5  # power by which elements become smaller towards the border of stick and the edge


def stick_half_width(friction: float, beta: float) -> float:
    """Half width that sticks, over that of the punch. beta: Dundurs' constant of a rigid punch.

    On the surface below a punch, without its rigid motion (Johnson, Contact Mechanics, 2.25),

        (1/pi) int p/(x - s) ds - beta q = 0,
        (1/pi) int q/(x - s) ds + beta p = 0 where it sticks,

    and q = friction p sgn x where it slips. For each border of stick this has one solution; q is
    continuous at the right one. The load of a patch that grows in proportion is a sum of such
    punches (Spence 1973), all of which stick alike. Without the term beta q the border is Spence's
    K(sqrt(1 - c^2)) / K(c) = beta / friction.
    """

    def jump(c: float) -> float:
        """Singular part of the traction beside the border c; its regular part is as sqrt(c - x)."""
        t = np.linspace(0, 1, ELEMENTS + 1)
        to_both_ends = t**FINE / (t**FINE + (1 - t) ** FINE)
        edges = np.concatenate([c * (1 - (1 - t) ** FINE), c + (1 - c) * to_both_ends[1:]])
        x, n = (edges[1:] + edges[:-1]) / 2, ELEMENTS
        own = np.log(np.abs((x[:, None] - edges[:-1]) / (x[:, None] - edges[1:]))) / np.pi
        mirrored = np.log((x[:, None] + edges[1:]) / (x[:, None] + edges[:-1])) / np.pi
        even, odd = own + mirrored, own - mirrored
        coupled = np.block([[even, -beta * np.eye(2 * n)], [beta * np.eye(2 * n)[:n], odd[:n]]])
        slips = np.zeros((4 * n, 3 * n))  # from the pressures and the tractions of what sticks
        slips[: 2 * n, : 2 * n] = np.eye(2 * n)
        slips[2 * n : 3 * n, 2 * n :] = np.eye(n)
        slips[3 * n :, n : 2 * n] = friction * np.eye(n)
        root = np.sqrt(np.concatenate([np.diff(edges), np.diff(edges)[:n]]))
        found = np.linalg.svd(root[:, None] * (coupled @ slips) / root)[2][-1] / root
        excess, left = found[2 * n :] - friction * found[:n], np.sqrt(c - x[:n])
        return float((excess[-1] - excess[-4] * left[-1] / left[-4]) / found[0])

    return float(brentq(jump, 0.05, 0.74, xtol=1e-4))

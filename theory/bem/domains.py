"""Domains of boundary elements that suit the patches in them.

A domain is (2, 2): its centre (x, s) and its half sizes, mm.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import find_objects, label

from railhead.theory.array_types import Array, Mask
from railhead.theory.bem.grid_patch import Grid, PatchSolution

FILL_RANGE, FILL = (0.6, 0.9), 0.8  # share of the domain's width that the patch takes up
APART = 1.6  # times their size: patches that are still apart then get a domain each
MOST = 8  # domains that one is split into


def suited(
    patches: Sequence[PatchSolution], domains: Sequence[Array], *, fine: bool, split: bool
) -> list[Array]:
    """Rectangular domains (2, 2) for the next solution: centres and half sizes, mm.

    A domain that suits its patch remains, one whose patch meets the border grows, and one that the
    patch does not fill shrinks. With `split`, separate patches in a domain get domains of their
    own. With `fine`, domains only grow, and none is split. A domain without contact is dropped.
    Overlapping domains are merged. patches: solution of each domain, of all patches in it.
    """
    better = []
    for patch, domain in zip(patches, domains, strict=True):
        touching = patch.pressure > 0
        if not touching.any():
            continue
        apart = _apart(touching, domain) if split and not fine else []
        if len(apart) > 1:
            better += apart
            continue
        fitted = [_window(np.any(touching, axis=1 - k), domain[:, k], fine) for k in (0, 1)]
        better.append(np.transpose(fitted))
    return merged(better)


def merged(domains: Sequence[Array]) -> list[Array]:
    """Domains (2, 2) that do not overlap: overlapping ones are replaced by the smallest rectangle
    around them.
    """
    return [_around(np.array(group)) for group in _groups(domains, 1.0)]


def towards(gap: Array, domain: Array, grid: Grid) -> Array:
    """Domain (2, 2) around the cell of the smallest gap (n, n). Where that cell lies on the border,
    the domain becomes twice as wide in that direction; else an eighth as wide in both directions.
    """
    i, j = np.unravel_index(int(np.argmin(gap)), gap.shape)
    border = np.isin((i, j), (0, gap.shape[0] - 1))
    factor = np.where(border, 2, 1) if border.any() else 1 / 8
    return np.array([(grid.x[i], grid.s[j]), factor * domain[1]])


def _apart(touching: Mask, domain: Array) -> list[Array]:
    """Domains (2, 2) around the separate patches in a domain. touching: cells with pressure (nx,
    ns). Patches whose boxes overlap when 1.6 times (APART) as large share a domain; at most eight
    domains (MOST) result.
    """
    boxes = []
    size = 2 * domain[1] / touching.shape
    for slices in find_objects(label(touching, structure=np.ones((3, 3)))[0]):
        first, last = np.array([(cut.start, cut.stop) for cut in slices]).T
        middle = domain[0] - domain[1] + size * (first + last) / 2
        boxes.append(np.array([middle, size * (last - first) / 2]))
    factor = APART
    while len(groups := _groups(boxes, factor)) > MOST:
        factor *= 2
    return [_around(np.array(group)) * [[1], [1 / FILL]] for group in groups]


def _groups(boxes: Sequence[Array], factor: float) -> list[list[Array]]:
    """Groups of boxes (2, 2): two boxes are in one group where they overlap after their half sizes
    are multiplied by `factor`; a group counts as the smallest box around it.
    """
    groups: list[list[Array]] = []
    for box in boxes:
        group = [box]
        while near := [other for other in groups if _near(group, other, factor)]:
            group += [each for other in near for each in other]
            groups = [other for other in groups if not any(other is one for one in near)]
        groups.append(group)
    return groups


def _near(group: list[Array], other: list[Array], factor: float) -> bool:
    """Whether the smallest boxes around two groups overlap after the half sizes of both are
    multiplied by `factor`; boxes that only touch do not. A group is a list of boxes (2, 2), centre
    and half sizes in mm.
    """
    one, two = _around(np.array(group)), _around(np.array(other))
    return bool(np.all(np.abs(one[0] - two[0]) < factor * (one[1] + two[1])))


def _around(boxes: Array) -> Array:
    """Smallest box (2, 2), centre and half sizes, around boxes (n, 2, 2)."""
    if len(boxes) == 1:
        return np.asarray(boxes[0])
    low, high = (boxes[:, 0] - boxes[:, 1]).min(axis=0), (boxes[:, 0] + boxes[:, 1]).max(axis=0)
    return np.array([(low + high) / 2, (high - low) / 2])


def _window(used: Mask, domain: Array, fine: bool) -> tuple[float, float]:
    """Middle and half width (mm) of the next domain along one axis; twice as wide, towards the
    border, where the patch meets one. used: cells with pressure (n,); domain: present middle and
    half width; fine: the domain may only grow.
    """
    (middle, half), n, (first, last) = domain, used.size, np.flatnonzero(used)[[0, -1]]
    if first == 0 or last == n - 1:
        return middle + half * (int(last == n - 1) - int(first == 0)), 2 * half
    width = (last + 1 - first) / n
    if fine or FILL_RANGE[0] <= width <= FILL_RANGE[1]:
        return middle, half
    return middle + half * ((first + last + 1) / n - 1), half * width / FILL

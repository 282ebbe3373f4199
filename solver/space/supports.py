"""Supports of bodies by the tags of their facets, and what they leave to the nodes of a space."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from dolfinx import fem
from mpi4py import MPI

from railhead.solver.space.constraints import Held
from railhead.theory.array_types import Array, Mask

Direction = Sequence[float]


@dataclass(frozen=True, eq=False)
class Clamp:
    """Facets that do not move."""

    tag: int


@dataclass(frozen=True, eq=False)
class Slide:
    """Facets that do not move along a normal, of either sense: a sliding face or a symmetry."""

    tag: int
    normal: Direction


@dataclass(frozen=True, eq=False)
class Hub:
    """Facets that move as a rigid face without turning. Along `free`, a direction, a force may be
    given; without it, only a motion. A hub without a load stays.

    slides: whether the facets slide on the rigid face, and only move along `free` together.
    """

    tag: int
    free: Direction | None = None
    slides: bool = False

    def __post_init__(self) -> None:
        """Raises ValueError for facets that slide on a face without a free direction."""
        if self.slides and self.free is None:
            raise ValueError(f"Hub({self.tag}, slides=True) needs a free direction")


Support = Clamp | Slide | Hub


def unit(name: str, vector: Any) -> Array:
    """Unit vector along a direction (c,); raises ValueError for one without a length."""
    out = np.asarray(vector, float)
    length = np.linalg.norm(out)
    if not 0 < length < math.inf:
        raise ValueError(f"{name} must have a direction, not {vector!r}")
    return np.asarray(out / length)


def finite(owner: Any, name: str, given: Any, *shape: int) -> Array:
    """A number or, with a shape, an array that a part has. Raises ValueError for what is not finite
    and for another shape; owner, name: of the part and of its attribute, for the message.
    """
    out = np.asarray(given)
    if out.shape != shape or out.dtype.kind not in "iuf" or not np.isfinite(out).all():
        raise ValueError(f"{owner}: {name} must be {math.prod(shape)} finite number(s)")
    return out.astype(float)


def must_exist(what: str, tags: Any, tag: int, comm: MPI.Intracomm) -> None:
    """Raise ValueError where no rank has an entity with this tag; what: word for the entity in the
    message; tags: MeshTags (collective).
    """
    if not comm.allreduce(len(tags.find(tag))):
        raise ValueError(f"no {what} carries the tag {tag}")


def on_facets(space: Any, facet_tags: Any, tag: int) -> Mask:
    """Mask (n,) over the owned block dofs of a space: True on the facets with this tag
    (collective).
    """
    dim = space.mesh.topology.dim
    space.mesh.topology.create_connectivity(dim - 1, dim)
    dofs = fem.locate_dofs_topological(space, dim - 1, facet_tags.find(tag))
    mask = np.zeros(space.dofmap.index_map.size_local, dtype=bool)
    mask[dofs[dofs < len(mask)]] = True
    return mask


def masks(space: Any, facet_tags: Any, supports: Iterable[Support]) -> dict[Support, Mask]:
    """Of each support, the owned block dofs (n,) of a space on its facets (collective)."""
    return {each: on_facets(space, facet_tags, each.tag) for each in supports}


def held(found: Mapping[Support, Mask], free: Sequence[Hub], count: int, dim: int) -> Held:
    """What supports leave to n nodes with c coordinates.

    found: nodes (n,) of each support. free: hubs whose motion along their free direction is an
        unknown. count, dim: n and c.
    """
    fixed, planes = np.zeros(count, dtype=bool), []
    for part, mask in found.items():
        if isinstance(part, Slide):
            planes.append((mask, unit("normal", part.normal)))
        elif isinstance(part, Hub) and part.slides:
            planes.append((mask, unit("free", part.free)))
        else:
            fixed |= mask
    hubs = [(found[hub], unit("free", hub.free)) for hub in free]
    return Held(fixed=fixed, planes=planes, hubs=hubs, dim=dim)

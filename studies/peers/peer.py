"""What a module in codes/ provides, and which there are."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Mapping
from typing import Any, Protocol, cast

from studies.peers import codes


class Peer(Protocol):
    """See `studies.peers.codes`."""

    TITLE: str
    METHOD: str
    SETTINGS: str
    PIP: tuple[str, ...]
    DEBIAN: tuple[str, ...]
    RUNS: Mapping[str, Mapping[str, Any]]
    __file__: str

    def version(self) -> str:
        """Of the code; raises where it is not there."""

    def solve(self, case: Mapping[str, float], mesh: Any, **run: Any) -> dict[str, Any]:
        """In N, mm and MPa, of the whole contact."""


def peers() -> list[Peer]:
    """Every module in codes/, by name."""
    names = sorted(module.name for module in pkgutil.iter_modules(codes.__path__))
    return [cast(Peer, importlib.import_module(f"{codes.__name__}.{name}")) for name in names]

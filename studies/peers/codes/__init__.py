"""One module a code: what it is, how it is installed, and its solve.

    TITLE, METHOD, SETTINGS   names and sentences of the page
    PIP, DEBIAN               packages, the first of which has the page's version; with DEBIAN's it
                              runs in Debian's Python, else in the venv
    MODULES                   what must import there
    RUNS                      {label: keywords of `solve`}, coarse to fine; "mesh" is cell and
                              size of a mesh of `studies.peers.block_meshes`, read beforehand
    solve(case, mesh, **run)  -> {unknowns, force, pressure_max, x, y, pressure, [approach,
                              tau_max, iterations]}, in N, mm and MPa, of the whole contact

`solve` is called in another Python, which has neither railhead nor its libraries: a module imports
numpy and the standard library, and its code inside of it.
"""

import importlib
import pkgutil
from types import ModuleType

Peer = ModuleType
"""A module here, with the names above."""


def peers() -> list[Peer]:
    """Modules of this folder, one for each code, sorted by name."""
    names = sorted(module.name for module in pkgutil.iter_modules(__path__))
    return [importlib.import_module(f"{__name__}.{name}") for name in names]

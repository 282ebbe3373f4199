"""One module a code: what it is, how it is installed, and its solve.

    TITLE, METHOD, SETTINGS   names and sentences of the page
    PIP, DEBIAN               packages; with DEBIAN's it runs in Debian's Python, else in the venv
    RUNS                      {label: keywords of `solve`}, coarse to fine; "mesh" is [cell, order,
                              size in mm] of `studies.peers.blocks`, read before the call
    version() -> str          raises where the code is not there
    solve(case, mesh, **run)  -> {unknowns, force, pressure_max, x, y, pressure, [approach,
                              tau_max, iterations]}, in N, mm and MPa, of the whole contact

`version` and `solve` are called in another Python, which has neither railhead nor its libraries:
a module imports numpy and the standard library, and its code inside these two.
"""

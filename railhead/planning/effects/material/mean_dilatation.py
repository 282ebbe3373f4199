"""Volume change taken constant in each cell, for nearly incompressible bodies."""

from __future__ import annotations

from railhead.planning.context import Context, Effect

LARGEST_RATIO = 0.45  # Poisson's ratio above which ordinary cells begin to lock
#: The same in a meridian section: there the largest of the rms errors of pressure, area and shear
#: stress at default settings is 0.11 % without it and 0.14 % with it at 0.48, 0.18 and 0.15 % at
#: 0.49, 2.1 and 0.16 % at 0.499 (13 meshes of 6 to 24 elements per radius, of them 10 to 14).
LARGEST_REVOLVED = 0.49


def decide(context: Context) -> Effect:
    """Constant volume change in each cell is called for where a deformable body has nu above 0.45
    (0.49 in a meridian section); linear and hexahedral cells cannot have it.
    """
    scene = context.scene
    ratios = {name: part.poisson_ratio for name, part in context.deformable.items()}
    name, ratio = max(ratios.items(), key=lambda each: each[1], default=("no body", 0.0))
    limit = LARGEST_REVOLVED if context.contact.revolved else LARGEST_RATIO
    above = ratio > limit
    why = f"Poisson's ratio {ratio:g} of the {name}, {'above' if above else 'below'} {limit}"
    if scene.mesh.cell == "hexahedron" or scene.mesh.linear:
        locks = "; these cells lock, take quadratic tetrahedra" if above else ""
        return Effect(above, False, why + locks, {"on": "it needs quadratic tetrahedra"})
    return Effect(above, above, why)

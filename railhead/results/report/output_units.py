"""The units in which a reader wants the numbers, from a text."""

from railhead.postprocess.findings import FACTORS, Units
from railhead.scene.sections import SceneError

KINDS = ("mm", "N", "MPa")


def parse(text: str | None) -> Units:
    """Units from a text as "um,kN,GPa", in any order, at most one of each kind; None: base units.
    Where lengths have another unit, numbers in um have it, too. Raises SceneError for an unknown
    unit and for two of one kind.
    """
    chosen: dict[str, str] = {}
    for name in (part.strip() for part in text.split(",")) if text is not None else ():
        base = next((base for base in KINDS if name in FACTORS[base]), None)
        if base is None or base in chosen:
            problem = "is given beside another of its kind" if base else "is not known"
            words = "; ".join(", ".join(FACTORS[base]) for base in KINDS)
            raise SceneError("--units", f"{name!r} {problem}; give at most one each of {words}")
        chosen[base] = name
    if chosen.get("mm", "mm") != "mm":
        chosen["um"] = chosen["mm"]
    return Units(chosen)

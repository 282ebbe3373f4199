"""Passes of a wheel over a rail that yields, as people read them: rows, states, and verdict."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from railhead.postprocess.findings import COLUMN, ROW
from railhead.theory.array_types import Array
from railhead.theory.bem.grid_patch import PatchSolution

if TYPE_CHECKING:
    from railhead.solver.material import Hardening
    from railhead.solver.plasticity.rolling_block import RollingBlock, RollingPass, SectionState

PASS_COLUMNS = {
    "strain_increment_max": ("strain", ""),
    "forward_mm": ("forward", "mm"),
    "groove_mm": ("groove", "mm"),
    "pressure_max_MPa": ("pressure", "MPa"),
    "lean_mm": ("lean", "mm"),
    "residual_along_MPa": ("residual along", "MPa"),
    "residual_across_MPa": ("residual across", "MPa"),
}
"""What people read of each pass: words and base unit by key of its row."""
PASS_ERRORS = {
    "strain_max": "largest strain",
    "groove_mm": "groove",
    "residual_along_MPa": "residual along",
    "residual_across_MPa": "residual across",
}
"""Words by key of what has an estimated error after the last pass."""

RATES = {
    "strain_increment_max": "strain_per_pass",
    "shear_increment_max": "shear_per_pass",
    "forward_mm": "forward_mm_per_pass",
}
"""Names of the rates of passes that ratchet by the keys of their rows."""

FALLS = 0.9  # ratio of an increment to the one before, below which the increments fall
STEADY = 0.98  # ratio from which they are steady
SHARE = 0.1  # of the plastic strain that is there: what later passes may add after shakedown
NOTHING = 1e-2  # forward displacement over half length and strain increment, that counts as none
# Of steel with back stresses that are recalled, which ratchets slowly:
NO_RATE = 1e-3  # the same share
LEFT = 0.05  # of a rate: what later passes may add to a steady one
UNSURE = 5.0  # changes from pass to pass that may be noise, over the noise of an iteration

ELASTIC, SHAKES_DOWN, CYCLES = "elastic", "shakes down", "closed cycles"
RATCHETS, LIMIT, UNDECIDED = "ratchets", "at the limit", "undecided"
STILL = ELASTIC, SHAKES_DOWN, CYCLES  # verdicts on a surface that stays where it is


@dataclass(frozen=True, kw_only=True)
class RailState:
    """State of the rail's section after a pass, at the Gauss points of the section.

    y: places of the points across, from the middle of the patch, (ny,), ascending, mm.
    depth: their depths below the surface (nz,), ascending, mm.
    stress: residual stress xx, yy, zz, xy, xz, yz (ny, nz, 6), MPa.
    strain: equivalent plastic strain (ny, nz).
    across: nodes of the surface (n,), ascending, mm.
    up: displacement of these nodes out of the rail (n,), mm.
    """

    y: Array
    depth: Array
    stress: Array
    strain: Array
    across: Array
    up: Array

    def below(self) -> tuple[Array, Array]:
        """Residual stress (nz, 6), MPa, and plastic strain (nz,) below the middle of the patch:
        means of the points nearest to it on both sides.
        """
        distance = np.abs(self.y)
        near = distance < distance.min() + 1e-6 * np.ptp(self.depth)
        return self.stress[near].mean(axis=0), self.strain[near].mean(axis=0)

    def residual(self, depth: Array, across: Array) -> Array:
        """Residual stress (d, k, 6), MPa, at d depths and k places across, mm: linear over the
        depth in the nearest column of points, beyond its ends that of the end.
        """
        near = np.abs(self.y[:, None] - across).argmin(axis=0)
        columns = self.stress[near].transpose(0, 2, 1)
        found = [[np.interp(depth, self.depth, each) for each in column] for column in columns]
        return np.array(found).transpose(2, 0, 1)


@dataclass(frozen=True, kw_only=True)
class Passes:
    """Passes of a wheel over a rail, as one body below one patch goes through them.

    rows: a row for each pass, as "passes" of "result" in summary.json.
    verdict: what they come to, a word such as RATCHETS, see `verdict`.
    words: the verdict in a sentence.
    rate: what a pass adds where they ratchet, see `rate`; None where they do not.
    sections: state of the section after each pass.
    half_lengths: of the elastic patch, along and across, mm.
    profile: the rail's profile with the groove on it (n, 2), y and z as the file of rail.profile
        has them, mm; None of a half-space and of a section.
    converged: whether every pass met the tolerance of the fixed point.
    energy_error: largest difference of the rolling resistance from the sum of plastic work and
        elastic energy that stays, over this sum; None under a kept pressure, and where little or
        nothing yields.
    rim: largest plastic increment at the rim of the region where yield is followed, over the
        largest anywhere.
    errors: estimated relative errors after the last pass by key of its row, from a coarser and
        shorter block; empty where the scene asks for no accuracy.
    unknowns: number of unknowns of the block.
    seconds: time that all passes took.
    reason: why there are no passes; empty where there are some.
    name: of the body and the patch, as "wheel" or "rail, patch 2", if there are several.
    beside: the same passes of further bodies and patches; `converged` and `energy_error` are of all
        together.
    extrapolated: to many wheels, see `extrapolated`; None: not asked for.
    """

    rows: list[dict[str, Any]]
    verdict: str
    words: str = ""
    rate: dict[str, Any] | None = None
    sections: list[RailState] = field(default_factory=list)
    half_lengths: tuple[float, float] = (0.0, 0.0)
    profile: Array | None = None
    converged: bool = False
    energy_error: float | None = None
    rim: float = 0.0
    errors: Mapping[str, float] = field(default_factory=dict)
    unknowns: int = 0
    seconds: float = 0.0
    reason: str = ""
    name: str = ""
    beside: tuple[Passes, ...] = ()
    extrapolated: dict[str, Any] | None = None

    @property
    def residual_error(self) -> float | None:
        """Largest estimated error of the residual stresses after the last pass, MPa; None where
        errors are not estimated.
        """
        keys = self.errors.keys() & {"residual_along_MPa", "residual_across_MPa"}
        return max((self.errors[key] * abs(self.rows[-1][key]) for key in keys), default=None)

    @property
    def files(self) -> dict[str, Passes]:
        """These, and those beside them, by what names of their files have after "passes": nothing
        of the first, "_wheel" or "_rail_patch_2" of others.
        """
        names = {"_" + of.name.replace(", ", "_").replace(" ", "_"): of for of in self.beside}
        return {"": self} | names

    def table(self) -> list[dict[str, Any]]:
        """Rows of passes.csv: those of summary.json, with the number of the pass first and the
        place in two columns.
        """
        rows = []
        for number, row in enumerate(self.rows, 1):
            plain = {key: value for key, value in row.items() if key != "place_mm"}
            across, height = row["place_mm"] or (None, None)
            depth = None if height is None else -height
            place = {"place_across_mm": across, "place_depth_mm": depth}
            rows.append({"pass": number, **plain, **place})
        return rows

    def summary(self) -> dict[str, Any]:
        """Entries of "result" in summary.json: "passes", "passes_verdict", "passes_words",
        "rate" of passes that ratchet, "passes_extrapolated" if asked for, and "passes_after". The
        last holds depth, residual stresses and strain below the middle, the surface after the last
        pass, estimated errors, unknowns and seconds. With other bodies or patches "passes_name"
        names this one, and "passes_beside" has the same of each other. There must be a pass.
        """
        last = self.sections[-1]
        stress, strain = last.below()
        names = ("along", "across", "normal", "shear_across")
        return {
            "passes": self.rows,
            "passes_verdict": self.verdict,
            "passes_words": self.words,
            **({} if self.rate is None else {"rate": self.rate}),
            **({"passes_extrapolated": self.extrapolated} if self.extrapolated else {}),
            "passes_after": {
                "depth_mm": last.depth.tolist(),
                **{
                    f"residual_{name}_MPa": column.tolist()
                    for name, column in zip(names, stress.T[[0, 1, 2, 5]], strict=True)
                },
                "strain": strain.tolist(),
                "surface_across_mm": last.across.tolist(),
                "surface_up_mm": last.up.tolist(),
                "estimate": dict(self.errors),
                "unknowns": self.unknowns,
                "seconds": self.seconds,
            },
            **({"passes_name": self.name} if self.name else {}),
            **({"passes_beside": [of.summary() for of in self.beside]} if self.beside else {}),
        }


def rail_state(rolling: RollingBlock, state: SectionState) -> RailState:
    """Section of a state, mirrored to the whole where half of it was solved."""
    stress = rolling.block.kinematics.tensors(state.residual)[:, ROW, COLUMN]
    y, z = (np.unique(np.round(axis, 9)) for axis in rolling.streams.places.T)
    stress = stress.reshape(len(y), len(z), 6)[:, ::-1]
    strain = state.history.equivalent.reshape(len(y), len(z))[:, ::-1]
    across, up = state.profile.y, state.profile.up
    if rolling.block.half:
        y, strain = np.concatenate([-y[::-1], y]), np.concatenate([strain[::-1], strain])
        stress = np.concatenate([stress[::-1] * [1.0, 1.0, 1.0, -1.0, 1.0, -1.0], stress])
        across, up = np.concatenate([-across[:0:-1], across]), np.concatenate([up[:0:-1], up])
    return RailState(y=y, depth=-z[::-1], stress=stress, strain=strain, across=across, up=up)


def row(
    rolling: RollingBlock, each: RollingPass, section: RailState, patch: PatchSolution
) -> dict[str, Any]:
    """Row of a pass, an entry of "passes" in summary.json, whose keys end in the unit. "place_mm"
    is None where nothing yields.
    rolling: the block. each: the pass. section: whole state after it. patch: its pressure.
    """
    profile = each.profile
    middle = int(np.argmin(np.abs(profile.y)))
    place = rolling.streams.places[int(np.argmax(each.growth))]
    along, across = (section.stress[..., axis].ravel() for axis in (0, 1))
    weight = patch.pressure.sum()
    lean = float((patch.pressure.sum(axis=1) * patch.x).sum() / weight)
    largest = patch.pressure.max() if rolling.block.dim == 2 else patch.max_pressure
    return {
        "strain_increment_max": float(each.growth.max()),
        "strain_increment_rim": each.rim,
        "strain_max": float(section.strain.max()),
        "place_mm": [float(value) for value in place] if each.growth.any() else None,
        "shear_increment_max": float(each.shear[np.argmax(np.abs(each.shear))]),
        "forward_mm": float(profile.along[middle]),
        "groove_mm": max(float(-section.up.min()), 0.0) + 0.0,
        "ridge_mm": float(max(section.up.max(), 0.0)),
        "pressure_max_MPa": float(largest),
        "lean_mm": lean,
        "residual_along_MPa": float(along[np.argmax(np.abs(along))]),
        "residual_across_MPa": float(across[np.argmax(np.abs(across))]),
        "iterations": each.iterations,
        "change": each.change,
    }


def verdict(
    increments: Sequence[float],
    forward: Sequence[float],
    length: float,
    noise: float,
    *,
    hardens: bool,
    recalls: bool = False,
) -> str:
    """Verdict on n passes.

    increments: largest increase of the equivalent plastic strain in each pass (n,).
    forward: displacement of the surface along the rail in each pass (n,), mm.
    length: half length of the patch along the rail, mm.
    noise: increment that the tolerance of the solution may make.
    hardens: whether the flow curve rises without end; then nothing ratchets for ever, and no
        limit lies between shakedown and ratchetting: such passes are undecided.
    recalls: whether back stresses are recalled or the yield stress grows to a limit, without
        hardening that has no end.

    Elastic: nothing yields in any pass. Shakedown: nothing yields in the last two; or the last two
    increments each fall below 0.9 of the one before, and all that a geometric series adds to them
    is below a tenth of the sum of all; if it is more, they are undecided. Closed cycles: the
    increments are steady and the forward displacement is zero or, of a curve that rises without
    end, falls. Ratchetting: both are steady. In between, increments fall slowly, at the limit of
    shakedown. Fewer than three passes are undecided, before the fourth only shakedown is told, and
    a forward displacement that still grows or turns round is undecided.
    Of steel that recalls, increments and forward displacement are steady where later passes, as a
    geometric series, add less than 5 % (LEFT); until then it is "not steady after n passes".
    """
    small = [value <= noise for value in increments]
    if small and small[0] and all(small):
        return ELASTIC
    if len(small) > 2 and small[-1] and small[-2]:
        return SHAKES_DOWN
    undecided = f"not steady after {len(increments)} passes" if recalls else UNDECIDED
    if len(increments) < 3:
        return undecided
    falls = _ratio(increments)
    if falls < FALLS:
        rest = increments[-1] * falls / (1 - falls)
        return SHAKES_DOWN if rest < SHARE * sum(increments) else undecided
    if len(increments) < 4:
        return undecided
    stands = NOTHING * length * increments[-1]
    if recalls:
        none = abs(forward[-1]) <= NO_RATE / NOTHING * stands
        moves = none or left(forward, noise * length) < LEFT
        steady = moves and left(increments, noise) < LEFT
        return (CYCLES if none else RATCHETS) if steady else undecided
    still = abs(forward[-1]) <= stands
    steady = all(FALLS <= each <= 1 / FALLS for each in _ratios(forward))
    if falls < STEADY:
        return LIMIT if (still or steady) and not hardens else undecided
    if still or (hardens and _ratio(forward) < FALLS):
        return CYCLES
    return RATCHETS if steady and not hardens else undecided


def left(values: Sequence[float], noise: float) -> float:
    """What later passes may add to the last of values (n,), n > 2, relative: their last changes
    continued as a geometric series, infinite where these do not fall. noise: of the values.
    """
    before, now = np.abs(np.diff(values[-3:]))
    if now <= UNSURE * noise:
        rest = float(now)
    else:
        rest = now * now / (before - now) if now < before else math.inf
    return rest / max(abs(values[-1]), 1e-300)


def rate(
    rows: Sequence[Mapping[str, Any]], noise: float, length: float, curve: Hardening
) -> dict[str, Any]:
    """What a steady pass adds, from the last of at least three rows: the values of RATES by their
    names, "rule" (the hardening law), and "estimate", the largest relative error that later passes
    leave open, None where their changes do not fall.

    noise: of strains. length: half length of the patch along the rail, mm.
    """
    noises = noise, noise, noise * length
    rest = [left([row[key] for row in rows], each) for key, each in zip(RATES, noises, strict=True)]
    found = {name: rows[-1][key] for key, name in RATES.items()}
    most = max(rest)
    return found | {"rule": rule(curve), "estimate": most if math.isfinite(most) else None}


def extrapolated(found: Passes, wheels: int) -> Passes:
    """Passes that are continued to a number of wheels: if they ratchet, each further pass adds what
    the last one did, at every point. "passes_extrapolated" has "wheels", and either "strain_max",
    "forward_mm" and their relative "estimate", that of the rate, or the "reason" why there are no
    such numbers.
    """
    estimate, more = (found.rate or {}).get("estimate"), wheels - len(found.rows)
    out: dict[str, Any] = {"wheels": wheels}
    if estimate is not None:
        before, last = (each.strain for each in found.sections[-2:])
        forward = [row["forward_mm"] for row in found.rows]
        out["strain_max"] = float((last + more * (last - before)).max())
        out["forward_mm"] = sum(forward) + more * forward[-1]
        said = f"strain {out['strain_max']:.2g}, {out['forward_mm']:.2g} mm forward"
        out["estimate"] = estimate
        said += f", within {estimate:.1%}, if each adds what the last pass did"
    elif found.verdict in STILL:
        out["reason"] = said = f"the surface stays ({found.verdict})"
    else:
        out["reason"] = said = f"not extrapolated ({found.verdict}); give more passes"
    return replace(found, extrapolated=out, words=f"{found.words}; after {wheels} wheels: {said}")


def _ratios(values: Sequence[float]) -> list[float]:
    """The last two ratios of a value to the one before; infinite after zero."""
    return [b / a if a else math.inf for a, b in zip(values[-3:], values[-2:], strict=False)]


def _ratio(values: Sequence[float]) -> float:
    """Larger absolute value of the last two ratios of a value to the one before."""
    return max(abs(each) for each in _ratios(values))


def words(
    verdict: str, rows: list[dict[str, Any]], rolling: RollingBlock, *, tractions: bool
) -> str:
    """The verdict in a sentence, with the hardening law that it stands on, and whether tractions
    act. verdict: a word of `verdict`. rows: of all passes, as of `row`.
    """
    last, curve = rows[-1], rolling.hardening
    rest = {
        ELASTIC: "nothing yields",
        SHAKES_DOWN: f"after {len(rows)} passes strain hardly grows",
        CYCLES: f"strain goes round, up to {last['strain_increment_max']:.2g} a pass, "
        "and the surface stays",
        RATCHETS: f"the surface moves by {last['forward_mm']:.2g} mm a pass",
        LIMIT: f"strain grows by {last['strain_increment_max']:.2g} a pass, slowly less",
    }.get(
        verdict,
        f"strain grows by {last['strain_increment_max']:.2g} in the last pass; more passes tell",
    )
    law = "; no tractions act"
    if tractions:
        law = "; the tractions of elastic bodies act, one way: yield does not change them"
    if verdict == ELASTIC:
        return f"{verdict}: {rest}{law}"
    beside = "real steel lies between it and linear kinematic hardening"
    if curve.backstresses or curve.isotropic[0]:
        beside = "with the same constants another rule has another rate"
    elif _hardens(curve) and curve.kinematic:
        beside = "which never ratchets for ever: real steel lies between it and perfect plasticity"
    elif _hardens(curve):
        beside = "which always shakes down in the end: real steel may not"
    joint = ", " if beside.startswith("which") else ": "
    return f"{verdict}: {rest} ({rule(curve)}{joint}{beside}{law})"


def rule(curve: Hardening) -> str:
    """Names of the parts of a flow curve's hardening."""
    backs, exponent = curve.backstresses, curve.recall_exponent
    recall = f"Jiang and Sehitoglu's rule, exponent {exponent:g}"
    names = {
        "Armstrong and Frederick's rule": not exponent and any(each.recall for each in backs),
        recall: bool(exponent),
        "kinematic hardening": any(not each.recall for each in backs) or curve.kinematic > 0,
        "isotropic hardening": (_hardens(curve) and curve.kinematic < 1) or curve.isotropic[0] > 0,
    }
    return " and ".join(name for name, used in names.items() if used) or "perfect plasticity"


def _hardens(curve: Hardening) -> bool:
    """Whether the stress of a flow curve grows anywhere."""
    return bool(curve.final_hardening_modulus or curve.stress[-1] > curve.stress[0])

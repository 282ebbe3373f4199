"""What a plan is predicted to cost: seconds of the processor, memory, and what accuracies take."""

from dataclasses import dataclass
from typing import Any

from railhead.planning import cost, error_envelopes
from railhead.planning.decisions import Decisions
from railhead.scene.scene import SceneError

PRICED_ACCURACIES = (0.05, 0.01, 0.002)  # accuracies whose cost a plan predicts
MEMORY_SHARE = 0.8  # largest predicted memory over the free memory


@dataclass(frozen=True)
class Price:
    """Predicted cost of a plan.

    plan: the decisions for a scene.
    """

    plan: Decisions

    @property
    def seconds(self) -> float:
        """Predicted seconds of the whole process: `solving_seconds`, and the pictures and the
        report where the scene asks for them.
        """
        kind = "solid that yields" if self._on("plasticity") else "solid"
        kind = "section" if self.plan.plane_model else kind
        drawn = cost.PICTURES["half-spaces" if self.plan.by_half_spaces else kind]
        return self.solving_seconds + cost.correction() * drawn * self.plan.scene.asks("pictures")

    @property
    def solving_seconds(self) -> float:
        """Predicted seconds of the whole process without pictures: imports, passes, and this mesh.
        For an accuracy or a budget without error laws also two coarser ones, each by 1.6 (STEP).
        """
        seconds, n = cost.START + self.seconds_of_one, self.plan.resolution
        if self.plan.scene.one_mesh or self.plan.by_half_spaces or self.plan.family is not None:
            return seconds
        before = (self.plan.at_resolution(n / error_envelopes.STEP**k) for k in (1, 2))
        return seconds + sum(Price(each).mesh_seconds for each in before)

    @property
    def seconds_of_one(self) -> float:
        """Predicted seconds of this mesh and of the passes, without imports."""
        passes = 0.0
        if self._on("passes") and self.plan.scene.rolling.passes is not None:
            first, each = cost.PASSES[self.plan.contact.line]
            each *= self.plan.scene.rolling.passes * (1 + self._on("plasticity_wheel"))
            passes = cost.correction() * self._rolled * (first + each)
        return self.mesh_seconds + passes

    @property
    def mesh_seconds(self) -> float:
        """Predicted seconds of one mesh on this machine: meshing, assembly, solution with load
        steps and friction, and reading. Imports are not included. Where half-spaces answer, the
        seconds of boundary elements.
        """
        law = cost.LAW * self._on("falling_friction")
        if self.plan.by_half_spaces:
            asked = self._on("friction"), self.plan.stresses_asked
            return cost.BOUNDARY_ELEMENTS[asked] + law
        more = 0.0
        if self._on("plasticity"):
            more = cost.LOAD_STEP[self.plan.contact.line] * self.plan.load_steps
        beside = 0.0
        if self._on("friction") and not self.plan.condenses:
            more, beside = cost.FRICTION, cost.FRICTION_SECONDS + law
        elif self._on("friction") and not self.plan.plane_model:
            more += cost.CONDENSING * self.plan.unknowns / cost.CONDENSING_AT
        elastic = self.cost_per_unknown.time(self.plan.unknowns)
        return cost.correction() * (elastic * (1 + more) + beside)

    @property
    def cost_per_unknown(self) -> cost.Cost:
        """Seconds and bytes per unknown of a meshed model of this kind, elastic and frictionless,
        on the machine of reference (`planning.cost`), without the correction for this machine. Only
        with quadratic tetrahedra do half-spaces cost less than bodies; sections cost the same with
        any cell.
        """
        if self.plan.plane_model:
            return cost.SECTION
        usual = cost.HALF_SPACES if self.plan.contact.half_space else cost.PROFILES
        return cost.OTHER_CELLS.get((self.plan.scene.mesh.cell, self.plan.order), usual)

    @property
    def memory(self) -> int:
        """Predicted peak of the memory of the process, bytes; that of the libraries and of passes
        where half-spaces answer.
        """
        each = self.cost_per_unknown.bytes
        if self._on("plasticity"):
            each += cost.YIELD_BYTES
        if self._on("friction"):
            each += cost.CONDENSING_BYTES if self.plan.condenses else cost.FRICTION_BYTES
        passes = cost.PASS_BYTES[self.plan.contact.line] if self._on("passes") else 0
        return cost.BASE_BYTES + max(each * self.plan.unknowns, passes * self._rolled)

    def _on(self, name: str) -> bool:
        """Whether an effect is simulated."""
        return self.plan.effects[name].on

    @property
    def _rolled(self) -> int:
        """Number of patches that boundary elements find; passes roll over each with a block of its
        own. 1 where boundary elements are not solved or find none.
        """
        elastic = self.plan.context.half_spaces.elastic
        return 1 if isinstance(elastic, str) else len(elastic.patches)

    def fits(self, free: int) -> bool:
        """Whether the predicted memory is at most 0.8 (MEMORY_SHARE) of the free memory (bytes)."""
        return self.memory <= MEMORY_SHARE * free

    def check_memory(self, free: int) -> None:
        """Refuse a scene whose mesh does not fit into the free memory (bytes): SceneError.
        Nothing is refused where the scene has a budget, or an accuracy without error laws: the
        first of its meshes is coarse, and a finer one that does not fit is left out.
        """
        plan, accuracy = self.plan, self.plan.scene.accuracy
        told = accuracy is None or plan.family
        if plan.scene.budget is None and told and not self.fits(free):
            needed = self.memory / MEMORY_SHARE / 1e9
            raise SceneError(
                "mesh.patch_size" if accuracy is None else "accuracy",
                f"{plan.patch_size:.3g} mm makes about {plan.unknowns:.2g} unknowns, which need "
                f"{needed:.3g} GB of {free / 1e9:.3g} GB free; give a larger one",
            )

    def prices(self) -> list[dict[str, Any]] | None:
        """Predicted cost of several accuracies, the least accurate first; None where no family of
        error laws fits the plan.
        Keys of a row: accuracy, patch_size_mm, unknowns, seconds, memory_MB, and of the largest
            expected estimate widest (its quantity), mesh, reading, left_out, load_steps and profile
            (its parts); all but accuracy are None where it is out of reach. Seconds:
            `solving_seconds`.
        """
        wanted, family = self.plan.scene.accuracy, self.plan.family
        if family is None:
            return None
        rows = []
        for accuracy in sorted({*PRICED_ACCURACIES, *([wanted] if wanted else [])}, reverse=True):
            planned, fine = self.plan.for_accuracy(accuracy), None
            others, widest, total, mesh = planned.error_without_meshes, None, 0.0, 0.0
            if self.plan.profile_error < accuracy and accuracy >= family.least + others:
                fine = planned
                total, widest, mesh = family.expected(fine.resolution)
            rows.append(
                {
                    "accuracy": accuracy,
                    "patch_size_mm": fine and fine.patch_size,
                    "unknowns": fine and fine.unknowns,
                    "seconds": fine and Price(fine).solving_seconds,
                    "memory_MB": fine and Price(fine).memory / 1e6,
                    "widest": widest,
                    "mesh": fine and mesh,
                    "reading": fine and total - mesh,
                    "left_out": fine and self.plan.omission_error,
                    "load_steps": fine and others - self.plan.omission_error,
                    "profile": fine and self.plan.profile_error,
                }
            )
        return rows

"""What a plan was asked for: checked, and carried out."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

from gonio.api.following import as_warning
from gonio.api.scene import SceneOptions
from gonio.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from gonio.api.following import Tell
    from gonio.plan import Plan
    from gonio.protocols import Progress
    from gonio.rig import Rig
    from gonio.timing import Timing
    from nnbrdf.prior import MaterialPrior
    from planner.candidates import Candidates
    from planner.field import Field
    from planner.make import Omission

_DENSITY = "sixth"


@dataclass(frozen=True, kw_only=True)
class PlanRequest:
    """What is to be chosen, from what, by what; `gonio plan --help` says more of each.

    Attributes
    ----------
    density, views, lights
        How many directions: `all`, `sixth` or a number; of density also the paper's subsets.
    criterion, weight
        How pairs are chosen, and how much each counts.
    candidates, view_candidates, light_candidates, max_theta_deg
        The directions to choose from.
    seed
        Of the random criterion.
    shots, hours
        How many pairs to choose freely, or how long they may take.
    scene, material, isotropic, mono
        How the material will be used.
    prior_path, rig_path, timing_path
        Files; None: the generated prior, the built-in rig, the timing that is found.
    bracket, anchors
        Exposures of a shot, and how often one pair is taken again.
    tell
        Told what a person should know.
    """

    density: str | None = None
    views: str | None = None
    lights: str | None = None
    criterion: str = "i-optimal"
    weight: str = "alike"
    candidates: str = "paper-81"
    view_candidates: str | None = None
    light_candidates: str | None = None
    max_theta_deg: float | None = None
    seed: int | None = None
    shots: int | None = None
    hours: float | None = None
    scene: Path | None = None
    material: str | None = None
    isotropic: bool = False
    mono: bool = False
    prior_path: Path | None = None
    rig_path: Path | None = None
    timing_path: Path | None = None
    bracket: str | None = None
    anchors: int | None = None
    tell: Tell = as_warning

    def make(self, progress: Progress | None = None) -> Plan:
        """Make the plan.

        Raises
        ------
        gonio.errors.BadInputError
            For what does not go together, or asks for what cannot be had.
        """
        from planner.anchors import with_anchors

        self.check_amount()
        predicted = self.settings["bracket"] == "predicted"
        self.refuse_idle(self.weight, None if predicted else self.prior_path)
        self.use.check(self.criterion, self.weight)
        if self.prior_path:
            self.believed()  # one that is damaged is told before the work
        plan = self._with_prior(self.use.finish(self._chosen(progress)))
        if self.weight == "cosine":
            plan = plan.of_demand("the cosines of both directions")
        if self.anchors:
            plan = with_anchors(plan, self.anchors, self.rig, self.settings["timing"])
        return plan

    @property
    def amounts(self) -> list[str]:
        """What says how much to measure."""
        names = ("density", "views", "lights", "shots", "hours")
        return [f"--{name}" for name in names if getattr(self, name) is not None]

    def check_amount(self) -> None:
        """Refuse to be told twice how much to measure."""
        free = {"--shots", "--hours"} & set(self.amounts)
        if free and len(self.amounts) > 1:
            named = sorted(free)
            others = ", ".join(each for each in self.amounts if each != named[0])
            raise BadInputError(f"{named[0]} says how many pairs to measure; leave out {others}")

    def refuse_idle(self, weight: str, prior_path: Path | None) -> None:
        """Refuse what the criterion would not look at."""
        from planner.criteria import CRITERIA, PRIOR_CRITERIA

        criterion = self.criterion
        if criterion not in CRITERIA:
            return
        if prior_path and criterion not in PRIOR_CRITERIA:
            raise BadInputError(f"criterion {criterion} knows no prior; leave out --prior")
        if weight != "alike" and criterion != "i-optimal":
            raise BadInputError(f"criterion {criterion} weighs no pairs; leave out --weight")
        if self.seed is not None and criterion != "random":
            raise BadInputError(f"criterion {criterion} draws nothing; leave out --seed")

    def _chosen(self, progress: Progress | None) -> Plan:
        from planner.density import split_density
        from planner.make import field_within, make_plan

        both_views, both_lights = split_density(self.density or _DENSITY)
        make = partial(
            make_plan, self.rig, views=self.views or both_views,
            lights=self.lights or both_lights, criterion=self.criterion, progress=progress,
            **self.settings,
        )  # fmt: skip
        if not self.use.given:
            return make(shots=self.shots, hours=self.hours, prior=self.believed)
        views, lights = self.sides
        field_of: Callable[[Mapping[str, Omission]], Field] = partial(
            field_within, self.rig, lights, views, self.max_theta_deg
        )
        return self.use.plan(
            make, field_of, self.believed, self.shots, self.hours, fewest=not self.amounts
        )

    def _with_prior(self, plan: Plan) -> Plan:
        from gonio.api.prior import with_prior

        if plan.selection.variance_left is not None or self.settings["bracket"] == "predicted":
            return with_prior(plan, self._prior)
        if self.prior_path:
            self.tell("all pairs are measured, so the prior had no say")
        return plan

    @cached_property
    def use(self) -> SceneOptions:
        """How the material will be used."""
        return SceneOptions(self.scene, self.material, self.isotropic, self.mono)

    @cached_property
    def rig(self) -> Rig:
        """The rig of the file, or the built-in one."""
        from gonio.rig import default_rig, load_rig

        return load_rig(self.rig_path) if self.rig_path else default_rig()

    @cached_property
    def sides(self) -> tuple[Candidates, Candidates]:
        """Candidates for views and for lights."""
        from planner.candidates import candidates_named

        both = self.candidates
        views, lights = self.view_candidates or both, self.light_candidates or both
        return candidates_named(views), candidates_named(lights)

    @cached_property
    def choice(self) -> dict[str, Any]:
        """From what to choose, as `planner.make.make_plan` takes it."""
        from planner.field import cosine_demand

        views, lights = self.sides
        return {
            "view_candidates": views,
            "light_candidates": lights,
            "demand": cosine_demand if self.weight == "cosine" else None,
            "max_theta_deg": self.max_theta_deg,
        }

    @cached_property
    def settings(self) -> dict[str, Any]:
        """The same, with what the rig takes and how shots are exposed."""
        from gonio.api.timing import timing_for

        timing: Timing | None = timing_for(self.rig, self.rig_path, self.timing_path, self.tell)
        # how bright shots come out hangs on the camera, of which only a measurement tells
        bracket = self.bracket or ("predicted" if timing else "all")
        return self.choice | {"seed": self.seed or 0, "timing": timing, "bracket": bracket}

    @cached_property
    def _prior(self) -> MaterialPrior:
        from gonio.api.prior import material_prior

        return material_prior(self.prior_path)

    def believed(self) -> MaterialPrior:
        """Return what materials are believed to look like."""
        return self._prior

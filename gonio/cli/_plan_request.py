"""What `gonio plan` was asked for: checked, and carried out."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import click

from gonio.cli._scene import SceneOptions
from gonio.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path

    from gonio.plan import Plan
    from gonio.protocols import Progress
    from gonio.rig import Rig
    from gonio.timing import Timing
    from nnbrdf.prior import MaterialPrior
    from planner.candidates import Candidates
    from planner.field import Field
    from planner.make import Omission


@dataclass(frozen=True)
class PlanRequest:
    """The options of the command, each under its own name.

    Attributes
    ----------
    typed
        Names of the options that were typed, rather than left as they are.
    """

    typed: frozenset[str]
    density: str
    views: str | None
    lights: str | None
    criterion: str
    weight: str
    candidates: str
    view_candidates: str | None
    light_candidates: str | None
    max_theta_deg: float | None
    seed: int | None
    shots: int | None
    hours: float | None
    continued: Path | None
    scene: Path | None
    material: str | None
    isotropic: bool
    mono: bool
    plot_demand: Path | None
    prior_path: Path | None
    rig_path: Path | None
    timing_path: Path | None
    bracket: str | None
    anchors: int | None
    output: Path
    plot: Path | None
    pareto: bool
    page: bool

    def run(self) -> None:
        """Make the plan, the further plan of a session, or the comparison of many.

        Raises
        ------
        gonio.errors.BadInputError
            For options that do not go together, or ask for what cannot be had.
        """
        if self.continued is not None:
            self._go_on(self.continued)
            return
        self._check_amount()
        self._check_names()
        if self.pareto:
            self._compare()
        else:
            self._plan()

    def _go_on(self, session: Path) -> None:
        from gonio.cli._continue import go_on, refuse_others, tell
        from gonio.cli._plan_table import print_plan

        refuse_others(self.criterion)
        self._refuse_idle(self.weight, self.prior_path)
        with self._choosing() as progress:
            path, plan = go_on(
                session, self.shots, self.prior_path, self.timing_path, self.bracket,
                criterion=self.criterion, progress=progress, **self._choice,
            )  # fmt: skip
        print_plan(plan)
        tell(plan, path)

    def _compare(self) -> None:
        from gonio.cli._pareto import write_pareto

        every = "criterion" not in self.typed
        if not every:
            self._refuse_idle("alike", None)
        criterion = None if every else self.criterion
        settings = self._settings | {"prior": self._believed}
        with _nothing_kept():
            write_pareto(self.output.parent, criterion, self._rig, settings)

    def _plan(self) -> None:
        from gonio.cli._plan_table import print_plan
        from nnbrdf.usable import MIN_SAMPLES
        from planner.anchors import with_anchors

        predicted = self._settings["bracket"] == "predicted"
        self._refuse_idle(self.weight, None if predicted else self.prior_path)
        self._use.check(self.criterion, self.weight, self.output)
        if self.prior_path:
            self._believed()  # one that is damaged is told before the work
        plan = self._with_prior(self._use.finish(self._chosen()))
        if self.weight == "cosine":
            plan = plan.of_demand("the cosines of both directions")
        if self.anchors:
            plan = with_anchors(plan, self.anchors, self._rig, self._settings["timing"])
        plan.save(self.output)
        print_plan(plan)
        click.echo(f"wrote {self.output}, sha256 {plan.sha256}")
        if len(plan.shots) < MIN_SAMPLES:
            click.echo(f"note: gonio reconstruct needs at least {MIN_SAMPLES} shots")
        self._tell_slow_homing()
        self._draw(plan)

    def _chosen(self) -> Plan:
        from planner.density import split_density
        from planner.make import field_within, make_plan

        both_views, both_lights = split_density(self.density)
        with self._choosing() as progress:
            make = partial(
                make_plan, self._rig, views=self.views or both_views,
                lights=self.lights or both_lights, criterion=self.criterion, progress=progress,
                **self._settings,
            )  # fmt: skip
            if not self._use.given:
                return make(shots=self.shots, hours=self.hours, prior=self._believed)
            views, lights = self._sides
            field_of: Callable[[Mapping[str, Omission]], Field] = partial(
                field_within, self._rig, lights, views, self.max_theta_deg
            )
            return self._use.plan(
                make, field_of, self._believed, self.shots, self.hours, fewest=not self._amounts
            )

    def _tell_slow_homing(self) -> None:
        from gonio.homing import longest_homing_s
        from gonio.timing import default_timing
        from gonio.words import duration

        longest_s = longest_homing_s(
            self._rig, self._settings["timing"] or default_timing(self._rig)
        )
        most_s = self._rig.arm.homing_timeout_s
        if longest_s > most_s:
            click.echo(
                f"note: homing may take {duration(longest_s)}, and a capture gives up after "
                f"{duration(most_s)}; raise arm.homing_timeout_s in the rig file"
            )

    @contextmanager
    def _choosing(self) -> Iterator[Progress]:
        from gonio.cli._console import progress_bar

        with _nothing_kept(), progress_bar("choosing") as progress:
            yield progress

    @cached_property
    def _amounts(self) -> list[str]:
        """The options typed that say how much to measure."""
        names = ("density", "views", "lights", "shots", "hours")
        return [f"--{name}" for name in names if name in self.typed]

    def _check_amount(self) -> None:
        free = {"--shots", "--hours"} & set(self._amounts)
        if free and len(self._amounts) > 1:
            named = sorted(free)
            others = ", ".join(each for each in self._amounts if each != named[0])
            raise BadInputError(f"{named[0]} says how many pairs to measure; leave out {others}")
        idle = [f"--{name}" for name in ("plot", "anchors") if getattr(self, name)]
        alone = [*self._amounts, *idle, *self._use.named]
        if self.pareto and alone:
            raise BadInputError(
                f"--pareto tries densities of its own; leave out {', '.join(alone)}"
            )

    def _check_names(self) -> None:
        for option, path in (("-o", self.output), ("--plot", self.plot)):
            if path is not None and not path.name:
                raise BadInputError(f"{option} is no file name; give one, as plan.json")
        if self.plot and self.plot.resolve() == self.output.resolve():
            raise BadInputError(
                f"--plot {self.plot} is where the plan goes; give the picture another name"
            )
        if self.page and self._page_path in (self.output, self.plot):
            raise BadInputError(
                f"{self._page_path} is where the plan's page goes; take another, or --no-page"
            )

    def _refuse_idle(self, weight: str, prior_path: Path | None) -> None:
        """Refuse options that the criterion would not look at."""
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

    @cached_property
    def _use(self) -> SceneOptions:
        return SceneOptions(self.scene, self.material, self.isotropic, self.mono, self.plot_demand)

    @cached_property
    def _rig(self) -> Rig:
        from gonio.rig import default_rig, load_rig

        return load_rig(self.rig_path) if self.rig_path else default_rig()

    @cached_property
    def _sides(self) -> tuple[Candidates, Candidates]:
        """Candidates for views and for lights."""
        from planner.candidates import candidates_named

        both = self.candidates
        views, lights = self.view_candidates or both, self.light_candidates or both
        return candidates_named(views), candidates_named(lights)

    @cached_property
    def _choice(self) -> dict[str, Any]:
        from planner.field import cosine_demand

        views, lights = self._sides
        return {
            "view_candidates": views,
            "light_candidates": lights,
            "demand": cosine_demand if self.weight == "cosine" else None,
            "max_theta_deg": self.max_theta_deg,
        }

    @cached_property
    def _settings(self) -> dict[str, Any]:
        from gonio.cli._timing import timing_for

        timing: Timing | None = timing_for(self._rig, self.rig_path, self.timing_path)
        # how bright shots come out hangs on the camera, of which only a measurement tells
        bracket = self.bracket or ("predicted" if timing else "all")
        return self._choice | {"seed": self.seed or 0, "timing": timing, "bracket": bracket}

    @cached_property
    def _prior(self) -> MaterialPrior:
        from gonio.cli._prior import material_prior

        return material_prior(self.prior_path)

    def _believed(self) -> MaterialPrior:
        return self._prior

    def _with_prior(self, plan: Plan) -> Plan:
        from gonio.cli._prior import with_prior

        if plan.selection.variance_left is not None or self._settings["bracket"] == "predicted":
            return with_prior(plan, self._prior)
        if self.prior_path:
            click.echo("note: all pairs are measured, so the prior had no say")
        return plan

    @property
    def _page_path(self) -> Path:
        return self.output.with_suffix(".html")

    def _draw(self, plan: Plan) -> None:
        from gonio.cli._plan_pictures import draw_plan, write_page

        if self.page:
            write_page(
                self._page_path, plan, self._rig, self._sides, self.max_theta_deg, self._use.pairs
            )
            click.echo(f"wrote {self._page_path}")
        if self.plot:
            draw_plan(plan, self.plot, *self._sides)
            click.echo(f"wrote {self.plot}")
        self._use.draw()


@contextmanager
def _nothing_kept() -> Iterator[None]:
    """Say of an interruption that it left nothing behind."""
    try:
        yield
    except KeyboardInterrupt as stop:
        stop.args = stop.args or ("nothing was written",)
        raise

"""What `gonio plan` was asked for: made, written, drawn and told."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

import click

from gonio.api.planning import PlanRequest
from gonio.cli._json import answer
from gonio.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from gonio.plan import Plan
    from gonio.protocols import Progress


@dataclass(frozen=True, kw_only=True)
class PlanCommand(PlanRequest):
    """The options of the command, each under its own name.

    Attributes
    ----------
    continued
        The session that is to go on.
    output, plot, plot_demand
        Files of plan and pictures.
    pareto, page
        Whether many plans are compared instead, and whether the plan's page is written.
    every
        Whether all criteria are compared, since none was named.
    """

    continued: Path | None
    output: Path
    plot: Path | None
    plot_demand: Path | None
    pareto: bool
    page: bool
    every: bool

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
        self._check_pareto()
        self._check_names()
        if self.pareto:
            self._compare()
        else:
            self._plan()

    def _go_on(self, root: Path) -> None:
        from gonio.api.continuing import check_knowing, go_on
        from gonio.cli._console import progress_bar
        from gonio.cli._continue import refuse_others, tell
        from gonio.cli._plan_table import print_plan
        from gonio.session import Session

        refuse_others()
        check_knowing(self.criterion)
        with _nothing_kept():
            path, plan = go_on(Session.open(root), self, progress_bar)
        print_plan(plan)
        tell(plan, path)
        self._answer(plan, path)

    def _compare(self) -> None:
        from gonio.cli._pareto import write_pareto

        if not self.every:
            self.refuse_idle("alike", None)
        criterion = None if self.every else self.criterion
        settings = self.settings | {"prior": self.believed}
        with _nothing_kept():
            write_pareto(self.output.parent, criterion, self.rig, settings)

    def _plan(self) -> None:
        from gonio.cli._plan_table import print_plan
        from nnbrdf.usable import MIN_SAMPLES

        with self._choosing() as progress:
            plan = self.make(progress)
        plan.save(self.output)
        print_plan(plan)
        click.echo(f"wrote {self.output}, sha256 {plan.sha256}")
        if len(plan.shots) < MIN_SAMPLES:
            click.echo(f"note: gonio reconstruct needs at least {MIN_SAMPLES} shots")
        self._tell_slow_homing()
        self._draw(plan)
        self._answer(plan, self.output)

    def _answer(self, plan: Plan, path: Path) -> None:
        from gonio.api.told import plan_document

        answer({**plan_document(plan), "file": path})

    def _tell_slow_homing(self) -> None:
        from gonio.homing import longest_homing_s
        from gonio.timing import default_timing
        from gonio.words import duration

        longest_s = longest_homing_s(self.rig, self.settings["timing"] or default_timing(self.rig))
        most_s = self.rig.arm.homing_timeout_s
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

    def _check_pareto(self) -> None:
        self.check_amount()
        idle = [f"--{name}" for name in ("plot", "anchors") if getattr(self, name)]
        alone = [*self.amounts, *idle, *self.use.named]
        if self.pareto and alone:
            raise BadInputError(
                f"--pareto tries densities of its own; leave out {', '.join(alone)}"
            )

    def _check_names(self) -> None:
        for option, path in (("-o", self.output), ("--plot", self.plot)):
            if path is not None and not path.name:
                raise BadInputError(f"{option} is no file name; give one, as plan.json")
        for option, picture in (("--plot", self.plot), ("--plot-demand", self.plot_demand)):
            if picture and picture.resolve() == self.output.resolve():
                raise BadInputError(
                    f"{option} {picture} is where the plan goes; give the picture another name"
                )
        if self.plot_demand and not self.scene:
            raise BadInputError("--plot-demand draws what a scene asks for; give --scene")
        if self.page and self._page_path in (self.output, self.plot):
            raise BadInputError(
                f"{self._page_path} is where the plan's page goes; take another, or --no-page"
            )

    @property
    def _page_path(self) -> Path:
        return self.output.with_suffix(".html")

    def _draw(self, plan: Plan) -> None:
        from gonio.cli._plan_pictures import draw_demand, draw_plan, write_page

        if self.page:
            write_page(
                self._page_path, plan, self.rig, self.sides, self.max_theta_deg, self.use.pairs
            )
            click.echo(f"wrote {self._page_path}")
        if self.plot:
            draw_plan(plan, self.plot, *self.sides)
            click.echo(f"wrote {self.plot}")
        if self.plot_demand and self.use.pairs:
            draw_demand(self.use.pairs, self.plot_demand)
            click.echo(f"wrote {self.plot_demand}")


@contextmanager
def _nothing_kept() -> Iterator[None]:
    """Say of an interruption that it left nothing behind."""
    try:
        yield
    except KeyboardInterrupt as stop:
        stop.args = stop.args or ("nothing was written",)
        raise

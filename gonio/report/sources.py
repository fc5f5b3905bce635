"""What a report is made from, each read once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

from gonio.checks import Checks
from gonio.report.captured import Captured
from gonio.report.gridded import GriddedModel, is_slow
from gonio.report.screen import Screen

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from gonio.checks import Check
    from gonio.materials import MeasuredTable
    from gonio.planchain import PlanChain
    from gonio.protocols import Estimate, Prior
    from gonio.samples import Samples
    from gonio.session import Session
    from nnbrdf.load import Model


@dataclass(frozen=True)
class Sources:
    """A model and all that is known with it.

    Attributes
    ----------
    model
        Its folder.
    samples
        What it was made from.
    session
        Where they were measured; None for a table from elsewhere.
    truth
        The material itself, where a simulated session tells it.
    prior
        What materials looked like before; None: the generated one.
    """

    model: Path
    samples: Samples
    session: Session | None
    truth: MeasuredTable | None
    prior: Prior | None

    @cached_property
    def estimate(self) -> Model:
        """The model."""
        from nnbrdf.load import load_model

        return load_model(self.model)

    @cached_property
    def grid(self) -> dict[str, NDArray[Any]]:
        """What it says on the 81 x 81 grid."""
        # the types differ by the kind of number alone
        return dict(self.estimate.grid())

    @cached_property
    def quick(self) -> Estimate:
        """The model, or, where that is slow to evaluate, its table on the grid."""
        if is_slow(self.estimate):
            return cast("Estimate", GriddedModel.of_grid(self.grid, self.white))
        return self.estimate

    @cached_property
    def chain(self) -> PlanChain | None:
        """The session's plans."""
        return self.session.chain() if self.session else None

    @cached_property
    def captured(self) -> Captured | None:
        """What the session's journal tells."""
        return Captured.of(self.session)

    @cached_property
    def checks(self) -> tuple[Check, ...]:
        """What the reduction thought of the frames; nothing where it was not asked."""
        if self.session is None or not self.session.checks_path.is_file():
            return ()
        return Checks.load(self.session.checks_path).checks

    @property
    def white(self) -> float:
        """The model's white, in 1/sr."""
        return self.estimate.card.white

    @property
    def screen(self) -> Screen:
        """How values are shown."""
        return Screen.of(self.samples.color_space)

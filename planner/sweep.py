"""Many plans side by side: what each costs, and which error is to be expected of it."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.errors import BadInputError
from planner.locate import rows_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from numpy.typing import NDArray

    from gonio.plan import Plan
    from gonio.protocols import Progress
    from planner.expected import ExpectedError
    from planner.field import Field

SIDES = (4, 6, 8, 10, 14, 20, 30)
"""Views and lights of each product."""
PAIRS = (16, 36, 64, 100, 196, 400, 1134)
"""Numbers of free pairs: those of the products, and of 81 views by 14 lights."""


@dataclass(frozen=True)
class Design:
    """What one plan is asked for: as many views as lights, or pairs chosen freely."""

    criterion: str
    side: int | None = None
    pairs: int | None = None

    @property
    def label(self) -> str:
        """`14 x 14`, or the number of pairs."""
        return f"{self.pairs}" if self.side is None else f"{self.side} x {self.side}"

    @property
    def settings(self) -> dict[str, Any]:
        """What `planner.make.make_plan` is to be called with."""
        what = (
            {"shots": self.pairs}
            if self.side is None
            else dict.fromkeys(("views", "lights"), self.side)
        )
        return {"criterion": self.criterion, **what}


@dataclass(frozen=True)
class Outcome:
    """What a design came to.

    Attributes
    ----------
    shots
        How many the rig can take of it.
    seconds
        Of the capture, as estimated.
    error
        Expected standard deviation of ln(BRDF), see `planner.expected`.
    planning_s
        What choosing and ordering took of one core, the prior's factor not counted.
    """

    design: Design
    shots: int
    seconds: float
    error: float
    planning_s: float


@dataclass(frozen=True)
class Sweep:
    """The outcomes, and why there is none of some designs."""

    outcomes: tuple[Outcome, ...]
    refused: tuple[tuple[Design, str], ...]


def designs_of(criteria: Iterable[str], field: Field) -> list[Design]:
    """Return products and free pairs of every size by each criterion, as far as a field goes.

    Raises
    ------
    BadInputError
        When it does not go as far as the smallest.
    """
    most, pairs = min(field.allowed.shape), field.allowed.size
    sizes: list[dict[str, int]] = [{"side": side} for side in SIDES if side <= most]
    sizes += [{"pairs": count} for count in PAIRS if count <= pairs]
    if not sizes:
        raise BadInputError(
            f"{pairs} pairs of candidates are too few to compare designs; {min(PAIRS)} at least"
        )
    return [Design(name, **size) for name in criteria for size in sizes]


def run_sweep(
    designs: Sequence[Design],
    plan_of: Callable[..., Plan],
    field: Field,
    judge: ExpectedError,
    progress: Progress,
    workers: int = 1,
) -> Sweep:
    """Make a plan of each design and say what it costs and gives.

    Parameters
    ----------
    plan_of
        `planner.make.make_plan` with everything but the design's settings.
    field
        The candidates that the plans choose from.
    judge
        Of the same field.
    workers
        How many plans are made side by side, by threads.

    Raises
    ------
    BadInputError
        When there is no plan of any design.
    """
    outcomes, refused = [], []
    with _leaving_at_once(ThreadPoolExecutor(workers)) as pool:
        made = pool.map(partial(_plan, plan_of), designs)
        for number, (design, (plan, planning_s)) in enumerate(zip(designs, made, strict=True), 1):
            if isinstance(plan, BadInputError):
                refused.append((design, str(plan)))
            else:
                error = judge.after(_measured(plan, field))
                shots, seconds = len(plan.shots), plan.estimates.total_s
                outcomes.append(Outcome(design, shots, seconds, error, planning_s))
            progress(number, len(designs))
    if not outcomes:
        raise BadInputError(refused[0][1])
    return Sweep(tuple(outcomes), tuple(refused))


@contextmanager
def _leaving_at_once(pool: ThreadPoolExecutor) -> Iterator[ThreadPoolExecutor]:
    """Close a pool at the end; when that is no good one, without what has not begun."""
    try:
        yield pool
    finally:
        pool.shutdown(cancel_futures=True)


def _plan(plan_of: Callable[..., Plan], design: Design) -> tuple[Plan | BadInputError, float]:
    """Return the plan of a design, or why there is none, and the processor's seconds it took."""
    # of this thread alone: what runs beside it does not count
    began = time.thread_time()
    try:
        plan: Plan | BadInputError = plan_of(**design.settings)
    except BadInputError as error:
        plan = error
    return plan, time.thread_time() - began


def _measured(plan: Plan, field: Field) -> NDArray[np.int64]:
    rows = rows_of(plan, "light", field.lights), rows_of(plan, "view", field.views)
    return np.asarray(np.ravel_multi_index(rows, field.allowed.shape))

"""Measuring and choosing in turn, until what is known is enough."""

from __future__ import annotations

import time
from functools import partial
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path
    from typing import Any

    from gonio.adaptive import Goal, Round
    from gonio.api.following import Following
    from gonio.api.measuring import Driven
    from gonio.clock import Clock
    from gonio.plan import Plan
    from gonio.samples import Samples
    from gonio.session import Session

FIRST_SHOTS = 32
"""Of a first plan: enough to tell what kind of material it is."""


def new_goal(said: dict[str, Any], prior_path: Path | None) -> Goal:
    """Return the goal of a new session (errors as `gonio.adaptive.Goal.of`)."""
    from gonio.adaptive import Goal

    return Goal.of(said, readable(prior_path))


def readable(prior_path: Path | None) -> Path | None:
    """Refuse a prior that cannot be read before it is made a goal."""
    from gonio.api.prior import material_prior

    if prior_path is not None:
        material_prior(prior_path)
    return prior_path


def first_shots(goal: Goal) -> int:
    """Return how many pairs to begin with where no plan was given."""
    return min(FIRST_SHOTS, goal.max_shots or FIRST_SHOTS)


def check_affordable(plan: Plan, goal: Goal) -> None:
    """Refuse a first plan that is beyond the goal's limits, or too small to go on from.

    Raises
    ------
    gonio.errors.BadInputError
        Naming the limit.
    """
    from gonio.errors import BadInputError
    from gonio.words import duration
    from nnbrdf.usable import MIN_SAMPLES

    shots, seconds = len(plan.shots), plan.estimates.total_s
    if shots < MIN_SAMPLES:
        raise BadInputError(
            f"the first plan has {shots} shots, and --adaptive goes on from {MIN_SAMPLES} or more; "
            "give another with --plan"
        )
    if goal.max_shots is not None and shots > goal.max_shots:
        raise BadInputError(
            f"the first plan has {shots} shots, more than --max-shots {goal.max_shots}; "
            "raise that, or give a smaller plan with --plan"
        )
    if seconds > goal.seconds:
        raise BadInputError(
            f"the first plan takes {duration(seconds)}, more than --hours {goal.hours:g}; "
            "raise that, or give a smaller plan with --plan"
        )


def note_goal(session: Session, goal: Goal, clock: Clock) -> None:
    """Put the goal into a new session's journal, before anybody can see the session."""
    from gonio.adaptive import begin

    with session.journal(writing=True) as journal:
        begin(journal, clock, goal)


def measure_adaptively(session: Session, driven: Driven, goal: Goal, following: Following) -> Round:
    """Measure and choose in turn until the goal or a limit is reached; return the last round."""
    from gonio.adaptive import Rounds, Watch, begin, goal_under_way
    from gonio.api.prior import material_prior
    from gonio.api.reduction import reduced
    from gonio.api.timing import timing_for
    from gonio.capture import Capture
    from gonio.reduce.camera_check import check_camera
    from gonio.wishes import heeding

    watch = Watch(session, material_prior(goal.prior_path))
    began = time.perf_counter()
    with (
        session.lock(),
        heeding(session.root),
        session.journal(writing=True) as journal,
        driven as (instrument, operator),
    ):
        if goal_under_way(journal) != goal:
            begin(journal, instrument.clock, goal)

        def capture() -> None:
            with following.meeting(journal), following.bars("capturing") as progress:
                judge = partial(check_camera, session, journal)
                Capture(session, instrument, operator, journal, judge).run(progress)

        def reduce() -> Samples:
            return reduced(session, following.bars)

        timing = timing_for(session.rig(), session.rig_path, None, following.tell)
        rounds = Rounds(
            session, journal, instrument.clock, watch, goal,
            timing=timing, bracket="predicted" if timing else "all",
        )  # fmt: skip
        with following.using(journal):
            last = rounds.run(capture, reduce, following.told)
        session.note_timing("adaptive", time.perf_counter() - began)
    return last

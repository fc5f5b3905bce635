"""`gonio capture --adaptive`: rounds of measuring and choosing, from the command line."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from contextlib import AbstractContextManager
    from pathlib import Path

    from gonio.adaptive import Goal, Round
    from gonio.capture import Instrument, Operator
    from gonio.clock import Clock
    from gonio.plan import Plan
    from gonio.samples import Samples
    from gonio.session import Session

FIRST_SHOTS = 32
"""Of a first plan: enough to tell what kind of material it is."""


@dataclass(frozen=True)
class Wish:
    """What was asked for on the command line.

    Attributes
    ----------
    adaptive
        Whether `--adaptive` was.
    said
        The goal's numbers that were given.
    prior_path
        The prior's file, where one was named.
    """

    adaptive: bool
    said: dict[str, Any]
    prior_path: Path | None

    @classmethod
    def of(cls, options: dict[str, Any], prior_path: Path | None, *, adaptive: bool) -> Wish:
        """Make it of the options, None where not given.

        Raises
        ------
        gonio.errors.BadInputError
            For one that means nothing without `--adaptive`.
        """
        from gonio.errors import BadInputError

        said = {name: value for name, value in options.items() if value is not None}
        idle = [*said, *(["prior"] if prior_path else [])]
        if idle and not adaptive:
            option = idle[0].replace("_", "-")
            raise BadInputError(f"--{option} is an option of --adaptive; add that, or leave it out")
        return cls(adaptive, said, prior_path)

    def goal(self) -> Goal | None:
        """Return the goal of a new session; None without `--adaptive`."""
        from gonio.adaptive import Goal

        if not self.adaptive:
            return None
        return Goal.of(self.said, _read(self.prior_path))

    def going_on(self, session: Session) -> Goal | None:
        """Return the goal of a session that goes on: as before, but for what is asked for now."""
        from gonio.adaptive import Goal, goal_under_way, last_goal

        if not session.journal_path.is_file():
            return self.goal()
        with session.journal() as journal:
            if not self.adaptive:
                return goal_under_way(journal)
            return Goal.of(self.said, _read(self.prior_path), last_goal(journal))


def _read(path: Path | None) -> Path | None:
    """Refuse a prior that cannot be read before it is made a goal."""
    from gonio.cli._prior import material_prior

    if path is not None:
        material_prior(path)
    return path


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


def measure_adaptively(
    session: Session, driven: AbstractContextManager[tuple[Instrument, Operator]], goal: Goal
) -> None:
    """Measure and choose in turn until the goal or a limit is reached, and say which."""
    from gonio.adaptive import Rounds, Watch, begin, goal_under_way
    from gonio.capture import Capture
    from gonio.cli._console import progress_bar
    from gonio.cli._ending import tell_faults, tell_usage
    from gonio.cli._prior import material_prior
    from gonio.cli._samples import reduced
    from gonio.cli._timing import timing_for
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
            with tell_faults(journal), progress_bar("capturing") as progress:
                Capture(session, instrument, operator, journal).run(progress)

        def reduce() -> Samples:
            return reduced(session)

        timing = timing_for(session.rig(), session.rig_path, None)
        rounds = Rounds(
            session, journal, instrument.clock, watch, goal,
            timing=timing, bracket="predicted" if timing else "all",
        )  # fmt: skip
        with tell_usage(journal):
            last = rounds.run(capture, reduce, lambda state: _tell(state, goal))
        session.note_timing("adaptive", time.perf_counter() - began)
    _conclude(session, last)


def _tell(state: Round, goal: Goal) -> None:
    from gonio.cli._console import console
    from gonio.words import duration

    console.print(
        f"round {state.number}: {state.shots} shots, mean sd {state.deviation:.3f} "
        f"(target {goal.until:g}), {duration(state.rig_s)} of rig time"
    )


def _conclude(session: Session, last: Round) -> None:
    from gonio.cli._console import console
    from gonio.score import score_of
    from gonio.words import duration

    console.print(
        f"{session.root}: {last.ended}: mean sd {last.deviation:.3f} after {last.shots} shots in "
        f"{last.number} plans, {duration(last.rig_s)} of rig time"
    )
    if (score := score_of(session)) is not None:
        console.print(f"that is {score.sentence}")
    console.print(f"next: {session.reconstruct_command}")

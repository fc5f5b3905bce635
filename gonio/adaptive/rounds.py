"""Rounds of an adaptive capture: take, reduce, take stock, choose; until a target or a limit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from gonio.adaptive.goal import note_end
from gonio.errors import NothingLeftError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from gonio.adaptive.goal import Goal
    from gonio.adaptive.standing import Standing, Watch
    from gonio.clock import Clock
    from gonio.journal import Event, Journal
    from gonio.plan import Plan
    from gonio.samples import Samples
    from gonio.session import Session

_AT_WORK = ("homed", "frame", "fault", "stopped", "finished")


@dataclass(frozen=True)
class Round:
    """Where an adaptive capture stands.

    Attributes
    ----------
    number
        Of the round, from 1; a round is a plan.
    shots
        Planned so far, all taken.
    deviation
        Mean posterior standard deviation of ln(f + 0.01 white) over the 81 x 81 pairs.
    rig_s
        The rig's time so far, in seconds.
    ended
        What ended it; empty where it goes on.
    """

    number: int
    shots: int
    deviation: float
    rig_s: float
    ended: str = ""


class Rounds:
    """An adaptive capture of a session, locked by the caller.

    All that it decides hangs on the chain of plans and on the journal with its frames, so that one
    that was killed goes on as if it had not been.

    Parameters
    ----------
    session, journal, clock
        What is measured, its journal to be written, and the rig's clock.
    watch
        Takes stock of it.
    goal
        When to end.
    choice
        How pairs are chosen, as of `gonio.adaptive.Standing.next_plan`.
    """

    def __init__(
        self,
        session: Session,
        journal: Journal,
        clock: Clock,
        watch: Watch,
        goal: Goal,
        **choice: Any,
    ) -> None:
        self._session, self._journal, self._clock = session, journal, clock
        self._watch, self._goal, self._choice = watch, goal, choice

    def run(
        self,
        capture: Callable[[], object],
        reduce: Callable[[], Samples],
        tell: Callable[[Round], object],
    ) -> Round:
        """Go round by round to the end.

        Parameters
        ----------
        capture
            Takes what the session's plans lack.
        reduce
            Returns the samples of what was taken.
        tell
            Is called with each round.

        Returns
        -------
        Round
            The last one, with what ended it.
        """
        while True:
            capture()
            standing = self._watch.take_stock(reduce())
            plan, reason = self._decide(standing)
            state = self._state(standing, reason)
            tell(state)
            if plan is None:
                note_end(self._journal, self._clock, reason, state.shots, state.deviation)
                return state
            self._session.add_plan(plan)

    def _decide(self, standing: Standing) -> tuple[Plan | None, str]:
        """Return the next plan, or none and why."""
        goal = self._goal
        if standing.deviation <= goal.until:
            return None, f"the target of {goal.until:g} is reached"
        shots = goal.batch
        if goal.max_shots is not None:
            shots = min(shots, goal.max_shots - len(standing.chain.shots))
        if shots < 1:
            return None, f"the limit of {goal.max_shots} shots is reached"
        try:
            plan = self._within_time(standing, shots)
        except NothingLeftError:
            return None, "every pair that the rig can take has been measured"
        return plan, "" if plan else f"no further shot fits into {goal.hours:g} h"

    def _within_time(self, standing: Standing, shots: int) -> Plan | None:
        """Return the next plan, of fewer shots where time is short; None where none fits."""
        left_s = self._goal.seconds - rig_time(self._journal.events())
        while shots >= 1:
            plan = standing.next_plan(shots, at_once=True, **self._choice)
            takes_s = plan.estimates.total_s
            if takes_s <= left_s:
                return plan
            shots = min(shots - 1, int(shots * max(left_s, 0.0) / takes_s))
        return None

    def _state(self, standing: Standing, reason: str) -> Round:
        return Round(
            number=len(standing.chain.plans),
            shots=len(standing.chain.shots),
            deviation=standing.deviation,
            rig_s=rig_time(self._journal.events()),
            ended=reason,
        )


def rig_time(events: Iterable[Event]) -> float:
    """Return the seconds that a rig has worked, by its journal: the time between runs not counted.

    A run that was killed counts up to its last event.
    """
    total, last = 0.0, None
    for event in events:
        if last is not None and event.kind in _AT_WORK:
            total += event.at_s - last
        # whatever ends a pause, it was no work
        last = None if event.kind == "paused" else event.at_s
    return total

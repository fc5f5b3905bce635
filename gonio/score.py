"""How well a capture's time was foretold."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from gonio.journal import Event
    from gonio.plan import Estimates, Plan
    from gonio.session import Session


@dataclass(frozen=True)
class Score:
    """What a capture took, beside what its plans had expected.

    Attributes
    ----------
    took_s, homing_s
        Of the whole capture, and of what came before its axes were home.
    expected
        Of each of its plans.
    """

    took_s: float
    homing_s: float
    expected: Sequence[Estimates]

    @property
    def error(self) -> float:
        """By how much it took longer than expected, as a share of that; negative for shorter."""
        return self.took_s / math.fsum(each.total_s for each in self.expected) - 1.0

    @property
    def error_once_home(self) -> float:
        """The same without homing: how far axes have to go to their switches is anybody's guess."""
        expected_s = math.fsum(each.total_s - each.homing_s for each in self.expected)
        return (self.took_s - self.homing_s) / expected_s - 1.0

    @property
    def is_within(self) -> bool | None:
        """Whether it ended within the 5 to 95 % interval; None where there is not one of all."""
        if len(self.expected) > 1:
            return None
        low_s, high_s = self.expected[0].total_lo_s, self.expected[0].total_hi_s
        if low_s is None or high_s is None:
            return None
        return low_s <= self.took_s <= high_s

    @property
    def sentence(self) -> str:
        """All of it in words."""
        place = {None: "", True: "within the 5 to 95 % interval, ", False: "outside of 5 to 95 %, "}
        return (
            f"{_share(self.error)} than estimated, {place[self.is_within]}"
            f"and {_share(self.error_once_home)} once home"
        )


def _share(error: float) -> str:
    return f"{abs(error):.2%} {'longer' if error > 0 else 'shorter'}"


def score_of(session: Session) -> Score | None:
    """Return how well the time of a session's plans was foretold.

    None where one of them was not measured in one go, or not to its end yet.

    Raises
    ------
    gonio.errors.BadFileError
        When journal or plan are damaged.
    """
    if not session.journal_path.is_file():
        return None
    with session.journal() as journal:
        runs = [run for run in _runs(journal.events()) if run.get("begun")]
    plans = session.chain().plans
    if len(runs) != len(plans) or not all(map(_is_whole, runs, plans)):
        return None
    return Score(
        took_s=math.fsum(run["finished"].at_s - run["begun"].at_s for run in runs),
        homing_s=math.fsum(run["homed"].at_s - run["begun"].at_s for run in runs),
        expected=[plan.estimates for plan in plans],
    )


def _is_whole(run: Mapping[str, Event], plan: Plan) -> bool:
    if not {"homed", "finished"} <= set(run):
        return False
    asked = run["begun"].data
    return (asked.get("plan"), asked.get("frames")) == (plan.sha256, plan.estimates.frames)


def _runs(events: Iterable[Event]) -> list[dict[str, Event]]:
    """Return the first event of each kind of each run."""
    runs: list[dict[str, Event]] = [{}]
    for event in events:
        if event.kind == "begun":
            runs.append({})
        runs[-1].setdefault(event.kind, event)
    return runs

"""How well a capture's time was foretold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from gonio.journal import Event
    from gonio.plan import Estimates
    from gonio.session import Session


@dataclass(frozen=True)
class Score:
    """What a capture took, beside what its plan had expected.

    Attributes
    ----------
    took_s, homing_s
        Of the whole capture, and of what came before its axes were home.
    expected
        The plan's.
    """

    took_s: float
    homing_s: float
    expected: Estimates

    @property
    def error(self) -> float:
        """By how much it took longer than expected, as a share of that; negative for shorter."""
        return self.took_s / self.expected.total_s - 1.0

    @property
    def error_once_home(self) -> float:
        """The same without homing: how far axes have to go to their switches is anybody's guess."""
        expected_s = self.expected.total_s - self.expected.homing_s
        return (self.took_s - self.homing_s) / expected_s - 1.0

    @property
    def is_within(self) -> bool | None:
        """Whether it ended within the 5 to 95 % interval; None where the plan states none."""
        low_s, high_s = self.expected.total_lo_s, self.expected.total_hi_s
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
    """Return how well the time of a session's first plan was foretold.

    None where it was not measured in one go, or not to its end yet.

    Raises
    ------
    gonio.errors.BadFileError
        When journal or plan are damaged.
    """
    if not session.journal_path.is_file():
        return None
    with session.journal() as journal:
        first = _first_run(journal.events())
    plan = session.chain().plans[0]
    begun, homed, finished = (first.get(kind) for kind in ("begun", "homed", "finished"))
    if not (begun and homed and finished) or begun.data.get("plan") != plan.sha256:
        return None
    if begun.data.get("frames") != plan.estimates.frames:
        return None
    return Score(finished.at_s - begun.at_s, homed.at_s - begun.at_s, plan.estimates)


def _first_run(events: Iterable[Event]) -> dict[str, Event]:
    """Return the events of each kind, one each, up to the end of the first run."""
    run: dict[str, Event] = {}
    for event in events:
        if event.kind == "begun" and "begun" in run:
            break
        run.setdefault(event.kind, event)
        if event.kind == "finished":
            break
    return run

"""What an adaptive capture is after, as its session's journal keeps it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

from pydantic import Field

from gonio.errors import ResumeRefusedError
from gonio.files import sha256_file
from gonio.validation import Document, check, within

if TYPE_CHECKING:
    from gonio.clock import Clock
    from gonio.journal import Journal

_BEGUN: Final = "adaptive"
_ENDED: Final = "adaptive ended"
_SECONDS_PER_HOUR = 3600.0


class Goal(Document):
    """When an adaptive capture ends, and how it goes there.

    Attributes
    ----------
    until
        Mean posterior standard deviation of ln(f + 0.01 white) over the 81 x 81 pairs to reach.
    batch
        Shots of a round.
    max_shots
        Of the whole session; None: all pairs.
    hours
        Of the rig's time; None: any.
    prior, prior_sha256
        Whole path and content of the prior's file; empty for the generated one.
    """

    until: Annotated[float, within(1e-6, 10)] = 0.05
    batch: int = Field(default=16, ge=1, le=6561)
    max_shots: int | None = Field(default=None, ge=8)
    hours: Annotated[float, within(1e-3, 1e5)] | None = None
    prior: str = ""
    prior_sha256: str = ""

    @classmethod
    def of(cls, said: dict[str, Any], prior: Path | None, before: Goal | None = None) -> Goal:
        """Make a goal of what was said, the rest as it was before, or by default.

        Raises
        ------
        gonio.errors.BadInputError
            Naming what is out of range.
        """
        data = (before or cls()).model_dump() | said
        if prior:
            data |= {"prior": str(prior.resolve()), "prior_sha256": sha256_file(prior)}
        return check(cls, data, Path("adaptive"), "correct the option of that name")

    @property
    def seconds(self) -> float:
        """Of the rig's time, in seconds; infinite where any will do."""
        return float("inf") if self.hours is None else _SECONDS_PER_HOUR * self.hours

    @property
    def prior_path(self) -> Path | None:
        """The prior's file; None for the generated one.

        Raises
        ------
        gonio.errors.ResumeRefusedError
            When it is not as it was: the rounds to come would not go on from those before.
        """
        if not self.prior:
            return None
        path = Path(self.prior)
        if not path.is_file() or sha256_file(path) != self.prior_sha256:
            raise ResumeRefusedError(
                f"{path}: is not the prior that the capture was begun with; put that back, or "
                "name one with --prior"
            )
        return path


def begin(journal: Journal, clock: Clock, goal: Goal) -> None:
    """Note that a capture goes for a goal from now on."""
    journal.append(clock, _BEGUN, **goal.model_dump(mode="json"))


def note_end(journal: Journal, clock: Clock, reason: str, shots: int, deviation: float) -> None:
    """Note that the goal, or a limit, was reached."""
    journal.append(clock, _ENDED, reason=reason, shots=shots, deviation=round(deviation, 6))


def goal_under_way(journal: Journal) -> Goal | None:
    """Return the goal that a capture goes for and has not reached; None where there is none."""
    goal = None
    for event in journal.events():
        if event.kind == _BEGUN:
            goal = check(Goal, event.data, journal.path, "measure anew into another folder")
        elif event.kind == _ENDED:
            goal = None
    return goal


def last_goal(journal: Journal) -> Goal | None:
    """Return the goal that was set last, reached or not."""
    events = list(journal.events(_BEGUN))
    remedy = "measure anew into another folder"
    return check(Goal, events[-1].data, journal.path, remedy) if events else None


def ending(journal: Journal) -> str | None:
    """Return what ended the last adaptive capture; None where there was none or it goes on."""
    told = None
    for event in journal.events():
        if event.kind in (_BEGUN, _ENDED):
            told = event.data.get("reason")
    return None if told is None else str(told)

"""What is asked of an adaptive capture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.adaptive import Goal
    from gonio.session import Session


@dataclass(frozen=True)
class Wish:
    """What is asked of it, or that it is none.

    Attributes
    ----------
    adaptive
        Whether it is one.
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
        from gonio.api.rounds import new_goal

        return new_goal(self.said, self.prior_path) if self.adaptive else None

    def going_on(self, session: Session) -> Goal | None:
        """Return the goal of a session that goes on: as before, but for what is asked for now."""
        from gonio.adaptive import Goal, goal_under_way, last_goal
        from gonio.api.rounds import readable

        if not session.journal_path.is_file():
            return self.goal()
        with session.journal() as journal:
            if not self.adaptive:
                return goal_under_way(journal)
            return Goal.of(self.said, readable(self.prior_path), last_goal(journal))

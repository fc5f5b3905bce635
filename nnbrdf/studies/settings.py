"""What a setting does to a ranking: several studies of the same rows, side by side."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from nnbrdf.studies.tables import kendall_tau, tabulate

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from nnbrdf.studies.job import Job, Outcome
    from nnbrdf.studies.tables import Table


@dataclass(frozen=True)
class Ranked:
    """One setting on one material.

    Attributes
    ----------
    errors, times
        Tables of eps8 and of seconds, with the same rows.
    halves
        Tables of eps8 of the even and of the odd seeds alone: two settings whose rankings agree
        no less than these two do not differ. None for a single seed.
    """

    errors: Table
    times: Table
    halves: tuple[Table, Table] | None

    def tau_to(self, other: Ranked) -> float | None:
        """Return Kendall's tau between the ranking of this setting and of another."""
        return agreement(other.errors, self.errors)

    @property
    def tau_between_seeds(self) -> float | None:
        """Kendall's tau between the rankings of the halves; None for a single seed."""
        return None if self.halves is None else agreement(*self.halves)


def rank_setting(outcomes: Sequence[Outcome], row_of: Callable[[Job], str]) -> Ranked:
    """Return the tables of one setting.

    Parameters
    ----------
    outcomes
        Of one material and one setting.
    row_of
        What names the row of a job.
    """
    errors, times = (tabulate(outcomes, metric, row_of)[0] for metric in ("eps8", "seconds"))
    even, odd = ([o for o in outcomes if o.job.seed % 2 == half] for half in (0, 1))
    halves = (
        (tabulate(even, "eps8", row_of)[0], tabulate(odd, "eps8", row_of)[0])
        if even and odd
        else None
    )
    return Ranked(errors, times, halves)


def agreement(first: Table, second: Table) -> float | None:
    """Return Kendall's tau between the ranks of two tables of the same rows."""
    ranks = {row.name: row.rank for row in second.rows}
    return kendall_tau([row.rank for row in first.rows], [ranks[row.name] for row in first.rows])

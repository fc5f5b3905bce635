"""Outcomes as the paper's tables: a row each, a column a network and subset, a mean, a rank."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from nnbrdf.studies.job import Job, Outcome

BIGGER_IS_BETTER = ("sphere_psnr_db",)


@dataclass(frozen=True)
class Row:
    """One line of a table.

    Attributes
    ----------
    name
        What was varied.
    cells
        Median over the seeds, a column each; None where half of them or more diverged.
    mean
        Of the cells; None where a cell is.
    rank
        1 is the best; rows with no mean come last and share the last rank.
    percent_from_best
        How far the mean is from the best one; None without a mean, and from a best of zero error.
    diverged
        How many trainings of all.
    """

    name: str
    cells: tuple[float | None, ...]
    mean: float | None
    rank: int
    percent_from_best: float | None
    diverged: int


@dataclass(frozen=True)
class Table:
    """A metric of one material.

    Attributes
    ----------
    material, metric
        Which.
    columns
        Their names.
    rows
        In the order they were first met.
    """

    material: str
    metric: str
    columns: tuple[str, ...]
    rows: tuple[Row, ...]


def column_of(job: Job) -> str:
    """Return the name of a job's column."""
    return f"{job.network} {job.subset}"


def tabulate(
    outcomes: Sequence[Outcome],
    metric: str,
    row_of: Callable[[Job], str],
    column_of: Callable[[Job], str] = column_of,
) -> list[Table]:
    """Return a table for each material.

    Parameters
    ----------
    outcomes
        Of one study.
    metric
        A field of `Outcome`: one of `nnbrdf.studies.job.METRICS`, or `seconds`.
    row_of, column_of
        What name the row and the column of a job.
    """
    groups: dict[str, list[Outcome]] = defaultdict(list)
    for outcome in outcomes:
        groups[outcome.job.material].append(outcome)
    names = (row_of, column_of)
    return [_table(material, group, metric, *names) for material, group in groups.items()]


def ranking(table: Table) -> list[str]:
    """Return the names of the rows, best first."""
    return [row.name for row in sorted(table.rows, key=lambda row: row.rank)]


def means_of(tables: Sequence[Table]) -> list[tuple[str, *tuple[float | None, ...]]]:
    """Return the means of several tables of the same rows: a name and a mean each, a line a row.

    Lines go by the rank in the first.
    """
    means = [{row.name: row.mean for row in table.rows} for table in tables]
    return [(name, *(each[name] for each in means)) for name in ranking(tables[0])]


def mean_ranks(tables: Sequence[Table]) -> dict[str, float]:
    """Return the mean rank of each row over several tables of the same rows."""
    ranks = [{row.name: row.rank for row in table.rows} for table in tables]
    return {name: sum(each[name] for each in ranks) / len(ranks) for name in ranks[0]}


def median_of(outcomes: Sequence[Outcome], metric: str) -> float:
    """Return the median; what diverged is worse than anything, and so is what was never trained.

    A training has no `sphere_psnr_db` where its picture is perfect: it is infinite. Of two in the
    middle that are not both finite, it is the worse.
    """
    worst = worst_of(metric)
    values = [worst if outcome.diverged else getattr(outcome, metric) for outcome in outcomes]
    known = sorted((math.inf if each is None else each for each in values), reverse=worst < 0.0)
    if not known:
        return worst
    better, worse = known[(len(known) - 1) // 2], known[len(known) // 2]
    # the mean of two infinities may be no number
    return (better + worse) / 2.0 if math.isfinite(better) and math.isfinite(worse) else worse


def known_of(value: float, metric: str) -> float | None:
    """Return a median as a table has it: None where half of the trainings or more diverged."""
    return None if value == worst_of(metric) else value


def worst_of(metric: str) -> float:
    """Return what nothing is worse than."""
    return -math.inf if metric in BIGGER_IS_BETTER else math.inf


def kendall_tau(first: Sequence[float], second: Sequence[float]) -> float | None:
    """Return how two rankings of the same things agree, from -1 to 1; None for less than two.

    Kendall's tau-b, which minds ties.
    """
    from scipy.stats import kendalltau

    if len(first) < 2:
        return None
    tau = float(kendalltau(first, second).statistic)
    return tau if math.isfinite(tau) else None


def _table(
    material: str,
    outcomes: Sequence[Outcome],
    metric: str,
    row_of: Callable[[Job], str],
    column_of: Callable[[Job], str],
) -> Table:
    cells: dict[str, dict[str, list[Outcome]]] = defaultdict(lambda: defaultdict(list))
    for outcome in outcomes:
        cells[row_of(outcome.job)][column_of(outcome.job)].append(outcome)
    columns = tuple(dict.fromkeys(column for row in cells.values() for column in row))
    medians = {
        name: tuple(known_of(median_of(row[column], metric), metric) for column in columns)
        for name, row in cells.items()
    }
    means = {name: _mean(values) for name, values in medians.items()}
    sign = -1.0 if metric in BIGGER_IS_BETTER else 1.0
    order = sorted(sign * mean for mean in means.values() if mean is not None)
    rows = [
        Row(
            name,
            medians[name],
            mean,
            len(order) + 1 if mean is None else 1 + order.index(sign * mean),
            _percent(mean, sign * order[0]) if mean is not None else None,
            sum(outcome.diverged for cell in cells[name].values() for outcome in cell),
        )
        for name, mean in means.items()
    ]
    return Table(material, metric, columns, tuple(rows))


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return sum(known) / len(known) if known and len(known) == len(values) else None


def _percent(mean: float, best: float) -> float | None:
    if mean == best:
        return 0.0
    return 100.0 * abs(mean - best) / abs(best) if best and math.isfinite(best) else None

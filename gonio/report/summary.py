"""How good a model is, in numbers: against the truth where it is known, and at the samples."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import paper_directions

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray
    from rich.table import Table

    from gonio.materials import MeasuredTable
    from gonio.samples import Samples
    from nnbrdf.load import Model
    from nnbrdf.model import NNBRDF

NOT_KNOWN = "not known: a rig has no truth"
GRID_PAIRS = len(paper_directions()) ** 2
# an axis stands within hundredths of a degree of where it was sent
_SAME = np.radians(0.1)


@dataclass(frozen=True)
class Row:
    """One comparison, in both metrics (see `nnbrdf.metrics`)."""

    name: str
    eps8: float
    male: float


@dataclass(frozen=True)
class Summary:
    """The errors of a model and what they were paid with.

    Attributes
    ----------
    against_truth
        First the error that is quoted: of the model, or the median of the members where there are
        several, then the delivered one's; then channel by channel. Empty where the truth is not
        known.
    residual
        Of the model at the samples, with the samples' white.
    coverage
        Share of the true values between the 5 and 95 % quantiles; None where not known.
    weights
        How many numbers the model is made of.
    shots
        Number of samples.
    pairs
        Number of different pairs of light and view among them; an exchanged pair is another one,
        as in the full set.
    """

    against_truth: tuple[Row, ...]
    residual: Row
    coverage: float | None
    weights: int
    shots: int
    pairs: int

    @property
    def error(self) -> Row | None:
        """The error that is quoted, where the truth is known."""
        return self.against_truth[0] if self.against_truth else None

    @property
    def share(self) -> float:
        """Number of different pairs over the 6561 of the full set."""
        return self.pairs / GRID_PAIRS

    def rows(self) -> list[tuple[str, str, str]]:
        """Return name, eps8 and male as a person reads them, for terminal and page."""
        rows = [(row.name, f"{row.eps8:.2f}", f"{row.male:.3f}") for row in self.against_truth]
        residual = (self.residual.name, f"{self.residual.eps8:.2f}", f"{self.residual.male:.3f}")
        return [*(rows or [("error", NOT_KNOWN, "")]), residual]

    def facts(self) -> list[tuple[str, str]]:
        """Return what else is to be known, for terminal and page."""
        coverage = NOT_KNOWN if self.coverage is None else f"{100 * self.coverage:.0f} %"
        return [
            ("truth within 5 to 95 %", coverage),
            ("shots", str(self.shots)),
            ("share measured", f"{100 * self.share:.3g} % of {GRID_PAIRS} pairs"),
            ("weights", str(self.weights)),
        ]

    def table(self) -> Table:
        """Return the table for the terminal."""
        from rich.table import Table

        table = Table(box=None, pad_edge=False)
        for name in ("", "eps8", "male"):
            table.add_column(name)
        for row in self.rows():
            table.add_row(*row)
        table.add_row()
        for fact in self.facts():
            table.add_row(*fact)
        return table


def summarize(model: Path, samples: Samples, truth: MeasuredTable | None) -> Summary:
    """Compare a model with its samples, and with the truth where there is one.

    Parameters
    ----------
    model
        The model's folder.
    samples
        What it was made from.
    truth
        The material on the 81 x 81 grid; None on a rig.

    Raises
    ------
    gonio.errors.BadFileError
        When the model cannot be read.
    """
    from nnbrdf.load import load_model

    estimate = load_model(model)
    against, coverage = ((), None) if truth is None else _against_truth(estimate, truth)
    return Summary(
        against_truth=against,
        residual=_residual(estimate, samples),
        coverage=coverage,
        weights=estimate.card.weights,
        shots=len(samples),
        pairs=_different_pairs(samples),
    )


def _different_pairs(samples: Samples) -> int:
    """Count the pairs of directions, those once that are within 0.1 deg of one before."""
    from scipy.spatial import KDTree

    # without the exact repeats first, which would be too many for the tree
    pairs = np.unique(np.hstack([samples.light, samples.view]), axis=0)
    near = KDTree(pairs).query_pairs(_SAME, output_type="ndarray")
    return len(pairs) - len(np.unique(near[:, 1]))


def _against_truth(estimate: Model, true: MeasuredTable) -> tuple[tuple[Row, ...], float]:
    """Return the errors, the quoted one first, and the share of the truth within the bands."""
    # once: of some models it takes seconds
    grid = estimate.grid()
    coverage = float(np.mean((grid["lo"] <= true.values) & (true.values <= grid["hi"])))
    rows = _rows(grid["values"].astype(np.float64), true)
    return (_quoted(estimate, rows, true), coverage)


def _rows(values: NDArray[np.float64], true: MeasuredTable) -> tuple[Row, ...]:
    from nnbrdf.metrics import eps8, eps8_per_channel, male, male_per_channel

    pair = (true.values, true.white)
    channels = zip(
        "rgb", eps8_per_channel(values, *pair), male_per_channel(values, *pair), strict=True
    )
    rows = (Row(f"  channel {name}", float(e), float(m)) for name, e, m in channels)
    return (Row("error", eps8(values, *pair), male(values, *pair)), *rows)


def _quoted(estimate: Model, rows: tuple[Row, ...], true: MeasuredTable) -> tuple[Row, ...]:
    """Put the median of the members first, where there are several."""
    from nnbrdf.metrics import eps8, male
    from nnbrdf.model import NNBRDF

    if not isinstance(estimate, NNBRDF):
        return rows
    pair, members = (true.values, true.white), member_grids(estimate)
    median = Row(
        f"error (median of {len(members)} networks)",
        float(np.median([eps8(member, *pair) for member in members])),
        float(np.median([male(member, *pair) for member in members])),
    )
    return (median, replace(rows[0], name="delivered network"), *rows[1:])


def _residual(estimate: Model, samples: Samples) -> Row:
    from nnbrdf.metrics import eps8, male

    # noise may be below zero, where male has no logarithm
    measured = samples.value.clip(0.0)
    told = at_samples(estimate, samples)
    name = "residual at the samples"
    return Row(name, eps8(told, measured, samples.white), male(told, measured, samples.white))


def member_grids(estimate: NNBRDF) -> NDArray[np.float64]:
    """Return what each network says on the 81 x 81 grid, 1/sr, shape (members, 81, 81, 3)."""
    from nnbrdf.ensemble import Ensemble, grid_pairs

    light, view = grid_pairs()
    ensemble = Ensemble(estimate.networks, estimate.card.encoding, estimate.card.white)
    values = ensemble.predict(light.reshape(-1, 3), view.reshape(-1, 3)).clip(0.0)
    return values.reshape(-1, *light.shape)


def at_samples(estimate: Model, samples: Samples) -> NDArray[np.float64]:
    """Return what the model says at the samples, 1/sr, shape (n, channels)."""
    # a single channel is repeated by the model, and one of the three is enough
    return estimate.evaluate(samples.light, samples.view)[:, : len(samples.channels)]

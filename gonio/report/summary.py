"""How good a model is, in numbers: against the truth where it is known, and at the samples."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.directions import paper_directions
from nnbrdf.metrics import Errors, eps8_per_channel, errors_of, male_per_channel

if TYPE_CHECKING:
    from collections.abc import Mapping
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
class Against:
    """Errors against the truth.

    Attributes
    ----------
    quoted
        Of the model, or the median of its members where there are several.
    delivered
        Of the model.
    channels
        Of the model, channel by channel.
    members
        How many networks, one of which is the model.
    """

    quoted: Errors
    delivered: Errors
    channels: Mapping[str, Errors]
    members: int = 1

    def rows(self) -> list[tuple[str, Errors]]:
        """Return them as a person reads them, the quoted one first."""
        channels = [(f"  channel {name}", errors) for name, errors in self.channels.items()]
        if self.members == 1:
            return [("error", self.quoted), *channels]
        median = f"error (median of {self.members} networks)"
        return [(median, self.quoted), ("delivered network", self.delivered), *channels]


@dataclass(frozen=True)
class Summary:
    """The errors of a model and what they were paid with.

    Attributes
    ----------
    against_truth
        None where the truth is not known.
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

    against_truth: Against | None
    residual: Errors
    coverage: float | None
    weights: int
    shots: int
    pairs: int

    @property
    def error(self) -> Errors | None:
        """The error that is quoted, where the truth is known."""
        return None if self.against_truth is None else self.against_truth.quoted

    @property
    def share(self) -> float:
        """Number of different pairs over the 6561 of the full set."""
        return self.pairs / GRID_PAIRS

    def document(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        told = self.against_truth
        return {
            "error": told and told.quoted._asdict(),
            "members": told and told.members,
            "delivered": told and told.delivered._asdict(),
            "channels": told and {name: each._asdict() for name, each in told.channels.items()},
            "residual": self.residual._asdict(),
            "coverage": self.coverage,
            "weights": self.weights,
            "shots": self.shots,
            "pairs": self.pairs,
            "share": self.share,
        }

    def rows(self) -> list[tuple[str, str, str]]:
        """Return name, eps8 and male as a person reads them, for terminal and page."""
        against = self.against_truth.rows() if self.against_truth else []
        told = [*against, ("residual at the samples", self.residual)]
        rows = [(name, f"{errors.eps8:.2f}", f"{errors.male:.3f}") for name, errors in told]
        return rows if against else [("error", NOT_KNOWN, ""), *rows]

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
    against, coverage = (None, None) if truth is None else _against_truth(estimate, truth)
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


def _against_truth(estimate: Model, true: MeasuredTable) -> tuple[Against, float]:
    """Return the errors, and the share of the truth within the bands."""
    # once: of some models it takes seconds
    grid = estimate.grid()
    coverage = float(np.mean((grid["lo"] <= true.values) & (true.values <= grid["hi"])))
    values, pair = grid["values"].astype(np.float64), (true.values, true.white)
    each = zip(eps8_per_channel(values, *pair), male_per_channel(values, *pair), strict=True)
    channels = {name: Errors(float(e), float(m)) for name, (e, m) in zip("rgb", each, strict=True)}
    delivered = errors_of(values, *pair)
    members = _member_errors(estimate, true)
    if not members:
        return (Against(delivered, delivered, channels), coverage)
    median = Errors(*(float(each) for each in np.median(members, axis=0)))
    return (Against(median, delivered, channels, len(members)), coverage)


def _member_errors(estimate: Model, true: MeasuredTable) -> list[Errors]:
    """Return the errors of each network, where there are several to choose from."""
    from nnbrdf.model import NNBRDF

    if not isinstance(estimate, NNBRDF):
        return []
    return [errors_of(member, true.values, true.white) for member in member_grids(estimate)]


def _residual(estimate: Model, samples: Samples) -> Errors:
    # noise may be below zero, where male has no logarithm
    return errors_of(at_samples(estimate, samples), samples.value.clip(0.0), samples.white)


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

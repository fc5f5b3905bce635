"""The estimator `paper`: networks trained as Mikes and Haindl (2023) did."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadInputError
from nnbrdf.activations import activation_named
from nnbrdf.card import Card
from nnbrdf.encoding import ENCODINGS, INPUTS, encoding_named
from nnbrdf.history import History
from nnbrdf.model import NNBRDF
from nnbrdf.network import glorot_uniform, weight_count
from nnbrdf.training import default_trainer, epoch_steps, train
from nnbrdf.usable import check_samples

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.protocols import Progress
    from gonio.samples import Samples
    from nnbrdf.history import Checkpoint

_LEAST_MEMBERS = 2


@dataclass
class PaperEstimator:
    """The NN-BRDF of Mikes and Haindl (2023), several times over to tell its spread.

    Networks trained on min(value / white, 1), where white is 4 x the samples' median. Samples
    flagged as clipped are kept: they are lower bounds, and mostly above white, where targets end
    anyway. Sigmas of the samples are not used. Members whose gradient overflows are left out.

    Attributes
    ----------
    hidden
        Outputs of the hidden layers: (15, 30, 20) has 1268 weights, (3, 6, 4) has 88.
    epochs, steps
        How long to train; `steps`, batches of 32, goes before `epochs` where it is given.
    seed
        Of the starts and of the orders of the samples.
    members
        How many networks; sigma has one degree of freedom less.
    activation, encoding
        Names of `nnbrdf.activations.ACTIVATIONS` and `nnbrdf.encoding.ENCODINGS`; by default the
        paper's, SoftSign on the unit vectors of view and light.
    trainer
        A name of `nnbrdf.training.TRAINERS`; by default the quickest there is.
    """

    hidden: tuple[int, ...] = (15, 30, 20)
    epochs: int = 500
    steps: int | None = None
    seed: int = 0
    members: int = 5
    activation: str = "softsign"
    encoding: str = "xyz"
    trainer: str | None = None
    name: str = field(default="paper", init=False)

    def __post_init__(self) -> None:
        least = {"epochs": 1, "steps": 1, "seed": 0, "members": _LEAST_MEMBERS}
        for name, minimum in least.items():
            value = getattr(self, name)
            if value is not None and value < minimum:
                raise BadInputError(f"{name} is {value}; give at least {minimum}")
        if min(self.hidden, default=1) < 1:
            raise BadInputError(f"hidden is {self.hidden}; give each layer at least 1 output")
        activation_named(self.activation)
        encoding_named(self.encoding)

    def fit(self, samples: Samples, progress: Progress | None = None) -> NNBRDF:
        """Train the members and deliver the one with the median final loss.

        Raises
        ------
        gonio.errors.BadInputError
            For fewer than 8 samples, values that are not finite, a negative sigma, a number of
            channels other than one or three, or when the gradients of all members but one, or of
            all, overflow.
        gonio.errors.MissingExtraError
            Where the kernel was not compiled and torch is not installed.
        """
        check_samples(samples, self.name)
        history = self._train(samples, progress)
        end = history.checkpoints[-1]
        return NNBRDF(self._card(samples, end), end.networks, history)

    def _train(self, samples: Samples, progress: Progress | None) -> History:
        steps = self.steps or self.epochs * epoch_steps(len(samples))
        sequence = np.random.SeedSequence(self.seed)
        generators = [np.random.default_rng(each) for each in sequence.spawn(self.members)]
        start = glorot_uniform(self._sizes(samples), generators, activation=self.activation)
        seeds = [int(each.integers(2**63)) for each in generators]
        inputs = ENCODINGS[self.encoding](samples.light, samples.view)
        checkpoints = train(start, inputs, _targets(samples), steps, seeds, progress, self.trainer)
        kept = np.flatnonzero(~checkpoints[-1].diverged).tolist()
        if len(kept) < _LEAST_MEMBERS:
            raise BadInputError(
                f"the gradients of {self.members - len(kept)} of {self.members} networks with "
                f"activation {self.activation} overflowed; use another activation"
            )
        return History(
            tuple(point.select(kept) for point in checkpoints), self.encoding, samples.white
        )

    def _sizes(self, samples: Samples) -> tuple[int, ...]:
        return (INPUTS[self.encoding], *self.hidden, len(samples.channels))

    def _card(self, samples: Samples, end: Checkpoint) -> Card:
        return Card(
            estimator=self.name,
            encoding=self.encoding,
            layers=self._sizes(samples),
            activation=self.activation,
            white=samples.white,
            delivered=_median_index(end.loss),
            final_losses=tuple(end.loss.tolist()),
            channels=samples.channels,
            color_space=samples.color_space,
            weights=weight_count(self._sizes(samples)),
            samples=len(samples),
            steps=end.step,
            seed=self.seed,
            trainer=self.trainer or default_trainer(),
            diverged=self.members - end.networks.members,
            provenance=samples.provenance,
        )


def _targets(samples: Samples) -> NDArray[np.float64]:
    # noise below zero is cut off, which the mean absolute error, a median at heart, does not mind
    return np.clip(samples.value / samples.white, 0.0, 1.0)


def _median_index(loss: NDArray[np.float64]) -> int:
    """Return which is the median; of an even number, the lower of the two."""
    return int(np.argsort(loss, kind="stable")[(len(loss) - 1) // 2])

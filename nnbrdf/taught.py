"""An NN-BRDF taught by the posterior: two small networks, one for the value, one for its spread."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, Literal

import numpy as np
from pydantic import Field, model_validator

from gonio.files import write_json
from gonio.validation import Document
from nnbrdf.activations import ACTIVATIONS
from nnbrdf.card import CARD_NAME, read_document
from nnbrdf.ensemble import GRID_CHANNELS
from nnbrdf.evaluate import evaluate, is_available
from nnbrdf.findings import Findings
from nnbrdf.folder import grid_of, in_chunks, save_model, write_grid
from nnbrdf.halfway import HALFWAY, HALFWAY_INPUTS
from nnbrdf.network import Networks, weight_count
from nnbrdf.prior.learned import LearnedMaterial
from nnbrdf.prior.lognormal import LogNormal
from nnbrdf.prior.used import PriorUsed
from nnbrdf.weights import read_tensors, shapes_of, write_tensors

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

SCHEMA: Final = "gonio.taught/1"
Count = Annotated[int, Field(ge=1)]


class TaughtCard(Document):
    """`model.json` of a taught network.

    Attributes
    ----------
    encoding
        A name of `nnbrdf.halfway.HALFWAY`.
    layers, spread_layers
        Number of inputs, of each hidden layer's outputs, and of outputs: logarithms of the
        channels (or of the one of which they are multiples), and of their deviation.
    activation
        Of the hidden layers.
    scale
        The first network says ln(value / scale + 0.01), per tint; in 1/sr.
    white
        4 x the median of the samples, in 1/sr.
    tint
        What each channel multiplies its output with.
    weights
        Number of weights and biases of the first network.
    teaching_error, unknown
        Mean absolute difference of network and posterior in the logarithm, over what was taught;
        and the posterior's mean deviation there.
    left_small
        Whether it has fewer weights than the default since these say as much.
    samples, steps, seed
        How many samples, how many batches, which seed.
    trainer
        Which of `nnbrdf.training.TRAINERS` made it.
    prior
        Under which prior it was taught; None in models made before it was recorded.
    findings
        What the samples told.
    provenance
        SHA-256 hashes of what the samples were made from, by name.
    """

    schema_: Literal["gonio.taught/1"] = Field(default=SCHEMA, alias="schema")
    estimator: str
    encoding: str
    layers: tuple[Count, ...] = Field(min_length=2)
    spread_layers: tuple[Count, ...] = Field(min_length=2)
    activation: str
    scale: float = Field(gt=0)
    white: float = Field(gt=0)
    tint: tuple[Annotated[float, Field(gt=0)], ...]
    channels: tuple[str, ...]
    color_space: str
    weights: Count
    teaching_error: float = Field(ge=0)
    unknown: float = Field(ge=0)
    left_small: bool
    samples: Count
    steps: Count
    seed: int = Field(ge=0)
    trainer: str
    prior: PriorUsed | None = None
    findings: Findings
    provenance: dict[str, str]

    @model_validator(mode="after")
    def _fits_together(self) -> TaughtCard:
        if self.encoding not in HALFWAY:
            raise ValueError(f"encoding: must be one of {', '.join(HALFWAY)}")
        if self.activation not in ACTIVATIONS:
            raise ValueError(f"activation: must be one of {', '.join(ACTIVATIONS)}")
        if {self.layers[0], self.spread_layers[0]} != {HALFWAY_INPUTS[self.encoding]}:
            raise ValueError("layers: do not begin with the inputs")
        if self.layers[-1] not in (1, len(self.channels)) or self.spread_layers[-1] != 1:
            raise ValueError("layers: do not end with one output or one a channel")
        if len(self.channels) not in (1, 3) or len(self.tint) != len(self.channels):
            raise ValueError("channels: must be one or three, with a tint each")
        if self.weights != weight_count(self.layers):
            raise ValueError(f"weights: layers make {weight_count(self.layers)}")
        return self

    def sentences(self) -> list[str]:
        """Say how the model was made, as a person reads it."""
        shape = "-".join(map(str, self.layers))
        result = [
            f"network {shape}, {self.weights} weights ({self.activation}, {self.encoding} "
            f"half-vector inputs), {self.steps} steps from seed {self.seed}; it misses the "
            f"posterior by {self.teaching_error:.3f} in the logarithm, which leaves "
            f"{self.unknown:.3f} unknown",
        ]
        if self.prior:
            result.append(f"the posterior is under {self.prior}")
        if self.left_small:
            result.append(
                "so few weights, since they miss the posterior by a quarter or less of what it "
                "leaves unknown, or by one per cent or less"
            )
        return result + self.findings.sentences()


@dataclass(frozen=True)
class TaughtBRDF:
    """A material as small networks; closed form, quick, reciprocal unless samples contradict it.

    Attributes
    ----------
    card
        What `model.json` says.
    value, spread
        Stacks of one network each.
    """

    card: TaughtCard
    value: Networks
    spread: Networks

    def evaluate(self, light: Array, view: Array) -> Array:
        """Return the posterior median in 1/sr, never below zero, shape (..., 3).

        Light and view are unit vectors, shapes (..., 3), broadcast against each other. A single
        channel is repeated three times. Compiled where it can be: see `nnbrdf.evaluate`.
        """
        if is_available():
            light, view = np.asarray(light, float), np.asarray(view, float)
            card = self.card
            return evaluate(self.value, card.encoding, light, view, card.scale, tuple(self._tint))
        return in_chunks(lambda *pairs: self._told(*pairs).median * self._tint, light, view)

    def sigma(self, light: Array, view: Array) -> Array:
        """Return one standard uncertainty in 1/sr, shape (..., 3)."""
        return in_chunks(lambda *pairs: self._told(*pairs).sigma * self._tint, light, view)

    def quantiles(self, light: Array, view: Array) -> tuple[Array, Array]:
        """Return the 5 and 95 % quantiles in 1/sr, shape (..., 3) each."""
        low = in_chunks(lambda *pairs: self._told(*pairs).quantiles[0] * self._tint, light, view)
        high = in_chunks(lambda *pairs: self._told(*pairs).quantiles[1] * self._tint, light, view)
        return low, high

    def as_example(self) -> LearnedMaterial:
        """Return the material as an example for the prior."""
        outputs = self.card.layers[-1]
        tint = np.asarray(self.card.tint) if outputs > 1 else np.array([np.mean(self.card.tint)])
        return LearnedMaterial(self.value, self.card.encoding, tint)

    def grid(self) -> dict[str, NDArray[np.float32]]:
        """Return `values`, `sigma`, `lo` and `hi` on the 81 x 81 grid, shape (81, 81, 3) each."""
        return grid_of(self)

    def save(self, folder: Path | str) -> None:
        """Write `weights.safetensors`, `model.json` and `grid.npz` (see `nnbrdf.folder`)."""
        save_model(folder, self._write)

    @classmethod
    def load(cls, folder: Path | str) -> TaughtBRDF:
        """Read a model; nothing in it is ever executed.

        Raises
        ------
        gonio.errors.BadFileError
            When a file is missing, broken, of another version, or does not fit the others.
        """
        folder = Path(folder)
        card = read_document(TaughtCard, SCHEMA, folder)
        tensors = read_tensors(
            folder, shapes_of(card.layers, 1) | shapes_of(card.spread_layers, 1, _SPREAD)
        )
        value, spread = (
            Networks(
                tuple(tensors[f"{prefix}layer_{index}"] for index in range(len(layers) - 1)),
                card.activation,
            )
            for prefix, layers in (("", card.layers), (_SPREAD, card.spread_layers))
        )
        return cls(card, value, spread)

    @property
    def _tint(self) -> Array:
        return np.broadcast_to(self.card.tint, GRID_CHANNELS)

    def _told(self, light: Array, view: Array) -> LogNormal:
        inputs = HALFWAY[self.card.encoding](light, view)
        mean = self.value.forward(inputs)[0]
        deviation = np.exp(self.spread.forward(inputs)[0])
        shape = (len(inputs), GRID_CHANNELS)
        return LogNormal(
            np.broadcast_to(mean, shape), np.broadcast_to(deviation, shape), self.card.scale
        )

    def _write(self, folder: Path) -> None:
        tensors = {f"layer_{index}": layer for index, layer in enumerate(self.value.layers)}
        tensors |= {f"{_SPREAD}layer_{i}": layer for i, layer in enumerate(self.spread.layers)}
        write_tensors(folder, tensors)
        write_grid(folder, self.grid())
        write_json(folder / CARD_NAME, self.card.model_dump(mode="json", by_alias=True))


_SPREAD = "spread_"

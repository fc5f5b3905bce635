"""`model.json`: what a model is, and what it was made from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Final, Literal, TypeVar

from pydantic import Field, model_validator

from gonio.errors import BadFileError
from gonio.validation import Document, check, parse_json, read_text
from nnbrdf.activations import ACTIVATIONS
from nnbrdf.encoding import INPUTS
from nnbrdf.network import weight_count

if TYPE_CHECKING:
    from pathlib import Path

SCHEMA: Final = "gonio.model/1"
CARD_NAME = "model.json"
REMEDY = "make the model again with: gonio reconstruct"

Count = Annotated[int, Field(ge=1)]
D = TypeVar("D", bound=Document)


class Card(Document):
    """The model beside its weights.

    Attributes
    ----------
    layers
        Number of inputs, of each hidden layer's outputs, and of channels.
    white
        What the networks' output 1 means, in 1/sr.
    delivered
        Index of the member whose values count: the one with the median final loss.
    final_losses
        Mean absolute error of each member over the samples, in units of white.
    channels
        Of the samples; a single one is repeated three times in `grid.npz`.
    weights
        Number of weights and biases of one member.
    samples, steps, seed
        How many samples, how many batches, and which seed it was trained with.
    trainer
        Which of `nnbrdf.training.TRAINERS` made it: the same seed gives each other numbers.
    diverged
        How many members more there were, whose gradient overflowed.
    provenance
        SHA-256 hashes of what the samples were made from, by name.
    """

    schema_: Literal["gonio.model/1"] = Field(default=SCHEMA, alias="schema")
    estimator: str
    encoding: str
    layers: tuple[Count, ...] = Field(min_length=2)
    activation: str
    white: float = Field(gt=0)
    delivered: int = Field(ge=0)
    final_losses: tuple[Annotated[float, Field(ge=0)], ...] = Field(min_length=2)
    channels: tuple[str, ...]
    color_space: str
    weights: Count
    samples: Count
    steps: Count
    seed: int = Field(ge=0)
    trainer: str
    diverged: int = Field(ge=0)
    provenance: dict[str, str]

    @model_validator(mode="after")
    def _fits_together(self) -> Card:
        if self.encoding not in INPUTS:
            raise ValueError(f"encoding: must be one of {', '.join(INPUTS)}")
        if self.activation not in ACTIVATIONS:
            raise ValueError(f"activation: must be one of {', '.join(ACTIVATIONS)}")
        if self.layers[0] != INPUTS[self.encoding] or self.layers[-1] != len(self.channels):
            raise ValueError("layers: does not begin with the inputs and end with the channels")
        if len(self.channels) not in (1, 3):
            raise ValueError(f"channels: must be one or three, not {len(self.channels)}")
        if self.delivered >= len(self.final_losses):
            raise ValueError("delivered: there is no such member")
        if self.weights != weight_count(self.layers):
            raise ValueError(f"weights: layers make {weight_count(self.layers)}")
        return self

    def sentences(self) -> list[str]:
        """Say how the model was made, as a person reads it."""
        return [
            f"{len(self.final_losses)} networks {'-'.join(map(str, self.layers))} "
            f"({self.activation}, {self.encoding} angles), {self.steps} steps from seed "
            f"{self.seed}; delivered is number {self.delivered}, the one with the median final loss"
        ]


def read_card(folder: Path) -> Card:
    """Read and check `model.json` of the folder of a model of the paper's kind.

    Raises
    ------
    gonio.errors.BadFileError
        When it is missing, malformed or of another version.
    """
    return read_document(Card, SCHEMA, folder)


def read_document(kind: type[D], schema: str, folder: Path) -> D:
    """Read and check `model.json` of a model's folder as the card of one kind of model.

    Raises
    ------
    gonio.errors.BadFileError
        When it is missing, malformed or of another schema.
    """
    path = folder / CARD_NAME
    data = read_json(folder)
    found = data.get("schema") if isinstance(data, dict) else None
    if found != schema:
        raise BadFileError(path, f"has schema {found!r}, not {schema!r}", REMEDY)
    return check(kind, data, path, REMEDY)


def read_json(folder: Path) -> object:
    """Return what `model.json` of a folder holds.

    Raises
    ------
    gonio.errors.BadFileError
        When it is missing or no JSON.
    """
    path = folder / CARD_NAME
    if not path.is_file():
        raise BadFileError(folder, f"is not a model (it has no {CARD_NAME})", REMEDY)
    return parse_json(read_text(path, REMEDY), path, REMEDY)

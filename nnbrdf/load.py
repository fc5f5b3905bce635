"""Reading a model's folder, whatever kind of model is in it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from gonio.errors import BadFileError
from gonio.protocols import Estimate
from nnbrdf import card, taught
from nnbrdf.card import CARD_NAME, REMEDY, read_json
from nnbrdf.model import NNBRDF
from nnbrdf.taught import TaughtBRDF

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class ModelCard(Protocol):
    """What the card of every kind of model says."""

    @property
    def estimator(self) -> str:
        """Name of the estimator."""

    @property
    def white(self) -> float:
        """4 x the median of the samples, in 1/sr."""

    @property
    def weights(self) -> int:
        """How many numbers the model is made of."""

    @property
    def channels(self) -> tuple[str, ...]:
        """Of the samples."""

    @property
    def color_space(self) -> str:
        """Of the samples, as files state it."""

    def sentences(self) -> list[str]:
        """Say how the model was made, as a person reads it."""


class Model(Estimate, Protocol):
    """An estimate with its card and its values on the 81 x 81 grid."""

    @property
    def card(self) -> ModelCard:
        """What `model.json` says."""

    def grid(self) -> dict[str, NDArray[np.float32]]:
        """Return `values`, `sigma`, `lo` and `hi`, shape (81, 81, 3) each."""


def load_model(folder: Path | str) -> Model:
    """Read a model; nothing in it is ever executed.

    Raises
    ------
    gonio.errors.BadFileError
        When a file is missing, broken, of another version, or does not fit the others.
    """
    folder = Path(folder)
    data = read_json(folder)
    schema = data.get("schema") if isinstance(data, dict) else None
    if schema == card.SCHEMA:
        return NNBRDF.load(folder)
    if schema == taught.SCHEMA:
        return TaughtBRDF.load(folder)
    return _rare(folder, schema)


def _rare(folder: Path, schema: object) -> Model:
    # scipy and sixteen models are nothing that the common kinds should wait for
    from nnbrdf import analytic_model, posterior_model

    if schema == posterior_model.SCHEMA:
        return posterior_model.PosteriorBRDF.load(folder)
    if schema == analytic_model.SCHEMA:
        return analytic_model.FittedBRDF.load(folder)
    known = (card.SCHEMA, taught.SCHEMA, posterior_model.SCHEMA, analytic_model.SCHEMA)
    raise BadFileError(
        folder / CARD_NAME, f"has schema {schema!r}, not one of {', '.join(known)}", REMEDY
    )

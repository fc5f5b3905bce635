"""The estimator `prior`: the posterior itself as a model."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, Literal

import numpy as np
from pydantic import Field, model_validator

from gonio.errors import BadFileError
from gonio.files import write_json
from gonio.validation import Document
from nnbrdf.card import CARD_NAME, REMEDY, read_document
from nnbrdf.ensemble import GRID_CHANNELS, grid_pairs
from nnbrdf.findings import Findings, findings_of
from nnbrdf.folder import PRIOR_NAME, save_model, write_grid
from nnbrdf.prior.family import Settings
from nnbrdf.prior.geometry import Pairs
from nnbrdf.prior.infer import Inference, infer
from nnbrdf.prior.material_prior import MaterialPrior
from nnbrdf.prior.posterior import Odds, Posterior, Sites
from nnbrdf.prior.used import PriorUsed
from nnbrdf.usable import check_samples
from nnbrdf.weights import read_tensors, write_tensors

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.protocols import Progress
    from gonio.samples import Samples
    from nnbrdf.prior.lognormal import LogNormal

    Array = NDArray[np.float64]

SCHEMA: Final = "gonio.posterior/1"
Count = Annotated[int, Field(ge=1)]
Positive = Annotated[float, Field(gt=0)]


class ComponentCard(Document):
    """One Gaussian process of the mixture: its family, settings, and share."""

    family: Literal["isotropic", "anisotropic"]
    smooth: float = Field(ge=0)
    stretch: Positive
    exchange: float = Field(ge=0)
    noise: float = Field(ge=0)
    share: float = Field(ge=0, le=1)


class PosteriorCard(Document):
    """`model.json` of a posterior.

    Attributes
    ----------
    scale
        The process is ln(value / scale + 0.01), in 1/sr.
    white
        4 x the median of the samples, in 1/sr.
    components
        The mixture, the likeliest first.
    weights
        How many numbers a value is made of: one a sample and channel.
    samples
        How many there were.
    prior
        Under which prior; None in models that were made before it was recorded.
    findings
        What the samples told.
    provenance
        SHA-256 hashes of what the samples were made from, by name.
    """

    schema_: Literal["gonio.posterior/1"] = Field(default=SCHEMA, alias="schema")
    estimator: str
    scale: Positive
    white: Positive
    components: tuple[ComponentCard, ...] = Field(min_length=1)
    channels: tuple[str, ...]
    color_space: str
    weights: Count
    samples: Count
    prior: PriorUsed | None = None
    findings: Findings
    provenance: dict[str, str]

    @model_validator(mode="after")
    def _fits_together(self) -> PosteriorCard:
        if len(self.channels) not in (1, 3):
            raise ValueError(f"channels: must be one or three, not {len(self.channels)}")
        return self

    def sentences(self) -> list[str]:
        """Say how the model was made, as a person reads it."""
        count = len(self.components)
        return [
            f"posterior of {self.samples} samples under {self.prior or 'an unrecorded prior'}, "
            f"{count} setting{'s' * (count > 1)} of the prior by evidence",
            *self.findings.sentences(),
        ]


@dataclass(frozen=True)
class PosteriorBRDF:
    """A material as the posterior of its samples: exact, and slow to evaluate.

    Attributes
    ----------
    card
        What `model.json` says.
    inference
        The posterior, and what it was conditioned on.
    prior, light, view
        The prior, and where the samples were taken, shape (n, 3) each.
    """

    card: PosteriorCard
    inference: Inference
    prior: MaterialPrior
    light: Array
    view: Array

    def evaluate(self, light: Array, view: Array) -> Array:
        """Return the posterior median in 1/sr, never below zero, shape (..., 3).

        Light and view are unit vectors, shapes (..., 3), broadcast against each other. A single
        channel is repeated three times.
        """
        return _shaped(self._told(light, view).median, light, view)

    def sigma(self, light: Array, view: Array) -> Array:
        """Return one standard uncertainty in 1/sr, shape (..., 3)."""
        return _shaped(self._told(light, view).sigma, light, view)

    def quantiles(self, light: Array, view: Array) -> tuple[Array, Array]:
        """Return the 5 and 95 % quantiles in 1/sr, shape (..., 3) each."""
        low, high = self._told(light, view).quantiles
        return _shaped(low, light, view), _shaped(high, light, view)

    def grid(self) -> dict[str, NDArray[np.float32]]:
        """Return `values`, `sigma`, `lo` and `hi` on the 81 x 81 grid, shape (81, 81, 3) each."""
        light, view = grid_pairs()
        told = self._told(light, view)
        low, high = told.quantiles
        arrays = {"values": told.median, "sigma": told.sigma, "lo": low, "hi": high}
        return {
            name: _shaped(array, light, view).astype(np.float32) for name, array in arrays.items()
        }

    def save(self, folder: Path | str) -> None:
        """Write `weights.safetensors`, `model.json`, `prior.npz` and `grid.npz`."""
        save_model(folder, self._write)

    @classmethod
    def load(cls, folder: Path | str) -> PosteriorBRDF:
        """Read a model; nothing in it is ever executed.

        Raises
        ------
        gonio.errors.BadFileError
            When a file is missing, broken, of another version, or does not fit the others.
        """
        folder = Path(folder)
        card = read_document(PosteriorCard, SCHEMA, folder)
        prior = MaterialPrior.load(folder / PRIOR_NAME)
        if card.prior and card.prior.sha256 != prior.sha256:
            problem = f"is another prior than {CARD_NAME} names"
            raise BadFileError(folder / PRIOR_NAME, problem, REMEDY)
        count, channels = card.samples, len(card.channels)
        shapes: dict[str, tuple[int, ...]] = {
            "light": (count, 3), "view": (count, 3), "log": (count, channels), "noise": (count,),
        }  # fmt: skip
        light, view, log, noise = read_tensors(folder, shapes, np.float64).values()
        posterior = _posterior(card, Sites(prior.families, Pairs.of(light, view)), log, noise)
        inference = Inference(
            posterior,
            card.scale,
            card.findings.inflation,
            outliers=_marked(card.findings.outliers, count),
            bounds=_marked(card.findings.lower_bounds, count),
            log=log,
            noise=noise,
        )
        return cls(card, inference, prior, light, view)

    def _told(self, light: Array, view: Array) -> LogNormal:
        light, view = np.broadcast_arrays(np.asarray(light, float), np.asarray(view, float))
        return self.inference.predict(light.reshape(-1, 3), view.reshape(-1, 3))

    def _write(self, folder: Path) -> None:
        inference = self.inference
        arrays = {"light": self.light, "view": self.view}
        write_tensors(folder, arrays | {"log": inference.log, "noise": inference.noise})
        self.prior.save(folder / PRIOR_NAME)
        write_grid(folder, self.grid())
        write_json(folder / CARD_NAME, self.card.model_dump(mode="json", by_alias=True))


@dataclass
class PriorEstimator:
    """Condition the prior on the samples and deliver the posterior.

    Attributes
    ----------
    prior
        What materials look like; generated by default.
    """

    prior: MaterialPrior | None = None
    name: str = field(default="prior", init=False)

    def fit(self, samples: Samples, progress: Progress | None = None) -> PosteriorBRDF:
        """Estimate the material.

        Raises
        ------
        gonio.errors.BadInputError
            For fewer than 8 samples, values that are not finite, a negative sigma, or a number of
            channels other than one or three.
        """
        check_samples(samples, self.name)
        prior = self.prior or MaterialPrior.generate()
        inference = infer(prior.families, samples)
        if progress is not None:
            progress(1, 1)
        card = PosteriorCard(
            estimator=self.name,
            scale=inference.scale,
            white=samples.white,
            components=_component_cards(inference.posterior),
            channels=samples.channels,
            color_space=samples.color_space,
            weights=samples.value.size,
            samples=len(samples),
            prior=prior.used,
            findings=findings_of(inference, single_spectrum=None),
            provenance=samples.provenance,
        )
        return PosteriorBRDF(card, inference, prior, samples.light, samples.view)


def _component_cards(posterior: Posterior) -> tuple[ComponentCard, ...]:
    return tuple(
        ComponentCard(family=each.family.name, share=share, **each.settings._asdict())
        for each, share in zip(posterior.components, posterior.shares.tolist(), strict=True)
    )


def _posterior(card: PosteriorCard, sites: Sites, log: Array, noise: Array) -> Posterior:
    chosen = [
        (each.family, Settings(each.smooth, each.stretch, each.exchange, each.noise))
        for each in card.components
    ]
    shares = np.array([each.share for each in card.components])
    odds = Odds(card.findings.isotropic_log_odds or 0.0, card.findings.reciprocal_log_odds or 0.0)
    return sites.under(chosen, shares, odds, log, noise)


def _marked(rows: tuple[int, ...], count: int) -> NDArray[np.bool_]:
    return np.isin(np.arange(count), rows)


def _shaped(values: Array, light: Array, view: Array) -> Array:
    """Return values of shape (n, channels) with three channels, in the shape of the pairs."""
    shape = np.broadcast_shapes(np.shape(light), np.shape(view))
    return np.broadcast_to(values, (len(values), GRID_CHANNELS)).reshape(shape)

"""The estimator `analytic`: the model of the literature that fits the samples best."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, Literal

import numpy as np
from pydantic import Field, model_validator

from gonio.files import write_json
from gonio.validation import Document
from nnbrdf.card import CARD_NAME, read_document
from nnbrdf.fitting import MODELS, Fit, fit_model, model_named
from nnbrdf.folder import grid_of, save_model, write_grid
from nnbrdf.prior.log import OFFSET
from nnbrdf.prior.lognormal import LogNormal
from nnbrdf.usable import check_samples

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.protocols import Material, Progress
    from gonio.samples import Samples

    Array = NDArray[np.float64]

SCHEMA: Final = "gonio.analytic/1"
_MAD = 1.4826
_LEAST_SPREAD = 1e-3


class AnalyticCard(Document):
    """`model.json` of a fitted model of the literature.

    Attributes
    ----------
    model, shape, colors
        Which model, its shape parameters by name, and the color of each of its terms.
    deviation
        One standard deviation of ln(value / white + 0.01), the same everywhere.
    residual
        Median absolute residual of the same at the samples.
    weights
        How many parameters.
    """

    schema_: Literal["gonio.analytic/1"] = Field(default=SCHEMA, alias="schema")
    estimator: str
    model: str
    shape: dict[str, float]
    colors: tuple[tuple[float, float, float], ...]
    white: float = Field(gt=0)
    deviation: float = Field(gt=0)
    residual: float = Field(ge=0)
    channels: tuple[str, ...]
    color_space: str
    weights: Annotated[int, Field(ge=1)]
    samples: Annotated[int, Field(ge=1)]
    provenance: dict[str, str]

    @model_validator(mode="after")
    def _fits_together(self) -> AnalyticCard:
        if self.model not in MODELS:
            raise ValueError(f"model: must be one of {', '.join(MODELS)}")
        family = MODELS[self.model]
        if set(self.shape) != {each.name for each in family.shape}:
            raise ValueError(f"shape: model {self.model} has other parameters")
        if len(self.colors) != len(family.terms):
            raise ValueError(f"colors: model {self.model} has {len(family.terms)} terms")
        return self

    def sentences(self) -> list[str]:
        """Say how the model was made, as a person reads it."""
        values = ", ".join(f"{name} {value:.4g}" for name, value in self.shape.items())
        return [
            f"model {self.model} ({values or 'no shape parameters'}), the best of {len(MODELS)} by "
            f"its residual, {self.residual:.3f} in the logarithm, with a penalty on parameters"
        ]


@dataclass(frozen=True)
class FittedBRDF:
    """A material as a model of the literature.

    Attributes
    ----------
    card
        What `model.json` says.
    """

    card: AnalyticCard

    def evaluate(self, light: Array, view: Array) -> Array:
        """Return the model's BRDF in 1/sr, shape (..., 3)."""
        return self._material.evaluate(light, view)

    def sigma(self, light: Array, view: Array) -> Array:
        """Return one standard uncertainty in 1/sr, told from the residuals, shape (..., 3)."""
        return self._told(light, view).sigma

    def quantiles(self, light: Array, view: Array) -> tuple[Array, Array]:
        """Return the 5 and 95 % quantiles in 1/sr, shape (..., 3) each."""
        return self._told(light, view).quantiles

    def grid(self) -> dict[str, NDArray[np.float32]]:
        """Return `values`, `sigma`, `lo` and `hi` on the 81 x 81 grid, shape (81, 81, 3) each."""
        return grid_of(self)

    def save(self, folder: Path | str) -> None:
        """Write `model.json` and `grid.npz`."""
        save_model(folder, self._write)

    @classmethod
    def load(cls, folder: Path | str) -> FittedBRDF:
        """Read a model; nothing in it is ever executed.

        Raises
        ------
        gonio.errors.BadFileError
            When a file is missing, broken, of another version, or does not fit the others.
        """
        return cls(read_document(AnalyticCard, SCHEMA, Path(folder)))

    @property
    def _material(self) -> Material:
        family = model_named(self.card.model)
        shape = np.array([self.card.shape[each.name] for each in family.shape])
        return family.material(shape, np.array(self.card.colors))

    def _told(self, light: Array, view: Array) -> LogNormal:
        white = self.card.white
        log = np.log(self.evaluate(light, view) / white + OFFSET)
        return LogNormal(log, np.full_like(log, self.card.deviation), white)

    def _write(self, folder: Path) -> None:
        write_grid(folder, self.grid())
        write_json(folder / CARD_NAME, self.card.model_dump(mode="json", by_alias=True))


@dataclass
class AnalyticEstimator:
    """Fit every model of the registry and deliver the best (Akaike's criterion, Laplace errors).

    Attributes
    ----------
    seed
        Of the starts.
    """

    seed: int = 0
    name: str = field(default="analytic", init=False)

    def fit(self, samples: Samples, progress: Progress | None = None) -> FittedBRDF:
        """Estimate the material.

        Raises
        ------
        gonio.errors.BadInputError
            For fewer than 8 samples, values that are not finite, a negative sigma, or a number of
            channels other than one or three.
        """
        check_samples(samples, self.name)
        names = [name for name in MODELS if _parameters(name, samples) < samples.value.size]
        best, least = None, np.inf
        for done, name in enumerate(names, 1):
            fit = fit_model(name, samples, self.seed)
            spread = float(np.abs(_residuals(fit, samples)).mean())
            penalty = 2 * samples.value.size * np.log(spread) + 2 * _parameters(name, samples)
            if penalty < least:
                best, least = fit, penalty
            if progress is not None:
                progress(done, len(names))
        assert best is not None
        return FittedBRDF(self._card(best, samples))

    def _card(self, fit: Fit, samples: Samples) -> AnalyticCard:
        residuals = np.abs(_residuals(fit, samples))
        return AnalyticCard(
            estimator=self.name,
            model=fit.family.name,
            shape=fit.shape,
            colors=tuple(map(tuple, fit.colors.tolist())),
            white=samples.white,
            deviation=max(_LEAST_SPREAD, _MAD * float(np.median(residuals))),
            residual=float(np.median(residuals)),
            channels=samples.channels,
            color_space=samples.color_space,
            weights=_parameters(fit.family.name, samples),
            samples=len(samples),
            provenance=samples.provenance,
        )


def _parameters(name: str, samples: Samples) -> int:
    family = MODELS[name]
    return len(family.shape) + len(family.terms) * len(samples.channels)


def _residuals(fit: Fit, samples: Samples) -> Array:
    told = fit.material.evaluate(samples.light, samples.view)[:, : len(samples.channels)]
    floor = OFFSET * samples.white
    return np.asarray(np.log((told + floor) / (samples.value.clip(0.0) + floor)))

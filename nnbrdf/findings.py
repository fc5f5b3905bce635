"""What samples tell of a material beyond its values, as a model's card says it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from pydantic import Field

from gonio.validation import Document

if TYPE_CHECKING:
    from nnbrdf.prior.infer import Inference


CLEAR: Final = 3.0
"""Logarithm of odds, 20 to 1, below which samples do not decide."""


class Findings(Document):
    """What was left out or let in, by evidence from the samples.

    Attributes
    ----------
    isotropic, isotropic_log_odds
        Whether the material depends on the azimuths by their difference only, and the logarithm
        of the odds for it.
    reciprocal, reciprocal_log_odds
        The same of whether light and view may be exchanged. Odds are None where it was not asked.
    single_spectrum
        Whether all channels are multiples of one; None where it was not asked.
    smooth, stretch, exchange, noise
        The settings of the prior that the samples speak for (see `nnbrdf.prior.family.Settings`).
    inflation
        Factor on the posterior's deviations, told from samples left out in turn.
    outliers, lower_bounds
        Rows of the samples that count less since the others do not explain them, and of those left
        out as clipped below what the others say.
    condition, jitter
        Condition number of the samples' covariance, from below, and what was added to its diagonal
        to factor it.
    """

    isotropic: bool
    isotropic_log_odds: float | None
    reciprocal: bool
    reciprocal_log_odds: float | None
    single_spectrum: bool | None
    smooth: float = Field(ge=0)
    stretch: float = Field(gt=0)
    exchange: float = Field(ge=0)
    noise: float = Field(ge=0)
    inflation: float = Field(gt=0)
    outliers: tuple[int, ...]
    lower_bounds: tuple[int, ...]
    condition: float = Field(ge=1)
    jitter: float = Field(ge=0)

    def sentences(self) -> list[str]:
        """Say it as a person reads it."""
        result = [self._azimuths(), self._exchange()]
        if self.single_spectrum is not None:
            result.append(
                "one spectrum: all channels are multiples of one"
                if self.single_spectrum
                else "channels differ by more than a factor"
            )
        if self.outliers:
            rows = ", ".join(map(str, self.outliers))
            result.append(f"not explained by the others, so of little weight: samples {rows}")
        if self.lower_bounds:
            rows = ", ".join(map(str, self.lower_bounds))
            result.append(f"clipped, so lower bounds that tell no more: samples {rows}")
        if self.jitter:
            result.append(f"the covariance needed {self.jitter:.2g} on its diagonal")
        return result

    def _azimuths(self) -> str:
        if self.isotropic_log_odds is None:
            return "isotropy was not examined"
        kind = "isotropic" if self.isotropic else "anisotropic"
        for_it = self.isotropic_log_odds if self.isotropic else -self.isotropic_log_odds
        odds = f"log odds {abs(for_it):.0f}"
        if abs(for_it) < CLEAR:
            return (
                "the samples do not tell whether only the difference of the azimuths counts "
                f"(log odds {abs(for_it):.1f}); assumed: {kind}, by the likeliest setting"
            )
        if for_it < 0:
            return (
                f"{kind} by the likeliest setting, though all settings together speak against it "
                f"({odds})"
            )
        if self.isotropic:
            return f"isotropic: only the difference of the azimuths counts ({odds})"
        return f"anisotropic ({odds} against isotropic)"

    def _exchange(self) -> str:
        if self.reciprocal_log_odds is None:
            return "reciprocity was not examined, and is not assumed"
        if self.reciprocal:
            return "reciprocal as far as the samples say: light and view may be exchanged"
        return (
            "the samples are explained better without reciprocity (log odds "
            f"{-self.reciprocal_log_odds:.0f}), so the model does not assume it"
        )


def findings_of(
    inference: Inference, *, single_spectrum: bool | None, examined: bool = True
) -> Findings:
    """Return what an inference found; `examined` says whether symmetries were asked for at all."""
    posterior = inference.posterior
    return Findings(
        isotropic=examined and posterior.isotropic,
        isotropic_log_odds=posterior.odds.isotropic if examined else None,
        reciprocal=examined and posterior.reciprocal,
        reciprocal_log_odds=posterior.odds.reciprocal if examined else None,
        single_spectrum=single_spectrum,
        **posterior.best.settings._asdict(),
        inflation=inference.inflation,
        outliers=tuple(inference.outliers.nonzero()[0].tolist()),
        lower_bounds=tuple(inference.bounds.nonzero()[0].tolist()),
        condition=posterior.best.condition,
        jitter=posterior.best.jitter,
    )

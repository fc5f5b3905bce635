"""What else may be made of a session's samples, to be shown beside its model."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gonio.api.opened import Opened
from gonio.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from gonio.api.following import Bars
    from gonio.materials import MeasuredTable
    from gonio.samples import Samples

_NO_SAMPLES = "needs samples; give a session among the materials"


def fitted_beside(
    opened: Sequence[Opened], recipes: Sequence[str], activations: Sequence[str], bars: Bars
) -> Iterator[Opened]:
    """Fit recipes to the samples of the first session.

    Parameters
    ----------
    opened
        The materials.
    recipes
        Names of estimators, or `nbrdf`.
    activations
        Each makes a network by the paper's recipe but for its activation.
    bars
        How each is followed.

    Raises
    ------
    gonio.errors.BadInputError
        When there is no session, or an activation's gradients overflow.
    """
    if not recipes and not activations:
        return
    samples = next((one.samples for one in opened if one.samples is not None), None)
    if samples is None:
        raise BadInputError(f"{', '.join([*recipes, *activations])} {_NO_SAMPLES}")
    for name in recipes:
        yield _nbrdf(samples) if name == "nbrdf" else _fit(name, name, samples, bars)
    for activation in activations:
        yield _fit(activation, "paper", samples, bars, activation=activation)


def _fit(title: str, estimator: str, samples: Samples, bars: Bars, **settings: Any) -> Opened:
    from nnbrdf.estimators import estimator_named

    with bars(f"fitting {title}") as progress:
        estimate = estimator_named(estimator)(**settings).fit(samples, progress)
    return Opened(title, estimate, samples.white)


def _nbrdf(samples: Samples) -> Opened:
    from gonio.api.opened import evaluating
    from nnbrdf.baselines import fit_nbrdf

    return Opened("nbrdf", evaluating(fit_nbrdf(samples)), samples.white)


def score_line(one: Opened, reference: Opened) -> str:
    """Say eps8 and male of a material against another, over the 81 x 81 pairs."""
    from nnbrdf.metrics import eps8, male

    table: MeasuredTable = reference.table
    pair = one.table.values.clip(0.0), table.values, table.white
    return f"eps8 {eps8(*pair):.2f}, male {male(*pair):.3f}"

"""Fitting a model to samples: robust least squares of logarithms, from several starts."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from time import thread_time
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.errors import BadInputError
from nnbrdf.analytic.base import both_above
from nnbrdf.cores import threads_for
from nnbrdf.fitting.family import Pairs
from nnbrdf.fitting.models import model_named

if TYPE_CHECKING:
    from gonio.protocols import Material
    from gonio.samples import Samples
    from nnbrdf.fitting.family import Family, Floats

STARTS = 8
_FLOOR = 0.01
_ROBUST = 0.3
_FEW = 500
_SPAN = (1e-5, 1e4)
_DIFFERENCE = 1e-5
_STEPS = 60


@dataclass(frozen=True)
class Fit:
    """A model fitted to samples.

    Attributes
    ----------
    family
        Which model.
    shape
        Its shape parameters, by name; `family.shape` has their units and bounds.
    colors
        Shape (terms, 3), a row for each of `family.terms`; all alike for one channel.
    residual
        Median absolute error of ln(f + 0.01 white) over the samples.
    seconds
        Time of the processor that the fit took, on one core.
    evaluations
        How often the model was evaluated.
    converged
        Whether the solver stopped by itself, not at its limit of steps.
    """

    family: Family
    shape: dict[str, float]
    colors: Floats
    residual: float
    seconds: float
    evaluations: int
    converged: bool

    @property
    def material(self) -> Material:
        """The model with its parameters set."""
        return self.family.material(np.array(list(self.shape.values())), self.colors)


def fit_model(name: str, samples: Samples, seed: int = 0, starts: int = STARTS) -> Fit:
    """Fit a model of the registry.

    The residual is ln(f + 0.01 white) - ln(value + 0.01 white), whose mean absolute value is the
    metric `male`, under the soft L1 loss; a highlight a thousand times the body would drown
    everything else in a residual of plain values. Starts, spread by a Latin hypercube, are tried on
    at most 500 samples, and the best goes on with all of them.

    Parameters
    ----------
    name
        In `nnbrdf.fitting.models.MODELS`.
    samples
        One or three channels.
    seed
        Of the starts.
    starts
        How many.

    Raises
    ------
    gonio.errors.BadInputError
        For an unknown name, samples that are not finite, neither one channel nor three, or fewer
        values than parameters.
    """
    # before the clock starts, else the first fit would be charged for the import
    import scipy.optimize
    import scipy.stats  # noqa: F401

    family = model_named(name)
    samples.check()
    problem = _Problem(family, samples)
    with threads_for(1):
        began = thread_time()
        best, evaluations = _solve(family, problem, np.random.default_rng(seed), starts)
        return problem.fit_of(best, thread_time() - began, evaluations)


def _solve(
    family: Family, problem: _Problem, rng: np.random.Generator, count: int
) -> tuple[Any, int]:
    """Return the best of the starts, and how often the model was evaluated."""
    few = problem.part(rng)
    starts = [few.solve(place) for place in _starts(family, rng, count)]
    best = min(starts, key=lambda result: result.cost)
    if len(few.values) < len(problem.values):
        best = problem.solve(best.x[: len(family.shape)])
    return best, few.evaluations + (problem.evaluations if problem is not few else 0)


def _starts(family: Family, rng: np.random.Generator, count: int) -> Floats:
    """Return places of the shape parameters in their boxes, shape (starts, parameters)."""
    from scipy.stats import qmc

    if not family.shape:
        return np.empty((1, 0))
    return np.asarray(qmc.LatinHypercube(len(family.shape), rng=rng).random(count))


class _Problem:
    """Samples and a model; what the solver moves are places in the box, then logs of colors."""

    def __init__(self, family: Family, samples: Samples) -> None:
        if samples.value.shape[1] not in (1, 3):
            raise BadInputError(
                f"the samples have {samples.value.shape[1]} channels; a model is fitted to one or "
                "to three, so select them"
            )
        above = both_above(samples.light, samples.view)
        self._family = family
        self._pairs = Pairs.of(samples.light[above], samples.view[above])
        self.values = samples.value[above]
        self._floor = _FLOOR * samples.white
        self._unit = samples.white
        self._goal = np.log(self.values.clip(0.0) + self._floor)
        self.evaluations = 0
        count = len(family.shape) + len(family.terms) * self.values.shape[1]
        if self.values.size < count:
            raise BadInputError(
                f"there are {self.values.size} values; model {family.name} has {count} parameters, "
                "so measure more directions"
            )

    def part(self, rng: np.random.Generator) -> _Problem:
        """Return the problem on at most 500 of the samples."""
        if len(self.values) <= _FEW:
            return self
        chosen = np.sort(rng.permutation(len(self.values))[:_FEW])
        smaller = copy(self)
        smaller._pairs = self._pairs.chosen(chosen)
        smaller.values, smaller._goal = self.values[chosen], self._goal[chosen]
        return smaller

    def solve(self, place: Floats) -> Any:
        """Return scipy's result from one start of the shape; colors start where they fit best."""
        from scipy.optimize import least_squares

        place = np.clip(place, 1e-3, 1.0 - 1e-3)
        colors = np.log(self._best_colors(self._terms(place)))
        low, high = (np.log(each * self._unit * np.pi) for each in _SPAN)
        start = np.concatenate([place, colors.ravel().clip(low + 1e-3, high - 1e-3)])
        count = len(place)
        bounds = (
            np.concatenate([np.zeros(count), np.full(colors.size, low)]),
            np.concatenate([np.ones(count), np.full(colors.size, high)]),
        )
        return least_squares(
            self._residual, start, self._jacobian, bounds, loss="soft_l1", f_scale=_ROBUST,
            max_nfev=_STEPS, xtol=1e-6, ftol=1e-6,
        )  # fmt: skip

    def fit_of(self, result: Any, seconds: float, evaluations: int) -> Fit:
        """Return what the solver's answer means."""
        place, colors = self._split(result.x)
        shape = {each.name: each.at(at) for each, at in zip(self._family.shape, place, strict=True)}
        residual = float(np.median(np.abs(self._residual(result.x))))
        colors = np.broadcast_to(colors, (len(colors), 3)).copy()
        converged = bool(result.status > 0)
        return Fit(self._family, shape, colors, residual, seconds, evaluations, converged)

    def _split(self, x: Floats) -> tuple[Floats, Floats]:
        count = len(self._family.shape)
        return x[:count], np.exp(x[count:]).reshape(-1, self.values.shape[1])

    def _terms(self, place: Floats) -> Floats:
        self.evaluations += 1
        shape = [each.at(at) for each, at in zip(self._family.shape, place, strict=True)]
        return self._family.evaluate(self._pairs, np.array(shape))

    def _best_colors(self, terms: Floats) -> Floats:
        """Return non-negative colors of the least relative error, kept above zero."""
        from scipy.optimize import nnls

        weight = 1.0 / (self.values.clip(0.0) + self._floor)
        channels = range(self.values.shape[1])
        solved = [
            nnls(terms * weight[:, c, None], (self.values * weight)[:, c])[0] for c in channels
        ]
        return np.asarray(np.maximum(np.stack(solved, axis=1), 1e-3 * self._unit))

    def _residual(self, x: Floats) -> Floats:
        place, colors = self._split(x)
        value = self._terms(place) @ colors
        return np.asarray(np.log(value + self._floor) - self._goal).ravel()

    def _jacobian(self, x: Floats) -> Floats:
        place, colors = self._split(x)
        terms = self._terms(place)
        value = terms @ colors
        slope = 1.0 / (value + self._floor)
        columns = [self._along(place, index, terms, colors) * slope for index in range(len(place))]
        for term, row in enumerate(colors):
            for channel, color in enumerate(row):
                column = np.zeros_like(value)
                column[:, channel] = color * terms[:, term] * slope[:, channel]
                columns.append(column)
        return np.stack([column.ravel() for column in columns], axis=1)

    def _along(self, place: Floats, index: int, terms: Floats, colors: Floats) -> Floats:
        """Return the change of the values with one place, by a difference that stays inside."""
        step = -_DIFFERENCE if place[index] > 0.5 else _DIFFERENCE
        moved = place.copy()
        moved[index] += step
        return np.asarray((self._terms(moved) - terms) @ colors / step)

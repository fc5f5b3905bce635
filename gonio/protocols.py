"""The seams that several rooms share: a material, its estimate, and the art of estimating it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple, Protocol

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from gonio.samples import Samples

Progress = Callable[[int, int], None]
"""Called with how much is done and how much there is."""


class Material(Protocol):
    """Anything that reflects: analytic, tabulated or learned."""

    def evaluate(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the BRDF.

        Parameters
        ----------
        light, view
            Unit vectors away from the sample, shapes (..., 3), broadcast against each other.

        Returns
        -------
        ndarray
            Linear RGB in 1/sr, shape (..., 3).
        """


class Estimate(Material, Protocol):
    """A material told from samples, which knows how sure it is."""

    def sigma(self, light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return one standard uncertainty in 1/sr, shaped as `evaluate`."""

    def quantiles(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the 5 and 95 % quantiles in 1/sr, each shaped as `evaluate`."""

    def save(self, folder: Path) -> None:
        """Write `weights.safetensors`, `model.json` and `grid.npz` to `folder`."""


class Estimator(Protocol):
    """Turns samples into an estimate of the material over the whole hemisphere."""

    name: str

    def fit(self, samples: Samples, progress: Progress | None = None) -> Estimate:
        """Estimate the material.

        Raises
        ------
        gonio.errors.BadInputError
            When the samples are too few or not usable.
        """


class PriorKind(NamedTuple):
    """One kind of material that a sample may be, as far as choosing pairs is concerned.

    Attributes
    ----------
    name
        Such as `isotropic`.
    share
        How much it counts; the shares of all kinds add up to one.
    factor
        Covariance of ln(BRDF) at the pairs that differ in this kind, as factor @ factor.T,
        shape (distinct, rank).
    which
        Which of these each pair is, shape (n,): pairs that symmetry makes equal are one.
    rest
        Variance that the factor leaves out, shape (distinct,), of which a measurement tells at its
        own pair alone. None: there is none.
    """

    name: str
    share: float
    factor: NDArray[np.float64]
    which: NDArray[np.int64]
    rest: NDArray[np.float64] | None = None


class Prior(Protocol):
    """What is believed of a material before it is measured."""

    def kinds(
        self, light: NDArray[np.float64], view: NDArray[np.float64], rank: int
    ) -> list[PriorKind]:
        """Return the covariance of each kind at pairs, without the dense matrix of all.

        Parameters
        ----------
        light, view
            Unit vectors away from the sample, shape (n, 3).
        rank
            Columns of the factors at most.
        """

    def expected(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return mean and standard deviation of ln(BRDF in 1/sr) at pairs, shape (n,) each.

        The BRDF counts with a hundredth of the material's white added, below which nothing is told
        apart; that the material's scale is unknown is in the deviation.

        Parameters
        ----------
        light, view
            Unit vectors away from the sample, shape (n, 3).
        """

"""Principal components with ridge regression, in log-relative space."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nnbrdf.prior.family import grid_pairs

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nnbrdf.prior.material_prior import MaterialPrior

    Array = NDArray[np.float64]

_EPSILON = 0.001
_RIDGE = 40.0
COMPONENTS = 300


class PcaRidge:
    """Nielsen, Jensen and Ramamoorthi (2015), on a basis of generated materials.

    Values times both cosines are mapped by ln((x + 0.001) / (median + 0.001)), and a material is
    the mean plus scaled principal components whose coefficients are ridge regressed (weight 40).
    Theirs were 100 measured isotropic materials in Rusinkiewicz coordinates and absolute units;
    here they are the prior's examples of any kind on the 81 x 81 grid, and a material's unit is
    4 x the median of its samples, as the examples' is of theirs.

    Parameters
    ----------
    prior
        Whose examples make the basis.
    """

    def __init__(self, prior: MaterialPrior) -> None:
        family = prior.families[-1]
        grid = grid_pairs()
        self._cosines = np.maximum(grid.light[:, 2] * grid.view[:, 2], 1e-3)
        distinct, which = family.distinct(grid)
        values = (family.examples.evaluate(distinct) / family.white[: len(family.examples)])[which]
        weighted = values * self._cosines[:, None]
        self._median = np.median(weighted, axis=1, keepdims=True)
        mapped = self._map(weighted)
        self._mean = mapped.mean(axis=1, keepdims=True)
        left, sizes, _ = np.linalg.svd(mapped - self._mean, full_matrices=False)
        self._basis = left[:, :COMPONENTS] * sizes[:COMPONENTS]

    def reconstruct(self, rows: NDArray[np.int64], values: Array, white: float) -> Array:
        """Return values on the grid from those at some of its pairs.

        Parameters
        ----------
        rows
            Which pairs of the flattened grid, shape (n,).
        values
            In 1/sr, shape (n, channels).
        white
            4 x their median, in 1/sr.

        Returns
        -------
        ndarray
            Shape (6561, channels), in 1/sr.
        """
        weighted = values.clip(0.0) / white * self._cosines[rows, None]
        target = self._map(weighted, rows) - self._mean[rows]
        basis = self._basis[rows]
        # the smaller of the two equivalent systems
        inner = basis @ basis.T + _RIDGE * np.eye(len(rows))
        weights = basis.T @ np.linalg.solve(inner, target)
        log = self._mean + self._basis @ weights
        weighted = np.exp(log) * (self._median + _EPSILON) - _EPSILON
        return np.asarray(white * weighted.clip(0.0) / self._cosines[:, None])

    def _map(self, weighted: Array, rows: NDArray[np.int64] | slice = slice(None)) -> Array:
        return np.asarray(np.log((weighted + _EPSILON) / (self._median[rows] + _EPSILON)))

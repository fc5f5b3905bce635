"""The matrix from a camera's channels to XYZ that makes a chart's patches look as they should."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.color import D65
from gonio.errors import BadInputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

_LAB_FROM_ROOTS = np.array([[0.0, 116.0, 0.0], [500.0, -500.0, 0.0], [0.0, 200.0, -200.0]])
_KAPPA, _EPSILON = 24389.0 / 27.0, 216.0 / 24389.0
# two directions along which white does not change
_ACROSS_WHITE = np.array([[1.0, -1.0, 0.0], [1.0, 1.0, -2.0]]).T / np.sqrt([2.0, 6.0])


def fit_matrix(camera: NDArray[np.float64], xyz: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the matrix from white-balanced camera RGB to XYZ, shape (3, 3).

    Least squares in CIELAB, made linear about each patch's reference, so that dark patches count as
    the eye sees them and one solution is exact. White is kept: a perfect diffuser, whose channels
    are all one, comes out as D65's white to the last digit, as the white reference wants it, which
    leaves six numbers free (Finlayson and Drew 1997, *Constrained least-squares regression in color
    spaces*).

    Parameters
    ----------
    camera
        Reflectance factor of the patches in each channel, shape (n, 3).
    xyz
        What they are under D65, a perfect diffuser's Y being 1, shape (n, 3).

    Raises
    ------
    gonio.errors.BadInputError
        When the patches do not tell colors apart.
    """
    columns, wanted = _equations(camera, xyz)
    free, _, rank, _ = np.linalg.lstsq(columns, wanted, rcond=None)
    matrix: NDArray[np.float64] = D65[:, None] / 3.0 + _across(np.asarray(free, np.float64))
    if rank < 6 or np.linalg.cond(matrix) > 100.0:
        raise BadInputError("the chart's patches do not tell colors apart; check what was shot")
    return matrix


def matrix_errors(
    camera: NDArray[np.float64], xyz: NDArray[np.float64], white_sigma: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return errors of the matrix that occur independently, one sigma each, shape (9, 3, 3).

    Six are the principal axes of the fit's covariance, by the scatter of the patches about it (JCGM
    100:2008, H.3, for a straight line). Three are what the white reference's noise does, which all
    patches share. All leave white as it is.

    Parameters
    ----------
    camera, xyz
        As `fit_matrix` has them.
    white_sigma
        Relative, of each channel of the white reference, shape (3,).
    """
    columns, wanted = _equations(camera, xyz)
    free, *_ = np.linalg.lstsq(columns, wanted, rcond=None)
    rest = wanted - columns @ free
    variance = float(rest @ rest) / (len(rest) - len(free))
    variances, axes = np.linalg.eigh(variance * np.linalg.inv(columns.T @ columns))
    scatter = [_across(each) for each in (np.sqrt(variances.clip(0.0)) * axes).T]
    found = fit_matrix(camera, xyz)
    shared = [fit_matrix(camera * (1.0 - each), xyz) - found for each in np.diag(white_sigma)]
    return np.array([*scatter, *shared])


def _equations(
    camera: NDArray[np.float64], xyz: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return what the six free numbers are to solve, shapes (3 n, 6) and (3 n,)."""
    slope = lab_slope(xyz)
    kept = camera.mean(axis=1, keepdims=True) * D65
    across = camera @ _ACROSS_WHITE
    # residual = slope (kept + free @ across - xyz), linear in the six of free
    columns = np.einsum("nij,nk->nijk", slope, across).reshape(3 * len(xyz), 6)
    return columns, np.einsum("nij,nj->ni", slope, xyz - kept).ravel()


def _across(free: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the part of the matrix that does not touch white, shape (3, 3)."""
    return np.asarray(free.reshape(3, 2) @ _ACROSS_WHITE.T)


def lab_slope(xyz: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how CIELAB changes with XYZ about some colors under D65, shape (n, 3) to (n, 3, 3)."""
    ratio = xyz / D65
    root_slope = np.where(ratio > _EPSILON, np.cbrt(ratio.clip(_EPSILON)) ** -2 / 3.0, _KAPPA / 116)
    slope: NDArray[np.float64] = _LAB_FROM_ROOTS * (root_slope / D65)[:, None, :]
    return slope

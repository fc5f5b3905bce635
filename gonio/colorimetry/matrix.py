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
    slope = lab_slope(xyz)
    kept = camera.mean(axis=1, keepdims=True) * D65
    across = camera @ _ACROSS_WHITE
    # residual = slope (kept + free @ across - xyz), linear in the six of free
    columns = np.einsum("nij,nk->nijk", slope, across).reshape(3 * len(xyz), 6)
    wanted = np.einsum("nij,nj->ni", slope, xyz - kept).ravel()
    free, _, rank, _ = np.linalg.lstsq(columns, wanted, rcond=None)
    matrix: NDArray[np.float64] = D65[:, None] / 3.0 + free.reshape(3, 2) @ _ACROSS_WHITE.T
    if rank < 6 or np.linalg.cond(matrix) > 100.0:
        raise BadInputError("the chart's patches do not tell colors apart; check what was shot")
    return matrix


def lab_slope(xyz: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how CIELAB changes with XYZ about some colors under D65, shape (n, 3) to (n, 3, 3)."""
    ratio = xyz / D65
    root_slope = np.where(ratio > _EPSILON, np.cbrt(ratio.clip(_EPSILON)) ** -2 / 3.0, _KAPPA / 116)
    slope: NDArray[np.float64] = _LAB_FROM_ROOTS * (root_slope / D65)[:, None, :]
    return slope

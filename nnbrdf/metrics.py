"""How far an estimate is from the truth, on the 81 x 81 grid."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gonio.directions import RINGS_81, paper_directions
from gonio.errors import BadInputError
from nnbrdf.difference import check_white, delta_e_2000, expose_sphere, psnr_db

if TYPE_CHECKING:
    from numpy.typing import NDArray

_FLOOR = 0.01
_HALF_BELT_DEG = 7.5


@dataclass(frozen=True)
class Scores:
    """All errors of one estimate.

    Attributes
    ----------
    eps8, male, cube_root_rmse
        See the functions of these names.
    sphere_psnr_db
        Of two pictures of a sphere (`nnbrdf.difference`), in dB; infinite where they are identical.
    delta_e_mean, delta_e_95
        Mean and 95th percentile of CIEDE2000 over the same pictures; None unless asked for.
    """

    eps8: float
    male: float
    cube_root_rmse: float
    sphere_psnr_db: float
    delta_e_mean: float | None = None
    delta_e_95: float | None = None


def score(
    estimate: NDArray[Any], true: NDArray[Any], white: float, *, delta_e: bool = False
) -> Scores:
    """Return all errors of a table.

    Parameters
    ----------
    estimate, true
        BRDF in 1/sr, shape (81, 81, 3), [light, view, channel]; linear sRGB.
    white
        Exposure scale of the true material, in 1/sr.
    delta_e
        Whether to compute color differences, too; ten times as slow.

    Raises
    ------
    BadInputError
        When a shape is another, a number is not finite, or white is not positive.
    MissingExtraError
        For `delta_e` without the extra `color`.
    """
    estimate, true = _checked(estimate, true, white)
    pictures = expose_sphere(estimate, white), expose_sphere(true, white)
    differences = delta_e_2000(*pictures) if delta_e else None
    return Scores(
        eps8=eps8(estimate, true, white),
        male=male(estimate, true, white),
        cube_root_rmse=cube_root_rmse(estimate, true, white),
        sphere_psnr_db=psnr_db(*pictures),
        delta_e_mean=None if differences is None else float(differences.mean()),
        delta_e_95=None if differences is None else float(np.percentile(differences, 95)),
    )


class Errors(NamedTuple):
    """How far one is from another, in both metrics that are quoted."""

    eps8: float
    male: float


def errors_of(estimate: NDArray[np.float64], true: NDArray[np.float64], white: float) -> Errors:
    """Return `eps8` and `male` (parameters and errors as for these)."""
    return Errors(eps8(estimate, true, white), male(estimate, true, white))


def eps8(estimate: NDArray[Any], true: NDArray[Any], white: float) -> float:
    """Return the mean absolute difference on an 8-bit scale that ends at white.

    Mikes and Haindl (2023), equations 2 and 3, of b8(f) = 255 clip(f / white, 0, 1).

    Parameters
    ----------
    estimate, true
        BRDF in 1/sr, one shape (..., channel).
    white
        Exposure scale of the true material, in 1/sr.

    Raises
    ------
    BadInputError
        When shapes differ, a number is not finite, or white is not positive.
    """
    return float(eps8_per_channel(estimate, true, white).mean())


def male(estimate: NDArray[Any], true: NDArray[Any], white: float) -> float:
    """Return the mean absolute log error above a floor of 1 % of white.

    That is |ln((estimate + 0.01 white) / (true + 0.01 white))|, both clipped at 0;
    highlights count beyond white. Parameters and errors as for `eps8`.
    """
    return float(male_per_channel(estimate, true, white).mean())


def cube_root_rmse(estimate: NDArray[Any], true: NDArray[Any], white: float) -> float:
    """Return the weighted RMS difference of cube roots of f cos(theta_light) / white.

    After Fores, Ferwerda and Gu (2012), who found the cube root of the cosine-weighted BRDF to
    follow what people see better than the BRDF itself; the division by white rids it of its unit.
    The mean square is over channels and pairs, each pair weighted by the solid angles of its two
    directions: their ring's belt, 7.5 deg to either side, shared among its azimuths. Negative
    values count as 0; highlights count beyond white.

    Parameters
    ----------
    estimate, true
        BRDF in 1/sr, shape (81, 81, channel), [light, view, channel].
    white
        Exposure scale of the true material, in 1/sr.

    Raises
    ------
    BadInputError
        When a shape is another, a number is not finite, or white is not positive.
    """
    return float(np.sqrt((cube_root_rmse_per_channel(estimate, true, white) ** 2).mean()))


def eps8_per_channel(
    estimate: NDArray[Any], true: NDArray[Any], white: float
) -> NDArray[np.float64]:
    """Return `eps8` of each channel, shape (channels,)."""
    estimate, true = _checked(estimate, true, white)
    difference = np.clip(estimate / white, 0, 1) - np.clip(true / white, 0, 1)
    return _mean_per_channel(255 * difference)


def male_per_channel(
    estimate: NDArray[Any], true: NDArray[Any], white: float
) -> NDArray[np.float64]:
    """Return `male` of each channel, shape (channels,)."""
    estimate, true = _checked(estimate, true, white)
    floor = _FLOOR * white
    estimate, true = np.clip(estimate, 0, None), np.clip(true, 0, None)
    return _mean_per_channel(np.log((estimate + floor) / (true + floor)))


def cube_root_rmse_per_channel(
    estimate: NDArray[Any], true: NDArray[Any], white: float
) -> NDArray[np.float64]:
    """Return `cube_root_rmse` of each channel, shape (channels,)."""
    estimate, true = _checked(estimate, true, white)
    if true.ndim != 3 or true.shape[:2] != (81, 81):
        raise BadInputError(f"the tables have shape {true.shape}, not (81, 81, channels)")
    cosine = paper_directions()[:, None, None, 2] / white
    difference = np.cbrt(estimate.clip(0) * cosine) - np.cbrt(true.clip(0) * cosine)
    solid_angle = _solid_angles()
    square = np.einsum("l,v,lvc->c", solid_angle, solid_angle, difference**2, optimize=True)
    root: NDArray[np.float64] = np.sqrt(square) / solid_angle.sum()
    return root


@cache
def _solid_angles() -> NDArray[np.float64]:
    """Return the solid angle of each of the 81 directions in sr, out to 82.5 deg."""
    theta, count = np.array(RINGS_81, np.float64).T
    inner = np.cos(np.radians(np.maximum(theta - _HALF_BELT_DEG, 0.0)))
    belt = 2.0 * np.pi * (inner - np.cos(np.radians(theta + _HALF_BELT_DEG)))
    return np.repeat(belt / count, count.astype(int))


def _mean_per_channel(difference: NDArray[np.float64]) -> NDArray[np.float64]:
    mean: NDArray[np.float64] = np.abs(difference).reshape(-1, difference.shape[-1]).mean(axis=0)
    return mean


def _checked(
    estimate: NDArray[Any], true: NDArray[Any], white: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    estimate, true = np.asarray(estimate, np.float64), np.asarray(true, np.float64)
    if estimate.shape != true.shape:
        raise BadInputError(
            f"the estimate has shape {estimate.shape} and the truth {true.shape}; "
            "compare them on one grid"
        )
    for name, values in (("estimate", estimate), ("truth", true)):
        if not np.isfinite(values).all():
            raise BadInputError(f"the {name} holds values that are not finite; make it again")
    check_white(white)
    return estimate, true

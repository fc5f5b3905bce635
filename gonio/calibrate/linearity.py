"""Linearity: how raw values bend away from the light that made them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.calibration import Linearity
from gonio.errors import BadInputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

_DEGREE = 4
# of the range: EMVA Standard 1288 judges linearity between these levels
_LOW, _HIGH = 0.05, 0.95
# of the lamps' monitors over a few frames, relative
_MONITOR = 2e-4
# levels are means, and their brightest pixels lie so much higher
_BEYOND = 1.1


def fit_linearity(
    dose: NDArray[np.float64],
    signal: NDArray[np.float64],
    raw_range: float,
    color: NDArray[np.float64] | None = None,
    noise: NDArray[np.float64] | None = None,
) -> tuple[Linearity, float]:
    """Fit the polynomial that makes signals proportional to doses.

    The relative residuals over their sigma are least: k dose / s - c1 u - c2 u^2 - ... - a color
    = 1, which is linear in k, c and a.

    Parameters
    ----------
    dose, signal
        Light in any unit, and raw units above dark, shape (n,), of unsaturated frames.
    raw_range
        The range in raw units.
    color
        How red the light was, in any unit, shape (n,): doses are of all its colors, and a channel
        sees some of them more. Without it, of one color.
    noise
        Relative, of the signals by photons, shape (n,); what monitors scatter comes on top.

    Returns
    -------
    Linearity
        The polynomial.
    float
        Raw units for a unit of dose at low signals.

    Raises
    ------
    gonio.errors.BadInputError
        When there are too few levels.
    """
    if len(signal) < 2 * _DEGREE:
        raise BadInputError(
            f"{len(signal)} levels of the white reference are bright and not saturated, and "
            f"{2 * _DEGREE} are needed; add exposures to camera.exposures_s in the rig file"
        )
    u = signal / raw_range
    columns = [dose / signal, *(-(u**power) for power in range(1, _DEGREE + 1))]
    if color is not None:
        columns.append(color - color.mean())
    matrix = np.stack(columns, axis=1)
    certainty = np.hypot(_MONITOR, 0.0 if noise is None else noise) ** -1.0
    weighted = matrix * np.broadcast_to(certainty, u.shape)[:, None]
    best, *_ = np.linalg.lstsq(weighted, certainty * np.ones(len(u)))
    raw_per_dose, *bend = best[: _DEGREE + 1]
    rest = weighted @ best - certainty
    judged = (u >= _LOW) & (u <= _HIGH)
    found = Linearity(
        coefficients=tuple(float(c) for c in bend),
        raw_range=raw_range,
        reach=_BEYOND * float(u.max()),
        deviation=_largest_deviation(dose[judged], signal[judged]),
        left=0.0,
        errors=_errors(weighted, rest),
    )
    left = _largest_deviation(dose[judged], found.undo(signal)[judged])
    return found.model_copy(update={"left": left}), float(raw_per_dose)


def _errors(
    matrix: NDArray[np.float64], rest: NDArray[np.float64]
) -> tuple[tuple[float, ...], ...]:
    """Return independent errors of the bending's coefficients, by noise or scatter about the fit.

    Principal axes of their covariance (JCGM 100:2008, H.3, for a straight line).
    """
    # that the noise which is known fits better by chance makes nothing surer
    variance = max(float(rest @ rest) / (len(rest) - matrix.shape[1]), 1.0)
    # doses may be in any unit, and a pseudoinverse takes small columns for none
    size = np.linalg.norm(matrix, axis=0)
    covariance = (
        variance * np.linalg.pinv((matrix / size).T @ (matrix / size)) / np.outer(size, size)
    )
    variances, axes = np.linalg.eigh(covariance[1 : _DEGREE + 1, 1 : _DEGREE + 1])
    scaled = np.sqrt(variances.clip(0.0))[:, None] * axes.T
    return tuple(tuple(row) for row in scaled.tolist())


def slope(found: Linearity, signal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the derivative of the corrected signal, by which noise grows; shaped as `signal`."""
    grown = [(power + 1) * c for power, c in enumerate((1.0, *found.coefficients))]
    return np.asarray(np.polynomial.polynomial.polyval(signal / found.raw_range, grown))


def _largest_deviation(dose: NDArray[np.float64], signal: NDArray[np.float64]) -> float:
    """Return the largest relative deviation from the best line through zero."""
    if not len(dose):
        return 0.0
    ratio = signal / dose
    return float(np.abs(ratio / ratio.mean() - 1.0).max())

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
# levels are means, and their brightest pixels lie so much higher
_BEYOND = 1.1


def fit_linearity(
    dose: NDArray[np.float64], signal: NDArray[np.float64], raw_range: float
) -> tuple[Linearity, float]:
    """Fit the polynomial that makes signals proportional to doses.

    The relative residuals are least: k dose / s - c1 u - c2 u^2 - ... = 1, which is linear in k
    and c.

    Parameters
    ----------
    dose, signal
        Light in any unit, and raw units above dark, shape (n,), of unsaturated frames.
    raw_range
        The range in raw units.

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
    matrix = np.stack(columns, axis=1)
    (raw_per_dose, *bend), *_ = np.linalg.lstsq(matrix, np.ones(len(u)))
    rest = matrix @ [raw_per_dose, *bend] - 1.0
    judged = (u >= _LOW) & (u <= _HIGH)
    found = Linearity(
        coefficients=tuple(float(c) for c in bend),
        raw_range=raw_range,
        reach=_BEYOND * float(u.max()),
        deviation=_largest_deviation(dose[judged], signal[judged]),
        left=0.0,
        errors=_errors(matrix, rest),
    )
    left = _largest_deviation(dose[judged], found.undo(signal)[judged])
    return found.model_copy(update={"left": left}), float(raw_per_dose)


def _errors(
    matrix: NDArray[np.float64], rest: NDArray[np.float64]
) -> tuple[tuple[float, ...], ...]:
    """Return independent errors of the bending's coefficients, by the scatter about the fit.

    Principal axes of their covariance (JCGM 100:2008, H.3, for a straight line).
    """
    variance = float(rest @ rest) / (len(rest) - matrix.shape[1])
    covariance = variance * np.linalg.pinv(matrix.T @ matrix)[1:, 1:]
    variances, axes = np.linalg.eigh(covariance)
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

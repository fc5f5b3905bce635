"""Least squares: which profile of motion explains the times of some moves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from gonio.errors import DeviceFaultError
from gonio.profile import s_curve_s, trapezoid_s

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

RESOLUTION_S: Final = 0.001
"""Finer than this no clock of a driver that asks now and then tells two profiles apart."""

# an S-curve is believed when the information criterion speaks for it by as much as is called strong
_STRONG = 10.0
# onsets of the ramp from which the fit of an S-curve starts, in shares of the ramp
_ONSETS = (0.1, 0.5, 1.0)
_SPAN = 100.0
_PRECISION = 1e-10


class Profile(NamedTuple):
    """What the moves of one axis say.

    Attributes
    ----------
    latency_s, velocity_deg_s, acceleration_deg_s2, jerk_deg_s3
        Of the profile; jerk 0 for a trapezoid.
    residual_s
        Standard deviation of one move about it.
    error
        Mean relative standard uncertainty of its times.
    """

    latency_s: float
    velocity_deg_s: float
    acceleration_deg_s2: float
    jerk_deg_s3: float
    residual_s: float
    error: float

    def times(self, distance_deg: Array) -> Array:
        """Return the seconds of moves, shaped as given."""
        return _times(_packed(self), distance_deg)


def fit_profile(
    distance_deg: Array, time_s: Array, velocity_deg_s: float, acceleration_deg_s2: float
) -> Profile:
    """Fit latency, velocity and acceleration, and jerk where the times ask for it.

    Parameters
    ----------
    distance_deg, time_s
        Of each move, shape (n,), n at least 6, distances of either sign.
    velocity_deg_s, acceleration_deg_s2
        What the axis is said to do, from where the fit starts.

    Raises
    ------
    gonio.errors.DeviceFaultError
        When no profile explains them.
    """
    distance = np.abs(distance_deg)
    nominal = np.array([velocity_deg_s, acceleration_deg_s2])
    late = max(float(np.min(time_s - trapezoid_s(distance, *nominal))), 0.0)
    trapezoid = _fit(np.array([late, *nominal]), distance, time_s)
    if _squares(trapezoid[1]) <= len(distance) * RESOLUTION_S**2:
        return _profile(*trapezoid, distance)
    ramp = velocity_deg_s / acceleration_deg_s2
    starts = [np.array([late, *nominal, acceleration_deg_s2 / (s * ramp)]) for s in _ONSETS]
    s_curve = min(
        (_fit(start, distance, time_s) for start in starts), key=lambda fit: _squares(fit[1])
    )
    best = s_curve if _criterion(trapezoid) - _criterion(s_curve) > _STRONG else trapezoid
    return _profile(*best, distance)


_Fit = tuple["Array", "Array", "Array"]
"""Parameters; residuals in s; their Jacobian by latency and the others' logarithms."""


def _fit(start: Array, distance: Array, time_s: Array) -> _Fit:
    from scipy.optimize import least_squares

    x = np.concatenate([start[:1], np.log(start[1:])])
    reach = np.concatenate([[np.inf], np.full(len(x) - 1, np.log(_SPAN))])
    try:
        found = least_squares(
            lambda x: _times(_parameters(x), distance) - time_s,
            x, bounds=(np.maximum(x - reach, [0.0, *[-np.inf] * (len(x) - 1)]), x + reach),
            x_scale=0.1, ftol=_PRECISION, xtol=_PRECISION, gtol=_PRECISION,
        )  # fmt: skip
    except ValueError as error:
        raise DeviceFaultError(
            f"the moves' times fit no profile ({error}); measure again, and compare the axis' "
            "speed and acceleration in the rig file with what it does"
        ) from None
    return _parameters(found.x), np.asarray(found.fun), np.asarray(found.jac)


def _parameters(x: Array) -> Array:
    return np.concatenate([x[:1], np.exp(x[1:])])


def _times(parameters: Array, distance: Array) -> Array:
    latency, velocity, acceleration, *jerk = parameters.tolist()
    if jerk and jerk[0]:
        return np.asarray(latency + s_curve_s(distance, velocity, acceleration, jerk[0]))
    return np.asarray(latency + trapezoid_s(distance, velocity, acceleration))


def _packed(profile: Profile) -> Array:
    return np.array(profile[:4])


def _squares(residuals: Array) -> float:
    return float(residuals @ residuals)


def _criterion(fit: _Fit) -> float:
    """Return Schwarz's information criterion (1978), with residuals no finer than can be told."""
    parameters, residuals, _ = fit
    count = len(residuals)
    variance = max(_squares(residuals) / count, RESOLUTION_S**2)
    return float(count * np.log(variance) + len(parameters) * np.log(count))


def _profile(parameters: Array, residuals: Array, jacobian: Array, distance: Array) -> Profile:
    free = max(len(residuals) - len(parameters), 1)
    variance = _squares(residuals) / free
    covariance = variance * np.linalg.pinv(jacobian.T @ jacobian)
    of_times = np.sqrt(np.einsum("ij,jk,ik->i", jacobian, covariance, jacobian))
    latency, velocity, acceleration, *jerk = parameters.tolist()
    return Profile(
        latency, velocity, acceleration, jerk[0] if jerk else 0.0,
        residual_s=float(np.sqrt(variance)),
        error=float(np.mean(of_times / _times(parameters, distance))),
    )  # fmt: skip


def fit_line(way: Array, time_s: Array) -> tuple[float, float]:
    """Return the time of no way and the velocity of a motion of constant speed.

    Raises
    ------
    gonio.errors.DeviceFaultError
        When a longer way does not take longer.
    """
    slope, start_s = np.polyfit(way, time_s, 1)
    if slope <= 0:
        raise DeviceFaultError(
            "homing from further away takes no longer; check the home switch and zero_counts"
        )
    return max(float(start_s), 0.0), float(1.0 / slope)


def fit_ring_down(time_s: Array, shaking_urad: Array) -> float:
    """Return in which time a vibration falls to 1/e; 0 where too little of it is seen.

    Parameters
    ----------
    time_s, shaking_urad
        What the settle register said and when, shape (n,). It shows the peak of a window, so only
        what has fallen below its first value is of the decay.
    """
    seen = (shaking_urad > 0) & (shaking_urad < 0.9 * shaking_urad.max(initial=0))
    if seen.sum() < 3:
        return 0.0
    slope, _ = np.polyfit(time_s[seen], np.log(shaking_urad[seen]), 1)
    return float(-1.0 / slope) if slope < 0 else 0.0

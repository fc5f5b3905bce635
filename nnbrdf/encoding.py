"""How a pair of directions becomes the inputs of a network, by name."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import TWO_PI, from_spherical, half_vector, to_half_difference, to_spherical
from gonio.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Encoding = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]

_QUARTER = math.pi / 2.0
_ROUNDING = 1e-12


def encode_xyz(light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return both unit vectors, the view's x, y, z first, then the light's.

    Parameters
    ----------
    light, view
        Unit vectors, shape (n, 3) each.

    Returns
    -------
    ndarray
        Shape (n, 6), from -1 to 1. Continuous everywhere.
    """
    return np.concatenate([view, light], axis=-1)


def encode_spherical(light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return theta / 90 deg and phi / 360 deg of the view, then of the light.

    Parameters as for `encode_xyz`.

    Returns
    -------
    ndarray
        Shape (n, 4), from 0 to 1 in the upper hemisphere. Not periodic: phi's input falls from 1
        to 0 where phi passes 360 deg. At the pole phi is 0.
    """
    return np.concatenate([_scaled(view), _scaled(light)], axis=-1)


def encode_sincos(light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return sin theta, cos theta, sin phi, cos phi of the view, then of the light.

    Parameters as for `encode_xyz`.

    Returns
    -------
    ndarray
        Shape (n, 8), from -1 to 1. Periodic; at the pole alone, where phi is 0, not continuous.
    """
    return np.concatenate([_sincos(view), _sincos(light)], axis=-1)


def encode_paper_literal(
    light: NDArray[np.float64], view: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return what the formula printed in Mikes and Haindl (2023) says, view first, then light.

    x = sin(theta/180) cos(phi/180), y = sin(theta/180) sin(phi/180), z = cos(theta/180), with the
    angles in degrees and no factor pi. Theta so spans 0.5 rad and phi 2 rad of a turn, and the
    inputs jump where phi passes 360 deg: by 2 sin(1) sin(theta/180), which is 0.681 at theta
    75 deg, 20 times the step of 0.034 from one azimuth of that ring to the next.
    Parameters as for `encode_xyz`.

    Returns
    -------
    ndarray
        Shape (n, 6), from -1 to 1.
    """
    return np.concatenate([_printed(view), _printed(light)], axis=-1)


def encode_rusinkiewicz(
    light: NDArray[np.float64], view: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return theta_h / 90 deg, phi_h / 360 deg, theta_d / 90 deg, phi_d / 360 deg.

    Parameters as for `encode_xyz`; for the angles and what they are at the poles see
    `gonio.directions.to_half_difference`.

    Returns
    -------
    ndarray
        Shape (n, 4), from 0 to 1 in the upper hemisphere. Not periodic: both phi fall from 1 to
        0 at 360 deg. Not continuous where the half vector is the normal or light and view meet.
    """
    theta_h, phi_h, theta_d, phi_d = to_half_difference(light, view)
    return np.stack([theta_h / _QUARTER, _turns(phi_h), theta_d / _QUARTER, _turns(phi_d)], axis=-1)


def encode_half_difference(
    light: NDArray[np.float64], view: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the half vector's x, y, z, then the difference vector's.

    The difference vector is the light's direction where the half vector is the normal (see
    `gonio.directions.to_half_difference`). Parameters as for `encode_xyz`.

    Returns
    -------
    ndarray
        Shape (n, 6), from -1 to 1. Periodic; where the half vector is the normal the difference
        vector is not continuous.
    """
    _, _, theta_d, phi_d = to_half_difference(light, view)
    return np.concatenate([half_vector(light, view), from_spherical(theta_d, phi_d)], axis=-1)


ENCODINGS: dict[str, Encoding] = {
    "xyz": encode_xyz,
    "spherical": encode_spherical,
    "sincos": encode_sincos,
    "rusinkiewicz": encode_rusinkiewicz,
    "half-difference": encode_half_difference,
    "paper-literal": encode_paper_literal,
}
"""Each maps light and view, shapes (n, 3), to inputs, shape (n, inputs)."""

INPUTS = {
    "xyz": 6,
    "spherical": 4,
    "sincos": 8,
    "rusinkiewicz": 4,
    "half-difference": 6,
    "paper-literal": 6,
}
"""How many inputs each encoding has."""


def encoding_named(name: str) -> Encoding:
    """Return the encoding of a name.

    Raises
    ------
    gonio.errors.BadInputError
        For an unknown name, listing the known.
    """
    if name not in ENCODINGS:
        raise BadInputError(f"encoding {name!r} is not known; use {', '.join(ENCODINGS)}")
    return ENCODINGS[name]


def _scaled(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    theta, phi = to_spherical(direction)
    return np.stack([theta / _QUARTER, _turns(phi)], axis=-1)


def _sincos(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    theta, phi = to_spherical(direction)
    return np.stack([np.sin(theta), np.cos(theta), np.sin(phi), np.cos(phi)], axis=-1)


def _printed(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    theta, phi = to_spherical(direction)
    return from_spherical(np.degrees(theta) / 180.0, 360.0 * _turns(phi) / 180.0)


def _turns(phi: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return an azimuth as part of a turn, in [0, 1)."""
    turns = phi / TWO_PI
    # a plane of symmetry computed to rounding must not land on both ends of the scale
    return np.where(turns > 1.0 - _ROUNDING, 0.0, turns)

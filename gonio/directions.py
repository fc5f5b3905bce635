"""Directions and their coordinates.

A direction is a float64 unit vector, shape (..., 3), pointing away from the sample: +z is the
sample's normal, +x its marked edge. Angles are radians here; names that end in `_deg` are what
people read and type.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

RINGS_81: tuple[tuple[float, int], ...] = ((0, 1), (15, 6), (30, 12), (45, 18), (60, 20), (75, 24))
"""Theta in degrees and number of azimuths of each ring (Mikes and Haindl 2023)."""

TWO_PI = 2.0 * math.pi


def from_spherical(theta: ArrayLike, phi: ArrayLike) -> NDArray[np.float64]:
    """Return unit vectors, shape (..., 3), for polar angle `theta` and azimuth `phi` in radians."""
    theta, phi = np.broadcast_arrays(np.asarray(theta, np.float64), np.asarray(phi, np.float64))
    sin_theta = np.sin(theta)
    return np.stack([sin_theta * np.cos(phi), sin_theta * np.sin(phi), np.cos(theta)], axis=-1)


def to_spherical(direction: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return theta in [0, pi] and phi in [0, 2 pi), in radians.

    At the poles, where phi is undefined, it is 0. Theta comes from an arctangent, so it keeps
    its precision near the poles, where an arccosine would lose half the digits.
    """
    x, y, z = np.moveaxis(np.asarray(direction, np.float64), -1, 0)
    theta = np.arctan2(np.hypot(x, y), z)
    phi = np.arctan2(y, x) % TWO_PI
    at_pole = (x == 0) & (y == 0)
    # a tiny negative angle modulo 2 pi rounds up to 2 pi itself
    return theta, np.where(at_pole | (phi >= TWO_PI), 0.0, phi)


def from_degrees(theta_deg: ArrayLike, phi_deg: ArrayLike) -> NDArray[np.float64]:
    """Return unit vectors for angles in degrees, of the upper hemisphere only.

    Raises
    ------
    BadInputError
        For an angle that is not finite, or theta outside [0, 90] deg.
    """
    theta_deg, phi_deg = np.asarray(theta_deg, np.float64), np.asarray(phi_deg, np.float64)
    check_theta_deg(theta_deg)
    if not np.isfinite(phi_deg).all():
        raise BadInputError("phi is not finite; give degrees from the sample's marked edge")
    return from_spherical(np.radians(theta_deg), np.radians(phi_deg))


def to_degrees(direction: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return theta and phi in degrees (see `to_spherical`)."""
    theta, phi = to_spherical(direction)
    return np.degrees(theta), np.degrees(phi)


def check_theta_deg(theta_deg: ArrayLike) -> None:
    """Refuse polar angles that reflection does not have.

    Raises
    ------
    BadInputError
        For theta above 90 deg (transmission), below 0 or not finite.
    """
    theta_deg = np.asarray(theta_deg, np.float64)
    if not np.isfinite(theta_deg).all():
        raise BadInputError("theta is not finite; give degrees from the sample's normal")
    if (theta_deg > 90).any():
        raise BadInputError(
            f"theta {theta_deg.max():g} deg is beyond 90 deg, behind the sample: that would be "
            "transmission, which gonio does not measure; use 0 to 90 deg"
        )
    if (theta_deg < 0).any():
        raise BadInputError(f"theta {theta_deg.min():g} deg is negative; use 0 to 90 deg")


def normalize(vector: ArrayLike) -> NDArray[np.float64]:
    """Return `vector`, shape (..., 3), scaled to unit length; a null vector stays null."""
    vector = np.asarray(vector, np.float64)
    length = np.linalg.norm(vector, axis=-1, keepdims=True)
    return vector / np.where(length > 0, length, 1.0)


def half_vector(light: ArrayLike, view: ArrayLike) -> NDArray[np.float64]:
    """Return the unit half vector, shape (..., 3).

    Of opposite directions, which have none, it is the normal +z: the limit within the plane of
    incidence.
    """
    total = np.asarray(light, np.float64) + np.asarray(view, np.float64)
    opposite = np.linalg.norm(total, axis=-1, keepdims=True) < 1e-12
    return normalize(np.where(opposite, [0.0, 0.0, 1.0], total))


def to_half_difference(
    light: ArrayLike, view: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return Rusinkiewicz's angles theta_h, phi_h, theta_d, phi_d in radians.

    The half vector is turned onto the normal, about z by -phi_h and then about y by -theta_h; the
    difference vector is the light's direction in that frame (Rusinkiewicz 1998, section 3).
    Exchanging light and view turns phi_d by pi and changes nothing else.

    Where the half vector is the normal, but for rounding, phi_h is 0 and phi_d the light's
    azimuth. Where light and view coincide, theta_d and phi_d are 0.
    """
    light = np.asarray(light, np.float64)
    theta_h, phi_h = to_spherical(half_vector(light, view))
    # computed mirror pairs miss the normal by 1e-16, and their phi_h would be that of the rounding
    phi_h = np.where(theta_h < 1e-12, 0.0, phi_h)
    theta_d, phi_d = to_spherical(_turn_y(_turn_z(light, -phi_h), -theta_h))
    coincide = np.all(light == np.asarray(view, np.float64), axis=-1)
    return theta_h, phi_h, np.where(coincide, 0.0, theta_d), np.where(coincide, 0.0, phi_d)


def from_half_difference(
    theta_h: ArrayLike, phi_h: ArrayLike, theta_d: ArrayLike, phi_d: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return light and view, the inverse of `to_half_difference`.

    Both may lie below the horizon: not every combination of angles is a pair of the hemisphere.
    """
    theta_h, phi_h = np.asarray(theta_h, np.float64), np.asarray(phi_h, np.float64)
    difference = from_spherical(theta_d, phi_d)
    light = _turn_z(_turn_y(difference, theta_h), phi_h)
    half = from_spherical(theta_h, phi_h)
    cosine = np.sum(light * half, axis=-1, keepdims=True)
    return light, normalize(2.0 * cosine * half - light)


def paper_directions() -> NDArray[np.float64]:
    """Return the 81 directions of the paper, shape (81, 3), from the pole outwards."""
    theta_deg, phi_deg = paper_angles_deg()
    return from_degrees(theta_deg, phi_deg)


def paper_angles_deg() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return theta and phi of the 81 directions in degrees, shape (81,) each."""
    return ring_angles_deg(RINGS_81)


def ring_angles_deg(
    rings: Sequence[tuple[float, int]],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return theta and phi in degrees, shape (n,) each, of rings of (theta, number of azimuths)."""
    theta = [np.full(count, ring) for ring, count in rings]
    phi = [np.arange(count) * 360.0 / count for _, count in rings]
    return np.concatenate(theta).astype(np.float64), np.concatenate(phi)


def _turn_z(vector: NDArray[np.float64], angle: NDArray[np.float64]) -> NDArray[np.float64]:
    cos, sin = np.cos(angle), np.sin(angle)
    x, y, z = np.moveaxis(vector, -1, 0)
    return np.stack(np.broadcast_arrays(cos * x - sin * y, sin * x + cos * y, z), axis=-1)


def _turn_y(vector: NDArray[np.float64], angle: NDArray[np.float64]) -> NDArray[np.float64]:
    cos, sin = np.cos(angle), np.sin(angle)
    x, y, z = np.moveaxis(vector, -1, 0)
    return np.stack(np.broadcast_arrays(cos * x + sin * z, y, cos * z - sin * x), axis=-1)

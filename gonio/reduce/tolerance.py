"""How an axis off its angle, or a sample off its seat, shows in a BRDF value."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import from_spherical, normalize, to_spherical

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.protocols import Material

    Array = NDArray[np.float64]

# about the horizon no model means much, and the cosine's own relative error has no bound
_LOWEST = np.cos(np.radians(89.5))
_LOBE_RAD = np.radians(10.0)


def axis_effects(material: Material, arms_rad: Array, angle_rad: float) -> Array:
    """Return by how much values err, relative, when one axis stands `angle_rad` off its encoder.

    What is measured is f(true light, true view) x cosine(true light); what is made of it divides by
    the cosine of the light as told. So the light's theta tells through the slope of ln f plus
    -tan(theta). Central differences over the angle itself: the mean slope within it (JCGM 100:2008,
    5.1.3, note 2).

    Parameters
    ----------
    material
        A fit to the samples.
    arms_rad
        Theta and phi of light and view by the encoders, shape (n, 4).
    angle_rad
        How far off.

    Returns
    -------
    ndarray
        Shape (4, n, 3): light theta, light phi, view theta, view phi.
    """
    told = _directions(arms_rad)
    ends = [
        [_relative(material, told, _directions(arms_rad + sign * step)) for sign in (1.0, -1.0)]
        for step in angle_rad * np.eye(4)
    ]
    return np.array([(high - low) / 2.0 for high, low in ends])


def missed_effects(scatter: Array, arms_rad: Array, angle_rad: float) -> Array:
    """Return by how much values err, relative, through slopes that the fit does not have.

    What scatters about the fit is taken to change within 10 deg, as lobes of cloth and varnish do.

    Parameters
    ----------
    scatter
        Of ln f about the fit, shape (3,).
    arms_rad, angle_rad
        As `axis_effects` has them.

    Returns
    -------
    ndarray
        Shape (4, n, 3), as of `axis_effects`.
    """
    # near the pole an azimuth moves the arm's end little
    reach = np.stack([np.ones(len(arms_rad)), np.sin(arms_rad[:, 0])] * 2)
    reach[3] = np.sin(arms_rad[:, 2])
    return np.asarray(angle_rad / _LOBE_RAD * reach[..., None] * scatter)


def seat_effects(
    material: Material,
    light: Array,
    view: Array,
    *,
    tilt_rad: float,
    height_mm: float,
    distance_mm: float,
) -> Array:
    """Return by how much values err, relative, for a sample that is tilted or too high.

    A tilt turns light and view alike, as the sample sees them. A higher face lies nearer to the
    lamps, and the camera's middle ray meets it aside of the centre.

    Returns
    -------
    ndarray
        Shape (3, n, 3): tilts about +x and +y, height.
    """
    unmoved = light, view
    turned = [
        _relative(
            material, unmoved, (_turned(light, axis, tilt_rad), _turned(view, axis, tilt_rad))
        )
        for axis in (0, 1)
    ]
    seen = height_mm * view / view[:, 2:].clip(_LOWEST)
    to_lamps = distance_mm * light - seen
    inverse_square = distance_mm**2 / (to_lamps**2).sum(axis=1, keepdims=True)
    nearer = _relative(material, unmoved, (normalize(to_lamps), view))
    return np.array([*turned, (1.0 + nearer) * inverse_square - 1.0])


def _relative(material: Material, told: tuple[Array, Array], true: tuple[Array, Array]) -> Array:
    """Return what the true directions send over what those told would, less one, shape (n, 3)."""
    sent, foretold = (
        material.evaluate(_above(light), _above(view)) * light[:, 2:].clip(_LOWEST)
        for light, view in (true, told)
    )
    ratio = np.divide(sent, foretold, out=np.ones_like(sent), where=foretold > 0)
    return np.asarray(ratio - 1.0)


def _directions(arms_rad: Array) -> tuple[Array, Array]:
    light_theta, light_phi, view_theta, view_phi = arms_rad.T
    return from_spherical(light_theta, light_phi), from_spherical(view_theta, view_phi)


def _above(direction: Array) -> Array:
    """Return the directions, those about the horizon or below lifted above it."""
    theta, phi = to_spherical(direction)
    return from_spherical(np.minimum(theta, np.arccos(_LOWEST)), phi)


def _turned(direction: Array, axis: int, angle_rad: float) -> Array:
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_rotvec(angle_rad * np.eye(3)[axis]).apply(direction))

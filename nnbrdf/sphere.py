"""A material on a sphere, the picture by which people know it again."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import from_degrees, normalize

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from gonio.protocols import Material

_PASSES = 3
_SOFTBOX_HALF_WIDTH = 0.07
_FILL = 0.15
_FILL_FROM = from_degrees(75.0, -20.0)


def shade_sphere(material: Material, size_px: int) -> NDArray[np.float64]:
    """Render a sphere under a softbox from the upper left and a weak light from the right.

    The marked edge (+x, the grain) runs along the sphere's circles of latitude, left to right. A
    white diffuser facing the softbox comes out as 1.

    Parameters
    ----------
    material
        What it is made of.
    size_px
        Side of the square picture.

    Returns
    -------
    ndarray
        Linear RGB, shape (size_px, size_px, 3), before black (see `sphere_cover`).
    """
    color = np.zeros((size_px**2, 3))
    for rays in sphere_rays(size_px):
        color[rays.pixel] += rays.weight[:, None] * material.evaluate(rays.light, rays.view)
    return color.reshape(size_px, size_px, 3)


@dataclass(frozen=True)
class Rays:
    """What one look at the sphere sees of one light: at most one ray a pixel.

    Attributes
    ----------
    pixel
        Where it falls, counted along the rows of the picture, shape (n,).
    light, view
        Unit vectors in the frame of the surface it comes from, shape (n, 3) each.
    weight
        What to multiply the BRDF by: cosine of incidence, strength of the light and share of the
        pixel, shape (n,).
    """

    pixel: NDArray[np.int64]
    light: NDArray[np.float64]
    view: NDArray[np.float64]
    weight: NDArray[np.float64]


def sphere_rays(size_px: int) -> Iterator[Rays]:
    """Yield all that the picture of `shade_sphere` is the sum of."""
    places = _places()
    # each place in the pixel sees another place of the softbox: antialiasing and area light in one
    for (x, y), light in zip(places, _softbox(len(places)), strict=True):
        normal, inside = _sphere_normals(size_px, x, y)
        pixel, frame = np.flatnonzero(inside), _surface_frames(normal)
        yield _rays_of(light, np.pi / len(places), pixel, frame)
        yield _rays_of(_FILL_FROM, _FILL * np.pi / len(places), pixel, frame)


def sphere_cover(size_px: int) -> NDArray[np.float64]:
    """Return how much of each pixel the sphere covers, 0 to 1, shape (size_px, size_px)."""
    cover = np.mean([_sphere_normals(size_px, x, y)[1] for x, y in _places()], axis=0)
    return np.asarray(cover)


def tone_map(linear: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return 8-bit sRGB (IEC 61966-2-1), highlights rolled off rather than clipped."""
    knee = 0.6
    excess = np.clip(linear - knee, 0.0, None) / (1.0 - knee)
    rolled = np.where(linear > knee, knee + (1.0 - knee) * (1.0 - np.exp(-excess)), linear)
    return np.round(255.0 * encode_srgb(rolled)).astype(np.uint8)


def encode_srgb(linear: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return sRGB from 0 to 1 (IEC 61966-2-1), clipped there, of linear values."""
    clipped = np.clip(linear, 0.0, 1.0)
    bright = 1.055 * np.maximum(clipped, 0.0031308) ** (1.0 / 2.4) - 0.055
    return np.where(clipped <= 0.0031308, 12.92 * clipped, bright)


def _places() -> list[tuple[float, float]]:
    """Return where in a pixel its passes look, from its upper left corner, in pixels."""
    steps = (np.arange(_PASSES) + 0.5) / _PASSES
    return [(float(x), float(y)) for x in steps for y in steps]


def _sphere_normals(size: int, x: float, y: float) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return normals at place (x, y) of each pixel of the sphere, shape (n, 3), and which pixels.

    Normals are x right, y up, z towards the eye.
    """
    right, up = np.meshgrid(
        (np.arange(size) + x) / size * 2.0 - 1.0, 1.0 - (np.arange(size) + y) / size * 2.0
    )
    depth = 1.0 - right**2 - up**2
    inside = depth > 0
    return np.stack([right, up, np.sqrt(np.abs(depth))], axis=-1)[inside], inside


def _rays_of(
    direction: NDArray[np.float64],
    strength: float,
    pixel: NDArray[np.int64],
    frame: NDArray[np.float64],
) -> Rays:
    """Return the rays of the pixels that a light reaches, of all those on the sphere."""
    light = frame @ direction
    lit = light[:, 2] > 0
    return Rays(pixel[lit], light[lit], frame[lit, :, 2], strength * light[lit, 2])


def _surface_frames(normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rows tangent, bitangent, normal, shape (n, 3, 3); the tangent is horizontal."""
    tangent = normalize(np.cross([0.0, 1.0, 0.0], normal))
    return np.stack([tangent, np.cross(normal, tangent), normal], axis=1)


def _softbox(count: int) -> list[NDArray[np.float64]]:
    """Return `count` directions over the softbox, in an order unlike that of the pixel's places.

    The eye is at +z, so polar angles count from the eye.
    """
    centre = from_degrees(48.0, 130.0)
    right = normalize(np.cross([0.0, 1.0, 0.0], centre))
    up = np.cross(centre, right)
    steps = np.linspace(-_SOFTBOX_HALF_WIDTH, _SOFTBOX_HALF_WIDTH, math.isqrt(count))
    box = [normalize(centre + x * right + y * up) for x in steps for y in steps]
    return [box[i] for i in np.random.default_rng(0).permutation(count)]

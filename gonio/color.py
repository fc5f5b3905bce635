"""Color spaces that the instrument, its twin and its reports must agree on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from gonio.protocols import Material

D65: Final = np.array([0.9504700, 1.0000001, 1.0888300])
"""XYZ of sRGB's white: the row sums of `XYZ_FROM_SRGB`."""

D50: Final = np.array([0.96422, 1.0, 0.82521])
"""XYZ of the profile connection space's white (ICC.1:2022, 7.2.16)."""

ACES_WHITE: Final = np.array([0.32168 / 0.33767, 1.0, 0.34065 / 0.33767])
"""XYZ of the white of ACES, x = 0.32168, y = 0.33767 (SMPTE ST 2065-1)."""

XYZ_FROM_SRGB: Final = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)
"""Linear sRGB to CIE XYZ under D65 (primaries and white of IEC 61966-2-1)."""

_AP1 = ((0.713, 0.293), (0.165, 0.830), (0.128, 0.044))
_CONES: Final = np.array(
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]
)
_CIE_KAPPA, _CIE_EPSILON = 24389.0 / 27.0, 216.0 / 24389.0


def adaptation(white: ArrayLike, to: ArrayLike) -> NDArray[np.float64]:
    """Return the matrix that adapts XYZ from one white to another, shape (3, 3).

    Bradford's, linear, complete (ICC.1:2022, annex E).
    """
    ratio = (_CONES @ np.asarray(to)) / (_CONES @ np.asarray(white))
    adapted: NDArray[np.float64] = np.linalg.inv(_CONES) @ np.diag(ratio) @ _CONES
    return adapted


def _xyz_from_rgb(
    primaries: tuple[tuple[float, float], ...], white: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the matrix of primaries, as x and y, whose sum is white (SMPTE RP 177)."""
    columns = np.array([[x / y, 1.0, (1.0 - x - y) / y] for x, y in primaries]).T
    matrix: NDArray[np.float64] = columns * np.linalg.solve(columns, white)
    return matrix


def lab_from_xyz(xyz: ArrayLike, white: ArrayLike) -> NDArray[np.float64]:
    """Return CIELAB (ISO/CIE 11664-4), shape (..., 3) as given."""
    ratio = np.asarray(xyz, np.float64) / np.asarray(white)
    root = np.where(ratio > _CIE_EPSILON, np.cbrt(ratio), (_CIE_KAPPA * ratio + 16.0) / 116.0)
    x, y, z = np.moveaxis(root, -1, 0)
    return np.stack([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)], axis=-1)


def xyz_from_lab(lab: ArrayLike, white: ArrayLike) -> NDArray[np.float64]:
    """Return the inverse of `lab_from_xyz`."""
    lightness, a, b = np.moveaxis(np.asarray(lab, np.float64), -1, 0)
    y = (lightness + 16.0) / 116.0
    root = np.stack([y + a / 500.0, y, y - b / 200.0], axis=-1)
    ratio = np.where(root**3 > _CIE_EPSILON, root**3, (116.0 * root - 16.0) / _CIE_KAPPA)
    return np.asarray(ratio * np.asarray(white))


@dataclass(frozen=True)
class Space:
    """A color space of three linear channels.

    Attributes
    ----------
    name
        As files state it.
    from_srgb
        From linear sRGB, adapted to its own white, shape (3, 3).
    channels
        Their names.
    """

    name: str
    from_srgb: NDArray[np.float64]
    channels: tuple[str, ...] = ("r", "g", "b")

    @property
    def white(self) -> NDArray[np.float64]:
        """What a perfect diffuser's factor of one is in it, shape (3,)."""
        return np.asarray(self.from_srgb.sum(axis=1))


SRGB: Final = "linear sRGB"
CAMERA: Final = "camera RGB"
LUMINANCE: Final = "luminance"

SPACES: Final = {
    "linear-srgb": Space(SRGB, np.eye(3)),
    "xyz": Space("XYZ D65", XYZ_FROM_SRGB, ("X", "Y", "Z")),
    "acescg": Space(
        "ACEScg",
        np.linalg.inv(_xyz_from_rgb(_AP1, ACES_WHITE))
        @ adaptation(XYZ_FROM_SRGB.sum(axis=1), ACES_WHITE)
        @ XYZ_FROM_SRGB,
    ),
}
"""By what the command line calls them; the camera's own channels are no such space."""


@dataclass(frozen=True)
class InSpace:
    """A material seen in other channels: `matrix`, shape (3, 3), is from its own to those."""

    material: Material
    matrix: NDArray[np.float64]

    def evaluate(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the BRDF in the other channels (see `gonio.protocols.Material`)."""
        return np.asarray(self.material.evaluate(light, view) @ self.matrix.T)


def srgb_from(color_space: str) -> NDArray[np.float64] | None:
    """Return the matrix to linear sRGB from a space as files state it, shape (3, 3).

    None for one that says nothing of how it looks, such as the camera's own channels.
    """
    for space in SPACES.values():
        if space.name == color_space:
            return np.asarray(np.linalg.inv(space.from_srgb))
    return None

"""How different two colors look."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.color import D65, lab_from_xyz

if TYPE_CHECKING:
    from numpy.typing import NDArray

_FAR = 25.0**7


def delta_e_2000(xyz: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the CIEDE2000 differences of colors under D65, shape (..., 3) to (...).

    ISO/CIE 11664-6, all parametric factors 1, as Sharma, Wu and Dalal (2005) write it out.
    """
    (l1, a1, b1), (l2, a2, b2) = (
        np.moveaxis(lab_from_xyz(each, D65), -1, 0) for each in (xyz, other)
    )
    chroma = (np.hypot(a1, b1) + np.hypot(a2, b2)) / 2.0
    redder = 1.5 - 0.5 * np.sqrt(chroma**7 / (chroma**7 + _FAR))
    c1, c2 = np.hypot(redder * a1, b1), np.hypot(redder * a2, b2)
    h1, h2 = (_hue_deg(redder * a, b) for a, b in ((a1, b1), (a2, b2)))
    grey = c1 * c2 == 0
    turn = np.where(grey, 0.0, (h2 - h1 + 180.0) % 360.0 - 180.0)
    hue = np.where(grey, h1 + h2, h1 + turn / 2.0)
    light, chroma = (l1 + l2) / 2.0, (c1 + c2) / 2.0
    from_middle = (light - 50.0) ** 2
    by_light = (l2 - l1) / (1.0 + 0.015 * from_middle / np.sqrt(20.0 + from_middle))
    by_chroma = (c2 - c1) / (1.0 + 0.045 * chroma)
    across = 2.0 * np.sqrt(c1 * c2) * np.sin(np.radians(turn) / 2.0)
    by_hue = across / (1.0 + 0.015 * chroma * _hue_weight(hue))
    square = by_light**2 + by_chroma**2 + by_hue**2 + _blues(hue, chroma) * by_chroma * by_hue
    return np.asarray(np.sqrt(square.clip(0.0)))


def _hue_deg(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.degrees(np.arctan2(b, a)) % 360.0)


def _hue_weight(hue_deg: NDArray[np.float64]) -> NDArray[np.float64]:
    def wave(times: float, less_deg: float) -> NDArray[np.float64]:
        return np.asarray(np.cos(np.radians(times * hue_deg - less_deg)))

    weight = 1.0 - 0.17 * wave(1.0, 30.0) + 0.24 * wave(2.0, 0.0)
    return np.asarray(weight + 0.32 * wave(3.0, -6.0) - 0.20 * wave(4.0, 63.0))


def _blues(hue_deg: NDArray[np.float64], chroma: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how much chroma and hue turn into each other, which they do in blue alone."""
    turn = 30.0 * np.exp(-((((hue_deg % 360.0) - 275.0) / 25.0) ** 2))
    strength = 2.0 * np.sqrt(chroma**7 / (chroma**7 + _FAR))
    return np.asarray(-np.sin(np.radians(2.0 * turn)) * strength)

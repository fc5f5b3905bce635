"""The twin's sensor: how linear sRGB becomes electrons, and electrons raw values."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.color import XYZ_FROM_SRGB

if TYPE_CHECKING:
    from numpy.typing import NDArray

CFA: Final = "RGGB"
BLACK_LEVEL: Final = 1024
WHITE_LEVEL: Final = 65535
FULL_WELL_E: Final = 60_000.0
READ_NOISE_E: Final = 3.0
GAIN: Final = (WHITE_LEVEL - BLACK_LEVEL) / FULL_WELL_E
"""Raw units per electron: the well is full at WhiteLevel."""

ELECTRONS_PER_S: Final = 1.731e5
"""Electrons a second in a green pixel for linear sRGB (1, 1, 1) W/sr/m2.

Chosen so that the white reference (factor 0.99) under all eleven lamps at 2 m fills half the well
in 0.2 s.
"""

CAMERA_NEUTRAL: Final = np.array([0.55, 1.0, 0.65])
"""Camera RGB of a neutral patch: the channels' unequal sensitivities."""

CAMERA_FROM_SRGB: Final = CAMERA_NEUTRAL[:, None] * np.array(
    [[0.50, 0.30, 0.20], [0.20, 0.65, 0.15], [0.16, 0.34, 0.50]]
)
"""Linear sRGB to camera RGB: every filter lets much of its neighbors' light through."""

CAMERA_FROM_XYZ: Final = CAMERA_FROM_SRGB @ np.linalg.inv(XYZ_FROM_SRGB)
"""ColorMatrix1."""

# beyond this the pixel is full whatever the noise, and NumPy's Poisson has a limit of its own
_SURELY_FULL_E = 20.0 * FULL_WELL_E


def keyed_generator(seed: int, key: str) -> np.random.Generator:
    """Return the generator of one frame's noise: the same for a key, in whatever order."""
    digest = hashlib.sha256(key.encode()).digest()
    return np.random.default_rng([seed, int.from_bytes(digest, "big")])


def true_exposure_s(exposure_s: float, random: np.random.Generator) -> float:
    """Return how long the shutter was open: within 0.5 % of the request, up to 50 us late."""
    return exposure_s * (1.0 + random.uniform(-0.005, 0.005)) + random.uniform(0.0, 50e-6)


def mosaic(srgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return what each pixel's filter passes of linear sRGB, shapes (h, w, 3) to (h, w)."""
    seen = np.empty(srgb.shape[:2])
    for place, color in enumerate(CFA):
        cell = np.s_[place // 2 :: 2, place % 2 :: 2]
        seen[cell] = srgb[cell] @ CAMERA_FROM_SRGB["RGB".index(color)]
    return seen


def count(mean_electrons: NDArray[np.float64], random: np.random.Generator) -> NDArray[np.float64]:
    """Return how many electrons there truly were, with shot noise; shape as given."""
    return random.poisson(np.clip(mean_electrons, 0.0, _SURELY_FULL_E)).astype(np.float64)


def read_out(
    electrons: NDArray[np.float64], random: np.random.Generator, end: float = 1.0
) -> NDArray[np.uint16]:
    """Return raw values, with read noise, clipped at a share of the range; shape as given."""
    noisy = electrons + READ_NOISE_E * random.standard_normal(electrons.shape)
    raw = np.round(BLACK_LEVEL + GAIN * noisy)
    highest = np.round(BLACK_LEVEL + end * (WHITE_LEVEL - BLACK_LEVEL))
    return np.clip(raw, 0, highest).astype(np.uint16)

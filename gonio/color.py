"""Color spaces that the instrument and its twin must agree on."""

from __future__ import annotations

from typing import Final

import numpy as np

XYZ_FROM_SRGB: Final = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)
"""Linear sRGB to CIE XYZ under D65 (primaries and white of IEC 61966-2-1)."""

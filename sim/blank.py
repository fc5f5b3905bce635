"""A camera that sees nothing, quickly: its files are whole and hardly have pixels."""

from __future__ import annotations

import hashlib
from functools import cache
from typing import Any

import numpy as np

from sim import sensor
from sim.dng import dng_bytes

_SIDE = 16
_NO_ID = "0" * 32


class BlankCamera:
    """Takes the exposures of a rehearsal, as black frames of 16 x 16 pixels.

    Parameters
    ----------
    seed
        Of the frames' unique ids.
    """

    def __init__(self, seed: int) -> None:
        self._seed = seed

    def frame(self, *, exposure_s: float, key: str, **_: Any) -> bytes:
        """Return a whole DNG (see `sim.tether.Camera`)."""
        unique_id = hashlib.sha256(f"{self._seed}/{key}".encode()).hexdigest()[:32]
        return _blank(exposure_s).replace(_NO_ID.encode(), unique_id.encode())


@cache
def _blank(exposure_s: float) -> bytes:
    return dng_bytes(
        np.full((_SIDE, _SIDE), sensor.BLACK_LEVEL, np.uint16),
        cfa=sensor.CFA,
        black=sensor.BLACK_LEVEL,
        white=sensor.WHITE_LEVEL,
        exposure_s=exposure_s,
        iso=100,
        color_matrix=sensor.CAMERA_FROM_XYZ,
        as_shot_neutral=sensor.CAMERA_NEUTRAL,
        camera_model="gonio rehearsal, no picture",
        unique_id=_NO_ID,
    )

"""Whole raw files of 8 x 8 pixels, one like no other, and a camera for twins that makes them."""

import numpy as np

from sim.dng import dng_bytes


def tiny_dng(number, exposure_s):
    """Return a file; `number` is in its pixels and its unique id, and all are of one size."""
    return dng_bytes(
        np.arange(number, number + 64).astype(np.uint16).reshape(8, 8),
        black=0,
        white=65535,
        exposure_s=exposure_s,
        iso=100,
        color_matrix=np.eye(3),
        as_shot_neutral=np.ones(3),
        camera_model="test",
        unique_id=f"{number:032x}",
    )


class TinyCamera:
    """A `sim.tether.Camera`; `data`, where a test sets it, is what every file is."""

    def __init__(self):
        self.data = None
        self.count = 0

    def frame(self, *, exposure_s, **scene):
        self.count += 1
        return self.data if self.data is not None else tiny_dng(self.count, exposure_s)

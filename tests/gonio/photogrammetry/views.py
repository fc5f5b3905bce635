"""Views of the board without pictures: corners where a camera would find them."""

import math

import numpy as np

from gonio.board import SQUARES, corner_points_mm
from gonio.camera import Camera
from gonio.photogrammetry.detection import BoardView
from gonio.rig import default_rig

FINE = default_rig().camera.model_copy(
    update={"width": 2000, "height": 2000, "focal_px": 28000.0, "centre_px": (999.5, 999.5)}
)
"""14 px/mm: a marker's module is 14 px from above, and 7 px at 60 deg."""

POSES_DEG = [(0.0, phi) for phi in (0.0, 90.0)] + [
    (theta, phi + theta) for theta in (20.0, 40.0, 60.0) for phi in range(0, 300, 60)
]
"""Seventeen."""


def corners_seen(spec, alignment, poses_deg=POSES_DEG, *, sigma_px=0.02, off_deg=0.0, seed=0):
    """Return views with noise; each arm stops `off_deg` (one sd) from where its encoders say."""
    random = np.random.default_rng(seed)
    ids = np.arange((SQUARES - 1) ** 2)
    views = []
    for pose in poses_deg:
        true = alignment.pose(*(np.array(pose) + off_deg * random.standard_normal(2)))
        pixels = Camera(spec).project(corner_points_mm(ids), true)
        pixels += sigma_px * random.standard_normal(pixels.shape)
        inside = ((pixels > 2) & (pixels < (spec.width - 3, spec.height - 3))).all(axis=1)
        views.append(BoardView(*map(math.radians, pose), ids[inside], pixels[inside]))
    return views

"""The pose of one shot: by the encoders, and better by the board where it is seen."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.alignment import AlignedPose
from gonio.photogrammetry.adjustment import LEAST_CORNERS
from gonio.photogrammetry.model import ENCODER_DEG

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.geometry import ArmPose
    from gonio.photogrammetry.detection import BoardView
    from gonio.photogrammetry.geometry_file import Geometry
    from gonio.rig import CameraSpec

CORNER_PX: Final = 0.05
"""What corners are found to at an oblique view; most of it is one and the same in neighbours."""

# corners farther off than this are of something else, or of a board that was moved
_STRANGE_PX = 1.0


def refined_pose(geometry: Geometry, spec: CameraSpec, view: BoardView) -> ArmPose:
    """Return the most likely pose by encoders and board together.

    Where fewer than twelve corners are seen, or they contradict the geometry by more than a pixel,
    it is that of the encoders and the alignment.

    Parameters
    ----------
    geometry
        Camera and view arm.
    spec
        The camera by the rig file.
    view
        What the shot shows of the board, which may be nothing.
    """
    by_encoders = AlignedPose(view.theta, view.phi, geometry.view)
    if len(view.ids) < LEAST_CORNERS:
        return by_encoders
    from scipy.optimize import least_squares

    camera, points, sigma = geometry.camera(spec), view.points_mm, float(np.radians(ENCODER_DEG))

    def pose(off: NDArray[np.float64]) -> AlignedPose:
        theta, phi = (sigma * off).tolist()
        return AlignedPose(view.theta + theta, view.phi + phi, geometry.view)

    def errors_px(off: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(camera.project(points, pose(off)) - view.pixels)

    def residuals(off: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.concatenate([errors_px(off).ravel() / CORNER_PX, off])

    # angles off by one sigma of the encoder are 1 here, so that steps are of a fit size
    found = least_squares(residuals, np.zeros(2), loss="soft_l1", diff_step=1e-4)
    if np.median(np.abs(errors_px(found.x))) > _STRANGE_PX:
        return by_encoders
    return pose(found.x)

"""Stray light: what the camera sees beside the board, where nothing is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.board import BOARD_SIDE_MM
from gonio.calibration import StrayLight
from gonio.camera import Camera

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.geometry import ArmPose
    from gonio.rig import CameraSpec

    Array = NDArray[np.float64]

# a halo about what is bright ends before that, as a share of the frame's width
_AWAY: Final = 0.15
_FEWEST: Final = 100


def dark_room(spec: CameraSpec, view: ArmPose) -> NDArray[np.bool_]:
    """Return which pixels look past the board by 15 % of the frame's width, shape (height, width).

    None does where the board fills the picture.
    """
    from scipy.ndimage import distance_transform_edt

    points = Camera(spec).plane_points(view)
    # a ray that misses the plane is NaN, which is on no board
    board = (np.abs(points[..., :2]) <= BOARD_SIDE_MM / 2.0).all(axis=-1)
    away: NDArray[np.bool_] = distance_transform_edt(~board) > _AWAY * spec.width
    return away & bool(board.any())


def stray_light_of(
    signals: Sequence[Array], room: NDArray[np.bool_], channel: NDArray[np.intp]
) -> StrayLight | None:
    """Return the share of all light that is spread evenly over the frame.

    Veiling glare g makes (1 - g) image + g mean of an image (ISO 9358:1994, whose black area the
    dark room is), channel by channel: so g is what pixels say that see nothing, over the mean of
    all. Light that the room does send back counts with it.

    Parameters
    ----------
    signals
        Frames above dark and linear, each of shape (height, width).
    room
        As from `dark_room`.
    channel
        0, 1 or 2 for each pixel's filter, shape (height, width).

    Returns
    -------
    StrayLight or None
        Sigma is by the scatter over frames and channels; None where too few pixels see the room.
    """
    masks = [channel == each for each in range(3)]
    if min(int((room & mask).sum()) for mask in masks) < _FEWEST:
        return None
    shares = np.array([s[room & mask].mean() / s[mask].mean() for s in signals for mask in masks])
    sigma = float(shares.std(ddof=1) / np.sqrt(len(shares)))
    return StrayLight(share=max(float(shares.mean()), 0.0), sigma=sigma)

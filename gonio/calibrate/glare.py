"""Stray light: what the camera sees beside the board, where nothing is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.board import BOARD_SIDE_MM
from gonio.calibrate.halo import halo_of
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


def away_from_board_px(spec: CameraSpec, view: ArmPose) -> Array:
    """Return by how many pixels each pixel looks past the board, shape (height, width).

    0 on it, and everywhere where it is not seen.
    """
    from scipy.ndimage import distance_transform_edt

    points = Camera(spec).plane_points(view)
    # a ray that misses the plane is NaN, which is on no board
    board = (np.abs(points[..., :2]) <= BOARD_SIDE_MM / 2.0).all(axis=-1)
    return np.asarray(distance_transform_edt(~board) * board.any(), np.float64)


def stray_light_of(
    signals: Sequence[Array],
    away_px: Array,
    channel: NDArray[np.intp],
    bad: NDArray[np.bool_],
) -> StrayLight | None:
    """Return the share of all light that is spread evenly over the frame, and the halo.

    Veiling glare g makes (1 - g) image + g mean of an image (ISO 9358:1994, whose black area the
    dark room is), channel by channel: so g is what pixels say that see nothing, over the mean of
    all. Light that the room does send back counts with it.

    Parameters
    ----------
    signals
        Frames above dark and linear, each of shape (height, width).
    away_px
        As from `away_from_board_px`; the veil is told from 15 % of the frame's width on.
    channel
        0, 1 or 2 for each pixel's filter, shape (height, width).
    bad
        Pixels to leave out, shape (height, width).

    Returns
    -------
    StrayLight or None
        Sigma is by the scatter over frames and channels; None where too few pixels see the room.
    """
    masks = [(channel == each) & ~bad for each in range(3)]
    room = away_px > _AWAY * channel.shape[1]
    if min(int((room & mask).sum()) for mask in masks) < _FEWEST:
        return None
    shares = np.array([s[room & mask].mean() / s[mask].mean() for s in signals for mask in masks])
    sigma = float(shares.std(ddof=1) / np.sqrt(len(shares)))
    share = max(float(shares.mean()), 0.0)
    even = [np.where(bad, 0.0, signal) for signal in signals]
    return StrayLight(share=share, sigma=sigma, halo=halo_of(even, away_px, channel, share))

"""How far a line of sight is from a box."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.rig import KeepOut


def box_distance_mm(
    towards: NDArray[np.float64], near_mm: float, far_mm: float, box: KeepOut
) -> NDArray[np.float64]:
    """Return the distance of a box to the piece of each ray from `near_mm` to `far_mm`, (n,).

    The squared distance of t * d to a box is convex and piecewise quadratic in t, so its slope
    rises, in straight pieces between the planes of the box: the zero of the slope is exact.

    Parameters
    ----------
    towards
        Unit vectors d, shape (n, 3).
    """
    low, high = np.array(box.min_mm), np.array(box.max_mm)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        planes = np.concatenate([low / towards, high / towards], axis=-1)
    # a ray that lies in a plane never crosses it
    knots = np.clip(
        np.nan_to_num(planes, nan=near_mm, posinf=far_mm, neginf=near_mm), near_mm, far_mm
    )
    ends = np.broadcast_to([near_mm, far_mm], (len(towards), 2))
    knots = np.sort(np.concatenate([knots, ends], axis=-1), axis=-1)
    slope = (_beyond(knots, towards, low, high) * towards[:, None]).sum(axis=-1)
    after = np.where(slope[:, -1] < 0, knots.shape[1] - 1, (slope >= 0).argmax(axis=1))
    before = np.maximum(after - 1, 0)
    row = np.arange(len(knots))
    rise = slope[row, after] - slope[row, before]
    part = np.where(rise > 0, -slope[row, before] / np.where(rise > 0, rise, 1.0), 1.0)
    nearest = knots[row, before] + np.clip(part, 0.0, 1.0) * (
        knots[row, after] - knots[row, before]
    )
    return np.asarray(np.linalg.norm(_beyond(nearest[:, None], towards, low, high)[:, 0], axis=-1))


def ball_distance_mm(
    towards: NDArray[np.float64], near_mm: float, far_mm: float, box: KeepOut
) -> NDArray[np.float64]:
    """Return the distance of the ball around a box instead, which is no greater and quicker."""
    low, high = np.array(box.min_mm), np.array(box.max_mm)
    centre, radius = 0.5 * (low + high), 0.5 * np.linalg.norm(high - low)
    along_mm = np.clip(towards @ centre, near_mm, far_mm)
    return np.asarray(np.linalg.norm(along_mm[:, None] * towards - centre, axis=1) - radius)


def _beyond(
    along_mm: NDArray[np.float64],
    towards: NDArray[np.float64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return from a box's nearest point to the points (n, k) along rays (n, 3), (n, k, 3)."""
    points = along_mm[..., None] * towards[:, None]
    return np.asarray(points - np.clip(points, low, high))

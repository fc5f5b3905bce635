"""How sharp a frame is: the width of the edge between the sample and its holder."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.camera import Camera
from gonio.geometry import SAMPLE_SIDE_MM

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.geometry import ArmPose
    from gonio.reduce.correction import Correction
    from gonio.reduce.dark import Dark
    from gonio.reduce.frames import Frame
    from gonio.rig import CameraSpec

_REACH_PX: Final = 8.0
_BINS: Final = 64
# beside the three black squares that touch each side, away from their corners: white ones hold
# markers, whose edges are no edge of the sample
_ALONG_MM: Final = np.concatenate([np.linspace(x - 3.5, x + 3.5, 15) for x in (-20.0, 0.0, 20.0)])
_WIDTHS_PX: Final = np.geomspace(0.25, 5.0, 14)
_SHIFTS_PX: Final = np.linspace(-4.0, 4.0, 17)
# fewer bins than that hold pixels beyond the blur: then one side of the edge is not seen
_FEWEST_BINS = 3
# share of a profile's variance that a step has to explain: a textured sample has edges of its own
_CLEAR = 0.95
_STEEPEST_DEG = 60.0
_GREEN = 1


def edge_width_px(
    frame: Frame, dark: Dark, spec: CameraSpec, correction: Correction
) -> float | None:
    """Return the standard deviation of the blur across the sample's sides, in pixels.

    As in the slanted-edge method of ISO 12233, pixels along a straight edge sample one profile
    more finely than they are apart. A step blurred by a Gaussian is fitted to it.

    Returns
    -------
    float or None
        Of two opposite sides the sharper one, and of both pairs the wider; None where no pair is
        seen well enough to tell, as beyond 60 deg, off the picture, or where sample and holder are
        alike.
    """
    if np.degrees(frame.view.theta) > _STEEPEST_DEG:
        return None
    sides = (_side(spec, frame.view, quarter) for quarter in range(4))
    right, top, left, bottom = (_width(*_profile(frame, dark, correction, *side)) for side in sides)
    # a shake blurs a side and the one across alike, a highlight that ends there only one
    both = [pair for pair in ((right, left), (top, bottom)) if None not in pair]
    return max((min(filter(None, pair)) for pair in both), default=None)


def _side(
    spec: CameraSpec, pose: ArmPose, quarter: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return pixels along a side of the sample and the outward normals there, shape (n, 2)."""
    half = np.full_like(_ALONG_MM, SAMPLE_SIDE_MM / 2.0)
    turn = np.array([[0, -1], [1, 0]])
    points = np.stack([half, _ALONG_MM], axis=1) @ np.linalg.matrix_power(turn, quarter).T
    flat = np.zeros((len(points), 1))
    camera = Camera(spec)
    edge = camera.project(np.hstack([points, flat]), pose)
    beyond = camera.project(np.hstack([1.02 * points, flat]), pose)
    tangent = np.gradient(edge, axis=0)
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
    normal *= np.sign((normal * (beyond - edge)).sum(axis=1, keepdims=True))
    return edge, normal / np.linalg.norm(normal, axis=1, keepdims=True)


def _profile(
    frame: Frame,
    dark: Dark,
    correction: Correction,
    edge: NDArray[np.float64],
    normal: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return count and mean of the green pixels by their distance, shape (_BINS,)."""
    steps = np.arange(-_REACH_PX, _REACH_PX + 1)
    pixels = np.round(edge[:, None] + steps[:, None] * normal[:, None]).astype(np.intp)
    distance = ((pixels - edge[:, None]) * normal[:, None]).sum(axis=-1).ravel()
    column, row = pixels.reshape(-1, 2).T
    height, width = frame.raw.mosaic.shape
    seen = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    seen &= np.abs(distance) < _REACH_PX
    column, row, distance = column[seen], row[seen], distance[seen]
    usable = frame.raw.sensor.channel(row, column) == _GREEN
    if correction.bad is not None:
        usable &= ~correction.bad[row, column]
    at = row[usable], column[usable]
    value = correction.linear(frame.raw.mosaic[at] - dark.mean[at])
    value /= correction.response(frame.raw.sensor)[at]
    place = ((distance[usable] + _REACH_PX) * _BINS / (2 * _REACH_PX)).astype(np.intp)
    count = np.bincount(place, minlength=_BINS).astype(np.float64)
    total = np.bincount(place, weights=value, minlength=_BINS)
    return count, total / np.maximum(count, 1.0)


def _width(count: NDArray[np.float64], mean: NDArray[np.float64]) -> float | None:
    """Return the width of the blurred step that fits a profile best, where there is a step."""
    ends = count[: _BINS // 4], count[-_BINS // 4 :]
    if min((end > 0).sum() for end in ends) < _FEWEST_BINS:
        return None
    steps, widths = _steps()
    share = count / count.sum()
    middle = steps - (steps @ share)[:, None]
    value = mean - share @ mean
    spread = middle**2 @ share
    height = (middle * value) @ share / np.maximum(spread, 1e-12)
    misfit = (value - height[:, None] * middle) ** 2 @ share
    best = int(np.argmin(np.where(spread > 1e-3, misfit, np.inf)))
    explained = 1.0 - misfit[best] / max(float(value**2 @ share), 1e-12)
    return float(widths[best]) if explained > _CLEAR else None


@lru_cache(maxsize=1)
def _steps() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return steps of every shift and width, shape (n, _BINS), and the widths, shape (n,)."""
    from scipy.special import ndtr

    middle = (np.arange(_BINS) + 0.5) * (2 * _REACH_PX / _BINS) - _REACH_PX
    shift, width = (grid.ravel() for grid in np.meshgrid(_SHIFTS_PX, _WIDTHS_PX))
    return ndtr((middle - shift[:, None]) / width[:, None]), width

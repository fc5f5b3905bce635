"""The pixels that see the middle of the sample."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from gonio.camera import Camera
from gonio.directions import normalize
from gonio.errors import BadInputError
from gonio.geometry import SAMPLE_SIDE_MM

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from gonio.geometry import ArmPose
    from gonio.reduce.raw import Sensor
    from gonio.rig import CameraSpec

SMALLEST_MM: Final = 5.0
LARGEST_MM: Final = 10.0
"""Sides of the patch that a sample is the mean over, unless it was ever told otherwise."""

# along each side: so many pixels have little noise, and more are slow to read
_ENOUGH_PX = 20.0
_MM_PER_M = 1000.0
_FLAT = 1e-6
# weights that are more uneven cost more than they are worth
_MOST_NOISE = 2.0


def usual_patch_mm(spec: CameraSpec) -> float:
    """Return the side of 20 pixels on the sample, but at least 5 mm and at most 10.

    On a coarse sensor noise asks for a larger patch, and directions for a smaller one.
    """
    px_per_mm = spec.focal_px / (_MM_PER_M * spec.distance_m)
    return float(np.clip(_ENOUGH_PX / px_per_mm, SMALLEST_MM, LARGEST_MM))


@dataclass(frozen=True)
class Patch:
    """The pixels whose rays meet a square about the sample's centre.

    Attributes
    ----------
    rows, columns
        Where they are, shape (n,).
    channel
        0, 1 or 2 for red, green or blue, shape (n,).
    points_mm
        Where they look, shape (n, 3).
    view
        Mean direction from there to the camera, shape (3,).
    solid_angle
        Of the square as the camera sees it, in sr: the view directions that its mean covers.
    """

    rows: NDArray[np.intp]
    columns: NDArray[np.intp]
    channel: NDArray[np.intp]
    points_mm: NDArray[np.float64]
    view: NDArray[np.float64]
    solid_angle: float

    @cached_property
    def weights(self) -> NDArray[np.float64]:
        """Of each pixel, shape (n,): each channel's add up to one, and all look at one middle.

        Red and blue lie in rows and columns of their own. Weighted alike, their middles are a pixel
        apart, which is far on the sample at grazing views, and errs where the BRDF has a slope.
        """
        weights, where = np.empty(len(self.channel)), self.points_mm[:, :2]
        for channel in range(3):
            mine = self.channel == channel
            weights[mine] = _centred(where[mine], where.mean(axis=0))
        return weights

    @cached_property
    def pixels(self) -> NDArray[np.float64]:
        """How many alike of each channel would have as little noise, shape (3,)."""
        return np.asarray(1.0 / np.bincount(self.channel, self.weights**2, minlength=3))

    def of(self, mosaic: NDArray[np.generic]) -> NDArray[np.float64]:
        """Return the patch's pixels of a frame, shape (height, width) to (n,)."""
        return np.asarray(mosaic[self.rows, self.columns], np.float64)

    def mean(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the mean over each channel's pixels, shape (n,) to (3,)."""
        return np.asarray(np.bincount(self.channel, self.weights * values, minlength=3), np.float64)

    def any(self, those: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return whether one of each channel's pixels is such, shape (n,) to (3,)."""
        return np.bincount(self.channel[those], minlength=3) > 0


def _centred(where: NDArray[np.float64], middle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the least uneven weights whose middle is that, as far as places allow, shape (n,)."""
    count = len(where)
    away, shift = where - where.mean(axis=0), middle - where.mean(axis=0)
    # of a single row nothing can move the middle across
    slope = np.linalg.pinv(away.T @ away, rcond=_FLAT) @ shift
    weights = 1.0 / count + away @ slope
    alike = np.full(count, 1.0 / count)
    return weights if (weights**2).sum() < _MOST_NOISE / count else alike


class FindsPatch(Protocol):
    """Whoever tells which pixels of a frame to read."""

    @property
    def find(self) -> Callable[[ArmPose, Sensor], Patch]:
        """Return the patch for a pose of the camera."""


class PatchFinder:
    """Finds the patch for a pose of the camera; the last few are kept.

    Parameters
    ----------
    spec
        The camera.
    side_mm
        Side of the square.
    bad
        Pixels to leave out, shape (height, width).

    Raises
    ------
    gonio.errors.BadInputError
        When the square is not on the sample.
    """

    def __init__(
        self, spec: CameraSpec, side_mm: float, bad: NDArray[np.bool_] | None = None
    ) -> None:
        if not 0 < side_mm <= SAMPLE_SIDE_MM:
            raise BadInputError(
                f"a patch of {side_mm:g} mm does not fit the sample; use a side above 0 and up to "
                f"{SAMPLE_SIDE_MM:g} mm"
            )
        self._spec, self._bad = spec, bad
        self.side_mm = side_mm
        # the frames of a bracket share a pose
        self.find = lru_cache(maxsize=8)(self._find)

    def at_least(self, side_mm: float) -> PatchFinder:
        """Return what finds patches that are no smaller than that."""
        return PatchFinder(self._spec, max(self.side_mm, side_mm), self._bad)

    def _find(self, pose: ArmPose, sensor: Sensor) -> Patch:
        """Return the patch.

        Raises
        ------
        gonio.errors.BadInputError
            When a channel has no pixel in it.
        """
        left, top, window = self._window(pose)
        points = Camera(window).plane_points(pose)
        # a ray that misses the plane is NaN, which is inside nothing
        inside = (np.abs(points) <= self.side_mm / 2.0).all(axis=-1)
        if self._bad is not None:
            inside &= ~self._bad[top : top + window.height, left : left + window.width]
        rows, columns = np.nonzero(inside)
        channel = sensor.channel(rows + top, columns + left)
        if len(np.unique(channel)) < 3:
            raise BadInputError(
                f"the camera at {np.degrees(pose.theta):.1f} deg sees the patch of "
                f"{self.side_mm:g} mm with too few pixels; use a larger --patch-mm"
            )
        points = points[inside]
        eye = pose.place(_MM_PER_M * self._spec.distance_m)
        return Patch(
            rows=rows + top,
            columns=columns + left,
            channel=channel,
            points_mm=points,
            view=normalize(normalize(eye - points).mean(axis=0)),
            solid_angle=self.side_mm**2 * np.cos(pose.theta) / (eye @ eye),
        )

    def _window(self, pose: ArmPose) -> tuple[int, int, CameraSpec]:
        """Return the left column, top row and camera of the part of the picture that matters."""
        half = self.side_mm / 2.0
        # with the middles of the sides, which distortion may push out beyond the corners
        steps = (-half, 0.0, half)
        square = [(x, y, 0.0) for x in steps for y in steps]
        pixels = Camera(self._spec).project(square, pose)
        size = (self._spec.width, self._spec.height)
        low = np.clip(np.floor(pixels.min(axis=0)) - 2, 0, np.array(size) - 2).astype(int)
        high = np.clip(np.ceil(pixels.max(axis=0)) + 3, low + 2, size).astype(int)
        width, height = (high - low).tolist()
        x, y = self._spec.centre_px
        left, top = low.tolist()
        shape = {"width": width, "height": height, "centre_px": (x - left, y - top)}
        return left, top, self._spec.model_copy(update=shape)

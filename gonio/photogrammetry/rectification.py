"""Pictures put on the sample's plane: a fixed grid of texels, each the mean over its footprint."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from gonio.photogrammetry.footprint import means_of_rows

try:
    from gonio import _pixels
except ImportError:
    _pixels = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.camera import Camera
    from gonio.geometry import ArmPose
    from gonio.photogrammetry.grid import TexelGrid

LOOK_PX: Final = 1.25
"""A texel is looked at in places at most so far apart."""

_PROBES = 17


class Rectified(NamedTuple):
    """Rows of texels, shapes (3, rows, side); NaN out of sight.

    Attributes
    ----------
    value
        Of the red, green and blue filters' pixels.
    variance
        Of these; infinite where a pixel's is that counts.
    """

    value: NDArray[np.float32]
    variance: NDArray[np.float32]


class Rectifier:
    """Puts a picture on the grid of texels; nothing is demosaiced.

    A texel is cut into equal parts, so many along each side that their middles are no more than
    `LOOK_PX` apart in the picture: a footprint at a grazing view is long in one direction and
    short in the other. At each middle the picture is taken as a plane of each filter's own pixels,
    linear between them (two pixels apart). The texel is the mean of all; so it has the mean over
    its footprint where it is larger than a pixel, and is interpolated where it is smaller. Pixels
    to leave out have no weight. Variance is that of the sum for pixels that err independently.

    A texel is out of sight when any of its looks lies less than a pixel from the picture's edge, or
    a filter has no pixel to show for it.

    Parameters
    ----------
    value, variance
        Of each pixel, shape (height, width); NaN for one to leave out.
    pattern
        Filter colors of the 2 x 2 cell, row by row.
    camera, pose
        Where it was taken from.
    grid
        Where it goes.
    """

    def __init__(
        self,
        value: NDArray[np.float32],
        variance: NDArray[np.float32],
        pattern: str,
        camera: Camera,
        pose: ArmPose,
        grid: TexelGrid,
    ) -> None:
        self.value, self.variance = value, variance
        self.channels = tuple("RGB".index(color) for color in pattern)
        self.camera, self.pose, self.grid = camera, pose, grid

    @cached_property
    def parts(self) -> tuple[int, int]:
        """Into how many parts a texel is cut along x and along y."""
        grid = self.grid
        at = np.linspace(-grid.side_mm / 2.0, grid.side_mm / 2.0, min(grid.side + 1, _PROBES))
        here = np.stack(self.camera.plane_pixels(at, -at, self.pose))
        along_x = np.stack(self.camera.plane_pixels(at + grid.pitch_mm, -at, self.pose))
        along_y = np.stack(self.camera.plane_pixels(at, grid.pitch_mm - at, self.pose))
        across, down = (
            max(math.ceil(float(np.linalg.norm(there - here, axis=0).max()) / LOOK_PX), 1)
            for there in (along_x, along_y)
        )
        return across, down

    @cached_property
    def compiled(self) -> _pixels.Texels | None:
        """The kernel's view of it; None where there is no kernel."""
        if _pixels is None:
            return None
        spec, grid = self.camera.spec, self.grid
        first = float(grid.x_mm[0])
        return _pixels.Texels(
            self.value,
            self.variance,
            self.channels,
            self.camera.plane_rays(self.pose).ravel().tolist(),
            (spec.focal_px, *spec.centre_px),
            spec.distortion or None,
            (first, -first, grid.pitch_mm),
            (grid.side, *self.parts),
        )

    def rows(self, first: int, last: int) -> Rectified:
        """Return rows of texels from `first` up to `last`, which is none of them."""
        if self.compiled is not None:
            return Rectified(*self.compiled.rows(first, last))
        return Rectified(*means_of_rows(self, first, last))

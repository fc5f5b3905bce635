"""What the camera sees of the white reference, pixel by pixel, by the rig's geometry."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.camera import Camera
from gonio.directions import normalize
from gonio.geometry import SAMPLE_SIDE_MM
from gonio.materials import reference_material
from gonio.reduce.color import camera_of_white
from gonio.reduce.light import Source

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.calibrate.exposing import Exposed
    from gonio.rig import Rig

PATCH_MM: Final = 40.0
"""Side of the square that photon transfer, linearity and lamps are told from."""

# defocus and halo soften the reference's edge
_EDGE_MM = 2.0
_MM_PER_M = 1000.0


class WhiteScene:
    """The white reference from one pose of the camera.

    Parameters
    ----------
    rig
        Geometry and reference.
    frame
        Taken there; its sensor tells which pixel has which filter.

    Attributes
    ----------
    seen
        Pixels that see the reference away from its edge, shape (height, width).
    patch
        Those within `PATCH_MM`, shape (height, width).
    channel
        0, 1 or 2 for each pixel's filter, shape (height, width).
    """

    def __init__(self, rig: Rig, frame: Exposed) -> None:
        sensor = frame.raw.sensor
        rows, columns = np.indices((sensor.height, sensor.width))
        self.channel: Final = sensor.channel(rows, columns)
        self._rig, self._view = rig, frame.view
        self._points = Camera(rig.camera).plane_points(frame.view)
        reach = np.abs(self._points[..., :2]).max(axis=-1)
        self.seen: Final = reach <= SAMPLE_SIDE_MM / 2.0 - _EDGE_MM
        self.patch: Final = reach <= PATCH_MM / 2.0
        self._to_camera = camera_of_white(sensor.color_matrix)

    def dose(self, frame: Exposed, where: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Return exposure x irradiance x BRDF of `where`'s pixels, shape (n,).

        Each channel is what a white-balanced camera sees; its scale is as the filter's.
        """
        points = self._points[where]
        source = Source(self._rig.lamps, frame.light, frame.flux)
        eye = self._view.place(_MM_PER_M * self._rig.camera.distance_m)
        brdf = reference_material(self._rig).evaluate(
            source.directions(points), normalize(eye - points)
        )
        seen = brdf @ self._to_camera.T
        channel = np.take_along_axis(seen, self.channel[where][:, None], axis=1)[:, 0]
        dose: NDArray[np.float64] = frame.raw.exposure_s * source.irradiance(points) * channel
        return dose

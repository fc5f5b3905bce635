"""What the twin's camera has before it: the sample in its board, pixel by pixel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.board import BOARD_SIDE_MM
from gonio.camera import Camera
from gonio.directions import normalize
from gonio.geometry import SAMPLE_SIDE_MM
from sim import sensor
from sim.board import CharucoBoard, printed_at
from sim.chart import ColorChart

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.geometry import ArmPose
    from gonio.protocols import Material
    from gonio.rig import CameraSpec

_MM_PER_M = 1000.0


@dataclass(frozen=True)
class Scene:
    """The scene of one pose, whatever the exposure and the strength of the lamps.

    Attributes
    ----------
    points
        Where each pixel looks, in mm, shape (height, width, 3).
    brdf
        Of what is there, linear sRGB in 1/sr, shape (height, width, 3).
    response
        What each pixel's filter passes of that, shape (height, width).
    """

    points: NDArray[np.float64]
    brdf: NDArray[np.float64]
    response: NDArray[np.float64]


def render(
    spec: CameraSpec, material: Material, view: ArmPose, light_mm: NDArray[np.float64]
) -> Scene:
    """Evaluate the material at each pixel's own directions to the camera and to the light.

    Parameters
    ----------
    spec
        The camera.
    material
        What lies in the holder.
    view
        Where the camera is.
    light_mm
        Centre of the lit lamps, shape (3,).
    """
    points = Camera(spec).plane_points(view)
    eye = view.place(_MM_PER_M * spec.distance_m)
    seen = np.isfinite(points[..., 0]) & (eye[2] > 0)
    points = np.where(seen[..., None], points, 0.0)
    reach = np.abs(points).max(axis=-1)
    sample = seen & (reach <= SAMPLE_SIDE_MM / 2.0)
    board = seen & ~sample & (reach <= BOARD_SIDE_MM / 2.0)
    brdf = np.zeros(points.shape)
    if isinstance(material, CharucoBoard):
        # it has no sample in it: what is printed goes on all over
        board |= sample
    elif isinstance(material, ColorChart):
        brdf[sample] = material.seen(points)[sample]
    else:
        place = points[sample]
        brdf[sample] = material.evaluate(normalize(light_mm - place), normalize(eye - place))
    brdf[board] = printed_at(points, board)[:, None]
    return Scene(points, brdf, sensor.mosaic(brdf))


def irradiance(points: NDArray[np.float64], lamp_mm: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the irradiance in W/m2 from a lamp of 1 W/sr, by the inverse square of distance.

    Parameters
    ----------
    points
        On the sample's plane, in mm, shape (..., 3).
    lamp_mm
        Where the lamp is, shape (3,).

    Returns
    -------
    ndarray
        Shape (...), 0 for a lamp below the plane.
    """
    x, y, z = lamp_mm / _MM_PER_M
    across = (points[..., 0] / _MM_PER_M - x) ** 2 + (points[..., 1] / _MM_PER_M - y) ** 2
    square = across + z * z
    strength: NDArray[np.float64] = max(z, 0.0) / (square * np.sqrt(square))
    return strength

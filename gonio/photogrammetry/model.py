"""Where a camera on its arm sees the board's corners, by all that is to be found."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from gonio.alignment import ALIGNED, Alignment
from gonio.camera import Camera

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray
    from scipy.sparse import csr_matrix

    from gonio.photogrammetry.detection import BoardView
    from gonio.rig import CameraSpec

ENCODER_DEG: Final = 0.01
"""Standard deviation of what an arm truly does about its alignment: play, sag, warmth, noise.

What is expected at least: views that tell of more are believed.
"""

INTRINSICS: Final = ("focal_px", "centre_x_px", "centre_y_px")
DISTORTION: Final = ("k1", "k2", "p1", "p2", "k3")
ARM: Final = tuple(Alignment.model_fields)

# a lens is known to so many pixels at the picture's corner: the small fields of view of a rig tell
# little of it, and its higher orders nothing
_LENS_PX = 2.0


class State(NamedTuple):
    """Camera, arm, and what each view's angles are off it, in degrees, shape (views, 2)."""

    camera: Camera
    alignment: Alignment
    off_deg: NDArray[np.float64]


class BundleModel:
    """The corners of several views, as functions of one vector of parameters.

    The vector has the camera's intrinsics (with distortion, where the rig file has any), the arm's
    alignment, and for each view its corrections of theta, then of phi.

    Parameters
    ----------
    spec
        The camera by the rig file.
    views
        What was found.
    """

    def __init__(self, spec: CameraSpec, views: Sequence[BoardView]) -> None:
        self._spec, self._count = spec, len(views)
        self.names = (*INTRINSICS, *(DISTORTION if spec.distortion else ()), *ARM)
        self.start = np.array(
            [spec.focal_px, *spec.centre_px, *spec.distortion, *(0.0 for _ in ARM)]
            + 2 * self._count * [0.0]
        )
        self._theta, self._phi = np.array([(view.theta, view.phi) for view in views]).T
        self._points = np.concatenate([view.points_mm for view in views])
        self._pixels = np.concatenate([view.pixels for view in views])
        self.view = np.repeat(np.arange(self._count), [len(view.ids) for view in views])

    def state(self, vector: NDArray[np.float64]) -> State:
        """Return what a vector stands for."""
        focal, x, y = vector[: len(INTRINSICS)]
        arm = len(self.names) - len(ARM)
        update = {
            "focal_px": float(focal),
            "centre_px": (float(x), float(y)),
            "distortion": tuple(map(float, vector[len(INTRINSICS) : arm])),
        }
        values = dict(zip(ARM, map(float, vector[arm : len(self.names)]), strict=True))
        return State(
            Camera(self._spec.model_copy(update=update)),
            ALIGNED.model_copy(update=values),
            vector[len(self.names) :].reshape(2, self._count).T,
        )

    def errors_px(self, vector: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return where the corners should be less where they were found, shape (n, 2)."""
        camera, alignment, off_deg = self.state(vector)
        off = np.radians(off_deg)
        frames = alignment.frames(self._theta + off[:, 0], self._phi + off[:, 1])
        reach = 1000.0 * self._spec.distance_m + alignment.distance_mm
        eyes = alignment.centre_mm + reach * frames[:, 2]
        at = np.einsum("nij,nj->ni", frames[self.view], self._points - eyes[self.view])
        seen = camera.project_seen(at * (1.0, -1.0, -1.0))
        return np.asarray(seen - self._pixels)

    def residuals(
        self, vector: NDArray[np.float64], corner_px: float, play_deg: float
    ) -> NDArray[np.float64]:
        """Return errors over what is to be expected of each: corners, views' angles, the lens."""
        corners = self.errors_px(vector).ravel() / corner_px
        return np.concatenate([corners, vector[len(self.names) :] / play_deg, self._lens(vector)])

    def play_deg(self, vector: NDArray[np.float64]) -> float:
        """Return the standard deviation of the views' angles about the arm's alignment.

        By chi-square over its degrees of freedom, which the alignment's angles take some of.
        """
        off_deg, told = vector[len(self.names) :], sum(name.endswith("_deg") for name in ARM)
        return max(ENCODER_DEG, float(np.sqrt(off_deg @ off_deg / (len(off_deg) - told))))

    def structure(self) -> csr_matrix:
        """Return where the Jacobian of the residuals is not 0."""
        from scipy.sparse import block_array, csr_matrix, eye_array

        shared = len(self.names)
        which = np.repeat(self.view, 2)
        of_view = csr_matrix(
            (np.ones(len(which)), (np.arange(len(which)), which)), (len(which), self._count)
        )
        lens = np.zeros((len(self._lens(self.start)), shared))
        lens[:, len(INTRINSICS) : len(INTRINSICS) + len(lens)] = np.eye(len(lens))
        blocks = [
            [np.ones((len(which), shared)), of_view, of_view],
            [None, eye_array(self._count), None],
            [None, None, eye_array(self._count)],
            *([[lens, None, None]] if len(lens) else []),
        ]
        return csr_matrix(block_array(blocks))

    def _lens(self, vector: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what distortion differs from the rig file's over what is to be expected."""
        spec = self._spec
        if not spec.distortion:
            return np.zeros(0)
        corner = np.hypot(spec.width, spec.height) / 2.0 / spec.focal_px
        powers = np.array([3, 5, 2, 2, 7])
        part = slice(len(INTRINSICS), len(INTRINSICS) + len(DISTORTION))
        off_px: NDArray[np.float64] = spec.focal_px * corner**powers * (vector - self.start)[part]
        return off_px / _LENS_PX

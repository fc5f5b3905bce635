"""The camera's projection: from the sample's plane to pixels and back, lens distortion included."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from gonio.geometry import ArmPose
    from gonio.rig import CameraSpec


@dataclass(frozen=True)
class Camera:
    """A camera at the end of the view arm, in OpenCV's model (pinhole, k1 k2 p1 p2 k3)."""

    spec: CameraSpec

    @property
    def matrix(self) -> NDArray[np.float64]:
        """The 3 x 3 matrix of intrinsics, in pixels."""
        focal, (x, y) = self.spec.focal_px, self.spec.centre_px
        return np.array([[focal, 0, x], [0, focal, y], [0, 0, 1]], dtype=np.float64)

    @property
    def distortion(self) -> NDArray[np.float64]:
        """OpenCV's five distortion coefficients."""
        return np.array(self.spec.distortion or (0.0,) * 5)

    def project(self, points_mm: ArrayLike, pose: ArmPose) -> NDArray[np.float64]:
        """Return the pixels (column, row), shape (n, 2), of points in mm, shape (n, 3)."""
        # turned here: cv2.Rodrigues loses half the digits near half a turn, the view from above
        eye = pose.place(1000.0 * self.spec.distance_m)
        points = (np.asarray(points_mm, np.float64).reshape(-1, 3) - eye) @ _turn(pose).T
        return self.project_seen(points)

    def project_seen(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the same of points in the camera's own frame (x right, y down, z forward)."""
        import cv2

        still = np.zeros(3)
        pixels, _ = cv2.projectPoints(points, still, still, self.matrix, self.distortion)
        return np.asarray(pixels, np.float64).reshape(-1, 2)

    def plane_pixels(
        self, x_mm: NDArray[np.float64], y_mm: NDArray[np.float64], pose: ArmPose
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the columns and rows of a grid on the sample's plane, shape (len(y), len(x)) each.

        As `project` of its points, and many times as quick: a homography, and then the lens.
        """
        across, down, ahead = (
            row[0] * x_mm + (row[1] * y_mm + row[2])[:, None] for row in self.plane_rays(pose)
        )
        u, v = across / ahead, down / ahead
        if self.spec.distortion:
            u, v = _distorted(u, v, self.spec.distortion)
        (x, y), focal = self.spec.centre_px, self.spec.focal_px
        return focal * u + x, focal * v + y

    def plane_rays(self, pose: ArmPose) -> NDArray[np.float64]:
        """Return the homography from (x, y, 1) on the sample's plane to the camera's frame, 3 x 3.

        What comes out is right, down and ahead, in mm.
        """
        turn = _turn(pose)
        shift = -turn @ pose.place(1000.0 * self.spec.distance_m)
        return np.column_stack([turn[:, 0], turn[:, 1], shift])

    def plane_points(self, pose: ArmPose) -> NDArray[np.float64]:
        """Return where each pixel's ray meets the sample's plane.

        Returns
        -------
        ndarray
            Points in mm, shape (height, width, 3), z = 0; NaN where a ray misses the plane.
        """
        import cv2

        columns, rows = np.meshgrid(
            np.arange(self.spec.width, dtype=np.float64),
            np.arange(self.spec.height, dtype=np.float64),
        )
        pixels = np.stack([columns, rows], axis=-1).reshape(-1, 1, 2)
        plane = cv2.undistortPoints(pixels, self.matrix, self.distortion).reshape(-1, 2)
        rays = np.concatenate([plane, np.ones((len(plane), 1))], axis=1) @ _turn(pose)
        eye = pose.place(1000.0 * self.spec.distance_m)
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = np.where(rays[:, 2] < 0, -eye[2] / rays[:, 2], np.nan)
            points = eye + reach[:, None] * rays
        points[:, 2] = np.where(np.isfinite(points[:, 0]), 0.0, np.nan)
        return points.reshape(self.spec.height, self.spec.width, 3)


def _turn(pose: ArmPose) -> NDArray[np.float64]:
    """Return the rotation from the sample's frame to the camera's (x right, y down, z forward)."""
    return np.stack([pose.right, -pose.up, -pose.direction])


def _distorted(
    u: NDArray[np.float64], v: NDArray[np.float64], distortion: tuple[float, ...]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where the lens puts rays of slopes u and v (Brown 1971, in OpenCV's order)."""
    k1, k2, p1, p2, k3 = distortion
    square = u * u + v * v
    radial = 1.0 + square * (k1 + square * (k2 + square * k3))
    return (
        u * radial + 2.0 * p1 * u * v + p2 * (square + 2.0 * u * u),
        v * radial + p1 * (square + 2.0 * v * v) + 2.0 * p2 * u * v,
    )

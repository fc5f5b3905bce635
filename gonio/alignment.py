"""How an arm stands to the sample: offsets and tilts of its axes, its length, where they meet."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Final

import numpy as np

from gonio.geometry import ArmPose
from gonio.validation import Document, within

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

Offset = Annotated[float, within(-10, 10)]
Length = Annotated[float, within(-100, 100)]


class Alignment(Document):
    """What differs from the arm that the rig file describes; as made without arguments, nothing.

    The phi axis is tilted against the sample's normal, the theta axis against the right angle to
    it, and the arm's end is turned about its own line of sight. A camera's pitch and yaw are no
    part of it: at these focal lengths the principal point tells the same.

    Attributes
    ----------
    theta_offset_deg, phi_offset_deg
        To be added to the encoders' angles.
    phi_tilt_x_deg, phi_tilt_y_deg
        Rotation of the phi axis about the sample's x and y.
    theta_tilt_deg
        Rotation of the theta axis out of the plane that the phi axis is normal to.
    roll_deg
        Of the arm's end about its direction.
    distance_mm
        By how much the arm is longer than the rig file says.
    centre_x_mm, centre_y_mm, centre_z_mm
        Where the axes meet, in the sample's frame.
    """

    theta_offset_deg: Offset = 0.0
    phi_offset_deg: Offset = 0.0
    phi_tilt_x_deg: Offset = 0.0
    phi_tilt_y_deg: Offset = 0.0
    theta_tilt_deg: Offset = 0.0
    roll_deg: Offset = 0.0
    distance_mm: Length = 0.0
    centre_x_mm: Length = 0.0
    centre_y_mm: Length = 0.0
    centre_z_mm: Length = 0.0

    def pose(self, theta_deg: float, phi_deg: float) -> ArmPose:
        """Return the pose for angles by the encoders, in degrees."""
        theta, phi = math.radians(theta_deg), math.radians(phi_deg)
        return ArmPose(theta, phi) if self == ALIGNED else AlignedPose(theta, phi, self)

    def frames(self, theta: ArrayLike, phi: ArrayLike) -> NDArray[np.float64]:
        """Return the frames of the arm's end, shape (..., 3, 3), for angles in radians.

        Returns
        -------
        ndarray
            Its rows are right, up and direction, in the sample's frame.
        """
        offset, roll = map(math.radians, (self.theta_offset_deg, self.roll_deg))
        turned = np.asarray(phi, np.float64) + math.radians(self.phi_offset_deg)
        turn = (
            _about(0, math.radians(self.phi_tilt_x_deg))
            @ _about(1, math.radians(self.phi_tilt_y_deg))
            @ _about(2, turned)
            @ _about(0, math.radians(self.theta_tilt_deg))
            @ _about(1, np.asarray(theta, np.float64) + offset)
            @ _about(2, roll)
        )
        # an upright arm at phi = 0 has -x up and +y right
        return np.stack([turn[..., 1], -turn[..., 0], turn[..., 2]], axis=-2)

    @property
    def centre_mm(self) -> NDArray[np.float64]:
        """Where the axes meet, shape (3,)."""
        return np.array([self.centre_x_mm, self.centre_y_mm, self.centre_z_mm])


ALIGNED: Final = Alignment()
"""Exactly as the rig file says."""


@dataclass(frozen=True)
class AlignedPose(ArmPose):
    """A pose of an arm that stands as its alignment says; `theta` and `phi` are the encoders'."""

    alignment: Alignment = field(default=ALIGNED)

    @cached_property
    def _frame(self) -> NDArray[np.float64]:
        return self.alignment.frames(self.theta, self.phi)

    @cached_property
    def right(self) -> NDArray[np.float64]:
        """Unit vector forward x up, shape (3,)."""
        return np.asarray(self._frame[0])

    @cached_property
    def up(self) -> NDArray[np.float64]:
        """Unit vector towards the upper edge of the picture, shape (3,)."""
        return np.asarray(self._frame[1])

    @cached_property
    def direction(self) -> NDArray[np.float64]:
        """Unit vector from where the axes meet to the arm's end, shape (3,)."""
        return np.asarray(self._frame[2])

    def place(
        self, distance_mm: float, x_mm: float = 0.0, y_mm: float = 0.0
    ) -> NDArray[np.float64]:
        """Return the point, in mm, `x_mm` right and `y_mm` up of the arm's end."""
        reach = distance_mm + self.alignment.distance_mm
        return self.alignment.centre_mm + super().place(reach, x_mm, y_mm)


def _about(axis: int, angle: ArrayLike) -> NDArray[np.float64]:
    """Return right-handed rotations about a coordinate axis, shape (...) to (..., 3, 3)."""
    angle = np.asarray(angle, np.float64)
    turn = np.zeros((*angle.shape, 3, 3))
    one, other = (axis + 1) % 3, (axis + 2) % 3
    turn[..., axis, axis] = 1.0
    turn[..., one, one] = turn[..., other, other] = np.cos(angle)
    turn[..., other, one] = np.sin(angle)
    turn[..., one, other] = -turn[..., other, one]
    return turn

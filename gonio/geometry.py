"""Where an arm puts what it carries: the frame at the end of an arm of two axes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

SAMPLE_SIDE_MM = 70.0
"""Side of the square sample; its centre is the origin."""

HOLDER_RADIUS_MM = 100.0
"""The sample holder and its board lie within so much of the origin."""


@dataclass(frozen=True)
class ArmPose:
    """An arm at polar angle `theta` and azimuth `phi` (radians), looking at the origin.

    The azimuth counts at the pole, too: there it turns the arm's end about its own axis.
    """

    theta: float
    phi: float

    @classmethod
    def from_degrees(cls, theta_deg: float, phi_deg: float) -> ArmPose:
        """Return the pose for angles in degrees."""
        return cls(math.radians(theta_deg), math.radians(phi_deg))

    @cached_property
    def direction(self) -> NDArray[np.float64]:
        """Unit vector from the sample to the arm's end, shape (3,)."""
        sin, cos = math.sin(self.theta), math.cos(self.theta)
        return np.array([sin * math.cos(self.phi), sin * math.sin(self.phi), cos])

    @cached_property
    def up(self) -> NDArray[np.float64]:
        """Unit vector -d(direction)/d(theta), shape (3,)."""
        sin, cos = math.sin(self.theta), math.cos(self.theta)
        return np.array([-cos * math.cos(self.phi), -cos * math.sin(self.phi), sin])

    @cached_property
    def right(self) -> NDArray[np.float64]:
        """Unit vector forward x up, shape (3,), where forward points at the sample."""
        return np.cross(-self.direction, self.up)

    def place(
        self, distance_mm: float, x_mm: float = 0.0, y_mm: float = 0.0
    ) -> NDArray[np.float64]:
        """Return the point, in mm, `x_mm` right and `y_mm` up of the arm's end."""
        point: NDArray[np.float64] = (
            distance_mm * self.direction + x_mm * self.right + y_mm * self.up
        )
        return point

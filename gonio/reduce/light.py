"""The lamp head as a source: where it is, how much it sheds, and how large it looks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import normalize

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.geometry import ArmPose
    from gonio.rig import Lamps

_MM_PER_M = 1000.0


@dataclass(frozen=True)
class Source:
    """The lamps over one exposure.

    Attributes
    ----------
    lamps
        The lamp head.
    pose
        The light arm's.
    flux
        Mean of each of the eleven lamps, 1 = 25 deg C and 700 mA.
    """

    lamps: Lamps
    pose: ArmPose
    flux: Sequence[float]

    @property
    def strengths(self) -> NDArray[np.float64]:
        """Flux of each lamp of the head, shape (n,)."""
        return np.array([self.flux[lamp.n - 1] for lamp in self.lamps.lamp])

    def irradiance(self, points_mm: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the irradiance at points of the sample's plane.

        Inverse square and cosine, lamp by lamp: flux z / d^3.

        Parameters
        ----------
        points_mm
            Shape (n, 3).

        Returns
        -------
        ndarray
            Shape (n,), in 1/mm2, for a lamp of unit intensity at flux 1; the white reference
            settles the scale. Zero from lamps below the plane.
        """
        places = self._places()
        # |lamp - point|^2 multiplied out, which is one product of matrices
        lengths = [np.einsum("ni,ni->n", each, each) for each in (places, points_mm)]
        square = lengths[0][:, None] + lengths[1] - 2.0 * (places @ points_mm.T)
        height = np.clip(places[:, 2], 0.0, None)
        shed: NDArray[np.float64] = (self.strengths * height) @ (1.0 / (square * np.sqrt(square)))
        return shed

    def directions(self, points_mm: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return unit vectors, shape (n, 3), from points to the flux-weighted centre."""
        return normalize(self.centre_mm - points_mm)

    @property
    def centre_mm(self) -> NDArray[np.float64]:
        """The flux-weighted centre of the lamps, shape (3,)."""
        centre: NDArray[np.float64] = self.strengths @ self._places() / self.strengths.sum()
        return centre

    @property
    def solid_angle(self) -> float:
        """Of the convex hull of the lit lamps' places as the sample sees it, in sr.

        The head faces the sample, so it is area / distance^2; 0 for lamps that span no area,
        since the rig file states no size of a lamp.
        """
        import cv2

        lit = [lamp for lamp, s in zip(self.lamps.lamp, self.strengths, strict=True) if s > 0]
        places = np.array([(lamp.x_mm, lamp.y_mm) for lamp in lit], np.float32)
        if len(places) < 3:
            return 0.0
        area = cv2.contourArea(cv2.convexHull(places))
        return float(area) / (_MM_PER_M * self.lamps.distance_m) ** 2

    def _places(self) -> NDArray[np.float64]:
        across = np.array([(lamp.x_mm, lamp.y_mm) for lamp in self.lamps.lamp])
        places: NDArray[np.float64] = self.pose.place(
            _MM_PER_M * self.lamps.distance_m
        ) + across @ np.stack([self.pose.right, self.pose.up])
        return places

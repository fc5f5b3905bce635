"""How long the arms take from one shot to another.

Both arms and both axes of each move together, so a move takes as long as its slowest axis. Each
arm visits few directions: two small tables hold all times, whatever the number of shots.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gonio.timemodel import move_time

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.rig import Rig


@dataclass(frozen=True)
class TimeMetric:
    """Seconds between the shots of a plan.

    Attributes
    ----------
    view_s, light_s
        Seconds between the directions of one arm, shapes (v, v) and (l, l).
    view, light
        Which of these directions each shot has, shape (n,) each.
    """

    view_s: NDArray[np.float64]
    light_s: NDArray[np.float64]
    view: NDArray[np.int64]
    light: NDArray[np.int64]

    @classmethod
    def of(cls, angles_deg: NDArray[np.float64], rig: Rig) -> TimeMetric:
        """Make the tables of shots whose axes stand at `angles_deg`, shape (n, 4), as in AXES."""
        views, view = np.unique(angles_deg[:, :2], axis=0, return_inverse=True)
        lights, light = np.unique(angles_deg[:, 2:], axis=0, return_inverse=True)
        return cls(_arm_s(views, rig, "view"), _arm_s(lights, rig, "light"), view, light)

    @classmethod
    def of_one_arm(cls, times_s: NDArray[np.float64]) -> TimeMetric:
        """Make the metric of one arm's directions alone, from its table of shape (n, n)."""
        nothing = np.zeros(len(times_s), dtype=np.int64)
        return cls(times_s, np.zeros((1, 1)), np.arange(len(times_s)), nothing)

    def __len__(self) -> int:
        return len(self.view)

    def between(self, a: NDArray[np.int64] | np.int64, b: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the seconds from shots `a` to shots `b`."""
        view_s = self.view_s[self.view[a], self.view[b]]
        return np.asarray(np.maximum(view_s, self.light_s[self.light[a], self.light[b]]))

    def total(self, order: NDArray[np.int64]) -> float:
        """Return the seconds of the moves of a route, shot numbers of shape (n,)."""
        return float(self.between(order[:-1], order[1:]).sum())

    def with_nowhere(self) -> TimeMetric:
        """Return the metric with one more shot, no time away from any: where a route may end."""
        return replace(
            self,
            view_s=np.pad(self.view_s, (0, 1)),
            light_s=np.pad(self.light_s, (0, 1)),
            view=np.append(self.view, len(self.view_s)),
            light=np.append(self.light, len(self.light_s)),
        )


def _arm_s(angles_deg: NDArray[np.float64], rig: Rig, arm: str) -> NDArray[np.float64]:
    step = angles_deg[:, None] - angles_deg[None]
    theta_s = move_time(step[..., 0], rig.axis[f"{arm}_theta"])
    return np.maximum(theta_s, move_time(step[..., 1], rig.axis[f"{arm}_phi"]))

"""A plan among the directions that it chose from: which, how often, when."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from gonio.timemodel import pose_angles_deg, route_times
from planner.locate import rows_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from gonio.plan import Plan
    from gonio.rig import Rig
    from planner.candidates import Candidates

Side = Literal["light", "view"]


@dataclass(frozen=True)
class Directions:
    """The candidates of one side.

    Attributes
    ----------
    theta_deg, phi_deg
        Angles in degrees, shape (n,) each.
    of_shot
        Which of them each shot has, shape (shots,).
    refused
        Which the rig cannot take with any direction of the other side, shape (n,).
    """

    theta_deg: NDArray[np.float64]
    phi_deg: NDArray[np.float64]
    of_shot: NDArray[np.int64]
    refused: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.theta_deg)

    @property
    def times(self) -> NDArray[np.int64]:
        """How many shots have each of them, shape (n,)."""
        return np.bincount(self.of_shot, minlength=len(self))


@dataclass(frozen=True)
class Planned:
    """What the page of a plan draws.

    Attributes
    ----------
    light, view
        The candidates of either side.
    done_s
        Seconds from the start of the capture to the end of each shot, shape (shots,).
    refused
        Which pairs the rig cannot take, by reason, shape (lights, views) each.
    """

    light: Directions
    view: Directions
    done_s: NDArray[np.float64]
    refused: Mapping[str, NDArray[np.bool_]]

    @classmethod
    def of(
        cls,
        plan: Plan,
        rig: Rig,
        lights: Candidates,
        views: Candidates,
        refused: Mapping[str, NDArray[np.bool_]],
    ) -> Planned:
        """Find the shots of `plan` among the candidates, and when `rig` takes them."""
        never = np.zeros((len(lights), len(views)), bool)
        for pairs in refused.values():
            never |= pairs
        no_light, no_view = (np.asarray(never.all(axis=axis)) for axis in (1, 0))
        return cls(
            light=_directions(plan, "light", lights, no_light),
            view=_directions(plan, "view", views, no_view),
            done_s=done_s(plan, rig),
            refused=refused,
        )


def _directions(
    plan: Plan, side: Side, candidates: Candidates, refused: NDArray[np.bool_]
) -> Directions:
    return Directions(
        candidates.theta_deg, candidates.phi_deg, rows_of(plan, side, candidates), refused
    )


def done_s(plan: Plan, rig: Rig) -> NDArray[np.float64]:
    """Return about how many seconds from the start each shot ends, shape (shots,).

    Settling is shared alike by the moves, overhead by the frames; what the estimate has beyond
    the shots, homing and calibration, comes before them.
    """
    estimates = plan.estimates
    moves = np.concatenate([[0.0], route_times(pose_angles_deg(plan.shots), rig)])
    moved = moves > 0
    frames = np.array([len(shot.exposures_s) for shot in plan.shots])
    exposing = np.array([math.fsum(shot.exposures_s) for shot in plan.shots])
    settling = estimates.settling_s * moved / max(moved.sum(), 1)
    overhead = estimates.overhead_s * frames / estimates.frames
    done: NDArray[np.float64] = np.cumsum(moves + settling + exposing + overhead)
    return done + max(estimates.total_s - float(done[-1]), 0.0)

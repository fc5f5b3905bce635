"""Anchors: one pair taken again and again through a scan, to see whether the rig drifts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gonio.legs import legs_of
from gonio.paths import blocked, free_way
from gonio.plan import RouteTime
from gonio.timemodel import WHITE_POSE_DEG, estimate, pose_angles_deg, route_times
from gonio.timing import default_timing

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gonio.plan import Plan, Shot
    from gonio.rig import Rig
    from gonio.timing import Timing


def with_anchors(plan: Plan, every: int, rig: Rig, timing: Timing | None = None) -> Plan:
    """Return the plan with an anchor before each `every` shots and one at the end.

    Anchors repeat the shot of the plan that is nearest to the white reference's 0:45, away from
    grazing and from highlights, where no small error of an angle counts. All shots are counted
    anew along the route.

    Parameters
    ----------
    plan
        Without anchors.
    every
        Shots from one anchor to the next.
    rig, timing
        What takes them, and how it acts; without it, as `gonio.timing.default_timing` expects.

    Raises
    ------
    gonio.errors.BadInputError
        When the arms cannot get from a shot to the anchor.
    """
    timing = timing or default_timing(rig)
    anchor = _nearest_to_white(plan.shots).model_copy(update={"anchor": True})
    order = [
        shot
        for number, planned in enumerate(plan.shots)
        for shot in ([anchor] if number % every == 0 else []) + [planned]
    ]
    shots = tuple(
        shot.model_copy(update={"index": index}) for index, shot in enumerate([*order, anchor])
    )
    poses_deg = pose_angles_deg(shots)
    for blocked_way in np.flatnonzero(blocked(poses_deg[:-1], poses_deg[1:], rig)):
        free_way(poses_deg[blocked_way], poses_deg[blocked_way + 1], rig)
    angles_deg, _ = legs_of(poses_deg, rig)
    moving_s = float(route_times(angles_deg, rig, timing).sum())
    changes = {"shots": shots, "estimates": estimate(shots, rig, timing)}
    if plan.route is not None:
        # what no order of the other shots can beat, none of more shots can
        changes["route"] = RouteTime(moving_s=moving_s, bound_s=plan.route.bound_s)
    return plan.model_copy(update=changes)


def _nearest_to_white(shots: Sequence[Shot]) -> Shot:
    def nearness(shot: Shot) -> float:
        # the light is along the normal, so that its azimuth is of no account
        return sum(
            math.cos(math.radians(shot.axis_deg(axis) - WHITE_POSE_DEG[axis]))
            for axis in ("light_theta", "view_theta")
        )

    return max(shots, key=nearness)

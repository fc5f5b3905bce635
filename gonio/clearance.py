"""Which poses of the two arms are free: travel, the angle between the arms, keep-out boxes.

A pose is the angles of the four axes in degrees, in the order of `gonio.rig.AXES`; poses are
arrays of shape (n, 4). Every limit but the travel states a *margin*: the angle in radians by which
an arm could turn, any way, before the limit is touched; below 0 the pose is forbidden. So what a
move passes between two looks at it is bounded by how far the arms turn (see `gonio.swept`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Protocol

import numpy as np

from gonio.boxes import ball_distance_mm, box_distance_mm
from gonio.directions import from_spherical
from gonio.errors import BadInputError
from gonio.geometry import HOLDER_RADIUS_MM
from gonio.rig import AXES
from gonio.timemodel import WHITE_POSE_DEG

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from gonio.rig import KeepOut, Rig

ArmName = Literal["view", "light"]
COLUMNS: dict[ArmName, tuple[int, int]] = {"view": (0, 1), "light": (2, 3)}
"""Which axes of a pose belong to an arm."""

BEYOND_TRAVEL = "beyond the travel of an axis"

ROUND_OFF = 1e-9
"""Radians by which a pose may miss a limit: directions of a grid stand exactly at round ones."""


_THINNEST_MM = 10.0

_FAR = 0.5
"""Radians from which on a margin need not be exact."""


class Limit(Protocol):
    """Something that poses have to keep away from.

    Attributes
    ----------
    reason
        Why a pose that does not is left out.
    columns
        Which axes of a pose it looks at.
    deepest
        How far below 0 the margin can fall, in radians.
    """

    @property
    def reason(self) -> str: ...  # noqa: D102

    @property
    def columns(self) -> tuple[int, ...]: ...  # noqa: D102

    @property
    def deepest(self) -> float: ...  # noqa: D102

    def margin(self, angles_deg: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the radians that are left, shape (n,), for the columns' angles, (n, columns)."""


@dataclass(frozen=True)
class ArmsApart:
    """The two arms keep `least` radians between them (see `required_angle`)."""

    least: float
    reason: str
    columns: tuple[int, ...] = (0, 1, 2, 3)

    @property
    def deepest(self) -> float:
        """How far below 0 the margin can fall, in radians."""
        return self.least

    def margin(self, angles_deg: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the angle between the arms less the required one."""
        return between(_directions(angles_deg[:, :2]), _directions(angles_deg[:, 2:])) - self.least


@dataclass(frozen=True)
class OutOfBoxes:
    """Head and line of sight of one arm touch no box.

    The line of sight is a capsule of half the arm's width, from the edge of the sample holder to
    the head; the sphere at its end is the head. Its distance to a box less its radius, over the
    head's distance from the sample, is an angle that the arm can turn at least.

    Attributes
    ----------
    reach_mm, radius_mm
        Of the head: its distance from the sample, and half its width, above 0.
    """

    columns: tuple[int, ...]
    reach_mm: float
    radius_mm: float
    boxes: tuple[KeepOut, ...]
    reason: str = "inside a keep-out box (arm.keep_out)"

    def margin(self, angles_deg: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the least over all boxes."""
        towards = _directions(angles_deg)
        gap_mm = np.min([self._gap_mm(towards, box) for box in self.boxes], axis=0)
        return np.asarray((gap_mm - self.radius_mm) / self.reach_mm)

    @property
    def deepest(self) -> float:
        """How far below 0 the margin can fall, in radians."""
        return self.radius_mm / self.reach_mm

    def _gap_mm(self, towards: NDArray[np.float64], box: KeepOut) -> NDArray[np.float64]:
        near_mm = min(HOLDER_RADIUS_MM, self.reach_mm)
        gap_mm = ball_distance_mm(towards, near_mm, self.reach_mm, box)
        # far away, what is surely between them will do
        close = gap_mm - self.radius_mm < _FAR * self.reach_mm
        gap_mm[close] = box_distance_mm(towards[close], near_mm, self.reach_mm, box)
        return gap_mm


def required_angle(rig: Rig) -> float:
    """Return the angle in radians that the arms keep between them; 0 where there is none to keep.

    With `min_separation_deg` 0 the arms may pass each other. Above 0 it is the greater of it and
    the angle at which the heads stop hiding each other, seen from the sample:
    atan((arm_width_mm + lamp_width_mm) / 2 / distance), with the distance of the nearer head.
    """
    if rig.arm.min_separation_deg == 0:
        return 0.0
    nearer_mm = 1000.0 * min(rig.camera.distance_m, rig.lamps.distance_m)
    widths = math.atan((rig.arm.arm_width_mm + rig.arm.lamp_width_mm) / 2.0 / nearer_mm)
    return max(math.radians(rig.arm.min_separation_deg), widths)


def limits_of(rig: Rig) -> tuple[Limit, ...]:
    """Return what the rig's poses keep away from; none where it has neither separation nor box."""
    apart = required_angle(rig)
    limits: list[Limit] = [ArmsApart(apart, _apart_reason(apart, rig))] if apart else []
    if boxes := rig.arm.keep_out:
        view, light = COLUMNS["view"], COLUMNS["light"]
        camera_mm, lamps_mm = 1000.0 * rig.camera.distance_m, 1000.0 * rig.lamps.distance_m
        limits += [
            OutOfBoxes(view, camera_mm, _radius_mm(rig.arm.arm_width_mm), boxes),
            OutOfBoxes(light, lamps_mm, _radius_mm(rig.arm.lamp_width_mm), boxes),
        ]
    return tuple(limits)


def _radius_mm(width_mm: float) -> float:
    """Return half a width; no arm is a line, and one without a width would touch nothing."""
    return max(width_mm / 2.0, _THINNEST_MM)


def not_free(poses_deg: ArrayLike, rig: Rig) -> dict[str, NDArray[np.bool_]]:
    """Return which poses the rig cannot take, by reason, in the order of the checks.

    Parameters
    ----------
    poses_deg
        Shape (n, 4).

    Returns
    -------
    dict
        Shape (n,) each; a pose is under the first reason only, a free one under none.
    """
    poses = np.asarray(poses_deg, np.float64)
    reasons = {BEYOND_TRAVEL: beyond_travel(poses, rig)}
    taken = reasons[BEYOND_TRAVEL].copy()
    for limit in limits_of(rig):
        short = (limit.margin(poses[:, limit.columns]) < -ROUND_OFF) & ~taken
        reasons[limit.reason] = reasons.get(limit.reason, False) | short
        taken |= short
    return reasons


def beyond_travel(poses_deg: NDArray[np.float64], rig: Rig) -> NDArray[np.bool_]:
    """Return which poses, shape (n, 4), have an axis beyond its travel, shape (n,)."""
    low = np.array([rig.axis[name].min_deg for name in AXES])
    high = np.array([rig.axis[name].max_deg for name in AXES])
    return np.asarray(((poses_deg < low) | (poses_deg > high)).any(axis=-1))


def check_pose(pose_deg: ArrayLike, rig: Rig) -> None:
    """Refuse a pose, shape (4,), that the rig cannot take.

    Raises
    ------
    BadInputError
        Naming the axis and its travel, or the pose and the limit.
    """
    pose = np.asarray(pose_deg, np.float64)
    for name, angle in zip(AXES, pose.tolist(), strict=True):
        rig.check_reach(name, angle)
    for reason, short in not_free(pose[None], rig).items():
        if short[0]:
            raise BadInputError(
                f"{spoken(pose)} is {reason}; make a new plan with gonio plan --rig, or correct "
                "the rig file if it is wrong"
            )


def check_white(rig: Rig) -> None:
    """Refuse a rig that cannot see the white reference at 0:45: nothing it takes has a scale.

    Raises
    ------
    BadInputError
        As `check_pose`, naming the white reference.
    """
    try:
        check_pose([WHITE_POSE_DEG[name] for name in AXES], rig)
    except BadInputError as error:
        raise BadInputError(f"white reference: {error}") from None


def spoken(pose_deg: NDArray[np.float64]) -> str:
    """Return a pose as people read it: view 45/0, light 0/0 deg (theta/phi)."""
    view_theta, view_phi, light_theta, light_phi = (f"{angle:.6g}" for angle in pose_deg)
    return f"view {view_theta}/{view_phi}, light {light_theta}/{light_phi} deg (theta/phi)"


def between(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the angles in radians between unit vectors, shapes (..., 3)."""
    # by half the chord: an arccosine loses half the digits at small angles, as this does near pi
    chord = a - b
    return np.asarray(2.0 * np.arcsin(np.minimum(0.5 * np.sqrt((chord * chord).sum(axis=-1)), 1.0)))


def _directions(angles_deg: NDArray[np.float64]) -> NDArray[np.float64]:
    angles = np.radians(angles_deg)
    return from_spherical(angles[:, 0], angles[:, 1])


def _apart_reason(apart: float, rig: Rig) -> str:
    if apart > math.radians(rig.arm.min_separation_deg):
        return f"closer than {math.degrees(apart):.4g} deg (arm_width_mm, lamp_width_mm)"
    return f"closer than {rig.arm.min_separation_deg:g} deg (arm.min_separation_deg)"

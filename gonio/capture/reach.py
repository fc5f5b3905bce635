"""Whether a rig can take a plan: every pose, and every way from one to the next."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

import numpy as np

from gonio.clearance import check_pose, check_white
from gonio.errors import BadInputError
from gonio.paths import blocked, free_way
from gonio.rig import AXES
from gonio.timemodel import WHITE_POSE_DEG, pose_angles_deg

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from gonio.plan import Shot
    from gonio.rig import Rig


def check_reach(shots: Sequence[Shot], rig: Rig) -> None:
    """Refuse shots before anything moves when the rig cannot take all of them in their order.

    That is the white reference, each shot, and the ways from each to the next.

    Raises
    ------
    gonio.errors.BadInputError
        Naming the shot, and the axis with its travel or what the arms come too near to.
    """
    check_white(rig)
    names = ["white reference", *(f"shot {shot.index}" for shot in shots)]
    white = np.array([[WHITE_POSE_DEG[name] for name in AXES]])
    poses = np.concatenate([white, pose_angles_deg(shots).reshape(-1, 4)])
    for name, pose in zip(names[1:], poses[1:], strict=True):
        with _named(name):
            check_pose(pose, rig)
    at = poses[0]
    for number, hit in enumerate(blocked(poses[:-1], poses[1:], rig), 1):
        straight = not hit and (at == poses[number - 1]).all()
        with _named(f"{names[number - 1]} to {names[number]}"):
            # a way may end with an azimuth a turn away, from where the next one starts
            at = poses[number] if straight else free_way(at, poses[number], rig).poses_deg[-1]


@contextlib.contextmanager
def _named(what: str) -> Iterator[None]:
    try:
        yield
    except BadInputError as error:
        raise BadInputError(f"{what}: {error}") from None

"""Rigs that differ from the built-in one, and a plain account of how long their moves take."""

from itertools import pairwise, permutations

import numpy as np

from gonio.rig import AXES, Rig, default_rig
from gonio.timemodel import move_time

RIG = default_rig()
WIDE = (-370.0, 730.0)
"""Travel of a phi axis that reaches every direction three times or so."""


def rig_of(phi_travel=(0.0, 359.0), **fields):
    """Return the built-in rig with other phi travel, and fields of all its axes."""
    data = RIG.model_dump()
    for name, axis in data["axis"].items():
        if name.endswith("phi"):
            axis["min_deg"], axis["max_deg"] = phi_travel
        axis.update(fields)
    return Rig.model_validate(data)


def move_s(start, goal, rig):
    """Return the seconds of one move as the arm makes it: all axes go, then those with a run-up."""
    first, then = [], [0.0]
    for name, a, b in zip(AXES, start, goal, strict=True):
        axis, stop = rig.axis[name], b
        up = axis.approach_deg
        if up and abs(b - a) > axis.in_position_deg and (b - a) / up < 1.0:
            stop = min(max(b - up, axis.min_deg), axis.max_deg)
            then.append(float(move_time(b - stop, axis)))
        first.append(float(move_time(stop - a, axis)))
    return max(first) + max(then)


def route_s(poses_deg, rig):
    return sum(move_s(a, b, rig) for a, b in pairwise(poses_deg))


def least_s(between_s):
    """Return the seconds of the best of all orders, given those between shots, shape (n, n)."""
    orders = np.array(list(permutations(range(len(between_s)))))
    return between_s[orders[:, :-1], orders[:, 1:]].sum(axis=1).min()


def between_s(angles_deg, rig):
    return np.array([[move_s(a, b, rig) for b in angles_deg] for a in angles_deg])


def stands_deg(angles_deg, route):
    """Return the angles of the axes along a route, shape (n, 4)."""
    stands = angles_deg[route.order].copy()
    stands[:, 1::2] = route.phi_deg + 360.0 * route.turns
    return stands

"""From a rig and a density to a Plan."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadInputError
from gonio.plan import LampSetting, LeftOut, Plan, RouteTime, Selection, Shot
from gonio.timemodel import estimate
from planner.candidates import paper_candidates
from planner.criteria import criterion_named, reciprocal_pairs
from planner.density import count_of
from planner.reach import apart, refuse_keep_out, within_travel
from planner.route import plan_route

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from gonio.protocols import Prior
    from gonio.rig import Rig
    from planner.candidates import Candidates
    from planner.density import Density
    from planner.route import Route

FULL_CURRENT_MA = 700.0


def make_plan(
    rig: Rig,
    *,
    views: Density = "sixth",
    lights: Density = "sixth",
    criterion: str = "farthest",
    shots: int | None = None,
    prior: Callable[[], Prior] | None = None,
) -> Plan:
    """Choose directions, leave out what the rig cannot take, and put the rest in order.

    Every shot takes all of the rig's exposures, with all of its lamps at 700 mA.

    Parameters
    ----------
    rig
        What will measure: its travel, separation, speeds and exposures count.
    views, lights
        `all`, `sixth`, or a number of directions (see `planner.density`).
    criterion
        How directions are chosen, by name (see `planner.criteria`).
    shots
        Choose so many pairs freely, rather than all pairs of some views and lights.
    prior
        Makes what is believed of the material, for criteria that ask.

    Raises
    ------
    BadInputError
        For a density or criterion that is none, or when the rig can take no such shot.
    """
    refuse_keep_out(rig)
    candidates = paper_candidates()
    reach, allowed = _pairs_within_reach(candidates, rig)
    judge = criterion_named(criterion, candidates.directions, prior)
    if shots is not None:
        choice = judge.pairs(allowed, _checked_shots(shots, int(allowed.sum())))
    else:
        choice = judge.product(
            allowed,
            count_of(views, len(candidates), int(reach.any(axis=0).sum()), "view"),
            count_of(lights, len(candidates), int(reach.any(axis=1).sum()), "light"),
        )
    measured = choice.measured & allowed
    if not measured.any():
        raise BadInputError(
            f"all {choice.measured.sum()} chosen pairs are closer than arm.min_separation_deg "
            f"({rig.arm.min_separation_deg:g}); correct it in the rig file, or take more directions"
        )
    ordered, route = _in_order(candidates, measured, rig)
    selection = Selection(
        criterion=criterion,
        candidates=candidates.name,
        views=int(measured.any(axis=0).sum()),
        lights=int(measured.any(axis=1).sum()),
        full_set=measured.size,
        reciprocal_pairs=reciprocal_pairs(measured),
        variance_left=choice.variance_left,
        route=route.method,
    )
    return Plan(
        rig_sha256=rig.sha256,
        selection=selection,
        left_out=_left_out(reach, choice.measured, measured, rig),
        estimates=estimate(ordered, rig),
        route=RouteTime(moving_s=route.moving_s, bound_s=route.bound_s),
        shots=ordered,
    )


def _pairs_within_reach(
    candidates: Candidates, rig: Rig
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which pairs each arm can take, and which of these keep the arms apart, (n, n)."""
    reach = np.outer(
        within_travel(candidates, rig, "light"), within_travel(candidates, rig, "view")
    )
    allowed = reach & apart(candidates, rig)
    if not allowed.any():
        raise BadInputError(
            f"all pairs are closer than arm.min_separation_deg ({rig.arm.min_separation_deg:g}); "
            "correct it in the rig file"
        )
    return reach, allowed


def _checked_shots(shots: int, most: int) -> int:
    if not 1 <= shots <= most:
        raise BadInputError(f"shots is {shots}; give 1 to {most}, all pairs that the rig can take")
    return shots


def _in_order(
    candidates: Candidates, measured: NDArray[np.bool_], rig: Rig
) -> tuple[tuple[Shot, ...], Route]:
    """Return the shots of `measured`, indexed [light, view], in route order, and their route."""
    light, view = np.nonzero(measured)
    theta_deg, phi_deg = candidates.theta_deg, candidates.phi_deg
    route = plan_route(
        np.stack([theta_deg[view], phi_deg[view], theta_deg[light], phi_deg[light]], axis=1), rig
    )
    lamps = tuple(LampSetting(n=lamp.n, mA=FULL_CURRENT_MA) for lamp in rig.lamps.lamp)
    columns = {
        "view_theta_deg": theta_deg[view][route.order],
        "light_theta_deg": theta_deg[light][route.order],
        "view_phi_deg": route.phi_deg[:, 0],
        "light_phi_deg": route.phi_deg[:, 1],
        "view_turn": route.turns[:, 0],
        "light_turn": route.turns[:, 1],
    }
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    shots = (
        Shot(
            index=index,
            exposures_s=rig.camera.exposures_s,
            lamps=lamps,
            **dict(zip(columns, row, strict=True)),
        )
        for index, row in enumerate(rows)
    )
    return tuple(shots), route


def _left_out(
    reach: NDArray[np.bool_], chosen: NDArray[np.bool_], measured: NDArray[np.bool_], rig: Rig
) -> tuple[LeftOut, ...]:
    """Return why each pair that is not measured is not, in the order of the checks."""
    separation = f"closer than {rig.arm.min_separation_deg:g} deg (arm.min_separation_deg)"
    reasons = {
        "beyond the travel of an axis": ~reach,
        "not chosen at this density": reach & ~chosen,
        separation: chosen & ~measured,
    }
    counts = {reason: int(pairs.sum()) for reason, pairs in reasons.items()}
    return tuple(LeftOut(reason=reason, shots=shots) for reason, shots in counts.items() if shots)

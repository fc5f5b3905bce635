"""From a rig and a density to a Plan."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadInputError
from gonio.plan import LampSetting, LeftOut, Plan, Selection, Shot
from gonio.rig import AXES
from gonio.timemodel import estimate
from planner.candidates import paper_candidates
from planner.criteria import criterion_named, reciprocal_pairs
from planner.density import count_of
from planner.reach import apart, refuse_keep_out, within_travel
from planner.route import plan_route

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.rig import Rig
    from planner.candidates import Candidates
    from planner.density import Density

FULL_CURRENT_MA = 700.0


def make_plan(
    rig: Rig,
    *,
    views: Density = "sixth",
    lights: Density = "sixth",
    criterion: str = "farthest",
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

    Raises
    ------
    BadInputError
        For a density or criterion that is none, or when the rig can take no such shot.
    """
    refuse_keep_out(rig)
    candidates = paper_candidates()
    reach = np.outer(
        within_travel(candidates, rig, "light"), within_travel(candidates, rig, "view")
    )
    chosen = _choose(candidates, reach, views, lights, criterion)
    measured = chosen & apart(candidates, rig)
    if not measured.any():
        raise BadInputError(
            f"all {chosen.sum()} chosen pairs are closer than arm.min_separation_deg "
            f"({rig.arm.min_separation_deg:g}); correct it in the rig file, or take more directions"
        )
    shots, method = _in_order(candidates, measured, rig)
    selection = Selection(
        criterion=criterion,
        candidates=candidates.name,
        views=int(measured.any(axis=0).sum()),
        lights=int(measured.any(axis=1).sum()),
        full_set=measured.size,
        reciprocal_pairs=reciprocal_pairs(measured),
        route=method,
    )
    return Plan(
        rig_sha256=rig.sha256,
        selection=selection,
        left_out=_left_out(reach, chosen, measured, rig),
        estimates=estimate(shots, rig),
        shots=shots,
    )


def _choose(
    candidates: Candidates,
    reach: NDArray[np.bool_],
    views: Density,
    lights: Density,
    criterion: str,
) -> NDArray[np.bool_]:
    """Return the product of chosen lights and views among those in reach, (n, n) as `reach`."""
    light_reach, view_reach = np.flatnonzero(reach.any(axis=1)), np.flatnonzero(reach.any(axis=0))
    choice = criterion_named(criterion).choose(
        candidates.directions[view_reach],
        candidates.directions[light_reach],
        count_of(views, len(candidates), len(view_reach), "view"),
        count_of(lights, len(candidates), len(light_reach), "light"),
    )
    chosen = np.zeros_like(reach)
    chosen[np.ix_(light_reach[choice.lights], view_reach[choice.views])] = True
    return chosen


def _in_order(
    candidates: Candidates, measured: NDArray[np.bool_], rig: Rig
) -> tuple[tuple[Shot, ...], str]:
    """Return the shots of `measured`, indexed [light, view], in route order, and its method."""
    light, view = np.nonzero(measured)
    theta_deg, phi_deg = candidates.theta_deg, candidates.phi_deg
    angles_deg = np.stack(
        [theta_deg[view], phi_deg[view], theta_deg[light], phi_deg[light]], axis=1
    )
    route = plan_route(angles_deg, rig)
    lamps = tuple(LampSetting(n=lamp.n, mA=FULL_CURRENT_MA) for lamp in rig.lamps.lamp)
    shots = (
        Shot(
            index=index,
            exposures_s=rig.camera.exposures_s,
            lamps=lamps,
            **{f"{name}_deg": angle for name, angle in zip(AXES, angles, strict=True)},
        )
        for index, angles in enumerate(angles_deg[route.order].tolist())
    )
    return tuple(shots), route.method


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

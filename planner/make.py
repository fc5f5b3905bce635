"""From a rig and a density to a Plan."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadInputError
from gonio.plan import LampSetting, LeftOut, Plan, Selection, Shot
from gonio.rig import AXES
from gonio.timemodel import estimate
from gonio.timing import default_timing
from planner.candidates import paper_candidates
from planner.criteria import criterion_named
from planner.density import count_of
from planner.exposures import with_predicted_exposures
from planner.field import Field
from planner.reach import apart, refuse_keep_out, within_travel
from planner.route import plan_route

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from gonio.protocols import Prior
    from gonio.rig import Rig
    from gonio.timing import Timing
    from planner.candidates import Candidates
    from planner.density import Density

    Demand = Callable[[Candidates, Candidates], NDArray[np.float64]]
    Omission = Callable[[Field], NDArray[np.bool_]]

FULL_CURRENT_MA = 700.0


def make_plan(
    rig: Rig,
    *,
    views: Density = "sixth",
    lights: Density = "sixth",
    criterion: str = "farthest",
    shots: int | None = None,
    prior: Callable[[], Prior] | None = None,
    view_candidates: Candidates | None = None,
    light_candidates: Candidates | None = None,
    demand: Demand | None = None,
    leave_out: Mapping[str, Omission] | None = None,
    seed: int = 0,
    timing: Timing | None = None,
    bracket: str = "all",
) -> Plan:
    """Choose directions, leave out what the rig cannot take, and put the rest in order.

    Every shot is taken with all of the rig's lamps at 700 mA.

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
        Makes what is believed of the material, for criteria that ask, and for predicted exposures.
    view_candidates, light_candidates
        What to choose from (see `planner.candidates`); the paper's 81 unless given.
    demand
        Makes of light and view candidates how much each pair counts, shape (L, V); None: all alike.
    leave_out
        Returns of a field which pairs need not be measured, shape (L, V), by reason.
    seed
        Of the random criterion.
    timing
        How the rig acts; without it, as `gonio.timing.default_timing` expects.
    bracket
        `all` of the rig's exposures for every shot, or those `predicted` to show it (see
        `planner.exposures`).

    Raises
    ------
    BadInputError
        For a density or criterion that is none, or when the rig can take no such shot.
    """
    refuse_keep_out(rig)
    judge = criterion_named(criterion, prior, seed)
    light_set, view_set = (
        each or paper_candidates() for each in (light_candidates, view_candidates)
    )
    reach, field = _field_within_reach(light_set, view_set, rig, demand)
    field, omitted = _without(field, leave_out or {})
    if shots is not None:
        choice = judge.pairs(field, _checked_shots(shots, int(field.allowed.sum())))
    else:
        choice = judge.product(
            field,
            count_of(lights, len(light_set), int(field.allowed.any(axis=1).sum()), "light"),
            count_of(views, len(view_set), int(field.allowed.any(axis=0).sum()), "view"),
        )
    measured = choice.measured & field.allowed
    if not measured.any():
        raise BadInputError(
            f"all {choice.measured.sum()} chosen pairs are closer than arm.min_separation_deg "
            f"({rig.arm.min_separation_deg:g}); correct it in the rig file, or take more directions"
        )
    ordered, method = _in_order(field, measured, rig)
    if bracket == "predicted":
        if prior is None:
            raise BadInputError("predicted exposures need a prior; use bracket all, or pass one")
        ordered = with_predicted_exposures(ordered, prior(), rig, timing or default_timing(rig))
    selection = Selection(
        criterion=criterion,
        candidates=_set_names(light_set, view_set),
        views=int(measured.any(axis=0).sum()),
        lights=int(measured.any(axis=1).sum()),
        full_set=measured.size,
        reciprocal_pairs=field.reciprocal(measured),
        variance_left=choice.variance_left,
        variance_bound=choice.variance_bound,
        route=method,
    )
    return Plan(
        rig_sha256=rig.sha256,
        selection=selection,
        left_out=_left_out(reach, omitted, choice.measured, measured, rig),
        estimates=estimate(ordered, rig, timing),
        shots=ordered,
    )


def _set_names(lights: Candidates, views: Candidates) -> str:
    if lights.name == views.name:
        return lights.name
    return f"lights {lights.name}, views {views.name}"


def _field_within_reach(
    lights: Candidates, views: Candidates, rig: Rig, demand: Demand | None
) -> tuple[NDArray[np.bool_], Field]:
    """Return which pairs each arm can take, shape (L, V), and those that keep the arms apart."""
    reach = np.outer(within_travel(lights, rig, "light"), within_travel(views, rig, "view"))
    allowed = reach & apart(lights, views, rig)
    if not allowed.any():
        raise BadInputError(
            f"all pairs are closer than arm.min_separation_deg ({rig.arm.min_separation_deg:g}); "
            "correct it in the rig file"
        )
    return reach, Field(lights, views, allowed, None if demand is None else demand(lights, views))


def field_of(
    rig: Rig, lights: Candidates, views: Candidates, leave_out: Mapping[str, Omission]
) -> Field:
    """Return the pairs that a plan would choose from."""
    return _without(_field_within_reach(lights, views, rig, None)[1], leave_out)[0]


def _without(
    field: Field, leave_out: Mapping[str, Omission]
) -> tuple[Field, dict[str, NDArray[np.bool_]]]:
    """Return the field less what is left out, and which pairs that are, by reason.

    Raises
    ------
    BadInputError
        When nothing is left.
    """
    omitted = {}
    for reason, of in leave_out.items():
        omitted[reason] = field.allowed & of(field)
        field = replace(field, allowed=field.allowed & ~omitted[reason])
        if not field.allowed.any():
            raise BadInputError(
                f"no pair is left: all that the rig can take {reason}; widen the scene, or the "
                "travel in the rig file"
            )
    return field, omitted


def _checked_shots(shots: int, most: int) -> int:
    if not 1 <= shots <= most:
        raise BadInputError(f"shots is {shots}; give 1 to {most}, all pairs that the rig can take")
    return shots


def _in_order(field: Field, measured: NDArray[np.bool_], rig: Rig) -> tuple[tuple[Shot, ...], str]:
    """Return the shots of `measured`, indexed [light, view], in route order, and its method."""
    light, view = np.nonzero(measured)
    sides = (field.views, view), (field.lights, light)
    angles_deg = np.stack(
        [angle[rows] for each, rows in sides for angle in (each.theta_deg, each.phi_deg)], axis=1
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
    reach: NDArray[np.bool_],
    omitted: Mapping[str, NDArray[np.bool_]],
    chosen: NDArray[np.bool_],
    measured: NDArray[np.bool_],
    rig: Rig,
) -> tuple[LeftOut, ...]:
    """Return why each pair that is not measured is not, in the order of the checks."""
    separation = f"closer than {rig.arm.min_separation_deg:g} deg (arm.min_separation_deg)"
    reasons = {
        "beyond the travel of an axis": ~reach,
        **omitted,
        "not chosen": reach & ~chosen & ~np.any([*omitted.values()], axis=0),
        separation: chosen & ~measured,
    }
    counts = {reason: int(pairs.sum()) for reason, pairs in reasons.items()}
    return tuple(
        LeftOut(reason=reason, shots=shots)
        for reason, shots in counts.items()
        if shots or reason in omitted
    )

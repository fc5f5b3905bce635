"""From a rig and a density to a Plan."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from gonio.clearance import check_white
from gonio.errors import BadInputError
from gonio.plan import LeftOut, Plan, RouteTime, Selection
from gonio.timemodel import estimate
from gonio.timing import default_timing
from planner.candidates import paper_candidates
from planner.criteria import criterion_named
from planner.density import count_of
from planner.field import Field
from planner.reach import reach_of
from planner.shots import ShotMaker

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import numpy as np
    from numpy.typing import NDArray

    from gonio.plan import Shot
    from gonio.protocols import Prior, Progress
    from gonio.rig import Rig
    from gonio.timing import Timing
    from planner.candidates import Candidates
    from planner.density import Density

    Demand = Callable[[Candidates, Candidates], NDArray[np.float64]]
    Omission = Callable[[Field], NDArray[np.bool_]]


FEWER_FRAMES = "by taking only the exposures that may show a shot better than the others do"


def make_plan(
    rig: Rig,
    *,
    views: Density = "sixth",
    lights: Density = "sixth",
    criterion: str = "farthest",
    shots: int | None = None,
    hours: float | None = None,
    prior: Callable[[], Prior] | None = None,
    view_candidates: Candidates | None = None,
    light_candidates: Candidates | None = None,
    demand: Demand | None = None,
    max_theta_deg: float | None = None,
    leave_out: Mapping[str, Omission] | None = None,
    seed: int = 0,
    timing: Timing | None = None,
    bracket: str = "all",
    progress: Progress | None = None,
) -> Plan:
    """Choose directions, leave out what the rig cannot take, and put the rest in order.

    Every shot is taken with all of the rig's lamps at 700 mA.

    Parameters
    ----------
    rig
        What will measure: its travel, separation, boxes, speeds and exposures count.
    views, lights
        `all`, `sixth`, or a number of directions (see `planner.density`).
    criterion
        How directions are chosen, by name (see `planner.criteria`).
    shots
        Choose so many pairs freely, rather than all pairs of some views and lights.
    hours
        Choose the pairs that tell most in so many hours of rig time, each for what it costs.
    prior
        Makes what is believed of the material, for criteria that ask, and for predicted exposures.
    view_candidates, light_candidates
        What to choose from (see `planner.candidates`); the paper's 81 unless given.
    demand
        Makes of light and view candidates how much each pair counts, shape (L, V); None: all alike.
    max_theta_deg
        Leave out directions closer to grazing than that.
    leave_out
        Returns of a field which pairs need not be measured, shape (L, V), by reason.
    seed
        Of the random criterion.
    timing
        How the rig acts; without it, as `gonio.timing.default_timing` expects.
    bracket
        `all` of the rig's exposures for every shot, or those `predicted` to show it (see
        `planner.exposures`).
    progress
        Called with the steps of the choice done, and those there may be.

    Raises
    ------
    BadInputError
        For a density or criterion that is none, or when the rig can take no such shot.
    """
    judge = criterion_named(criterion, prior, seed, progress)
    light_set, view_set = (
        each or paper_candidates() for each in (light_candidates, view_candidates)
    )
    reach = reach_of(light_set, view_set, rig, max_theta_deg)
    check_white(rig)
    counts = None if demand is None else demand(light_set, view_set)
    field, omitted = _without(Field(light_set, view_set, reach.allowed, counts), leave_out or {})
    timing = timing or default_timing(rig)
    maker = ShotMaker(field, rig, timing, _exposing(prior, bracket))
    if hours is not None:
        choice = judge.within(field, 3600 * hours, maker.terms())
    elif shots is not None:
        choice = judge.pairs(field, _checked_shots(shots, int(field.allowed.sum())))
    else:
        choice = judge.product(field, *_counts(lights, views, field))
    measured = choice.measured & field.allowed
    if not measured.any():
        raise BadInputError(
            f"all {choice.measured.sum()} chosen pairs are {', '.join(reach.together)}; correct "
            "that in the rig file, or take more directions"
        )
    ordered, route = maker.ordered(measured)
    selection = Selection(
        criterion=criterion,
        candidates=_set_names(light_set, view_set),
        views=int(measured.any(axis=0).sum()),
        lights=int(measured.any(axis=1).sum()),
        full_set=measured.size,
        reciprocal_pairs=field.reciprocal(measured),
        variance_left=choice.variance_left,
        variance_bound=choice.variance_bound,
        route=route.method,
    )
    return Plan(
        rig_sha256=rig.sha256,
        selection=selection,
        left_out=(
            *reach.left_out(choice.measured, omitted, freely=shots is not None or bool(hours)),
            *_frames_left_out(ordered, rig, timing),
        ),
        estimates=estimate(ordered, rig, timing),
        route=RouteTime(moving_s=route.moving_s, bound_s=route.bound_s),
        shots=ordered,
    )


def _frames_left_out(shots: tuple[Shot, ...], rig: Rig, timing: Timing) -> tuple[LeftOut, ...]:
    """Return what it spares that shots take fewer exposures than the rig has, where any do."""
    every = rig.camera.exposures_s
    if all(len(shot.exposures_s) == len(every) for shot in shots):
        return ()
    whole = tuple(shot.model_copy(update={"exposures_s": every}) for shot in shots)
    seconds = [estimate(each, rig, timing).total_s for each in (whole, shots)]
    spared_min = (seconds[0] - seconds[1]) / 60
    return (LeftOut(reason=FEWER_FRAMES, shots=0, spared_shots=0, spared_min=spared_min),)


def _counts(lights: Density, views: Density, field: Field) -> tuple[int, int]:
    """Return how many lights and how many views to choose."""
    # what was said of both at once is refused as that
    said = ("density", "density") if lights == views else ("lights", "views")
    reachable = [int(field.allowed.any(axis=axis).sum()) for axis in (1, 0)]
    return (
        count_of(lights, len(field.lights), reachable[0], "light", said[0]),
        count_of(views, len(field.views), reachable[1], "view", said[1]),
    )


def _set_names(lights: Candidates, views: Candidates) -> str:
    if lights.name == views.name:
        return lights.name
    return f"lights {lights.name}, views {views.name}"


def field_within(
    rig: Rig,
    lights: Candidates,
    views: Candidates,
    max_theta_deg: float | None,
    leave_out: Mapping[str, Omission],
) -> Field:
    """Return the pairs that a plan would choose from."""
    field = Field(lights, views, reach_of(lights, views, rig, max_theta_deg).allowed)
    return _without(field, leave_out)[0]


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


def _exposing(prior: Callable[[], Prior] | None, bracket: str) -> Prior | None:
    if bracket != "predicted":
        return None
    if prior is None:
        raise BadInputError("predicted exposures need a prior; use bracket all, or pass one")
    return prior()


def _checked_shots(shots: int, most: int) -> int:
    if not 1 <= shots <= most:
        raise BadInputError(f"shots is {shots}; give 1 to {most}, all pairs that the rig can take")
    return shots

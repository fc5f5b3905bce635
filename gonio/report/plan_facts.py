"""What a plan's page says in numbers and words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.words import duration, several, size

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gonio.plan import Estimates, LeftOut, Plan

_NAMES = {
    "full_set": "pairs of candidates",
    "reciprocal_pairs": "measured both ways round",
    "variance_bound": "of any choice at least",
}


def cards(plan: Plan) -> Iterator[tuple[str, str, str]]:
    """Yield what comes first: name, value, and what it is of."""
    selection, estimates, shots = plan.selection, plan.estimates, len(plan.shots)
    yield (
        "shots",
        f"{shots}",
        f"{several(selection.lights, 'light')}, {several(selection.views, 'view')}",
    )
    yield "measured", f"{100 * shots / selection.full_set:.3g} %", f"of {selection.full_set} pairs"
    yield "time", duration(estimates.total_s), _interval(estimates)
    yield "storage", size(estimates.storage_bytes), f"in {estimates.frames} frames"
    if selection.variance_left is not None:
        yield "left unknown", f"{selection.variance_left:.2%}", selection.variance_of


def parts(estimates: Estimates) -> Iterator[tuple[str, float, str]]:
    """Yield the parts of the time: name, seconds, and seconds in words."""
    for name in type(estimates).model_fields:
        if name.endswith("_s") and not name.startswith("total"):
            seconds = float(getattr(estimates, name))
            yield name.removesuffix("_s").replace("_", " "), seconds, duration(seconds)


def ends_s(estimates: Estimates) -> tuple[float, float] | None:
    """Return between which times a capture ends, in seconds, where the estimate says."""
    low, high = (getattr(estimates, f"total_{end}_s", None) for end in ("lo", "hi"))
    return None if low is None or high is None else (low, high)


def _interval(estimates: Estimates) -> str:
    ends = ends_s(estimates)
    if ends is None:
        return "homing and calibration included"
    return f"+- {duration((ends[1] - ends[0]) / 2)} (5 to 95 %)"


def facts(plan: Plan) -> Iterator[tuple[str, str]]:
    """Yield how the shots were chosen: each field of the selection that says something."""
    for name in type(plan.selection).model_fields:
        value = getattr(plan.selection, name)
        if value is not None:
            # the only fractions there are shares of the prior's variance
            text = f"{value:.2%} of the prior's" if isinstance(value, float) else str(value)
            yield _NAMES.get(name, name.replace("_", " ")), text


def spared_rows(left_out: LeftOut) -> Iterator[tuple[str, str]]:
    """Say what an omission spares, where the plan knows."""
    if left_out.spared_shots is None:
        return
    seconds = 60 * (left_out.spared_min or 0.0)
    shots, time = several(abs(left_out.spared_shots), "shot"), duration(abs(seconds))
    if not left_out.spared_shots:
        yield "spares" if seconds >= 0 else "costs", time
    elif (left_out.spared_shots < 0) == (seconds < 0):
        yield "costs" if seconds < 0 else "spares", f"{shots}, {time}"
    else:
        more, less = (time, shots) if seconds < 0 else (shots, time)
        yield "spares", f"{less}, and costs {more}"
    if left_out.error_inside is not None:
        elsewhere = left_out.error_outside
        there = "" if elsewhere is None else f", {elsewhere:+.4f} elsewhere"
        yield (
            "expected error",
            f"{left_out.error_inside:+.4f} in what counts{there} (deviation of ln BRDF)",
        )

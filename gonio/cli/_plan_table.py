"""What a plan says in the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gonio.plan import Estimates, Plan


def print_plan(plan: Plan) -> None:
    """Print what a plan takes, leaves out and costs."""
    from rich.table import Table

    from gonio.cli._console import console

    table = Table(show_header=False, box=None)
    for name, value in _rows(plan):
        table.add_row(name, value)
    console.print(table)


def _rows(plan: Plan) -> Iterator[tuple[str, str]]:
    from gonio.report.plan_facts import spared_rows
    from gonio.words import duration, several, size

    selection, estimates, shots = plan.selection, plan.estimates, len(plan.shots)
    yield "views", str(selection.views)
    yield "lights", str(selection.lights)
    yield "shots", f"{shots}, {shots / selection.full_set:.1%} of the full set"
    if anchors := sum(shot.anchor for shot in plan.shots):
        yield "anchors", f"{anchors} of these shots repeat one pair"
    yield "measured both ways", f"{several(selection.reciprocal_pairs, 'pair')}, by reciprocity"
    if selection.variance_left is not None:
        bound = selection.variance_bound
        at_best = "" if bound is None else f"; no choice of so many leaves less than {bound:.2%}"
        of_what = selection.variance_of if plan.parent is None else "of what was unknown before it"
        yield "left unknown", f"{selection.variance_left:.2%} {of_what}{at_best}"
    for left_out in plan.left_out:
        yield "left out", f"{left_out.shots} {left_out.reason}"
        yield from ((f"  {name}", text) for name, text in spared_rows(left_out))
    yield "estimated time", _with_interval(estimates)
    for name in ("moving", "settling", "exposing", "overhead", "homing"):
        yield f"  {name}", duration(getattr(estimates, f"{name}_s"))
    yield "  timing", _timing_of(estimates)
    yield "estimated storage", f"{size(estimates.storage_bytes)} in {estimates.frames} frames"
    yield "route", selection.route
    if plan.route is not None:
        yield "", f"{plan.route.moving_s:.1f} s of moves; {plan.route.bound_s:.1f} s at the least"


def _with_interval(estimates: Estimates) -> str:
    from gonio.words import duration

    total = duration(estimates.total_s)
    if estimates.total_hi_s is None:
        return total
    reach_s = estimates.total_hi_s - estimates.total_s
    return f"{total} +- {duration(reach_s)} (5 to 95 %)"


def _timing_of(estimates: Estimates) -> str:
    if estimates.timing_sha256 is None:
        return "as built in; measure yours: gonio rig bench"
    return f"measured, sha256 {estimates.timing_sha256[:12]}"

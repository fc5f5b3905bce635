"""What plans, captures and samples say of themselves, as rows to read and as documents."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from gonio.plan import Estimates, Plan
    from gonio.samples import Flag, Samples
    from gonio.session import Session

Document = dict[str, Any]


def plan_document(plan: Plan) -> Document:
    """Return how a plan was chosen and what it will cost."""
    estimates = {**plan.estimates.model_dump(), "total_s": plan.estimates.total_s}
    return {
        "sha256": plan.sha256,
        "parent": plan.parent,
        "rig_sha256": plan.rig_sha256,
        "shots": len(plan.shots),
        "anchors": sum(shot.anchor for shot in plan.shots),
        "share_measured": len(plan.shots) / plan.selection.full_set,
        "selection": plan.selection.model_dump(),
        "left_out": [each.model_dump() for each in plan.left_out],
        "estimates": estimates,
        "route": plan.route and plan.route.model_dump(),
    }


def plan_rows(plan: Plan) -> Iterator[tuple[str, str]]:
    """Yield what a plan takes, leaves out and costs."""
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


def samples_document(samples: Samples) -> Document:
    """Return how many samples there are, and how good."""
    from gonio.samples import Flag

    return {
        "samples": len(samples),
        "clipped": flagged(samples, Flag.CLIPPED),
        "faint": flagged(samples, Flag.FAINT),
        "suspect": flagged(samples, Flag.SUSPECT),
        "color_space": samples.color_space,
        "color_made_by": samples.color_made_by,
        "median_value_per_sr": float(np.median(samples.value)) if len(samples) else None,
        "median_relative_sigma": relative_sigma(samples),
    }


def flagged(samples: Samples, flag: Flag) -> int:
    """Count the samples of which a channel has a flag."""
    return int((samples.flag & np.uint32(flag)).any(axis=1).sum())


def relative_sigma(samples: Samples) -> float | None:
    """Return the median of sigma over value; None where nothing is known of it."""
    # of a value about zero the ratio says nothing
    bright = (samples.value > 0) & np.isfinite(samples.sigma)
    relative = samples.sigma[bright] / samples.value[bright]
    return float(np.median(relative)) if relative.size else None


def session_document(session: Session) -> Document:
    """Return what was measured of what, what that took, and what it met."""
    from gonio.capture.usage import Usage, usages_of
    from gonio.faultlog import faults_of
    from gonio.score import score_of

    chain, notes, score = session.chain(), session.notes(), score_of(session)
    document: Document = {
        "session": session.root,
        **notes.model_dump(exclude={"schema_"}),
        "plans": [plan.sha256 for plan in chain.plans],
        "shots": len(chain.shots),
        "estimated_s": chain.estimated_s,
        "longer_than_estimated": score and score.error,
        "longer_once_home": score and score.error_once_home,
    }
    if not session.journal_path.is_file():
        return document
    with session.journal() as journal:
        faults, usages = faults_of(journal), usages_of(journal)
    usage = Usage.sum(usages)
    used = {**usage.model_dump(), "total_s": usage.total_s, "utilisation": usage.utilisation}
    return {**document, "faults": list(map(asdict, faults)), "rig_use": used}


def checks_document(path: Path) -> Document:
    """Return what the checks of a reduction found, and which shots to take again."""
    from gonio.checks import Checks

    checks = Checks.load(path)
    return {
        "checks": [each.model_dump() for each in checks.checks],
        "retake": [each.shot for each in checks.suspects],
    }

"""The report: one HTML page that needs nothing beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gonio.capture.usage import Usage, usages_of
from gonio.checks import Checks
from gonio.faultlog import faults_of, spoken
from gonio.files import write_bytes
from gonio.report.budget import parts_of
from gonio.report.summary import summarize
from gonio.report.truth import truth_of
from gonio.samples import Flag
from gonio.score import score_of

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.checks import Check
    from gonio.materials import MeasuredTable
    from gonio.report.summary import Summary
    from gonio.samples import Samples
    from gonio.session import Session
    from nnbrdf.albedo import Albedo
    from nnbrdf.load import Model

_STAGES = ("capture", "adaptive", "reduce", "reconstruct")
_MEANINGS = {
    Flag.CLIPPED: "saturated in every exposure: the value is a lower bound",
    Flag.FAINT: "not above its own noise",
    Flag.FEW_PIXELS: "the patch held fewer than eight pixels of this channel",
    Flag.NO_SIGMA: "its source stated no sigma",
    Flag.SUSPECT: "a check of its shot failed",
}


def write_report(
    target: Path, *, model: Path, samples: Samples, session: Session | None = None
) -> Summary:
    """Write the report of a model as one self-contained page, whole or not at all.

    Parameters
    ----------
    target
        The page.
    model
        The model's folder.
    samples
        What it was made from.
    session
        Where they were measured, with its notes, plans and timings; and, from the twin alone,
        its truth. None for a table from elsewhere.

    Raises
    ------
    gonio.errors.BadFileError
        When a file of the model or the session is missing or damaged.
    gonio.errors.StorageError
        When the page cannot be written.
    """
    truth = truth_of(session, samples.color_space)
    summary = summarize(model, samples, truth)
    page = _render(summary, model, samples, session, truth)
    # a name with half a surrogate pair is no UTF-8, and no reason to fail either
    write_bytes(target, page.encode("utf-8", "backslashreplace"))
    return summary


def _render(
    summary: Summary,
    model: Path,
    samples: Samples,
    session: Session | None,
    truth: MeasuredTable | None,
) -> str:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    from gonio.report import provenance
    from gonio.report.compare import comparison_of
    from gonio.report.drawings import draw_all
    from gonio.report.next_pairs import next_pairs
    from nnbrdf.load import load_model

    environment = Environment(
        loader=PackageLoader("gonio", "report"), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    chain = session.chain().plans if session else ()
    estimate = load_model(model)
    content: dict[str, Any] = {
        "summary": summary,
        "model": estimate.card,
        "albedos": _albedos(estimate),
        "next_pairs": next_pairs(estimate.grid(), estimate.card.white),
        "samples": samples,
        "flags": _flag_counts(samples),
        "sigma_parts": parts_of(samples),
        "checks": _checks(session),
        "notes": session.notes() if session else None,
        "plans": chain,
        "ending": provenance.ending_of(session),
        "timings": _timings(session),
        "simulated": session is not None and session.sim.is_dir(),
        "measured_on": provenance.measured_on(session),
        "score": score_of(session) if session else None,
        "faults": _faults(session),
        "usage": _usage(session),
        "versions": provenance.versions(),
        "hashes": provenance.hashes(model, samples, session),
        "drawn": draw_all(model, samples, chain, truth),
        "comparison": comparison_of(model),
    }
    return environment.get_template("page.html").render(content)


def _albedos(estimate: Model) -> list[Albedo]:
    """Return the directional albedos; of the exact posterior, slow to evaluate, none."""
    from nnbrdf.albedo import directional_albedo
    from nnbrdf.posterior_model import PosteriorBRDF

    return [] if isinstance(estimate, PosteriorBRDF) else directional_albedo(estimate)


def _checks(session: Session | None) -> tuple[Check, ...]:
    """Return what the reduction thought of the frames; nothing where it was not asked."""
    if session is None or not session.checks_path.is_file():
        return ()
    return Checks.load(session.checks_path).checks


def _faults(session: Session | None) -> str:
    """Return the faults that the capture met, in words; empty where it met none."""
    if session is None or not session.journal_path.is_file():
        return ""
    with session.journal() as journal:
        return spoken(faults_of(journal))


def _usage(session: Session | None) -> str:
    """Return what the rig's time went into, in words; empty where that is not known."""
    if session is None or not session.journal_path.is_file():
        return ""
    with session.journal() as journal:
        runs = usages_of(journal)
    return Usage.sum(runs).sentence if runs else ""


def _timings(session: Session | None) -> dict[str, float]:
    """Return the seconds of each stage, in the order of the work."""
    known = {} if session is None else session.timings()
    order = [*_STAGES, *sorted(known.keys() - set(_STAGES))]
    return {stage: known[stage] for stage in order if stage in known}


def _flag_counts(samples: Samples) -> list[tuple[str, int, str]]:
    """Return the flags that occurred: name, number of values, meaning."""
    counts = [(flag, int((samples.flag & flag.value != 0).sum())) for flag in Flag]
    return [(str(flag.name), count, _MEANINGS[flag]) for flag, count in counts if count]

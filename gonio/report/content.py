"""What the templates of a report are given."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gonio.report import course, provenance
from gonio.report.budget import parts_of
from gonio.report.chosen import discs_of
from gonio.report.compare import comparison_of
from gonio.report.drawings import error_drawings
from gonio.report.embedded import embedded
from gonio.report.expected import expected_of
from gonio.report.figures import page_style
from gonio.report.headline import headline
from gonio.report.layers import UNSURE, layers_of
from gonio.report.next_pairs import next_pairs
from gonio.report.renders import ABOUT, renders_of
from gonio.samples import Flag
from gonio.score import score_of

if TYPE_CHECKING:
    from gonio.protocols import Prior
    from gonio.report.drawings import Drawing
    from gonio.report.sources import Sources
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


def content_of(sources: Sources, summary: Summary) -> dict[str, Any]:
    """Return everything, by the names that the templates use."""
    return _of_model(sources, summary) | _of_session(sources)


def _of_model(sources: Sources, summary: Summary) -> dict[str, Any]:
    estimate, grid, samples, truth = (
        sources.estimate, sources.grid, sources.samples, sources.truth,
    )  # fmt: skip
    expected = expected_of(grid, sources.white)
    return {
        "summary": summary,
        "headline": list(headline(summary, expected, sources.captured, sources.checks)),
        "model": estimate.card,
        "albedos": _albedos(estimate),
        "next_pairs": next_pairs(grid, sources.white),
        "samples": samples,
        "flags": _flag_counts(samples),
        "sigma_parts": parts_of(samples),
        "layers": layers_of(grid, sources.white, samples, truth, sources.screen),
        "unsure": UNSURE,
        "embedded": embedded(sources),
        "renders": renders_of(sources.quick, truth, sources.screen),
        "about_renders": ABOUT,
        "discs": list(discs_of(sources)),
        "error_drawings": _error_drawings(sources),
        "comparison": comparison_of(sources.model),
    }


def _of_session(sources: Sources) -> dict[str, Any]:
    session = sources.session
    return {
        "checks": sources.checks,
        "captured": sources.captured,
        "notes": session.notes() if session else None,
        "plans": sources.chain.plans if sources.chain else (),
        "simulated": session is not None and session.sim.is_dir(),
        "score": score_of(session) if session else None,
        "timings": _timings(session),
        "course": _course(sources),
        "versions": provenance.versions(),
        "hashes": provenance.hashes(sources.model, sources.samples, session),
    }


def _error_drawings(sources: Sources) -> list[Drawing]:
    with page_style():
        return list(error_drawings(sources))


def _course(sources: Sources) -> list[Drawing]:
    """Return error against the rig's time, where there was a rig."""
    session, chain, captured = sources.session, sources.chain, sources.captured
    if session is None or chain is None or captured is None:
        return []
    shots, grid = len(chain.shots), sources.grid
    own = expected_of(grid, sources.white).deviation
    ends = [("the model's own bands", course.Reached(captured.rig_s, own, shots))]
    if sources.truth is not None:
        true = course.true_deviation(grid, sources.truth)
        ends.append(("its true error", course.Reached(captured.rig_s, true, shots)))
    told = course.foretold(chain, session.rig(), sources.prior or _generated())
    with page_style():
        return list(course.course_drawings(course.rounds_of(chain, captured), told, ends))


def _generated() -> Prior:
    from nnbrdf.prior import MaterialPrior

    return MaterialPrior.generate()


def _albedos(estimate: Model) -> list[Albedo]:
    """Return the directional albedos; of the exact posterior, slow to evaluate, none."""
    from nnbrdf.albedo import directional_albedo
    from nnbrdf.posterior_model import PosteriorBRDF

    return [] if isinstance(estimate, PosteriorBRDF) else directional_albedo(estimate)


def _timings(session: Session | None) -> dict[str, float]:
    """Return the seconds of each stage, in the order of the work."""
    known = {} if session is None else session.timings()
    order = [*_STAGES, *sorted(known.keys() - set(_STAGES))]
    return {stage: known[stage] for stage in order if stage in known}


def _flag_counts(samples: Samples) -> list[tuple[str, int, str]]:
    """Return the flags that occurred: name, number of values, meaning."""
    counts = [(flag, int((samples.flag & flag.value != 0).sum())) for flag in Flag]
    return [(str(flag.name), count, _MEANINGS[flag]) for flag, count in counts if count]

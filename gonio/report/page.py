"""The report: one HTML page that needs nothing beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.files import write_bytes
from gonio.report.sources import Sources
from gonio.report.summary import summarize
from gonio.report.truth import truth_of

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.protocols import Prior
    from gonio.report.summary import Summary
    from gonio.samples import Samples
    from gonio.session import Session


def write_report(
    target: Path,
    *,
    model: Path,
    samples: Samples,
    session: Session | None = None,
    prior: Prior | None = None,
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
    prior
        What fewer shots are judged by; None: the generated one.

    Raises
    ------
    gonio.errors.BadFileError
        When a file of the model or the session is missing or damaged.
    gonio.errors.StorageError
        When the page cannot be written.
    """
    truth = truth_of(session, samples.color_space)
    summary = summarize(model, samples, truth)
    page = _render(Sources(model, samples, session, truth, prior), summary)
    # a name with half a surrogate pair is no UTF-8, and no reason to fail either
    write_bytes(target, page.encode("utf-8", "backslashreplace"))
    return summary


def _render(sources: Sources, summary: Summary) -> str:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    from gonio.report.content import content_of

    environment = Environment(
        loader=PackageLoader("gonio", "report"), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    return environment.get_template("page.html").render(content_of(sources, summary))

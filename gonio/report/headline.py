"""What comes first on the page: a few numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from gonio.words import duration, several

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from gonio.checks import Check
    from gonio.report.captured import Captured
    from gonio.report.expected import Expected
    from gonio.report.summary import Summary


class Figure(NamedTuple):
    """A number with its name and what it is of; `mark` is `good` or `bad` where it is either."""

    name: str
    value: str
    note: str
    mark: str = ""


def headline(
    summary: Summary, expected: Expected, captured: Captured | None, checks: Sequence[Check]
) -> Iterator[Figure]:
    """Yield what is known of it."""
    share = f"{100 * summary.share:.3g} % of the 6561 pairs"
    yield Figure("shots", str(summary.shots), share)
    if captured:
        yield Figure("rig time", duration(captured.rig_s), "calibration frames included")
    yield Figure("median σ", _per_cent(expected.sigma), "of the value, over all pairs")
    yield Figure(
        "expected error",
        f"{expected.eps8:.2f}",
        f"eps8, by the model's own bands; male {expected.male:.3f}",
    )
    yield from _true(summary)
    asked = [check for check in checks if check.asked]
    if asked:
        yield _verdict(asked)


def _true(summary: Summary) -> Iterator[Figure]:
    if summary.error is not None:
        note = f"eps8, against the truth; male {summary.error.male:.3f}"
        yield Figure("true error", f"{summary.error.eps8:.2f}", note)
    if summary.coverage is not None:
        note = "of the truth lies within 5 to 95 %"
        yield Figure("coverage", f"{100 * summary.coverage:.0f} %", note)


def _per_cent(share: float) -> str:
    return f"{100 * share:.2g} %" if share < 1.0 else f"{100 * share:.0f} %"


def _verdict(asked: Sequence[Check]) -> Figure:
    flagged = [check.name for check in asked if not check.ok]
    if not flagged:
        return Figure("checks", "all ok", several(len(asked), "check"), "good")
    return Figure("checks", several(len(flagged), "flag"), ", ".join(flagged), "bad")

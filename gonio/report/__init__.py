"""What was measured and what came of it, as one HTML page."""

from __future__ import annotations

from gonio.report.page import write_report
from gonio.report.summary import Summary, summarize
from gonio.report.truth import truth_of

__all__ = ["Summary", "summarize", "truth_of", "write_report"]

"""What speaks for and against the shots of a session."""

from __future__ import annotations

from gonio.reduce.checks.run import run_checks

__all__ = ["run_checks"]

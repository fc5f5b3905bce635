"""The command line: one file a command, each imported only when it is asked for."""

from __future__ import annotations

from gonio.cli._main import main

__all__ = ["main"]

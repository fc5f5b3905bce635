"""Looking at a capture while it goes on, from a process of its own."""

from __future__ import annotations

from gonio.watch.access import Access
from gonio.watch.server import WatchServer

__all__ = ["Access", "WatchServer"]

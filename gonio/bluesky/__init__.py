"""A rig as devices of Bluesky, and a session as a plan of its RunEngine."""

from gonio.bluesky.bench import Bench, bench
from gonio.bluesky.plans import scan

__all__ = ["Bench", "bench", "scan"]

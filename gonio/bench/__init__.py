"""Measuring what a rig takes: moves, settling, homing, frames and the camera's sensitivity."""

from __future__ import annotations

from gonio.bench.checkup import Finding, exercise, look_over
from gonio.bench.run import Bench, bench_rig

__all__ = ["Bench", "Finding", "bench_rig", "exercise", "look_over"]

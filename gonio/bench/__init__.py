"""Measuring what a rig takes: moves, settling, homing, frames and the camera's sensitivity."""

from __future__ import annotations

from gonio.bench.run import Bench, bench_rig

__all__ = ["Bench", "bench_rig"]

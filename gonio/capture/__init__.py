"""Running a plan: calibration frames, then shot by shot, journaled and resumable."""

from __future__ import annotations

from gonio.capture.instrument import Instrument, Operator
from gonio.capture.run import WHITE_POSE_DEG, Capture, check_reach, check_space

__all__ = [
    "WHITE_POSE_DEG", "Capture", "Instrument", "Operator", "check_reach", "check_space"
]  # fmt: skip

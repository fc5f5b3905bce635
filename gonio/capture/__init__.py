"""Running a plan: calibration frames, then shot by shot, journaled and resumable."""

from __future__ import annotations

from gonio.capture.instrument import Instrument, Operator
from gonio.capture.reach import check_reach
from gonio.capture.run import Capture, check_space
from gonio.timemodel import WHITE_POSE_DEG

__all__ = [
    "WHITE_POSE_DEG", "Capture", "Instrument", "Operator", "check_reach", "check_space"
]  # fmt: skip

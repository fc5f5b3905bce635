"""From raw frames to BRDF samples."""

from __future__ import annotations

from gonio.reduce.provenance import is_reduced
from gonio.reduce.reduce import PATCH_MM, reduce_session

__all__ = ["PATCH_MM", "is_reduced", "reduce_session"]

"""From raw frames to BRDF samples."""

from __future__ import annotations

from gonio.reduce.patch import PATCH_MM
from gonio.reduce.provenance import is_reduced
from gonio.reduce.radiance import write_radiance
from gonio.reduce.reduce import reduce_session
from gonio.reduce.table import write_table

__all__ = ["PATCH_MM", "is_reduced", "reduce_session", "write_radiance", "write_table"]

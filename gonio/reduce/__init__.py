"""From raw frames to BRDF samples."""

from __future__ import annotations

from gonio.reduce.patch import usual_patch_mm
from gonio.reduce.provenance import is_reduced
from gonio.reduce.radiance import write_radiance
from gonio.reduce.reduce import reduce_session
from gonio.reduce.table import write_table

__all__ = ["is_reduced", "reduce_session", "usual_patch_mm", "write_radiance", "write_table"]

"""Pictures of materials on shapes under a probe of light: by direct light here, or by Mitsuba."""

from __future__ import annotations

from gonio.render.probe import PROBES, Probe
from gonio.render.shading import Picture, shade
from gonio.render.shapes import SHAPES, Shape

__all__ = ["PROBES", "SHAPES", "Picture", "Probe", "Shape", "shade"]

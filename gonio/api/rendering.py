"""What is rendered, under what, and by whom."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from gonio.render import PROBES, SHAPES, shade

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from gonio.api.following import Bars
    from gonio.api.opened import Opened
    from gonio.protocols import Material
    from gonio.render import Picture, Probe
    from gonio.report.render_sheet import Sheet


@dataclass(frozen=True)
class Scene:
    """Shapes by name, the probe, the side of a picture, and how many lights stand for it."""

    shapes: Sequence[str]
    probe: Probe
    size_px: int
    lights: int

    @classmethod
    def of(cls, shapes: Sequence[str], probe: str, size_px: int, lights: int) -> Scene:
        """Make it of what a user names."""
        return cls(shapes, PROBES[probe.lower()], size_px, lights)

    def sheet(
        self, opened: Sequence[Opened], scores: Mapping[str, str], stops: float, bars: Bars
    ) -> Sheet:
        """Render materials; the first is what the others are held against."""
        from gonio.report.render_sheet import Sheet

        materials = {one.name: one.material for one in opened}
        by_shape = {name: self.pictures(materials, name, bars) for name in self.shapes}
        pictures = {
            material: {name: by_shape[name][material] for name in self.shapes}
            for material in materials
        }
        return Sheet(pictures, scores, stops)

    def pictures(
        self, materials: Mapping[str, Material], shape: str, bars: Bars
    ) -> dict[str, Picture]:
        """Render materials, by name, on one of the shapes."""
        with bars(f"rendering {shape}") as progress:
            lights = self.probe.lights(self.lights)
            return shade(materials, SHAPES[shape], lights, self.size_px, progress)

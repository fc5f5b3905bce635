"""What is rendered, under what, and by whom."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from gonio.cli._console import progress_bar
from gonio.render import PROBES, SHAPES, shade

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from gonio.cli._materials import Opened
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

    def sheet(self, opened: Sequence[Opened], scores: Mapping[str, str], stops: float) -> Sheet:
        """Render materials; the first is what the others are held against."""
        from gonio.report.render_sheet import Sheet

        materials = {one.name: one.material for one in opened}
        by_shape = {name: self._render(materials, name) for name in self.shapes}
        pictures = {
            material: {name: by_shape[name][material] for name in self.shapes}
            for material in materials
        }
        return Sheet(pictures, scores, stops)

    def _render(self, materials: Mapping[str, Material], shape: str) -> dict[str, Picture]:
        with progress_bar(f"rendering {shape}") as progress:
            lights = self.probe.lights(self.lights)
            return shade(materials, SHAPES[shape], lights, self.size_px, progress)

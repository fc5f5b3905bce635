"""What is rendered, under what, and by whom."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from gonio.render import PROBES, SHAPES, shade

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from gonio.api.following import Bars
    from gonio.api.opened import Opened
    from gonio.protocols import Material, Progress
    from gonio.render import Picture, Probe, Shape
    from gonio.report.render_sheet import Sheet


@dataclass(frozen=True)
class Scene:
    """Shapes by name, the probe, the side of a picture, and how many lights stand for it.

    The renderer is `own` or `mitsuba`.
    """

    shapes: Sequence[str]
    probe: Probe
    size_px: int
    lights: int
    renderer: str = "own"

    @classmethod
    def of(
        cls, shapes: Sequence[str], probe: str, size_px: int, lights: int, renderer: str = "own"
    ) -> Scene:
        """Make it of what a user names."""
        return cls(shapes, PROBES[probe.lower()], size_px, lights, renderer)

    def sheet(
        self, opened: Sequence[Opened], scores: Mapping[str, str], stops: float, bars: Bars
    ) -> Sheet:
        """Render materials; the first is what the others are held against."""
        from gonio.report.render_sheet import Sheet

        materials = {one.name: one.material for one in opened}
        by_shape = self.pictures(materials, bars)
        pictures = {
            material: {name: by_shape[name][material] for name in self.shapes}
            for material in materials
        }
        return Sheet(pictures, scores, stops)

    def pictures(
        self, materials: Mapping[str, Material], bars: Bars
    ) -> dict[str, dict[str, Picture]]:
        """Render materials; returns pictures by shape, then by material.

        Raises
        ------
        gonio.errors.MissingExtraError
            When Mitsuba is to render and cannot be loaded.
        """
        shade_on = self._shader(materials, bars)
        pictures = {}
        for name in self.shapes:
            with bars(f"rendering {name}") as progress:
                pictures[name] = shade_on(SHAPES[name], progress)
        return pictures

    def _shader(
        self, materials: Mapping[str, Material], bars: Bars
    ) -> Callable[[Shape, Progress], dict[str, Picture]]:
        if self.renderer == "own":
            lights = self.probe.lights(self.lights)
            return lambda shape, progress: shade(materials, shape, lights, self.size_px, progress)
        from gonio.render.traced import Traced

        with bars("tabulating") as progress:
            traced = Traced.of(materials, progress)
        return lambda shape, progress: traced.shade(
            shape, self.probe, self.lights, self.size_px, progress
        )

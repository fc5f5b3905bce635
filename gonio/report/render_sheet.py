"""Renders side by side: a row a material, a picture and a difference a shape."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from gonio.files import write_with
from gonio.render.contrast import contrast, developed, exposure, on_paper, scale_of
from gonio.report.figures import literal, new_figure

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage

    from gonio.render.contrast import Contrast
    from gonio.render.shading import Picture

_CELL_IN, _NAME_IN, _BAR_IN = 1.9, 0.3, 0.55
_CAPTION_IN = 0.34
_DPI = 150
_COLORS = "magma"


@dataclass(frozen=True)
class Sheet:
    """Pictures of materials on shapes; the first material is what the others are held against.

    Attributes
    ----------
    pictures
        By material, then by shape.
    scores
        A line below each material's name, such as its eps8; missing where there is none.
    stops
        Brighter by so many doublings.
    """

    pictures: Mapping[str, Mapping[str, Picture]]
    scores: Mapping[str, str]
    stops: float = 0.0

    @cached_property
    def factor(self) -> float:
        """What all pictures are multiplied by."""
        return exposure(self._reference.values(), self.stops)

    @cached_property
    def contrasts(self) -> dict[str, dict[str, Contrast]]:
        """By material but the first, then by shape."""
        return {
            name: {
                shape: contrast(picture, self._reference[shape], self.factor)
                for shape, picture in of_shape.items()
            }
            for name, of_shape in list(self.pictures.items())[1:]
        }

    @cached_property
    def scale(self) -> float:
        """The 8-bit steps at which the colors of the differences end."""
        return scale_of(each for row in self.contrasts.values() for each in row.values())

    def write(self, path: Path) -> None:
        """Write it as PNG, whole or not at all.

        Raises
        ------
        gonio.errors.StorageError
            When it cannot be written.
        """
        write_with(path, lambda aside: self.draw().savefig(aside, format="png", dpi=_DPI))

    def draw(self) -> Figure:
        """Draw it."""
        rows, columns = len(self.pictures), len(self._reference)
        per_shape = 2 if self.contrasts else 1
        height = _CELL_IN + _CAPTION_IN
        figure = new_figure(
            _NAME_IN + per_shape * columns * _CELL_IN, rows * height + _BAR_IN * (per_shape - 1)
        )
        figure.set_facecolor("white")
        axes = figure.subplots(rows, per_shape * columns, squeeze=False)
        image = None
        for row, (name, of_shape) in zip(axes, self.pictures.items(), strict=True):
            for axis in row:
                _strip(axis)
            told = filter(None, (literal(name), self.scores.get(name)))
            row[0].set_ylabel("\n".join(told), fontsize=8)
            for picture, left in zip(of_shape.values(), row[::per_shape], strict=True):
                left.imshow(on_paper(developed(picture, self.factor), picture.cover))
            for each, right in zip(self.contrasts.get(name, {}).values(), row[1::2], strict=False):
                image = self._difference(right, each)
        if image is not None:
            bar = figure.colorbar(
                image, ax=axes, orientation="horizontal", extend="max", aspect=70, shrink=0.6
            )
            first = literal(self._first)
            bar.set_label(f"difference from {first} (8-bit steps, mean of channels)", size=8)
            bar.ax.tick_params(labelsize=7)
        return figure

    @property
    def _first(self) -> str:
        return next(iter(self.pictures))

    @property
    def _reference(self) -> Mapping[str, Picture]:
        return self.pictures[self._first]

    def _difference(self, axes: Axes, each: Contrast) -> AxesImage:
        image = axes.imshow(each.steps, cmap=_COLORS, vmin=0.0, vmax=self.scale)
        axes.set_title(f"PSNR {each.psnr}, mean {each.mean:.2f}", fontsize=7, y=-0.13)
        return image


def _strip(axes: Axes) -> None:
    """Leave nothing but the picture and the row's name."""
    axes.set_xticks([])
    axes.set_yticks([])
    axes.spines[:].set_visible(False)

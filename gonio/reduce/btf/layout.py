"""Where each shot goes in the array, and which shots one file of the array holds."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from gonio.reduce.btf.job import Block

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from gonio.journal import FrameRecord
    from gonio.photogrammetry.grid import TexelGrid
    from gonio.plan import Shot

TILE: Final = 64
"""Side of the squares that the array is stored in, in texels."""

_FILE_BYTES = 1_000_000_000
_MOST_VIEWS = 16
_TEXEL_BYTES = 12

Angles = tuple[float, float]


@dataclass(frozen=True)
class Layout:
    """The axes of the array.

    Attributes
    ----------
    lights, views
        Theta and phi in degrees, by theta and then phi.
    grid
        The texels.
    """

    lights: tuple[Angles, ...]
    views: tuple[Angles, ...]
    grid: TexelGrid

    @classmethod
    def of_shots(cls, shots: Sequence[Shot], grid: TexelGrid) -> Layout:
        """Return the axes on which each shot has a place."""
        lights = sorted({shot.direction_deg("light") for shot in shots})
        views = sorted({shot.direction_deg("view") for shot in shots})
        return cls(tuple(lights), tuple(views), grid)

    @property
    def shape(self) -> tuple[int, int, int, int, int]:
        """Light, view, y, x, channel."""
        return len(self.lights), len(self.views), self.grid.side, self.grid.side, 3

    @property
    def chunks(self) -> tuple[int, int, int, int, int]:
        """What is read at once: a square of one picture, for pictures and texels alike."""
        tile = min(TILE, self.grid.side)
        return 1, 1, tile, tile, 3

    @property
    def shards(self) -> tuple[int, int, int, int, int]:
        """What one file holds, and one process makes at a time: whole pictures of one light."""
        tile = self.chunks[2]
        side = -(-self.grid.side // tile) * tile
        fitting = _FILE_BYTES // (_TEXEL_BYTES * side**2)
        return 1, max(1, min(fitting, _MOST_VIEWS, len(self.views))), side, side, 3

    def blocks(self, shots: Sequence[Shot], records: Sequence[FrameRecord]) -> Iterator[Block]:
        """Yield the shots file by file; of several shots of one pair, the last counts."""
        place_of = {angles: index for index, angles in enumerate(self.views)}
        light_of = {angles: index for index, angles in enumerate(self.lights)}
        frames: dict[int, list[FrameRecord]] = defaultdict(list)
        for record in records:
            if record.role == "shot":
                frames[record.shot_index].append(record)
        files: dict[tuple[int, int], dict[int, Shot]] = defaultdict(dict)
        for shot in shots:
            view = place_of[shot.direction_deg("view")]
            files[light_of[shot.direction_deg("light")], view // self.shards[1]][view] = shot
        for (light, _), of_view in sorted(files.items()):
            inside = tuple(of_view.values())
            taken = tuple(record for shot in inside for record in frames[shot.index])
            yield Block(light, tuple(of_view), inside, taken)

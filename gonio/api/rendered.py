"""One material on one shape, as a picture that a notebook shows."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.api.opened import Opened
    from gonio.render import Picture


@dataclass(frozen=True, repr=False, eq=False)
class Rendered:
    """A picture, linear and as a person sees it.

    Attributes
    ----------
    picture
        Linear RGB before black, and how much of each pixel the shape covers.
    factor
        What it is multiplied by before it is shown.
    """

    picture: Picture
    factor: float

    @property
    def rgba(self) -> NDArray[np.uint8]:
        """8-bit sRGB with highlights rolled off, transparent beside the shape, (size, size, 4)."""
        from nnbrdf.sphere import tone_map

        cover = self.picture.cover[..., None]
        # colors are before black, and are to be before whatever the page is of
        color = tone_map(self.factor * self.picture.color / cover.clip(0.1))
        return np.concatenate([color, np.round(255.0 * cover).astype(np.uint8)], axis=-1)

    def save(self, path: Path | str) -> None:
        """Write it as PNG.

        Raises
        ------
        gonio.errors.StorageError
            When it cannot be written.
        """
        from gonio.files import write_bytes

        write_bytes(Path(path), self._repr_png_())

    def __repr__(self) -> str:
        height, width = self.picture.cover.shape
        return f"<Rendered {width} x {height} px, times {self.factor:.3g}>"

    def _repr_png_(self) -> bytes:
        from matplotlib.image import imsave

        buffer = io.BytesIO()
        imsave(buffer, self.rgba)
        return buffer.getvalue()


def render_alone(
    opened: Opened, shape: str, probe: str, size_px: int, lights: int, stops: float, renderer: str
) -> Rendered:
    """Render one material on one shape (see `gonio.Material.render`).

    Raises
    ------
    gonio.errors.BadInputError
        For an unknown shape, probe or renderer, or numbers that `gonio render` refuses.
    gonio.errors.MissingExtraError
        When Mitsuba is asked for and is not installed.
    """
    from gonio.api.following import unseen
    from gonio.api.numbers import LIGHTS, SIZE_PX, STOPS, check_real, check_whole
    from gonio.api.rendering import Scene
    from gonio.errors import BadInputError
    from gonio.render import PROBES, SHAPES
    from gonio.render.contrast import exposure
    from gonio.render.renderers import RENDERERS, chosen

    for name, known in ((shape, SHAPES), (probe, PROBES), (renderer, RENDERERS)):
        if name not in known:
            raise BadInputError(f"{name!r} is not known; use {', '.join(known)}")
    check_whole("size_px", size_px, *SIZE_PX)
    check_whole("lights", lights, *LIGHTS)
    check_real("stops", stops, *STOPS)
    scene = Scene.of((shape,), probe, size_px, lights, chosen(renderer).name)
    picture = scene.pictures({opened.name: opened.material}, unseen)[shape][opened.name]
    return Rendered(picture, exposure([picture], stops))

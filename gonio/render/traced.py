"""Pictures by Mitsuba 3 (Jakob et al. 2022): paths of light, on the same shapes and probes.

The extra `mitsuba` brings the renderer. Its `measured` plugin reads a material as an RGL tensor,
so that everything runs at its own speed whatever the material is.
"""

from __future__ import annotations

import tempfile
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from gonio.errors import MissingExtraError
from gonio.exchange.format import Source
from gonio.exchange.rgl import write
from gonio.render.mitsuba_scene import body_of, eye_of, probe_of
from gonio.render.shading import Picture
from gonio.steps import Steps

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from numpy.typing import NDArray

    from gonio.protocols import Material, Progress
    from gonio.render.probe import Probe
    from gonio.render.shapes import Shape

    Array = NDArray[np.float64]

# all but what is reflected more than three times
_DEPTH = 4
_LIGHTS_PER_PATH = 6
_FEWEST_PATHS = 4


@dataclass(frozen=True)
class Traced:
    """Materials as Mitsuba has them.

    Attributes
    ----------
    bsdfs
        Its plugins, by the material's name.
    """

    bsdfs: Mapping[str, Any]

    @classmethod
    def of(cls, materials: Mapping[str, Material], progress: Progress | None = None) -> Self:
        """Tabulate materials.

        Parameters
        ----------
        materials
            By name.
        progress
            Called with how much is done and how much there is.

        Raises
        ------
        gonio.errors.MissingExtraError
            When Mitsuba is not installed.
        """
        with _mitsuba() as mitsuba:
            step = Steps(len(materials), progress)
            bsdfs = {}
            for name, material in materials.items():
                bsdfs[name] = _bsdf(mitsuba, material)
                step()
            return cls(bsdfs)

    def shade(
        self,
        shape: Shape,
        probe: Probe,
        lights: int,
        size_px: int,
        progress: Progress | None = None,
    ) -> dict[str, Picture]:
        """Render the materials on a shape, with light that it throws on itself.

        All have the same seed, so that their noise is alike.

        Parameters
        ----------
        shape
            One of `gonio.render.shapes.SHAPES`.
        probe
            The light.
        lights
            A pixel has a sixth as many paths, each of which looks for light by the probe's
            brightness and by the material's lobe wherever it is reflected.
        size_px
            Side of the square pictures.
        progress
            Called with how much is done and how much there is.
        """
        with _mitsuba() as mitsuba:
            step = Steps(len(self.bsdfs), progress)
            paths = max(_FEWEST_PATHS, lights // _LIGHTS_PER_PATH)
            around = {
                "integrator": {"type": "path", "max_depth": _DEPTH, "hide_emitters": True},
                "sensor": eye_of(mitsuba, size_px, paths),
                "probe": probe_of(mitsuba, probe),
            }
            pictures = {}
            for name, bsdf in self.bsdfs.items():
                body = body_of(mitsuba, shape, bsdf)
                scene = mitsuba.load_dict({"type": "scene", "body": body, **around})
                pictures[name] = _picture(mitsuba.render(scene, seed=0))
                step()
            return pictures


@dataclass(frozen=True)
class _Exchanged:
    """A material with light and view exchanged: Mitsuba's paths come from the camera."""

    material: Material

    def evaluate(self, light: Array, view: Array) -> Array:
        return self.material.evaluate(view, light)


@contextmanager
def _mitsuba() -> Iterator[Any]:
    """Lend Mitsuba in the variant that needs no compiler; whoever uses another keeps it."""
    try:
        import mitsuba
    except ImportError:
        raise MissingExtraError("mitsuba", "mitsuba") from None
    before = mitsuba.variant()
    mitsuba.set_variant("scalar_rgb")
    level = mitsuba.log_level()
    mitsuba.set_log_level(mitsuba.LogLevel.Error)
    try:
        yield mitsuba
    finally:
        mitsuba.set_log_level(level)
        if before is not None:
            mitsuba.set_variant(before)


def _bsdf(mitsuba: Any, material: Material) -> Any:
    with tempfile.TemporaryDirectory(prefix="gonio-") as folder:
        path = Path(folder) / "material.bsdf"
        write(Source(_Exchanged(material), "material"), path, None)
        return mitsuba.load_dict({"type": "measured", "filename": str(path)})


def _picture(rgba: Any) -> Picture:
    pixels = np.array(rgba, np.float64)
    return Picture(pixels[..., :3], pixels[..., 3].clip(0.0, 1.0))

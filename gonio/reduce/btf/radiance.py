"""From a bracket to BRDF and sigma of each texel."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import chebyshev

from gonio.camera import Camera
from gonio.errors import BadInputError
from gonio.photogrammetry.rectification import Rectifier
from gonio.reduce.btf.develop import Development, develop
from gonio.reduce.hdr import Pixels, merge_pixels
from gonio.reduce.light import Source
from gonio.reduce.radiance import exposed
from gonio.reduce.stray import surrounds

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.photogrammetry.grid import TexelGrid
    from gonio.reduce.btf.develop import Tiles
    from gonio.reduce.btf.job import Job, Maps
    from gonio.reduce.dark import Dark
    from gonio.reduce.frames import Frame

_NODES = 7


def texels_of(bracket: Sequence[Frame], maps: Maps, job: Job, tiles: Tiles) -> None:
    """Put BRDF and one standard uncertainty of each texel into tiles, in 1/sr and linear sRGB.

    NaN out of sight. Where a channel was saturated in every exposure, a lower bound and infinity.

    Parameters
    ----------
    bracket
        The frames of a shot.
    maps
        Of the sensor's pixels.
    job
        The camera, the calibration and the grid.
    tiles
        Where they go.

    Raises
    ------
    gonio.errors.BadInputError
        When no light fell on the sample.
    """
    sources = [source_of(frame, job) for frame in bracket]
    # channels differ in sensitivity alone, which is put in when they are apart
    unit = float(job.rate_per_brdf.mean())
    darks = [maps.darks[frame.record.exposure_s] for frame in bracket]
    exposures = [
        unit * frame.raw.exposure_s * _central(source, frame)
        for frame, source in zip(bracket, sources, strict=True)
    ]
    shown = [
        exposed(frame, dark, exposure, veil)
        for frame, dark, exposure, veil in zip(
            bracket, darks, exposures, _veils(bracket, darks, exposures, job), strict=True
        )
    ]
    pixels = Pixels(job.gain, job.saturation, job.linearity, maps.response)
    merged = merge_pixels(shown, pixels)
    texels = Rectifier(
        merged.value, merged.variance, job.sensor.pattern, Camera(job.rig.camera),
        bracket[0].view, job.grid,
    )  # fmt: skip
    development = Development(
        rate=unit / job.rate_per_brdf,
        relative=job.relative_variance,
        matrix=np.linalg.inv(job.camera_from_space).astype(np.float64),
        even=_evening(sources[0], job.grid),
    )
    develop(texels, development, tiles)


def _veils(
    bracket: Sequence[Frame], darks: Sequence[Dark], exposures: Sequence[float], job: Job
) -> Sequence[NDArray[np.float64] | None]:
    # a sum of all pixels takes its time
    if not job.stray_light:
        return [None] * len(bracket)
    raws = [frame.raw for frame in bracket]
    means = surrounds(raws, darks, exposures, job.linearity, job.saturation)
    return [job.stray_light * mean for mean in means]


def source_of(frame: Frame, job: Job) -> Source:
    """Return the lamps over a frame, each with the strength that was found of it."""
    flux = np.multiply(frame.record.flux, job.strengths)
    return Source(job.rig.lamps, frame.light, flux.tolist())


def _central(source: Source, frame: Frame) -> float:
    shed = float(source.irradiance(np.zeros((1, 3)))[0])
    if shed <= 0:
        raise BadInputError(
            f"{frame.record.file}: no light fell on the sample; check the lamps and capture again"
        )
    return shed


def _evening(source: Source, grid: TexelGrid) -> NDArray[np.float32]:
    """Return the irradiance at the centre over that at each texel, shape (side, side).

    Lamps are far away, so that a few nodes each way tell it to 1e-7.
    """
    half = grid.side_mm / 2.0
    nodes = chebyshev.chebpts1(_NODES)
    x, y = half * np.stack(np.meshgrid(nodes, nodes))
    points = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    at_nodes = source.irradiance(np.zeros((1, 3))) / source.irradiance(points)
    between = chebyshev.chebvander(grid.x_mm / half, _NODES - 1) @ np.linalg.inv(
        chebyshev.chebvander(nodes, _NODES - 1)
    )
    # rows run along -y
    down = (between[::-1] @ at_nodes.reshape(_NODES, _NODES)).astype(np.float32)
    return np.asarray(down @ between.T.astype(np.float32))

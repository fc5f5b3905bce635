"""What a process needs to know to turn frames into texels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from gonio.files import canonical_json, sha256_bytes

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from gonio.calibration import Linearity
    from gonio.journal import FrameRecord
    from gonio.photogrammetry.geometry_file import Geometry
    from gonio.photogrammetry.grid import TexelGrid
    from gonio.plan import Shot
    from gonio.reduce.dark import Dark
    from gonio.reduce.raw import Sensor
    from gonio.rig import Rig


@dataclass(frozen=True)
class Maps:
    """What is known of each pixel of the sensor.

    Attributes
    ----------
    darks
        What is taken off a frame, by exposure in seconds.
    response
        See `gonio.reduce.hdr.Pixels`.
    """

    darks: dict[float, Dark]
    response: NDArray[np.float32] | None


@dataclass(frozen=True)
class Job:
    """Of a whole session; small, since it is sent to every process.

    Attributes
    ----------
    root, store
        The session's folder and the array's, which all processes see under these names.
    made_from
        Hash of all that texels are made from, but for the shots' own frames.
    rig, sensor, grid
        What took the frames, and the texels.
    gain, saturation, linearity
        See `gonio.reduce.hdr.Pixels`.
    stray_light
        Share of a frame's light that lies over all of it.
    strengths
        Of the lamps 1 to 11, where they differ at equal flux.
    rate_per_brdf, relative_variance, camera_from_space
        See `gonio.reduce.white.Response`.
    darks
        Read variance and number of the dark frames, by exposure in seconds.
    remedy
        What to do about a frame of no use.
    geometry
        Camera and view arm as measured, where they were.
    """

    root: Path
    store: Path
    made_from: str
    rig: Rig
    sensor: Sensor
    grid: TexelGrid
    gain: float
    saturation: float
    linearity: Linearity | None
    stray_light: float
    strengths: tuple[float, ...]
    rate_per_brdf: NDArray[np.float64]
    relative_variance: NDArray[np.float64]
    camera_from_space: NDArray[np.float64]
    darks: dict[float, tuple[float, int]]
    remedy: str
    geometry: Geometry | None


@dataclass(frozen=True)
class Block:
    """The shots of one light and a few neighboring views, which one file of the array holds.

    Attributes
    ----------
    light
        Index of the light.
    views
        Index of each shot's view.
    shots
        As many.
    records
        What the journal says of their frames.
    """

    light: int
    views: tuple[int, ...]
    shots: tuple[Shot, ...]
    records: tuple[FrameRecord, ...]

    def made_from(self, job: Job) -> str:
        """Return the hash of all that the block is made from."""
        content = [
            job.made_from,
            [shot.model_dump(mode="json") for shot in self.shots],
            [record.model_dump(mode="json") for record in self.records],
        ]
        return sha256_bytes(canonical_json(content))

"""What is known of the sensor when frames are read: nothing, or all that a calibration found."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Protocol

import numpy as np

from gonio.calibration import MAPS_NAME
from gonio.calibrationfolder import load_calibration
from gonio.errors import BadFileError, BadInputError
from gonio.reduce.dark import Dark, mean_dark
from gonio.reduce.doubt import Doubt

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from gonio.calibration import CalibrationDocument, CameraIdentity, Halo, Linearity
    from gonio.reduce.raw import Sensor

    Mosaics = Sequence[NDArray[np.uint16]]


class Correction(Protocol):
    """Turns raw values into light."""

    @property
    def bad(self) -> NDArray[np.bool_] | None:
        """Pixels to leave out, shape (height, width); None: nobody knows."""

    @property
    def even(self) -> bool:
        """Whether each pixel's response is known, so that any pixel serves for any other."""

    @property
    def gain(self) -> float | None:
        """Raw units per electron; None: the session's white frames tell it."""

    @property
    def linearity(self) -> Linearity | None:
        """How raw values bend; None: they do not."""

    @property
    def stray_light(self) -> float:
        """Share of a frame's light that is spread over all of it; the rig file's goes before."""

    @property
    def halo(self) -> Halo | None:
        """Light that is spread about what is bright; None: not known."""

    @property
    def doubt(self) -> Doubt:
        """How well it is known."""

    def check(self, sensor: Sensor) -> None:
        """Refuse frames of another camera than the one it was made with."""

    def dark(self, mosaics: Mosaics, exposure_s: float) -> Dark:
        """Return what to take off frames of one exposure, by dark frames of it."""

    def saturation(self, sensor: Sensor) -> float:
        """Return the raw value from which a pixel counts as saturated."""

    def linear(self, signal: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return signals above dark as they would be of a linear sensor, shaped as given."""

    def response(self, sensor: Sensor) -> NDArray[np.float64]:
        """Return how much each pixel answers to light, 1 at the centre, shape (height, width)."""

    def flux(self, monitored: Sequence[float]) -> Sequence[float]:
        """Return what lamps 1 to 11 shed when their monitors say so."""


class Uncorrected:
    """Takes the sensor as it is: dark frames off, and nothing else."""

    bad = None
    even = False
    gain = None
    linearity = None
    stray_light = 0.0
    halo = None
    doubt = Doubt()

    def check(self, sensor: Sensor) -> None:
        """Refuse nothing."""

    def dark(self, mosaics: Mosaics, exposure_s: float) -> Dark:
        """Return the mean of the dark frames."""
        del exposure_s
        return mean_dark(mosaics)

    def saturation(self, sensor: Sensor) -> float:
        """Return 98 % of the range."""
        return sensor.saturation

    def linear(self, signal: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the signals."""
        return signal

    def response(self, sensor: Sensor) -> NDArray[np.float64]:
        """Return 1 for each."""
        return np.broadcast_to(1.0, (sensor.height, sensor.width))

    def flux(self, monitored: Sequence[float]) -> Sequence[float]:
        """Return what the monitors say."""
        return monitored


@dataclass(frozen=True)
class Calibrated:
    """Corrects by a calibration (see `gonio.calibration`).

    Attributes
    ----------
    document
        What was found of sensor and lamps.
    folder
        Where it was found.
    offset, rate
        Of each pixel without light, raw units and raw units a second, shape (height, width).
    answer
        Of each pixel to light, 1 at the picture's centre, shape (height, width).
    bad
        Pixels to leave out, shape (height, width).
    """

    document: CalibrationDocument
    folder: Path
    offset: NDArray[np.float64]
    rate: NDArray[np.float64]
    answer: NDArray[np.float64]
    bad: NDArray[np.bool_]
    even: ClassVar[bool] = True

    @classmethod
    def load(cls, folder: Path) -> Calibrated:
        """Read a calibration of which document and maps are whole (errors as its loader's)."""
        document, path = load_calibration(folder, whole=False), folder / MAPS_NAME
        with np.load(path, allow_pickle=False) as maps:
            offset, rate, answer = (
                np.asarray(maps[name], np.float64) for name in ("offset", "rate", "response")
            )
            return cls(document, folder, offset, rate, answer, np.asarray(maps["bad"], np.bool_))

    @property
    def gain(self) -> float:
        """Raw units per electron."""
        return self.document.gain

    @property
    def linearity(self) -> Linearity:
        """How raw values bend."""
        return self.document.linearity

    @property
    def stray_light(self) -> float:
        """As it was seen in the dark room; 0 where it was not."""
        return self.document.stray_light.share if self.document.stray_light else 0.0

    @property
    def halo(self) -> Halo | None:
        """As it was seen beside the board."""
        return self.document.stray_light.halo if self.document.stray_light else None

    @cached_property
    def doubt(self) -> Doubt:
        """What the calibration says of itself."""
        return Doubt.of(self.document)

    def check(self, sensor: Sensor) -> None:
        """Refuse frames of another camera, or of this one at another setting.

        Raises
        ------
        gonio.errors.BadInputError
            Naming what differs.
        """
        if differs := difference(self.document.camera, sensor.identity):
            raise BadInputError(
                f"{self.folder}: was made with another camera or setting ({differs}); measure with "
                "a calibration of this one"
            )

    def dark(self, mosaics: Mosaics, exposure_s: float) -> Dark:
        """Return the calibration's dark frame, scaled to the session's own.

        A sensor that is warmer than it was has more dark current, and its black level may have
        moved: both are told by a line through the session's mean dark frame over the pixels of
        the calibration's.
        """
        now = mean_dark(mosaics)
        good = ~self.bad
        grown, away = exposure_s * self.rate, now.mean - self.offset
        level, mean = grown[good].mean(), away[good].mean()
        spread = float(((grown[good] - level) ** 2).sum())
        together = float(((grown[good] - level) * (away[good] - mean)).sum())
        scale = together / spread if spread else 0.0
        known = self.offset + mean + scale * (grown - level)
        return Dark(known, now.read_variance, self._frames(exposure_s))

    def _frames(self, exposure_s: float) -> int:
        counts = [series.frames for series in self.document.dark if series.exposure_s == exposure_s]
        return max(counts, default=1)

    def saturation(self, sensor: Sensor) -> float:
        """Return where the calibration saw raw values end, less a margin."""
        del sensor
        return self.document.saturation

    def linear(self, signal: NDArray[np.float64]) -> NDArray[np.float64]:
        """Undo the bending that the calibration found."""
        return self.document.linearity.undo(signal)

    def response(self, sensor: Sensor) -> NDArray[np.float64]:
        """Return the flat field."""
        del sensor
        return self.answer

    def flux(self, monitored: Sequence[float]) -> Sequence[float]:
        """Return each monitor's reading times its lamp's strength."""
        strengths = {lamp.n: lamp.strength for lamp in self.document.lamps}
        return [value * strengths.get(n, 1.0) for n, value in enumerate(monitored, start=1)]


def correction_in(folder: Path) -> Correction:
    """Return the correction by the calibration in a folder; none where there is no folder.

    Raises
    ------
    gonio.errors.BadFileError
        When the calibration is not as it was made.
    """
    if not folder.is_dir():
        return Uncorrected()
    try:
        return Calibrated.load(folder)
    except (OSError, KeyError, ValueError) as error:
        remedy = "put back the session's own copy"
        raise BadFileError(folder, f"has no maps that can be read ({error})", remedy) from None


def difference(calibrated: CameraIdentity, seen: CameraIdentity) -> str:
    """Name the first thing in which frames differ from those of a calibration; empty for none."""
    for name, value in calibrated:
        if getattr(seen, name) != value:
            return f"{name} {value!r}, and the frames have {getattr(seen, name)!r}"
    return ""

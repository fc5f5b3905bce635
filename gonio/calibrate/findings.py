"""What the frames of a calibration say, part by part."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gonio.calibrate.bad_pixels import find_bad
from gonio.calibrate.ending import end_of
from gonio.calibrate.flat import FlatField
from gonio.calibrate.glare import away_from_board_px, stray_light_of
from gonio.calibrate.linearity import fit_linearity
from gonio.calibrate.scene import WhiteScene
from gonio.calibrate.transfer import fit_gain, level_of
from gonio.calibration import LampStrength, TransferPoint
from gonio.errors import BadInputError
from gonio.words import several

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.calibrate.dark import DarkMaps
    from gonio.calibrate.exposing import Exposed
    from gonio.calibrate.transfer import Level
    from gonio.calibration import BadPixels, DarkSeries, Linearity, StrayLight
    from gonio.reduce.raw import Sensor
    from gonio.rig import Rig

_GREEN = 1
_QUANTIZATION = 1.0 / 12.0
# of linearity and the light's color, each of which tells the other
_ROUNDS = 4
# for a variance within a frame
_FEWEST_PIXELS = 16


class Findings:
    """Gathers the parts of a calibration in the order in which they build on each other.

    Parameters
    ----------
    rig
        What was measured with.
    dark
        Offset and dark current.
    scene
        The white reference at the first turn of the camera.
    probes
        A frame of it for each exposure, rising, all lamps lit.

    Attributes
    ----------
    sensor
        What the frames say of it.
    patch
        The pixels that levels and lamps are told from, shape (height, width).
    end
        Where raw values end.
    """

    def __init__(
        self, rig: Rig, dark: DarkMaps, scene: WhiteScene, probes: Sequence[Exposed]
    ) -> None:
        self.rig, self.dark = rig, dark
        self.sensor: Sensor = probes[0].raw.sensor
        self.points: list[TransferPoint] = []
        self.lamps: list[LampStrength] = []
        self.series: tuple[DarkSeries, ...] = ()
        self.linearity: Linearity
        self.gain, self.gain_sigma = 0.0, 0.0
        self.response: NDArray[np.float64]
        self.bad: NDArray[np.bool_]
        self.bad_pixels: BadPixels
        self.measured: NDArray[np.bool_]
        self.flat_sigma = 0.0
        self.stray_light: StrayLight | None = None
        self._scene = scene
        alike = np.ones(scene.patch.shape)
        self._dark_bad, _ = find_bad(dark, alike, alike)
        self.patch = scene.patch & ~self._dark_bad
        self._where = [self.patch & (scene.channel == channel) for channel in range(3)]
        fewest = min(int(where.sum()) for where in self._where)
        if fewest < _FEWEST_PIXELS:
            raise BadInputError(
                f"{several(fewest, 'pixel')} of a color see the middle of the white reference, and "
                f"{_FEWEST_PIXELS} are needed; use a longer lens, or compare [camera] focal_px and "
                "distance_m with the rig"
            )
        self.end = end_of(probes, self._where, [self._dark_of(probe) for probe in probes])
        self._flat = FlatField(rig.camera, scene.channel)
        self._levels: list[list[Level]] = []
        self._strengths: dict[int, tuple[float, float]] = {}

    @property
    def read_noise_e(self) -> float:
        """In electrons, without what rounding to whole numbers adds."""
        return math.sqrt(max(self.dark.read_variance - _QUANTIZATION, 0.0)) / self.gain

    @property
    def _stray_share(self) -> float:
        return self.stray_light.share if self.stray_light else 0.0

    @property
    def full_well_e(self) -> float:
        """Electrons at which the raw values end, the bending undone."""
        return float(self.linearity.undo(np.array(self.end.above)) / self.gain)

    def add_level(self, frames: Sequence[Exposed], current_mA: float) -> None:
        """Add repeats of one level."""
        levels = [self._level_of(frames, channel) for channel in range(3)]
        self._levels.append(levels)
        green = levels[_GREEN]
        self.points.append(
            TransferPoint(
                exposure_s=float(np.mean([frame.raw.exposure_s for frame in frames])),
                current_mA=round(current_mA, 1),
                dose=green.dose,
                signal=green.signal,
                variance=green.variance,
                saturated=green.saturated,
            )
        )

    def _level_of(self, frames: Sequence[Exposed], channel: int) -> Level:
        where = self._where[channel]
        raw = np.array([frame.raw.mosaic[where] for frame in frames], np.float64)
        dark = np.array([self._dark_of(frame)[where] for frame in frames])
        doses = np.array([self._scene.dose(frame, where).mean() for frame in frames])
        saturated = bool((raw >= self.end.saturation).any())
        return level_of(raw - dark, doses, saturated=saturated)

    def fit_sensor(self) -> None:
        """Fit linearity and gain to the levels."""
        free = [levels for levels in self._levels if not any(each.saturated for each in levels)]
        dose = np.array([levels[_GREEN].dose for levels in free])
        signal = np.array([[each.signal for each in levels] for levels in free]).reshape(-1, 3)
        noise = np.array([levels[_GREEN].relative_noise for levels in free])
        raw_range, color = self.end.above, None
        # how red the light was is known once red and blue are linear, too
        for _ in range(_ROUNDS):
            self.linearity, scale = fit_linearity(dose, signal[:, _GREEN], raw_range, color, noise)
            red, _, blue = np.log(self.linearity.undo(signal).clip(1.0)).T
            color = red - blue
        single = [each for levels in self._levels for each in levels if not each.saturated]
        self.gain, self.gain_sigma = fit_gain(single, self.dark.read_variance, self.linearity)
        self.points = [
            point.model_copy(update={"dose": scale * point.dose}) for point in self.points
        ]

    def add_stray(self, lit: Sequence[Exposed], dark: NDArray[np.float64]) -> None:
        """Tell stray light from frames that see the dark room, and the mean dark frame there."""
        away_px = away_from_board_px(self.rig.camera, lit[0].view)
        signals = [self.linearity.undo(frame.raw.mosaic - dark) for frame in lit]
        self.stray_light = stray_light_of(signals, away_px, self._scene.channel, self._dark_bad)

    def add_flat(self, frame: Exposed) -> None:
        """Add a frame for the flat field."""
        scene = WhiteScene(self.rig, frame)
        seen = scene.seen & (frame.raw.mosaic < self.end.saturation)
        expected = np.zeros(seen.shape)
        expected[seen] = scene.dose(frame, seen)
        signal = self._linear(frame)
        for channel in range(3):
            mine = self._scene.channel == channel
            signal[mine] -= self._stray_share * signal[mine].mean()
        self._flat.add(signal, expected, seen)

    def add_lamp(self, n: int, frames: Sequence[Exposed]) -> None:
        """Add frames of one lamp alone."""
        patch = self.patch
        signal = float(sum(self._linear(frame)[patch].sum() for frame in frames))
        dose = float(sum(self._scene.dose(frame, patch).sum() for frame in frames))
        monitor = self.rig.uncertainty.flux_monitor / math.sqrt(len(frames))
        self._strengths[n] = (signal / dose, math.hypot(math.sqrt(self.gain / signal), monitor))

    def finish(self, series: Sequence[DarkSeries]) -> None:
        """Settle flat field, bad pixels and lamps, now that all frames are taken."""
        self.series = tuple(series)
        self.response, smooth, self.measured = self._flat.response(~self._dark_bad)
        self.flat_sigma = self._flat.sigma(self.gain)
        self.bad, self.bad_pixels = find_bad(self.dark, self.response, smooth)
        mean = float(np.mean([strength for strength, _ in self._strengths.values()]))
        self.lamps = [
            LampStrength(n=n, strength=strength / mean, sigma=relative * strength / mean)
            for n, (strength, relative) in self._strengths.items()
        ]

    def _dark_of(self, frame: Exposed) -> NDArray[np.float64]:
        return self.dark.offset + self.dark.rate * frame.raw.exposure_s

    def _linear(self, frame: Exposed) -> NDArray[np.float64]:
        return self.linearity.undo(frame.raw.mosaic - self._dark_of(frame))

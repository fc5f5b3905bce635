"""What a calibration says of a camera: what its sensor does to light, and how that is known."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Final, Literal

from pydantic import AwareDatetime, Field

from gonio.files import canonical_json, sha256_bytes, write_json
from gonio.validation import Document, within

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

SCHEMA: Final = "gonio.calibration/1"
DOCUMENT_NAME: Final = "calibration.json"
MAPS_NAME: Final = "maps.npz"


class CameraIdentity(Document):
    """Which camera took the frames.

    Attributes
    ----------
    model
        Its UniqueCameraModel and, where the files state one, its serial number.
    iso
        Sensitivity, where the files state one.
    pattern
        Filter colors of the 2 x 2 cell.
    width, height
        In pixels.
    black, white
        BlackLevel and WhiteLevel, in raw units.
    """

    model: str
    iso: int | None
    pattern: str
    width: int
    height: int
    black: int
    white: int


class TwinIdentity(Document):
    """Which simulated sensor it was: another seed has other pixels."""

    seed: int
    imperfections_sha256: str


class Linearity(Document):
    """How raw values bend away from the light that made them, and how to undo it.

    Attributes
    ----------
    coefficients
        c of light = s (1 + c1 u + c2 u^2 + ...), u = s / `raw_range`.
    raw_range
        From BlackLevel to where raw values end, in raw units.
    reach
        The u up to which it holds, a tenth beyond the brightest level; above, the bending stays.
    deviation, left
        Largest deviation from a line between 5 and 95 % of the range, relative, before and after.
    errors
        Of the coefficients, such as occur independently, one standard uncertainty each: the
        covariance is the sum of their outer products. Calibrations of before tell none.
    """

    coefficients: tuple[float, ...]
    raw_range: float
    reach: float
    deviation: float
    left: float
    errors: tuple[tuple[float, ...], ...] = Field(default=(), exclude_if=lambda it: not it)

    def bending(self, signal: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return light over signal, for signals above dark in raw units, shaped as given."""
        import numpy as np

        u = np.clip(signal / self.raw_range, None, self.reach)
        return np.asarray(np.polynomial.polynomial.polyval(u, (1.0, *self.coefficients)))

    def undo(self, signal: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what a linear sensor would say, shaped as given."""
        straight: NDArray[np.float64] = signal * self.bending(signal)
        return straight


class TransferPoint(Document):
    """One level of the white reference (photon transfer, and linearity).

    Attributes
    ----------
    exposure_s, current_mA
        How it was lit and exposed.
    dose
        Light, in the unit in which a linear sensor would give as many raw units.
    signal
        Mean above dark of the green pixels, in raw units.
    variance
        Of one pixel from frame to frame, in raw units squared.
    saturated
        Whether a pixel was; such a point enters no fit.
    """

    exposure_s: float
    current_mA: float
    dose: float
    signal: float
    variance: float
    saturated: bool


class DarkSeries(Document):
    """Dark frames of one exposure.

    Attributes
    ----------
    exposure_s
        How long.
    since_start_s
        When, since the first frame: where a camera tells no temperature, how warm it may be.
    level
        Mean above BlackLevel, in raw units.
    frames
        How many.
    """

    exposure_s: float
    since_start_s: float
    level: float
    frames: int


class LampStrength(Document):
    """What a lamp sheds for its monitor's reading, the mean of all lamps being 1."""

    n: int
    strength: float
    sigma: float


class Halo(Document):
    """Light that is spread about what is bright, by a bell.

    Attributes
    ----------
    share
        Of each pixel's light.
    sigma
        Standard uncertainty of that.
    width
        Standard deviation of the bell, as a share of the frame's width.
    """

    share: float
    sigma: float
    width: float


class StrayLight(Document):
    """Share of a frame's light that is spread over all of it, seen beside the board.

    Attributes
    ----------
    share
        Of the frame's mean.
    sigma
        Standard uncertainty of that.
    halo
        Where there is one.
    """

    share: float
    sigma: float
    halo: Halo | None = Field(default=None, exclude_if=lambda it: it is None)


class BadPixels(Document):
    """How many pixels are left out, each counted once, under the first that holds."""

    hot: int
    noisy: int
    offset: int
    response: int


class CalibrationDocument(Document):
    """What `gonio calibrate` found.

    Attributes
    ----------
    made_utc
        When the last frame was taken.
    rig_sha256, camera, twin
        On what: the rig file, the camera, and of a simulated one which.
    gain, gain_sigma
        Raw units per electron.
    read_noise_e
        Of a pixel and frame, in electrons.
    saturation
        The raw value from which a pixel counts as saturated.
    end_seen
        Whether frames showed where raw values end; if not WhiteLevel was taken.
    full_well_e
        Electrons at which the raw values end.
    linearity
        How raw values bend.
    transfer, dark, lamps, bad_pixels
        What it was told from.
    flat_covered
        Share of the pixels whose response was measured; the others have that of a smooth fit.
    flat_sigma
        Standard uncertainty of one pixel's response, relative, by the noise of photons; 0 where it
        was not told.
    stray_light
        Where it could be seen.
    files
        SHA-256 of every other file in the folder, by its name.
    """

    schema_: Literal["gonio.calibration/1"] = Field(default=SCHEMA, alias="schema")
    made_utc: AwareDatetime
    rig_sha256: str
    camera: CameraIdentity
    twin: TwinIdentity | None
    gain: Annotated[float, within(1e-9, 1e9)]
    gain_sigma: float
    read_noise_e: float
    saturation: float
    end_seen: bool = Field(default=True, exclude_if=lambda it: it)
    full_well_e: float
    linearity: Linearity
    transfer: tuple[TransferPoint, ...]
    dark: tuple[DarkSeries, ...]
    lamps: tuple[LampStrength, ...]
    bad_pixels: BadPixels
    flat_covered: float
    flat_sigma: float = Field(default=0.0, exclude_if=lambda it: not it)
    stray_light: StrayLight | None = Field(default=None, exclude_if=lambda it: it is None)
    files: dict[str, str]

    @property
    def sha256(self) -> str:
        """SHA-256 of its canonical JSON, and by `files` of the whole folder."""
        return sha256_bytes(canonical_json(self._plain()))

    def save(self, folder: Path) -> None:
        """Write `calibration.json`, whole or not at all."""
        write_json(folder / DOCUMENT_NAME, {**self._plain(), "sha256": self.sha256})

    def _plain(self) -> dict[str, object]:
        return self.model_dump(mode="json", by_alias=True)

"""What a rig is: its arms, axes, lamps, camera and sample holder, as `rig.toml` says."""

from __future__ import annotations

import math
import tomllib
from importlib import resources
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from gonio.errors import BadInputError
from gonio.files import canonical_json, sha256_bytes
from gonio.geometry import HOLDER_RADIUS_MM
from gonio.uncertainty import Uncertainty
from gonio.validation import Document, check, parse_toml, read_text, within

AXES = ("view_theta", "view_phi", "light_theta", "light_phi")
AxisName = Literal["view_theta", "view_phi", "light_theta", "light_phi"]

_REMEDY = "compare it with docs/topics/rig-file.md"

# what no rig is: caught here, where the key can be named, and not in the middle of a night
Distance = Annotated[float, within(0.05, 100)]
Width = Annotated[float, within(0, 1e4)]
Offset = Annotated[float, within(-1e4, 1e4)]
Place = Annotated[float, within(-1e5, 1e5)]
Angle = Annotated[float, within(-3600, 3600)]
Timeout = Annotated[float, within(0.1, 3600)]
# left out of the hash where nobody waits, so that files of before there was such a key keep theirs
Wait = Annotated[float, within(0, 86400), Field(exclude_if=lambda seconds: seconds == 0)]
Share = Annotated[float, within(0, 0.5), Field(exclude_if=lambda share: share == 0)]
Pixels = Annotated[int, within(2, 30000)]
Point = tuple[Place, Place, Place]

_MOST_COUNTS = 2**32 - 1


class KeepOut(Document):
    """A box, in mm in the sample's frame, that no arm may enter."""

    min_mm: Point
    max_mm: Point

    @model_validator(mode="after")
    def _corners_in_order(self) -> KeepOut:
        if any(low >= high for low, high in zip(self.min_mm, self.max_mm, strict=True)):
            raise ValueError("each of min_mm must be below the same of max_mm")
        return self

    @model_validator(mode="after")
    def _leaves_the_sample(self) -> KeepOut:
        # every line of sight ends there, so no pose would be free
        nearest = [
            max(low, min(high, 0.0)) for low, high in zip(self.min_mm, self.max_mm, strict=True)
        ]
        if self.max_mm[2] > 0.0 and math.hypot(*nearest) < HOLDER_RADIUS_MM:
            raise ValueError(
                f"the box reaches within {HOLDER_RADIUS_MM:g} mm of the sample's centre, where "
                "every line of sight ends; end it below z = 0, or keep it further out"
            )
        return self


class Arm(Document):
    """The bus that the axes hang on, and what both arms have in common."""

    transport: Literal["tcp", "rtu"]
    host: str | None = None
    port: Annotated[int, within(1, 65535)] | None = None
    device: str | None = None
    profile: str = "cia402-modbus"
    min_separation_deg: Annotated[float, within(0, 179)] = 0.0
    arm_width_mm: Width = 0.0
    lamp_width_mm: Width = 0.0
    keep_out: tuple[KeepOut, ...] = ()
    settle_limit_urad: Annotated[float, within(0.1, 65534)] = 12.0
    homing_timeout_s: Timeout = 120.0

    @model_validator(mode="after")
    def _has_an_address(self) -> Arm:
        if self.transport == "tcp" and (self.host is None or self.port is None):
            raise ValueError("transport tcp needs host and port")
        if self.transport == "rtu" and self.device is None:
            raise ValueError("transport rtu needs device")
        return self


class Axis(Document):
    """One axis: its drive, its encoder's scale, its travel and its speed."""

    unit: Annotated[int, within(1, 247)]
    counts_per_deg: Annotated[float, within(-1e9, 1e9)]
    zero_counts: Annotated[int, within(-(2**31), 2**31 - 1)]
    min_deg: Angle
    max_deg: Angle
    max_velocity_deg_s: Annotated[float, within(1e-3, 1e4)]
    max_acceleration_deg_s2: Annotated[float, within(1e-3, 1e5)]
    in_position_deg: Annotated[float, within(1e-5, 10)] = 0.03
    following_error_deg: Annotated[float, within(1e-4, 360)] = 2.0
    approach_deg: Annotated[float, within(-90, 90)] = 0.0

    @model_validator(mode="after")
    def _scale_and_travel(self) -> Axis:
        scale = abs(self.counts_per_deg)
        if scale < 1:
            raise ValueError(
                f"counts_per_deg {self.counts_per_deg!r} is out of range, 1 to 1e9 is allowed, "
                "either way round"
            )
        if self.min_deg >= self.max_deg:
            raise ValueError("min_deg must be below max_deg")
        if max(abs(self.to_counts(end)) for end in (self.min_deg, self.max_deg)) >= 2**31:
            raise ValueError("the travel does not fit 32-bit counts; check counts_per_deg")
        for name in ("max_velocity_deg_s", "max_acceleration_deg_s2"):
            counts = getattr(self, name) * scale
            if not 1 <= counts <= _MOST_COUNTS:
                raise ValueError(
                    f"{name} is {counts:g} in counts, and 1 to {_MOST_COUNTS} is allowed; "
                    "check counts_per_deg"
                )
        return self

    def to_counts(self, degrees: float) -> int:
        """Return the nearest encoder count."""
        return round(degrees * self.counts_per_deg) + self.zero_counts

    def to_degrees(self, counts: int) -> float:
        """Return the angle of an encoder count in degrees."""
        return (counts - self.zero_counts) / self.counts_per_deg


class Axes(Document):
    """The four axes by name."""

    view_theta: Axis
    view_phi: Axis
    light_theta: Axis
    light_phi: Axis

    @model_validator(mode="after")
    def _units_differ(self) -> Axes:
        units = [self[name].unit for name in AXES]
        if len(set(units)) != len(units):
            raise ValueError(f"each axis needs a unit of its own, not {units}")
        return self

    def __getitem__(self, name: str) -> Axis:
        axis: Axis = getattr(self, name)
        return axis


class Lamp(Document):
    """One lamp and its place in the head, seen as the camera sees: x right, y up."""

    n: Annotated[int, within(1, 11)]
    x_mm: Offset
    y_mm: Offset


class Lamps(Document):
    """The lamp head."""

    device: str
    dialect: str = "lamps-1"
    distance_m: Distance = 2.0
    lamp: tuple[Lamp, ...] = Field(min_length=1, max_length=11)
    watchdog_ms: Annotated[int, within(0, 3_600_000)] = 30000
    warm_up_s: Wait = 0.0
    rest_after_s: Wait = 0.0
    rest_s: Wait = 0.0

    @field_validator("lamp")
    @classmethod
    def _numbers_differ(cls, lamps: tuple[Lamp, ...]) -> tuple[Lamp, ...]:
        if len({lamp.n for lamp in lamps}) != len(lamps):
            raise ValueError("two lamps have the same n")
        return lamps

    @model_validator(mode="after")
    def _rest_after_light(self) -> Lamps:
        if bool(self.rest_after_s) != bool(self.rest_s):
            raise ValueError("rest_after_s and rest_s go together: give both, or neither")
        return self


class CameraSetting(Document):
    """A setting of the camera's own, by the name that its library has for it."""

    name: str
    value: str


class CameraSpec(Document):
    """The camera: how its files come, its sensor and lens, and its exposures."""

    kind: Literal["folder", "gphoto2"] = "folder"
    folder: str = Field(default="", exclude_if=lambda path: not path)
    settings: tuple[CameraSetting, ...] = Field(default=(), exclude_if=lambda each: not each)
    distance_m: Distance = 2.0
    width: Pixels
    height: Pixels
    focal_px: Annotated[float, within(100, 1e6)]
    centre_px: tuple[float, float]
    distortion: tuple[Annotated[float, within(-1e6, 1e6)], ...] = ()
    file_timeout_s: Timeout = 10.0
    exposures_s: tuple[Annotated[float, within(1e-6, 300)], ...] = Field(min_length=1)
    stray_light: Share = 0.0

    @field_validator("distortion")
    @classmethod
    def _five_or_none(cls, distortion: tuple[float, ...]) -> tuple[float, ...]:
        if len(distortion) not in (0, 5):
            raise ValueError("give [k1, k2, p1, p2, k3], or [] for none")
        return distortion

    @field_validator("exposures_s")
    @classmethod
    def _rising(cls, exposures: tuple[float, ...]) -> tuple[float, ...]:
        if list(exposures) != sorted(set(exposures)):
            raise ValueError("list the exposures from short to long, each once")
        return exposures

    @model_validator(mode="after")
    def _knows_where_files_are(self) -> CameraSpec:
        if self.kind == "folder" and not self.folder:
            raise ValueError("kind folder needs folder")
        if self.kind == "folder" and self.settings:
            raise ValueError("settings are of kind gphoto2; leave them out")
        return self

    @model_validator(mode="after")
    def _sample_in_sight(self) -> CameraSpec:
        # the camera looks at the sample's centre, so that is where this pixel is
        for centre, pixels in zip(self.centre_px, (self.width, self.height), strict=True):
            if not 0 <= centre <= pixels - 1:
                raise ValueError(
                    f"centre_px {centre!r} is out of range, 0 to {pixels - 1} is allowed"
                )
        return self


class Holder(Document):
    """The sample holder and the white reference that takes the sample's place."""

    changer: Literal["manual", "command"] = "manual"
    changer_command: tuple[str, ...] = Field(default=(), exclude_if=lambda words: not words)
    reference: Annotated[float | str, within(1e-3, 1.2, or_text=True)] = 0.99

    @model_validator(mode="after")
    def _has_what_it_runs(self) -> Holder:
        if (self.changer == "command") != bool(self.changer_command):
            raise ValueError('changer = "command" and changer_command go together')
        return self


class Rig(Document):
    """A whole rig (see docs/topics/rig-file.md for every key)."""

    arm: Arm
    axis: Axes
    lamps: Lamps
    camera: CameraSpec
    holder: Holder
    uncertainty: Uncertainty = Field(
        default=Uncertainty(), exclude_if=lambda stated: stated == Uncertainty()
    )

    @property
    def sha256(self) -> str:
        """SHA-256 of the rig's canonical JSON: comments and key order do not count."""
        return sha256_bytes(canonical_json(self.model_dump(mode="json")))

    def check_reach(self, axis: str, degrees: float) -> None:
        """Refuse an angle beyond an axis' travel.

        Raises
        ------
        BadInputError
            Naming the axis and its travel.
        """
        travel = self.axis[axis]
        if not travel.min_deg <= degrees <= travel.max_deg:
            raise BadInputError(
                f"{axis} {degrees:g} deg is beyond the axis' travel of {travel.min_deg:g} to "
                f"{travel.max_deg:g} deg; change the plan, or the rig file if it is wrong"
            )


def default_rig_text() -> str:
    """Return the built-in rig file."""
    return resources.files("gonio").joinpath("data/rig.toml").read_text(encoding="utf-8")


def default_rig() -> Rig:
    """Return the built-in rig."""
    return Rig.model_validate(tomllib.loads(default_rig_text()))


def load_rig(path: Path | str) -> Rig:
    """Read and check a rig file.

    Raises
    ------
    gonio.errors.BadFileError
        When the file is missing, is not TOML, or a key is missing, unknown or out of range.
    """
    path = Path(path)
    return check(Rig, parse_toml(read_text(path, _REMEDY), path, _REMEDY), path, _REMEDY)

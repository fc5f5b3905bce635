"""What a rig is: its arms, axes, lamps, camera and sample holder, as `rig.toml` says."""

from __future__ import annotations

import tomllib
from importlib import resources
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from gonio.errors import BadInputError
from gonio.files import canonical_json, sha256_bytes
from gonio.validation import Document, check, parse_toml, read_text

AXES = ("view_theta", "view_phi", "light_theta", "light_phi")
AxisName = Literal["view_theta", "view_phi", "light_theta", "light_phi"]

_REMEDY = "compare it with docs/topics/rig-file.md"

Positive = Annotated[float, Field(gt=0)]
NonNegative = Annotated[float, Field(ge=0)]
Point = tuple[float, float, float]


class KeepOut(Document):
    """A box, in mm in the sample's frame, that no arm may enter."""

    min_mm: Point
    max_mm: Point

    @model_validator(mode="after")
    def _corners_in_order(self) -> KeepOut:
        if any(low >= high for low, high in zip(self.min_mm, self.max_mm, strict=True)):
            raise ValueError("each of min_mm must be below the same of max_mm")
        return self


class Arm(Document):
    """The bus that the axes hang on, and what both arms have in common."""

    transport: Literal["tcp", "rtu"]
    host: str | None = None
    port: int | None = Field(default=None, ge=1, le=65535)
    device: str | None = None
    profile: str = "cia402-modbus"
    min_separation_deg: Annotated[float, Field(ge=0, lt=180)] = 0.0
    arm_width_mm: NonNegative = 0.0
    lamp_width_mm: NonNegative = 0.0
    keep_out: tuple[KeepOut, ...] = ()
    settle_limit_urad: Positive = 12.0
    homing_timeout_s: Positive = 120.0

    @model_validator(mode="after")
    def _has_an_address(self) -> Arm:
        if self.transport == "tcp" and (self.host is None or self.port is None):
            raise ValueError("transport tcp needs host and port")
        if self.transport == "rtu" and self.device is None:
            raise ValueError("transport rtu needs device")
        return self


class Axis(Document):
    """One axis: its drive, its encoder's scale, its travel and its speed."""

    unit: int = Field(ge=1, le=247)
    counts_per_deg: float
    zero_counts: int = Field(ge=-(2**31), lt=2**31)
    min_deg: float
    max_deg: float
    max_velocity_deg_s: Positive
    max_acceleration_deg_s2: Positive
    in_position_deg: Positive = 0.03
    following_error_deg: Positive = 2.0
    approach_deg: float = 0.0

    @model_validator(mode="after")
    def _scale_and_travel(self) -> Axis:
        if self.counts_per_deg == 0:
            raise ValueError("counts_per_deg must not be 0")
        if self.min_deg >= self.max_deg:
            raise ValueError("min_deg must be below max_deg")
        if max(abs(self.to_counts(end)) for end in (self.min_deg, self.max_deg)) >= 2**31:
            raise ValueError("the travel does not fit 32-bit counts; check counts_per_deg")
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

    n: int = Field(ge=1, le=11)
    x_mm: float
    y_mm: float


class Lamps(Document):
    """The lamp head."""

    device: str
    dialect: Literal["lamps-1"] = "lamps-1"
    distance_m: Positive = 2.0
    lamp: tuple[Lamp, ...] = Field(min_length=1, max_length=11)
    watchdog_ms: int = Field(default=30000, ge=0, le=3_600_000)

    @field_validator("lamp")
    @classmethod
    def _numbers_differ(cls, lamps: tuple[Lamp, ...]) -> tuple[Lamp, ...]:
        if len({lamp.n for lamp in lamps}) != len(lamps):
            raise ValueError("two lamps have the same n")
        return lamps


class CameraSpec(Document):
    """The camera: where its files appear, its sensor and lens, and its exposures."""

    kind: Literal["folder"] = "folder"
    folder: str
    distance_m: Positive = 2.0
    width: int = Field(ge=2, le=30000)
    height: int = Field(ge=2, le=30000)
    focal_px: Positive
    centre_px: tuple[float, float]
    distortion: tuple[float, ...] = ()
    file_timeout_s: Positive = 10.0
    exposures_s: tuple[Annotated[float, Field(ge=1e-6, le=300)], ...] = Field(min_length=1)

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


class Holder(Document):
    """The sample holder and the white reference that takes the sample's place."""

    changer: Literal["manual"] = "manual"
    reference: Annotated[float, Field(gt=0, le=1.2)] | str = 0.99


class Rig(Document):
    """A whole rig (see docs/topics/rig-file.md for every key)."""

    arm: Arm
    axis: Axes
    lamps: Lamps
    camera: CameraSpec
    holder: Holder

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

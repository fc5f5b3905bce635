"""How a rig acts in time: what its axes, lamps and camera take, measured or as built in."""

from __future__ import annotations

import math
import tomllib
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Final, Literal

from pydantic import Field

from gonio.errors import BadFileError
from gonio.files import canonical_json, sha256_bytes, write_json
from gonio.rig import AXES, Axis, Lamps, Rig
from gonio.validation import Document, check, parse_json, read_text, within

SCHEMA: Final = "gonio.timing/1"
TIMING_NAME: Final = "rig-timing.json"
"""What `gonio rig bench` calls its file, and where `gonio plan` looks for it."""

_REMEDY = "measure the rig with: gonio rig bench"

Seconds = Annotated[float, within(0, 1e6)]


class Spread(Document):
    """A time that is not always the same.

    Attributes
    ----------
    mean_s
        Its mean.
    sd_s
        Standard deviation of one occurrence, independent of the others.
    error_s
        Standard uncertainty of the mean: the same error in every occurrence.
    """

    mean_s: Seconds
    sd_s: Seconds = 0.0
    error_s: Seconds = 0.0


class AxisTiming(Document):
    """How one axis moves, as it acts and not as its rig file says.

    Attributes
    ----------
    latency_s
        From the command to move until the motion begins, and from its end until that is noticed.
    velocity_deg_s, acceleration_deg_s2
        Of the profile.
    jerk_deg_s3
        Of an S-curve; 0 for a trapezoid.
    sd_s
        Standard deviation of one move about the profile.
    error
        Relative standard uncertainty of the profile's time: the same in every move.
    settle
        From the end of the motion until its arm is still.
    homing_velocity_deg_s, homing_s
        Homing takes `homing_s` and the way to the home switch at that velocity.
    """

    latency_s: Seconds
    velocity_deg_s: Annotated[float, within(1e-6, 1e6)]
    acceleration_deg_s2: Annotated[float, within(1e-6, 1e9)]
    jerk_deg_s3: Annotated[float, within(0, 1e12)] = 0.0
    sd_s: Seconds = 0.0
    error: Annotated[float, within(0, 1)] = 0.0
    settle: Spread = Spread(mean_s=0.0)
    homing_velocity_deg_s: Annotated[float, within(1e-6, 1e6)]
    homing_s: Seconds = 0.0

    @classmethod
    def nominal(cls, axis: Axis) -> AxisTiming:
        """Return an axis that acts just as its rig file says, at once and without shaking."""
        return cls(
            latency_s=0.0,
            velocity_deg_s=axis.max_velocity_deg_s,
            acceleration_deg_s2=axis.max_acceleration_deg_s2,
            homing_velocity_deg_s=axis.max_velocity_deg_s,
        )


class AxesTiming(Document):
    """The four axes by name."""

    view_theta: AxisTiming
    view_phi: AxisTiming
    light_theta: AxisTiming
    light_phi: AxisTiming

    def __getitem__(self, name: str) -> AxisTiming:
        axis: AxisTiming = getattr(self, name)
        return axis


class Timing(Document):
    """What a rig takes for everything that a capture does.

    Attributes
    ----------
    rig_sha256
        The rig that it is of.
    measured
        Whether it was measured on that rig; otherwise it is what the built-in twin takes.
    axis
        The four axes.
    ring_down_s
        In which an arm's vibration falls to 1/e: two stops at once shake more than one.
    startup
        Greeting and enabling everything, without homing, and lighting the lamps once.
    lamps
        Setting the lamps for a shot.
    hold
        What a frame takes beside its exposure while the arms must stand still.
    read_out
        From then until its file is there, which a move may use.
    white_level_s
        Exposure at which the white reference at 0:45, all lamps at full current and 25 deg C,
        reaches the camera's white level in its most sensitive channel.
    """

    schema_: Literal["gonio.timing/1"] = Field(default=SCHEMA, alias="schema")
    rig_sha256: str
    measured: bool
    axis: AxesTiming
    ring_down_s: Seconds = 0.0
    startup: Spread
    lamps: Spread
    hold: Spread
    read_out: Spread
    white_level_s: Annotated[float, within(1e-9, 1e6)]

    @property
    def sha256(self) -> str:
        """SHA-256 of the canonical JSON of everything else."""
        return sha256_bytes(canonical_json(self._content()))

    def save(self, path: Path) -> None:
        """Write it with its hash, whole or not at all."""
        write_json(path, self._content() | {"sha256": self.sha256})

    @classmethod
    def load(cls, path: Path | str) -> Timing:
        """Read a timing and check every field and its hash.

        Raises
        ------
        gonio.errors.BadFileError
            When the file is missing, of another schema, malformed, or changed since it was made.
        """
        path = Path(path)
        data = parse_json(read_text(path, _REMEDY), path, _REMEDY)
        if not isinstance(data, dict):
            raise BadFileError(path, "is no timing (no object at the top)", _REMEDY)
        if data.get("schema") != SCHEMA:
            raise BadFileError(path, f"has schema {data.get('schema')!r}, not {SCHEMA!r}", _REMEDY)
        stated = data.pop("sha256", None)
        timing = check(cls, data, path, _REMEDY)
        if stated != timing.sha256:
            problem = "is missing" if stated is None else "does not match the content"
            raise BadFileError(path, f"sha256: {problem}", _REMEDY)
        return timing

    def _content(self) -> dict[str, Any]:
        return self.model_dump(mode="json", by_alias=True)


class _BuiltIn(Document):
    """The keys of `gonio/data/timing.toml`, which explains them."""

    latency_s: float
    settle_s: float
    settle_sd_s: float
    settle_error_s: float
    settle_acceleration_deg_s2: float
    settle_limit_urad: float
    ring_down_s: float
    error: float
    homing_speed_share: float
    homing_crawl_share: float
    homing_crawl_deg: float
    homing_notice_s: float
    startup: Spread
    lamps: Spread
    hold: Spread
    read_out: Spread
    white_level_s: float
    white_lamps: int
    white_distance_m: float

    def axis(self, spec: Axis, limit_urad: float) -> AxisTiming:
        """Return how an axis of these speeds would act."""
        velocity, acceleration = spec.max_velocity_deg_s, spec.max_acceleration_deg_s2
        search, crawl = self.homing_speed_share * velocity, self.homing_crawl_share * velocity
        ramps = (search + crawl) / acceleration
        past_edge = self.homing_crawl_deg / search + self.homing_crawl_deg / crawl
        return AxisTiming(
            latency_s=self.latency_s,
            velocity_deg_s=velocity,
            acceleration_deg_s2=acceleration,
            error=self.error,
            settle=self._settle(acceleration, limit_urad),
            homing_velocity_deg_s=search,
            homing_s=ramps + past_edge + self.homing_notice_s,
        )

    def white(self, lamps: Lamps) -> float:
        """Return the exposure that fills the camera's range under these lamps."""
        nearer = (self.white_distance_m / lamps.distance_m) ** 2
        return self.white_level_s * self.white_lamps / len(lamps.lamp) / nearer

    def _settle(self, acceleration: float, limit_urad: float) -> Spread:
        # an arm is kicked in proportion to the ramp of its stop, and rings down exponentially
        harder = acceleration / self.settle_acceleration_deg_s2
        looser = limit_urad / self.settle_limit_urad
        mean_s = self.settle_s + self.ring_down_s * math.log(harder / looser)
        return Spread(mean_s=max(mean_s, 0.0), sd_s=self.settle_sd_s, error_s=self.settle_error_s)


def default_timing(rig: Rig) -> Timing:
    """Return what a rig is expected to take before anybody has measured it.

    Speeds and accelerations are the rig file's; everything else is what the built-in rig's twin
    was measured to take (`gonio/data/timing.toml`).
    """
    text = resources.files("gonio").joinpath("data/timing.toml").read_text(encoding="utf-8")
    known = _BuiltIn.model_validate(tomllib.loads(text))
    limit = rig.arm.settle_limit_urad
    axes = {name: known.axis(rig.axis[name], limit) for name in AXES}
    return Timing(
        rig_sha256=rig.sha256,
        measured=False,
        axis=AxesTiming(**axes),
        ring_down_s=known.ring_down_s,
        startup=known.startup,
        lamps=known.lamps,
        hold=known.hold,
        read_out=known.read_out,
        white_level_s=known.white(rig.lamps),
    )

"""The Plan document: which shots, in which order, and why."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Final, Literal

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from gonio.errors import BadFileError
from gonio.files import canonical_json, sha256_bytes, write_json
from gonio.validation import Document, check, parse_json, read_text

SCHEMA: Final = "gonio.plan/1"
_REMEDY = "make a new one with: gonio plan"

Theta = Annotated[float, Field(ge=0)]
Phi = Annotated[float, Field(ge=0, lt=360)]
Exposure = Annotated[float, Field(ge=1e-6, le=300)]
Side = Literal["view", "light"]

# what came after the first plans is left out of the file, and so of its hash, where it says nothing
Turns = Annotated[int, Field(ge=-10, le=10, exclude_if=lambda turns: turns == 0)]
Mark = Annotated[bool, Field(exclude_if=lambda marked: not marked)]


def _is_unknown(value: object) -> bool:
    # left out of the file, and so of the hash of plans that were made before there was such a field
    return value is None


class LampSetting(Document):
    """A lamp and its current."""

    n: int = Field(ge=1, le=11)
    mA: float = Field(gt=0, le=700)


class Shot(Document):
    """One pair of directions to measure, and how.

    `view_turn` and `light_turn` are full turns that the phi axes stand at beyond phi: an axis that
    travels more than a turn reaches some directions at two angles or more. An `anchor` repeats a
    pair that is measured anyway, to see whether the rig drifts.
    """

    index: int = Field(ge=0)
    light_theta_deg: Theta
    light_phi_deg: Phi
    view_theta_deg: Theta
    view_phi_deg: Phi
    exposures_s: tuple[Exposure, ...] = Field(min_length=1)
    lamps: tuple[LampSetting, ...] = Field(min_length=1)
    view_turn: Turns = 0
    light_turn: Turns = 0
    anchor: Mark = False

    @model_validator(mode="after")
    def _reflection_only(self) -> Shot:
        for name in ("light_theta_deg", "view_theta_deg"):
            theta = getattr(self, name)
            if theta > 90:
                raise ValueError(
                    f"{name} {theta:g} is beyond 90 deg: that would be transmission, "
                    "which gonio does not measure"
                )
        return self

    @model_validator(mode="after")
    def _nothing_twice(self) -> Shot:
        if len(set(self.exposures_s)) < len(self.exposures_s):
            raise ValueError("exposures_s holds one exposure twice, which would count it twice")
        if len({lamp.n for lamp in self.lamps}) < len(self.lamps):
            raise ValueError("lamps names one lamp twice")
        return self

    def axis_deg(self, axis: str) -> float:
        """Return the angle of an axis, by its name in the rig file, in degrees."""
        angle: float = getattr(self, f"{axis}_deg")
        side, _, name = axis.partition("_")
        return angle + 360.0 * getattr(self, f"{side}_turn") if name == "phi" else angle

    def direction_deg(self, side: Side) -> tuple[float, float]:
        """Return theta and phi of the view or the light; at the pole, which has none, phi is 0."""
        theta: float = getattr(self, f"{side}_theta_deg")
        return theta, getattr(self, f"{side}_phi_deg") if theta else 0.0


class Selection(Document):
    """How the shots were chosen.

    `variance_left` is the share of a prior's variance that they leave unknown, where it was asked,
    and `variance_bound` what any choice of as many pairs leaves at least; `prior_sha256` is of that
    prior, None where none was asked. Of a plan that goes on from samples, `deviation_before` and
    `deviation_after` are the mean posterior standard deviation of ln(f + 0.01 white) over the
    81 x 81 pairs, as it was and as it is expected to become. `demand` says by what
    pairs count, where not all alike, and `demand_sha256` is of that file.
    """

    criterion: str
    candidates: str
    views: int = Field(ge=0)
    lights: int = Field(ge=0)
    full_set: int = Field(ge=1)
    reciprocal_pairs: int = Field(ge=0)
    variance_left: float | None = Field(default=None, ge=0)
    variance_bound: float | None = Field(default=None, ge=0)
    deviation_before: float | None = Field(default=None, ge=0, exclude_if=_is_unknown)
    deviation_after: float | None = Field(default=None, ge=0, exclude_if=_is_unknown)
    prior_sha256: str | None = Field(default=None, exclude_if=_is_unknown)
    demand: str | None = Field(default=None, exclude_if=_is_unknown)
    demand_sha256: str | None = Field(default=None, exclude_if=_is_unknown)
    route: str

    @property
    def variance_of(self) -> str:
        """What `variance_left` is a share of, in words."""
        weighed = f", weighted by {self.demand}" if self.demand else ""
        return f"of the prior's variance{weighed}"


class RouteTime(Document):
    """What moving along the shots' order takes, and what no order of them can beat."""

    moving_s: float = Field(ge=0)
    bound_s: float = Field(ge=0)

    @property
    def gap(self) -> float:
        """By how much the route is above the bound at most, as a share of the route."""
        return 1.0 - self.bound_s / self.moving_s if self.moving_s else 0.0


class LeftOut(Document):
    """Shots that were not taken, and why.

    Attributes
    ----------
    reason
        Follows their number in a sentence.
    shots
        How many pairs that leaves unmeasured; over all reasons they add up.
    spared_shots, spared_min
        How many shots and minutes fewer the plan takes for it than one without this omission;
        below zero: more. None where that was not asked.
    error_inside, error_outside
        Change of the expected standard deviation of ln(BRDF), as a mean over what a scene asks for
        and over what it does not.
    """

    reason: str
    shots: int = Field(ge=0)
    spared_shots: int | None = None
    spared_min: float | None = None
    error_inside: float | None = None
    error_outside: float | None = None

    @model_serializer(mode="wrap")
    def _what_is_known(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        # without nulls: the hash of a plan that has no such numbers stays as it was
        return {name: value for name, value in handler(self).items() if value is not None}


class Estimates(Document):
    """What the plan will cost on the rig that it was made for.

    `total_lo_s` and `total_hi_s` are the 5 and 95 % quantiles of the whole; `timing_sha256` is of
    the timing that was measured on the rig, None where it was not.
    """

    moving_s: float = Field(ge=0)
    settling_s: float = Field(ge=0)
    exposing_s: float = Field(ge=0)
    overhead_s: float = Field(ge=0)
    homing_s: float = Field(default=0.0, ge=0, exclude_if=lambda seconds: seconds == 0)
    total_lo_s: float | None = Field(default=None, ge=0, exclude_if=_is_unknown)
    total_hi_s: float | None = Field(default=None, ge=0, exclude_if=_is_unknown)
    timing_sha256: str | None = Field(default=None, exclude_if=_is_unknown)
    frames: int = Field(ge=0)
    storage_bytes: int = Field(ge=0)

    @property
    def total_s(self) -> float:
        """Everything together, in seconds."""
        doing_s = self.moving_s + self.settling_s + self.exposing_s
        return doing_s + self.overhead_s + self.homing_s


class Plan(Document):
    """Shots in route order, how they were chosen, what was left out, and what it will cost."""

    schema_: Literal["gonio.plan/1"] = Field(default=SCHEMA, alias="schema")
    parent: str | None = None
    rig_sha256: str
    selection: Selection
    left_out: tuple[LeftOut, ...] = ()
    estimates: Estimates
    route: RouteTime | None = Field(default=None, exclude_if=lambda route: route is None)
    shots: tuple[Shot, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _indices_differ(self) -> Plan:
        if len({shot.index for shot in self.shots}) != len(self.shots):
            raise ValueError("two shots have the same index")
        return self

    @property
    def sha256(self) -> str:
        """SHA-256 of the canonical JSON of everything else."""
        return sha256_bytes(canonical_json(self._content()))

    def of_demand(self, what: str, sha256: str | None = None) -> Plan:
        """Return the plan that names what said how much pairs count."""
        named = self.selection.model_copy(update={"demand": what, "demand_sha256": sha256})
        return self.model_copy(update={"selection": named})

    def save(self, path: Path | str) -> None:
        """Write the plan with its hash, whole or not at all."""
        write_json(Path(path), self._content() | {"sha256": self.sha256})

    @classmethod
    def load(cls, path: Path | str, *, remedy: str = _REMEDY) -> Plan:
        """Read a plan and check every field and its hash; `remedy` tells what else to do.

        Raises
        ------
        gonio.errors.BadFileError
            When the file is missing, of another schema, malformed, or changed since it was made.
        """
        path = Path(path)
        data = parse_json(read_text(path, remedy), path, remedy)
        if not isinstance(data, dict):
            raise BadFileError(path, "is not a plan (no object at the top)", remedy)
        if data.get("schema") != SCHEMA:
            raise BadFileError(path, f"has schema {data.get('schema')!r}, not {SCHEMA!r}", remedy)
        stated = data.pop("sha256", None)
        plan = check(cls, data, path, remedy)
        if stated is None:
            raise BadFileError(path, "sha256: is missing", remedy)
        if stated != plan.sha256:
            raise BadFileError(path, "sha256: does not match the content", remedy)
        return plan

    def _content(self) -> dict[str, Any]:
        return self.model_dump(mode="json", by_alias=True)

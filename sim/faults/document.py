"""A file of faults: which, and when or how often."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from pydantic import Field, model_validator

from gonio.rig import AxisName
from gonio.validation import Document, check, parse_toml, read_text, within
from sim.faults.kinds import KINDS

if TYPE_CHECKING:
    from pathlib import Path

_REMEDY = "compare it with docs/topics/faults.md"


class Fault(Document):
    """One fault.

    Attributes
    ----------
    kind
        Its name in `sim.faults.KINDS`.
    rate
        Its chance each time that what its kind counts comes by.
    at
        Or at which of them, counted from 0 since the capture was begun or resumed.
    at_s
        Or at which times of the session's clock: at the first of them from then on.
    axis, lamp
        Which one; any, unless said.
    lasts_s
        For how long; as its kind, unless said.
    """

    kind: str
    rate: Annotated[float, within(0, 1)] = 0.0
    at: tuple[Annotated[int, within(0, 10**9)], ...] = ()
    at_s: tuple[Annotated[float, within(0, 1e9)], ...] = ()
    axis: AxisName | None = None
    lamp: Annotated[int, within(1, 11)] | None = None
    lasts_s: Annotated[float, within(0, 86400)] | None = None

    @model_validator(mode="after")
    def _makes_sense(self) -> Fault:
        kind = KINDS.get(self.kind)
        if kind is None:
            raise ValueError(f"{self.kind!r} is no kind of fault; use {', '.join(KINDS)}")
        if not (self.rate or self.at or self.at_s):
            raise ValueError("say when: a rate above 0, at, or at_s")
        if self.axis and kind.place not in ("axis", "bus"):
            raise ValueError(f"{self.kind} strikes no axis; leave axis out")
        if self.lamp and kind.place != "lamp":
            raise ValueError(f"{self.kind} strikes no lamp; leave lamp out")
        if self.lasts_s is not None and not kind.lasts_s:
            raise ValueError(f"{self.kind} is over at once; leave lasts_s out")
        return self

    @property
    def duration_s(self) -> float:
        """For how long it lasts."""
        return KINDS[self.kind].lasts_s if self.lasts_s is None else self.lasts_s


class FaultsFile(Document):
    """What a file of faults holds."""

    fault: tuple[Fault, ...] = Field(min_length=1)


def load_faults(path: Path) -> tuple[Fault, ...]:
    """Read and check a file of faults.

    Raises
    ------
    gonio.errors.BadFileError
        When it is missing, is not TOML, or a key is missing, unknown or out of range.
    """
    return check(
        FaultsFile, parse_toml(read_text(path, _REMEDY), path, _REMEDY), path, _REMEDY
    ).fault

"""Register tables of drives, as data: which register holds which object of CiA 402."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from gonio.validation import Document, load_named

BUILT_IN = ("cia402-modbus",)

_REMEDY = "compare it with docs/topics/drivers.md"


class Register(Document):
    """One object of the drive: its address, type and access."""

    address: Annotated[int, Field(ge=0, le=0xFFFF)]
    type: Literal["uint16", "int32", "uint32"] = "uint16"
    writable: bool = False

    @property
    def words(self) -> int:
        """How many 16-bit registers it takes."""
        return 1 if self.type == "uint16" else 2


class Profile(Document):
    """The registers that the arm driver uses, by name (IEC 61800-7-201)."""

    controlword: Register
    statusword: Register
    mode: Register
    mode_display: Register
    target_position: Register
    position_actual: Register
    profile_velocity: Register
    profile_acceleration: Register
    following_error: Register
    error_code: Register
    digital_inputs: Register
    watchdog_ms: Register
    settle_urad: Register


def load_profile(name: str) -> Profile:
    """Return a built-in register table, or one of a file that ends in .toml.

    Errors as for `gonio.validation.load_named`.
    """
    return load_named(Profile, name, BUILT_IN, "drive profile", _REMEDY)

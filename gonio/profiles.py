"""Register tables of drives, as data: which register holds which object of CiA 402."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib import resources
from typing import Annotated, Literal

from pydantic import Field

from gonio.errors import BadInputError
from gonio.validation import Document

BUILT_IN = ("cia402-modbus",)


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


@cache
def load_profile(name: str) -> Profile:
    """Return a built-in register table.

    Raises
    ------
    BadInputError
        For an unknown name.
    """
    if name not in BUILT_IN:
        raise BadInputError(f"drive profile {name!r} is not known; use {', '.join(BUILT_IN)}")
    text = resources.files("gonio").joinpath(f"data/{name}.toml").read_text(encoding="utf-8")
    return Profile.model_validate(tomllib.loads(text))

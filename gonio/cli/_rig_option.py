"""The option --rig of commands that need a real rig."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from collections.abc import Callable

_F = TypeVar("_F", bound="Callable[..., Any]")


def rig_option(function: _F) -> _F:
    """Add the option --rig, which must be given."""
    return click.option(
        "--rig",
        "rig_path",
        type=click.Path(path_type=Path),
        required=True,
        help="The rig's file, which says where arm, lamps and camera are.",
    )(function)

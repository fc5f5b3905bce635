"""The option --imperfections of commands that make a twin."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from collections.abc import Callable

_F = TypeVar("_F", bound="Callable[..., Any]")


def imperfections_option(function: _F) -> _F:
    """Add the option --imperfections, None where it is not given."""
    return click.option(
        "--imperfections",
        metavar="none|mild|all|FILE.toml",
        help="How far the twin's arms, camera and lamps are from ideal, by name or a file of sizes "
        "(docs/topics/imperfections.md).  "
        "[default: none]",
    )(function)

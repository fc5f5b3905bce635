"""What the commands that act on a served twin share."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from collections.abc import Callable

DEFAULT_FOLDER = Path("served")

_F = TypeVar("_F", bound="Callable[..., Any]")


def at_option(function: _F) -> _F:
    """Add the option --at."""
    return click.option(
        "--at",
        type=click.Path(path_type=Path),
        default=DEFAULT_FOLDER,
        show_default=True,
        help="The folder that the twin is served from.",
    )(function)


def tell(at: Path, words: str) -> None:
    """Have the twin served from a folder do something (see `sim.served.control.tell`)."""
    from sim.served.control import tell
    from sim.served.folder import ServedFolder

    tell(ServedFolder(at).control, words)

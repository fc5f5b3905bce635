"""Notes of the sample belong to the beginning of a session."""

from __future__ import annotations

import click
from click.core import ParameterSource

_NOTES = {
    "sample": "--sample",
    "orientation": "--orientation",
    "mounting": "--mounting",
    "operator": "--operator",
    "temperature_c": "--temperature",
}


def refuse_notes() -> None:
    """Refuse notes on a resume, which keeps those that the session was begun with."""
    from gonio.errors import ResumeRefusedError

    context = click.get_current_context()
    for name, option in _NOTES.items():
        if context.get_parameter_source(name) == ParameterSource.COMMANDLINE:
            raise ResumeRefusedError(
                f"{option}: the notes are those that the session was begun with; leave it out"
            )

"""The option --json: one object on standard output; what is for people goes to standard error."""

from __future__ import annotations

import json
import math
import sys
from contextlib import redirect_stdout
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

SCHEMA: Final = "gonio.answer/1"
_ANSWER: Final = "gonio.answer"


def answers(function: Callable[..., None]) -> Callable[..., None]:
    """Add the option --json to a command that says by `answer` what it found."""

    @wraps(function)
    def answering(*args: Any, as_json: bool, **options: Any) -> None:
        if not as_json:
            function(*args, **options)
            return
        screen, context = sys.stdout, click.get_current_context()
        try:
            with redirect_stdout(sys.stderr):
                function(*args, **options)
        finally:
            # what was found counts, too, where it is found to be wrong and ends in an error
            if (found := context.meta.get(_ANSWER)) is not None:
                click.echo(_text({"command": context.command_path, **found}), file=screen)

    return click.option(
        "--json",
        "as_json",
        is_flag=True,
        help="Print what was found as one JSON object; tables and notes go to stderr.",
    )(answering)


def answer(found: Mapping[str, Any]) -> None:
    """Say what a command found: keys as in files, with units; units are SI where they name none."""
    context = click.get_current_context(silent=True)
    if context is not None:
        context.meta[_ANSWER] = found


def _text(document: Mapping[str, Any]) -> str:
    whole = {"schema": SCHEMA, **document}
    return json.dumps(_plain(whole), indent=1, allow_nan=False, ensure_ascii=False)


def _plain(value: Any) -> Any:
    """Return a value as JSON has it; it has neither NaN nor infinities, so they become null."""
    if hasattr(value, "items"):
        return {str(name): _plain(each) for name, each in value.items()}
    if isinstance(value, Path):
        return str(value)
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value

"""A group of commands that imports none of them to list them."""

from __future__ import annotations

from difflib import get_close_matches
from importlib import import_module
from keyword import iskeyword
from typing import TYPE_CHECKING, Any

import click
from click.shell_completion import CompletionItem

if TYPE_CHECKING:
    from collections.abc import Mapping


class LazyGroup(click.Group):
    """A group whose commands are imported when they are run.

    Parameters
    ----------
    commands_of
        What comes before a command's name in its module's name; the module has a `command`.
    helps
        One line a command, in the order of use.
    """

    def __init__(
        self, *args: Any, commands_of: str, helps: Mapping[str, str], **kwargs: Any
    ) -> None:
        super().__init__(*args, **kwargs)
        self._commands_of, self._helps = commands_of, helps

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the commands in the order of use."""
        return list(self._helps)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import the module of a command."""
        if cmd_name not in self._helps:
            return None
        # no module may be called as a word of the language, as in import
        module = f"{cmd_name}_" if iskeyword(cmd_name) else cmd_name
        command: click.Command = import_module(f"{self._commands_of}{module}").command
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command, or tell the known ones and which of them was perhaps meant."""
        name = args[0]
        if name not in self._helps and not name.startswith("-"):
            near = get_close_matches(name.lower(), self._helps, n=1)
            meant = f" (did you mean {near[0]}?)" if near else ""
            known = ", ".join(self._helps)
            ctx.fail(f"{name!r} is no command of {ctx.command_path}{meant}; use {known}")
        return super().resolve_command(ctx, args)

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        """Return the commands that begin so, and options, without importing a command."""
        commands = [
            CompletionItem(name, help=text)
            for name, text in self._helps.items()
            if name.startswith(incomplete)
        ]
        # a command's own: those of a group would import all of its commands
        return [*commands, *click.Command.shell_complete(self, ctx, incomplete)]

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands without importing them."""
        with formatter.section("Commands"):
            formatter.write_dl(list(self._helps.items()))

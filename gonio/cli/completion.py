"""`gonio completion`: the shell completes commands and options."""

from __future__ import annotations

import click
from click.shell_completion import BashComplete, FishComplete, ZshComplete

SHELLS = {"bash": BashComplete, "zsh": ZshComplete, "fish": FishComplete}


@click.command(name="completion")
@click.argument("shell", type=click.Choice(list(SHELLS), case_sensitive=False))
def command(shell: str) -> None:
    """Print the script by which SHELL completes commands, options and files of gonio.

    It goes where the shell looks for such scripts. For zsh that is a folder on its fpath: put
    fpath=(~/.zfunc $fpath) before compinit in ~/.zshrc. Then open a new shell.

    \b
    Examples:
        gonio completion bash > ~/.local/share/bash-completion/completions/gonio
        gonio completion zsh > ~/.zfunc/_gonio
        gonio completion fish > ~/.config/fish/completions/gonio.fish
    """  # noqa: D301 - click takes a real backspace as "do not wrap"
    from gonio.cli._main import cli

    click.echo(SHELLS[shell](cli, {}, "gonio", "_GONIO_COMPLETE").source())

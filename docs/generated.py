"""Pages that are made of the program itself: its commands and its errors."""

import inspect
from pathlib import Path

import click

from gonio import errors
from gonio.cli._main import cli

_WIDTH = 88  # letters of a line that a page shows whole

COMMANDS = """# Commands

What `gonio COMMAND --help` prints. Options are alike in all of them: `-o` names what is written,
`--json` prints what was found for programs ({doc}`../topics/json`); `gonio completion` has the
shell complete them.

"""
ERRORS = """# Errors

Whatever goes wrong ends in one line: what it is, where, and what to do. In Python it is an
exception of the tree below, whose root is `gonio.GonioError`; on the command line it is that line
on standard error, and an exit code. A traceback is a defect of gonio.

| exit code | after |
| --- | --- |
| 0 | all went well |
| 2 | bad input: an option, a value, a file |
| 3 | a fault of a device or of the disk |
| 4 | a session that cannot be gone on with |
| 130, 143 | Ctrl-C, or SIGTERM: stopped in order, what was finished is kept |
| 141 | nobody reads on, as in `gonio materials \\| head -3` |

"""


def write(folder):
    """Write the pages; one that is as it was keeps its time, so that it is not read again."""
    folder.mkdir(exist_ok=True)
    for name, text in (("commands.md", commands()), ("errors.md", catalogue())):
        path = Path(folder / name)
        if not path.exists() or path.read_text() != text:
            path.write_text(text)


def commands():
    return COMMANDS + "\n".join(section(path, command) for path, command in every(cli, "gonio"))


def every(command, path):
    """Yield groups and commands, each after the group that it is in."""
    if path != "gonio":
        yield path, command
    if isinstance(command, click.Group):
        context = click.Context(command)
        for name in command.list_commands(context):
            yield from every(command.get_command(context, name), f"{path} {name}")


def section(path, command):
    wide = {"max_content_width": _WIDTH, "terminal_width": _WIDTH}
    context = click.Context(command, info_name=path, **wide)
    level = "#" * len(path.split())
    return f"{level} {path}\n\n```text\n{command.get_help(context)}\n```\n"


def catalogue():
    return ERRORS + "\n".join(entry(error) for error in tree(errors.GonioError))


def tree(error):
    """Yield an error of gonio.errors and all below it."""
    yield error
    for below in error.__subclasses__():
        if below.__module__ == errors.__name__:
            yield from tree(below)


def entry(error):
    meaning = inspect.getdoc(error).partition("\n")[0]
    of = "" if error is errors.GonioError else f" A `{error.__base__.__name__}`."
    return (
        f"## {error.__name__}\n\n{meaning}{of} Exit code {error.exit_code}.\n\n"
        f"**What to do:** {error.advice}\n"
    )

"""The entry point: find the command, and turn errors into one line and an exit code."""

from __future__ import annotations

import sys
from importlib import import_module

import click

from gonio import __version__
from gonio.errors import GonioError

# the short helps live here, so that `gonio --help` imports no command
COMMANDS = {
    "plan": "Choose which directions to measure, in which order; writes plan.json.",
    "capture": "Measure a plan on the rig, or on its simulated twin; writes session/.",
    "reduce": "Turn a session's raw frames into BRDF samples with sigma.",
    "reconstruct": "Turn a session, or a table of samples, into an NN-BRDF with a report.",
    "materials": "Show the materials that the simulated rig can carry.",
}


class LazyGroup(click.Group):
    """A group whose commands are imported when they are run."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the commands in the order of use."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import the module of a command."""
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = import_module(f"gonio.cli.{cmd_name}").command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands without importing them."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


@click.command(
    cls=LazyGroup,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
@click.version_option(__version__, prog_name="gonio")
def cli() -> None:
    """Plan, run and complete gonioreflectometer measurements.

    \b
    From nothing to a material, on the simulated rig:
        gonio plan --density sixth       which 3 % of the positions, in which order
        gonio capture --sim              arm, lamps and camera, resumable
        gonio reconstruct session/       raw frames -> BRDF samples -> NN-BRDF and report

    Each command works without options and says more with --help.
    """  # noqa: D301 - click takes a real backspace as "do not wrap"


def main() -> None:
    """Run the command line; exit 2 for bad input, 3 for a device fault, 4 for a refused resume."""
    try:
        cli.main(prog_name="gonio", standalone_mode=False)
    except click.exceptions.Exit as exit_:
        sys.exit(exit_.exit_code)
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except GonioError as error:
        _fail(str(error), error.exit_code)
    except (click.Abort, KeyboardInterrupt):
        _fail("stopped; what was finished is kept", 130)
    except OSError as error:
        _fail(f"{error.filename or 'input/output'}: {error.strerror or error}", 2)


def _fail(message: str, code: int) -> None:
    click.echo(f"gonio: {' '.join(message.split())}", err=True)
    sys.exit(code)

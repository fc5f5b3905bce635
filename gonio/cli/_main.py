"""The entry point: find the command, and turn errors into one line and an exit code."""

from __future__ import annotations

import errno
import os
import signal
import sys
from contextlib import suppress
from typing import TYPE_CHECKING

import click

from gonio import __version__
from gonio.cli._lazy import LazyGroup
from gonio.errors import GonioError

if TYPE_CHECKING:
    from types import FrameType

# what a shell says of a program that SIGPIPE, SIGINT or SIGTERM ended
_NOBODY_READS, _INTERRUPTED, _TERMINATED = 141, 130, 143
# matrices are small here, and threads that meet at each of them wait long on a busy machine;
# where many rows are worth it, nnbrdf.cores.threads_for asks for more
_THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")
_REFUSED = (errno.EACCES, errno.EPERM, errno.EROFS, errno.ENOSPC)

# the short helps live here, so that `gonio --help` imports no command
COMMANDS = {
    "plan": "Choose which directions to measure, in which order; writes plan.json.",
    "calibrate": "Measure what the camera does to light; writes calibration/.",
    "capture": "Measure a plan on the rig, or on its simulated twin; writes session/.",
    "watch": "Watch a capture as it goes, in the browser; pause and stop it.",
    "geometry": "Calibrate camera and view arm by shots of the holder's board.",
    "color": "Find the camera's color matrix by shots of a chart of 24 patches.",
    "reduce": "Turn a session's raw frames into BRDF samples with sigma.",
    "reconstruct": "Turn a session, or a table of samples, into an NN-BRDF with a report.",
    "render": "Show materials on shapes under a probe of light, with their errors.",
    "compare": "Hold materials against each other: table, maps, lobes, renders.",
    "export": "Write a material for another program: a renderer, a standard, a table.",
    "import": "Make a material of a file that another program wrote.",
    "btf": "Turn the pictures of gonio reduce --btf into a network for each texel.",
    "prior": "Make a prior of what materials look like from your own sessions.",
    "rig": "Look a rig over, home, move and stop it, measure what it takes.",
    "sim": "Serve the simulated rig over real wires, and act on it.",
    "study": "Rerun the paper's experiment on any material: activations, encodings, ...",
    "materials": "Show the materials that the simulated rig can carry.",
    "completion": "Print the script by which your shell completes gonio.",
}


@click.command(
    cls=LazyGroup,
    commands_of="gonio.cli.",
    helps=COMMANDS,
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
    """Run the command line; exit 2 for bad input, 3 for a device fault, 4 for a refused resume.

    As in `gonio materials | head -3`, it ends quietly with 141 where nobody reads on.
    """
    signal.signal(signal.SIGTERM, _terminate)
    # under nohup it is to go on
    if signal.getsignal(signal.SIGHUP) == signal.SIG_DFL:
        signal.signal(signal.SIGHUP, _terminate)
    for name in _THREADS:
        os.environ.setdefault(name, "1")
    try:
        cli.main(prog_name="gonio", standalone_mode=False)
    except SystemExit as left:
        # click and rich leave so, with 1, at a broken pipe; a completion does, with 0
        sys.exit(_NOBODY_READS if left.code else 0)
    except click.exceptions.Exit as exit_:
        sys.exit(exit_.exit_code)
    except click.exceptions.NoArgsIsHelpError as error:
        _end(error.format_message(), error.exit_code)
    except click.ClickException as error:
        _fail(_with_help(error), error.exit_code)
    except GonioError as error:
        _fail(_with_notes(str(error), error), error.exit_code)
    except (click.Abort, KeyboardInterrupt) as stop:
        # click makes an Abort of what it catches
        cause = stop.__cause__ or stop
        code = _TERMINATED if isinstance(cause, _Terminated) else _INTERRUPTED
        # a command may have said what is kept of it
        kept = "; ".join(map(str, cause.args)) or "what was finished is kept"
        _fail(_with_notes(f"stopped; {kept}", cause), code)
    except OSError as error:
        place = error.filename or "input/output"
        if error.errno in _REFUSED:
            _fail(f"{place}: {error.strerror}; check the folder, its permissions and space", 3)
        _fail(f"{place}: {error.strerror or error}", 2)


def _with_help(error: click.ClickException) -> str:
    """Return what click says, and where more is said, unless that says what was meant."""
    message = error.format_message()
    context = getattr(error, "ctx", None)
    if context is None or "Did you mean" in message or "; use " in message:
        return message
    return f"{message.rstrip('.')}; see: {context.command_path} --help"


class _Terminated(KeyboardInterrupt):
    """SIGTERM or SIGHUP: a shutdown of the machine, or a closed terminal, stops in order, too."""


def _terminate(number: int, frame: FrameType | None) -> None:
    raise _Terminated


def _with_notes(message: str, error: BaseException) -> str:
    return "; ".join([message, *getattr(error, "__notes__", ())])


def _fail(message: str, code: int) -> None:
    _end(f"gonio: {' '.join(message.split())}", code)


def _end(text: str, code: int) -> None:
    # nobody may read this either; the code stands
    with suppress(BrokenPipeError):
        click.echo(text, err=True)
    sys.exit(code)

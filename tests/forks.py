"""Runs `gonio` in forks of one process that has imported it already, as a process without the wait.

    python -m tests.forks SOCKET

takes requests at a socket, each with where the run's input, output and errors go, and answers each
with the number of its process and, when it ended, with its exit code.
"""

import contextlib
import gc
import importlib
import json
import os
import pkgutil
import select
import signal
import socket
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
# what commands import when they come to it, too
LATE = (
    "cv2", "h5netcdf", "matplotlib.backends.backend_agg", "matplotlib.backends.backend_svg",
    "matplotlib.figure", "rawpy", "rich.progress", "scipy.optimize", "scipy.stats", "tifffile",
    "tomli_w", "xarray",
)  # fmt: skip
# a console asks how wide it is when it is imported
PLAIN = {"COLUMNS": "120", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


class Ended(NamedTuple):
    returncode: int
    stdout: str
    stderr: str


class Forks:
    """The other end: `run` a command line in a fork, or `start` one and watch it."""

    def __init__(self):
        self._folder = tempfile.TemporaryDirectory(prefix="forks-")
        self._address = f"{self._folder.name}/socket"
        with socket.socket(socket.AF_UNIX) as listening:
            listening.bind(self._address)
            listening.listen(64)
            self._server = subprocess.Popen(
                [sys.executable, "-m", "tests.forks", str(listening.fileno())],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                pass_fds=[listening.fileno()],
                cwd=ROOT,
                env=os.environ | PLAIN,
            )

    def run(self, cwd, *arguments, timeout=240, **settings):
        """Run `gonio` with these arguments to its end; for the settings see `start`."""
        with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
            with self.start(cwd, *arguments, stdout=out, stderr=err, **settings) as running:
                code = running.wait(timeout)
            out.seek(0)
            err.seek(0)
            return Ended(code, out.read(), err.read())

    def start(self, cwd, *arguments, stdout, stderr, env=(), before=None):
        """Start `gonio` with these arguments, and return it as it runs.

        `before` is what to call before `gonio`: ("package.module:function", *arguments).
        """
        request = {
            "cwd": str(cwd), "arguments": [str(a) for a in arguments], "before": before,
            "env": os.environ | PLAIN | dict(env),
        }  # fmt: skip
        line = socket.socket(socket.AF_UNIX)
        line.connect(self._address)
        with Path(os.devnull).open() as stdin:
            numbers = [file.fileno() for file in (stdin, stdout, stderr)]
            socket.send_fds(line, [b"+"], numbers)
            line.sendall(json.dumps(request).encode() + b"\n")
        return Running(line)

    def close(self):
        self._server.stdin.close()
        self._server.wait()
        self._folder.cleanup()


class Running:
    """A run of `gonio`; killed when it is left."""

    def __init__(self, line):
        self._line, self._answers = line, line.makefile()
        self.pid = int(self._answers.readline())
        self.returncode = None

    def send_signal(self, number):
        if self.poll() is None:
            os.kill(self.pid, number)

    def poll(self):
        """Return the exit code, or None while it runs."""
        if self.returncode is None and select.select([self._line], [], [], 0)[0]:
            self.returncode = int(self._answers.readline())
        return self.returncode

    def wait(self, timeout):
        """Wait for the end; return the exit code, or the negative number of a signal."""
        if not select.select([self._line], [], [], timeout)[0]:
            raise subprocess.TimeoutExpired("gonio", timeout)
        return self.poll()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.poll() is None:
            self.send_signal(signal.SIGKILL)
            self.wait(20)
        self._answers.close()
        self._line.close()


def serve(listening):
    import_all()
    # what is here stays, and is not to be copied for the sake of a look at it
    gc.freeze()
    keepers = []
    while sys.stdin not in select.select([listening, sys.stdin], [], [])[0]:
        line, _ = listening.accept()
        keepers = [keeper for keeper in keepers if not os.waitpid(keeper, os.WNOHANG)[0]]
        keepers.append(os.fork())
        if not keepers[-1]:
            listening.close()
            os._exit(keep(line))
        line.close()
    for keeper in keepers:
        os.waitpid(keeper, 0)


def import_all():
    for package in ("gonio", "planner", "nnbrdf", "sim"):
        for module in pkgutil.walk_packages(
            importlib.import_module(package).__path__, f"{package}."
        ):
            if not module.name.endswith("__main__"):
                importlib.import_module(module.name)
    for name in LATE:
        importlib.import_module(name)
    # pictures on pages, whose pixels no test counts, are half of a small reconstruction's time
    vars(importlib.import_module("gonio.report.renders")).update(
        _SIZE_PX=16, _LIGHTS=4, _SHAPES=("sphere",)
    )


def keep(line):
    """Run what is asked for in a process of its own, and tell how it ends."""
    _, streams, _, _ = socket.recv_fds(line, 1, 3)
    request = json.loads(line.makefile().readline())
    child = os.fork()
    if not child:
        line.close()
        in_child(request, streams)
    for stream in streams:
        os.close(stream)
    line.sendall(f"{child}\n".encode())
    _, status = os.waitpid(child, 0)
    with contextlib.suppress(BrokenPipeError):
        line.sendall(f"{os.waitstatus_to_exitcode(status)}\n".encode())
    return 0


def in_child(request, streams):
    code = 1
    try:
        for number, stream in enumerate(streams):
            os.dup2(stream, number)
            os.close(stream)
        os.chdir(request["cwd"])
        os.environ.clear()
        os.environ.update(request["env"])
        tempfile.tempdir = None  # as TMPDIR says now
        if request["before"]:
            called, *arguments = request["before"]
            module, _, name = called.partition(":")
            getattr(importlib.import_module(module), name)(*arguments)
        sys.argv = ["gonio", *request["arguments"]]
        importlib.import_module("gonio.cli").main()
        code = 0
    except SystemExit as ended:
        code = ended.code or 0
    except BaseException:
        sys.excepthook(*sys.exc_info())
    finally:
        with contextlib.suppress(OSError, ValueError):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)


if __name__ == "__main__":
    serve(socket.socket(fileno=int(sys.argv[1])))

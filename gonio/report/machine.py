"""On which machine, by which command and when a page was made."""

from __future__ import annotations

import platform
import shlex
import sys
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path

from nnbrdf.cores import cores

_CPU_INFO = Path("/proc/cpuinfo")


def made_by() -> list[tuple[str, str]]:
    """Return the command line, the time and the machine of this process, each with its name."""
    now = datetime.now(UTC).isoformat(" ", "minutes").removesuffix("+00:00")
    command = shlex.join(["gonio", *sys.argv[1:]])
    return [("command", command), ("date", f"{now} UTC"), ("machine", machine())]


def machine() -> str:
    """Return the processor, how many of its cores this process may use, and the system."""
    count = cores()
    return f"{_processor()}, {count} core{'' if count == 1 else 's'}, {platform.system()}"


def _processor() -> str:
    with suppress(OSError):
        for line in _CPU_INFO.read_text(errors="replace").splitlines():
            name, _, value = line.partition(":")
            if name.strip() == "model name":
                return value.strip()
    return platform.processor() or platform.machine()

"""How many cores this process may use."""

import os


def cores() -> int:
    """Return the number of cores; where the system tells, only those this process is bound to."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1

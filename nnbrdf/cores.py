"""How many cores this process may use, and when matrices are worth more than one."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

_WORTH_MORE = 2000


def cores() -> int:
    """Return the number of cores; where the system tells, only those this process is bound to."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@contextmanager
def threads_for(size: int) -> Iterator[None]:
    """Give linear algebra one thread where matrices have few rows, and all cores where many.

    Threads that meet at each of hundreds of small matrices wait for the last one: where other
    programs run, ten times as long as a single thread takes.
    """
    import scipy.linalg  # noqa: F401 - has a BLAS of its own, which is limited once it is loaded
    from threadpoolctl import threadpool_limits

    with threadpool_limits(cores() if size > _WORTH_MORE else 1, "blas"):
        yield

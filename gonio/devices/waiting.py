"""Waiting with a deadline."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from gonio.clock import Clock


def wait_until(
    clock: Clock, condition: Callable[[], bool], timeout_s: float, every_s: float
) -> bool:
    """Ask every `every_s` until `condition` holds; return False when `timeout_s` pass first."""
    deadline = clock.now() + timeout_s
    while not condition():
        if clock.now() >= deadline:
            return False
        clock.sleep(every_s)
    return True

"""Work that a device does in its own thread, as a status of Bluesky."""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable


class Work:
    """A `bluesky.protocols.Status` of a call in the rig's one thread.

    Drivers, journal and clock know one thread only, and RunEngine's must not wait.
    """

    def __init__(self, future: Future[Any]) -> None:
        self._future = future

    def add_callback(self, callback: Callable[[Work], None]) -> None:
        """Call back when it has ended, at once where it has."""
        self._future.add_done_callback(lambda _: callback(self))

    def exception(self, timeout: float | None = 0.0) -> BaseException | None:
        """Wait so many seconds (None: for good); return what went wrong, or None.

        Raises
        ------
        TimeoutError
            When it has not ended by then.
        """
        return self._future.exception(timeout)

    @property
    def done(self) -> bool:
        """Whether it has ended."""
        return self._future.done()

    @property
    def success(self) -> bool:
        """Whether it has ended well."""
        return self._future.done() and self._future.exception() is None


class Worker:
    """The rig's one thread."""

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(1, "gonio-rig")

    def begin(self, call: Callable[..., object], *arguments: object) -> Work:
        """Have something done after all that was begun before."""
        return Work(self._pool.submit(call, *arguments))

    def do(self, call: Callable[..., Any], *arguments: object) -> Any:
        """Have something done, and wait for it; what it raises is raised."""
        return self._pool.submit(call, *arguments).result()

    def close(self) -> None:
        """Wait for what was begun."""
        self._pool.shutdown()

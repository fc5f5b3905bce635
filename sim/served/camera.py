"""The served twin's camera: it renders beside the wires, which have to answer meanwhile."""

from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from sim.tether import Camera


class ServedCamera:
    """Counts the frames of another camera, and names them apart from those of earlier power-ups.

    Parameters
    ----------
    camera
        Makes the files.
    power_ups
        How often the twin in this folder was started before; a key may come again then, and a
        frame's noise and unique id may not.

    Attributes
    ----------
    frames
        How many were made.
    """

    def __init__(self, camera: Camera, power_ups: int) -> None:
        self.frames = 0
        self._camera = camera
        self._suffix = f"|{power_ups}" if power_ups else ""

    def frame(self, *, key: str, **scene: Any) -> bytes:
        """Return a whole DNG (see `sim.tether.Camera`)."""
        data = self._camera.frame(key=key + self._suffix, **scene)
        self.frames += 1
        return data


class DarkRoom:
    """Has files rendered one after the other in a thread, and hands them over on the loop."""

    def __init__(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._thread = ThreadPoolExecutor(1)

    def develop(self, render: Callable[[], bytes], take: Callable[[bytes], None]) -> None:
        """Do as `sim.tether.Tether.develop` is to."""
        job = self._thread.submit(render)

        def hand_over() -> None:
            if not job.cancelled():
                take(job.result())

        job.add_done_callback(lambda _: self._loop.call_soon_threadsafe(hand_over))

    def close(self) -> None:
        """Give up what is not begun, and wait for the rest."""
        self._thread.shutdown(cancel_futures=True)
